// SPDX-License-Identifier: MIT
// Where each value of a config was written, as its record tells.
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

class Origins : public Shell {
 protected:
  /// The lines of a config.yaml that have a value and do not say where it is from.
  static std::vector<std::string> untold(const fs::path& run) {
    std::vector<std::string> out;
    for (const std::string& line : lines_of(text_of(run / "config.yaml"))) {
      const bool has_value = !line.empty() && line.back() != ':' && line.find("{}") == std::string::npos;
      if (has_value && line.find("  # ") == std::string::npos) out.push_back(line);
    }
    return out;
  }
};

/// What a page shows, which is packed in it.
std::string page_data(const fs::path& page) {
  const std::string program =
      "import base64, re, sys, zlib; text = open(sys.argv[1]).read(); "
      "print(zlib.decompress(base64.b64decode(re.search('id=\"data\">([^<]*)', text)[1])).decode())";
  return test::Child({"/usr/bin/python3", "-c", program, page.string()}, page.parent_path()).wait().out;
}

TEST_F(Origins, EndEachLineOfTheConfigOfARunAndStandOnItsPageAndInTheListOfRuns) {
  ASSERT_EQ(palpate(Words{"run", config("paper/object_i.yaml")} + "belief.height.noise=1mm taps=4 --quiet").status, 0);
  const std::string text = text_of(directory() / "config.yaml");
  EXPECT_THAT(untold(directory()), testing::IsEmpty());
  EXPECT_THAT(text, AllOf(HasSubstr("/kernel/rbf.yaml:"), HasSubstr("  noise: 0.001 m  # command line\n"),
                          HasSubstr("\n  tie_tolerance: 1e-08  # default\n")));
  EXPECT_EQ(text_of(directory() / "manifest.json").find("rbf.yaml"), std::string::npos) << "they stand in one place";
  ASSERT_EQ(palpate({"report", directory().string()}).status, 0);
  EXPECT_THAT(page_data(directory() / "report.html"),
              AllOf(HasSubstr("/kernel/rbf.yaml:"), HasSubstr(R"(["belief.height.noise","0.001 m","command line"])")));
  EXPECT_THAT(palpate("list").out, HasSubstr("weighted")) << "the group that was named";
  // Who goes on does not write them anew.
  test::cut_taps(directory());
  fs::remove(directory() / "summary.json");
  ASSERT_EQ(palpate({"resume", directory().string(), "--quiet"}).status, 0);
  EXPECT_EQ(text_of(directory() / "config.yaml"), text);
}

TEST_F(Origins, EndEachLineOfTheConfigOfEachJobHoweverManySettingsASweepHas) {
  ASSERT_EQ(palpate(Words{"sweep", config("paper/object_i.yaml")} +
                    "belief.label.prior_mean=range(0,66) taps=3 initial.count=3 --quiet")
                .status,
            0);
  for (const int job : {0, 65}) {
    const fs::path run = test::job_of(directory(), job);
    EXPECT_THAT(untold(run), testing::IsEmpty());
    EXPECT_THAT(text_of(run / "config.yaml"), HasSubstr("  prior_mean: " + std::to_string(job) + "  # command line\n"));
    EXPECT_THAT(text_of(run / "config.yaml"), HasSubstr("/kernel/rbf.yaml:"));
  }
}

}  // namespace
}  // namespace palpate
