// SPDX-License-Identifier: MIT
#include "report/browser.hpp"

#include "support/sanitizers.hpp"
#include "support/support.hpp"

#include <sstream>

namespace palpate::test {

Browsed browse(const std::filesystem::path& page, const std::vector<std::string>& steps, bool webgl) {
  // The interpreter for which Debian's selenium is installed.
  std::vector<std::string> words{"/usr/bin/python3", (source_folder() / "tests/report/browse.py").string(),
                                 page.string()};
  if (!webgl) words.emplace_back("--no-webgl");
  words.insert(words.end(), steps.begin(), steps.end());
  const TemporaryFolder folder;
  // What a sanitizer needs of the program under test is nothing to the browser.
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

std::string browser_missing() {
  if (kSanitized) return "what a browser makes of a page is the same in every build";
  for (const char* file : {"/usr/bin/chromium", "/usr/bin/chromedriver"}) {
    if (!std::filesystem::exists(file)) return std::string(file) + " is not installed";
  }
  const TemporaryFolder folder;
  const Ended ended = run_program({"/usr/bin/python3", "-c", "import selenium"}, folder.path());
  return ended.status == 0 ? "" : "python3-selenium is not installed";
}

}  // namespace palpate::test
