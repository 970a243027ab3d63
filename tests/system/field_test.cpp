// SPDX-License-Identifier: MIT
// A field that is added to the summary by one line is found wherever fields are: the program here is palpate with such
// a line, `thrice_taps`.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

class AFieldOfOneLine : public Shell {
 protected:
  std::string said(const Words& words) const {
    const fs::path program = test::program_file().parent_path() / "palpate_with_a_field";
    const Ended ended = test::run_program(Words{program} + words, here());
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended.out;
  }
};

TEST_F(AFieldOfOneLine, IsWrittenExpectedAndCompared) {
  said({"sweep", paper(), "acquisition=weighted,uncertainty", "taps=6", "candidates.count=9", "seed=range(0,3)",
        "expect={thrice_taps: '== 18', median(thrice_taps): '>= 18'}", "--quiet"});
  const auto rows = csv_rows(text_of(directory() / "results.csv"));
  ASSERT_EQ(rows.size(), 6U);
  for (const Cells& row : rows) EXPECT_EQ(row.at("thrice_taps"), "18");
  EXPECT_THAT(text_of(job_of(directory(), 0) / "summary.json"), HasSubstr("\"thrice_taps\": 18,"));

  const auto words = HasSubstr("thrice_taps");
  EXPECT_THAT(
      said({"compare", directory(), "--by", "acquisition", "--metric", "thrice_taps", "--where", "thrice_taps > 17"}),
      words);
  EXPECT_THAT(said({"pareto", directory(), "--cost", "thrice_taps", "--error", "footprint_iou"}), words);
  EXPECT_THAT(said("schema"), HasSubstr("|thrice_taps|failed_taps|"));
}

}  // namespace
}  // namespace palpate
