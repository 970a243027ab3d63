// SPDX-License-Identifier: MIT
#include "report/browser.hpp"

#include "support/sanitizers.hpp"

#include <fmt/format.h>

#include <sstream>

namespace palpate::test {

Browsed browse(const std::filesystem::path& page, const std::vector<std::string>& steps, bool webgl) {
  // This interpreter has Debian's selenium.
  std::vector<std::string> words{"/usr/bin/python3", (source_folder() / "tests/report/browse.py").string(),
                                 page.string()};
  if (!webgl) words.emplace_back("--no-webgl");
  words.insert(words.end(), steps.begin(), steps.end());
  const TemporaryFolder folder;
  // The browser must not run under the sanitizer of the program under test.
  const Ended ended = run_program(words, folder.path(), {"ASAN_OPTIONS", "TSAN_OPTIONS", "LD_PRELOAD"});
  Browsed out;
  if (ended.status != 0) out.trouble = ended.err.substr(ended.err.size() > 2000 ? ended.err.size() - 2000 : 0);
  std::istringstream lines(ended.out);
  for (std::string line; std::getline(lines, line);) out.values.push_back(nlohmann::json::parse(line));
  if (ended.status == 0) {
    out.severe = out.values.back().get<std::vector<std::string>>();
    out.values.pop_back();
  }
  return out;
}

namespace {

/// Returns the reason why pages cannot be tested here; "" if they can.
std::string browser_missing() {
  if (kSanitized) return "what a browser makes of a page is the same in every build";
  for (const char* file : {"/usr/bin/chromium", "/usr/bin/chromedriver"}) {
    if (!std::filesystem::exists(file)) return std::string(file) + " is not installed";
  }
  const TemporaryFolder folder;
  const Ended ended = run_program({"/usr/bin/python3", "-c", "import selenium"}, folder.path());
  return ended.status == 0 ? "" : "python3-selenium is not installed";
}

}  // namespace

std::string drawn(int what) { return fmt::format("await document.body.dataset.drawn == '{}'", what); }

void Reports::SetUp() {
  if (const std::string missing = browser_missing(); !missing.empty()) GTEST_SKIP() << missing;
}

void Reports::report(const std::filesystem::path& directory) const {
  const Ended ended = palpate({"report", directory.string()}, folder_.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  ASSERT_EQ(ended.out, (directory / "report.html").string() + "\n");
}

Browsed ReportsInBoth::browse(const std::filesystem::path& directory, const std::vector<std::string>& steps) const {
  Browsed seen = test::browse(directory / "report.html", steps, GetParam());
  EXPECT_EQ(seen.trouble, "");  // also if the page opened a dialog
  EXPECT_THAT(seen.severe, ::testing::IsEmpty());
  return seen;
}

std::string webgl_name(const ::testing::TestParamInfo<bool>& info) { return info.param ? "WithWebGL" : "WithoutWebGL"; }

}  // namespace palpate::test
