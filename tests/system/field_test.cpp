// SPDX-License-Identifier: MIT
// A field that is added to the summary by one line is found wherever fields are: the program here is palpate with such
// a line, `thrice_taps`.
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

class AFieldOfOneLine : public ::testing::Test {
 protected:
  Ended run(std::vector<std::string> words) {
    words.insert(words.begin(), (test::program_file().parent_path() / "palpate_with_a_field").string());
    Ended ended = test::run_program(words, folder_.path());
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended;
  }

  TemporaryFolder folder_;
};

TEST_F(AFieldOfOneLine, IsWrittenExpectedAndCompared) {
  run({"sweep", test::paper(), "acquisition=weighted,uncertainty", "taps=6", "candidates.count=9", "seed=range(0,3)",
       "expect={thrice_taps: '== 18', median(thrice_taps): '>= 18'}", "--quiet"});
  const auto sweep = test::only_run(folder_.path() / "runs");
  const auto rows = test::csv_rows(text_of(sweep / "results.csv"));
  ASSERT_EQ(rows.size(), 6U);
  for (const test::Cells& row : rows) EXPECT_EQ(row.at("thrice_taps"), "18");
  EXPECT_THAT(text_of(sweep / "jobs" / rows.front().at("id") / "summary.json"), HasSubstr("\"thrice_taps\": 18,"));

  EXPECT_THAT(
      run({"compare", sweep.string(), "--by", "acquisition", "--metric", "thrice_taps", "--where", "thrice_taps > 17"})
          .out,
      HasSubstr("thrice_taps"));
  EXPECT_THAT(run({"pareto", sweep.string(), "--cost", "thrice_taps", "--error", "footprint_iou"}).out,
              HasSubstr("thrice_taps"));
  EXPECT_THAT(run({"schema"}).out, HasSubstr("|thrice_taps|failed_taps|"));
}

}  // namespace
}  // namespace palpate
