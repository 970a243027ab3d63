// SPDX-License-Identifier: MIT
// `palpate curves` as a user calls it: errors over the taps of groups, as table, CSV and figures.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

class CurvesOfGroups : public Shell {
 protected:
  /// A sweep of the default, whose taps have no errors in their record.
  fs::path defaults() const {
    return swept("acquisition=outline_and_fill,weighted taps=7 candidates.count=16 seed=range(0,5)",
                 config("default.yaml"));
  }
  Ended curves(const fs::path& sweep, const Words& more = {}) const {
    const Ended ended = palpate(Words{"curves", sweep} + more);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended;
  }
};

int times_in(const std::string& text, const std::string& part) {
  int out = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++out;
  return out;
}

TEST_F(CurvesOfGroups, AreAtEachTapWhatCompareSaysOfThatTap) {
  const fs::path directory = defaults();
  for (const Row& tap : rows_of(job_of(directory, 0), "tap")) EXPECT_FALSE(tap.number("rmse_m")) << "no tap costs it";
  const Ended ended = curves(directory, "-o curves.csv");
  EXPECT_THAT(ended.out, StartsWith("rmse_m [mm] against taps; less is better\n"));
  const std::vector<Cells> rows = csv_rows(text_of(here() / "curves.csv"));
  ASSERT_EQ(rows.size(), 14U) << "two groups, seven taps";
  for (const std::string tap : {"2", "5", "7"}) {
    const Words at = tap == "7" ? Words() : Words{"--at", tap};
    ASSERT_EQ(palpate(Words{"compare", directory} + "--by acquisition --metric rmse_m" + at).status, 0);
    const std::string file =
        tap == "7" ? "compare_acquisition_rmse_m.csv" : "compare_acquisition_rmse_m_at_" + tap + ".csv";
    for (const Cells& group : csv_rows(text_of(directory / file))) {
      if (group.at("kind") != "group") continue;
      int found = 0;
      for (const Cells& row : rows) {
        if (row.at("acquisition") != group.at("group") || row.at("at") != tap) continue;
        ++found;
        for (const char* cell : {"n", "units", "mean", "low_95", "high_95"})
          EXPECT_EQ(row.at(cell), group.at(cell)) << cell;
        EXPECT_NE(row.at("mean"), "");
      }
      EXPECT_EQ(found, 1);
    }
  }
}

TEST_F(CurvesOfGroups, AreComputedOnceAndAgainOnlyForAJobThatRanAgain) {
  const fs::path directory = defaults();
  curves(directory, "-o once.csv");
  const fs::path kept = job_of(directory, 3) / "summaries.jsonl";
  const auto stamp = fs::last_write_time(kept);
  const Ended again = curves(directory, "-o again.csv --metric footprint_iou");
  EXPECT_EQ(fs::last_write_time(kept), stamp);
  EXPECT_EQ(again.err, "table: again.csv\n") << "no job was replayed";
  // What belongs to another summary is not that of this run.
  std::string text = text_of(kept);
  const auto at = text.rfind("\"of_summary\": \"");
  ASSERT_NE(at, std::string::npos);
  char& digit = text[at + 15];
  digit = digit == '0' ? '1' : '0';
  write(kept, text);
  curves(directory, "-o third.csv");
  EXPECT_NE(text_of(kept), text);
  EXPECT_EQ(text_of(here() / "third.csv"), text_of(here() / "once.csv"));
  write(kept, "no JSON\n");
  curves(directory, "-o fourth.csv");
  EXPECT_EQ(text_of(here() / "fourth.csv"), text_of(here() / "once.csv"));
}

TEST_F(CurvesOfGroups, AreDrawnAsPngPdfAndSvgWithABandForEachGroup) {
  const fs::path directory =
      swept("acquisition=weighted,random scene=object_i,object_ii taps=6 candidates.count=16 seed=range(0,5)");
  curves(directory, "-o a.png -o a.pdf -o a.svg --against robot_seconds");
  EXPECT_EQ(text_of(here() / "a.png").substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_THAT(text_of(here() / "a.pdf"), StartsWith("%PDF-"));
  const std::string svg = text_of(here() / "a.svg");
  EXPECT_THAT(svg, AllOf(HasSubstr("<svg"), HasSubstr("weighted"), HasSubstr("scene: object_ii")));
  EXPECT_GE(times_in(svg, "fill-opacity"), 4) << "two groups on two scenes";
  curves(directory);
  EXPECT_TRUE(fs::exists(directory / "curves_acquisition_rmse_m_taps.png"));
  EXPECT_TRUE(fs::exists(directory / "curves_acquisition_rmse_m_taps.csv"));
}

TEST_F(CurvesOfGroups, AreAFigureOfTheSweepsReportOnceTheyAreComputed) {
  const fs::path directory = defaults();
  const fs::path figure = directory / "figures/curves.png";
  EXPECT_EQ(palpate({"report", directory, "--figures"}).status, 0);
  EXPECT_FALSE(fs::exists(figure)) << "report computes none";
  curves(directory, "-o alone.png");
  const Ended ended = palpate({"report", directory, "--figures"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("/figures/curves.png\n"));
  EXPECT_EQ(text_of(figure), text_of(here() / "alone.png"));
}

TEST_F(CurvesOfGroups, RefuseInOneLineWhatCannotBeDrawn) {
  const Words curves{"curves", swept("acquisition=weighted,random taps=4 candidates.count=16 seed=range(0,2)")};
  EXPECT_EQ(refused(curves + "-o a.jpg"),
            "command line: -o: 'a.jpg' does not end in what is written, end it in one of .csv, .png, .pdf, .svg\n");
  EXPECT_THAT(refused(curves + "-o none/a.png"), HasSubstr("there is no folder"));
  EXPECT_THAT(refused(curves + "--by aquisition"), HasSubstr("did you mean 'acquisition'?"));
  EXPECT_THAT(refused(curves + "--metric rsme_m"), HasSubstr("did you mean 'rmse_m'?"));
  EXPECT_THAT(refused(curves + "--metric seed"), HasSubstr("is swept"));
  EXPECT_THAT(refused(curves + "--against wall_seconds"), StartsWith("--against: "));
}

}  // namespace
}  // namespace palpate
