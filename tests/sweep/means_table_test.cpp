// SPDX-License-Identifier: MIT
// Means of several metrics and numbers of taps as a Markdown table.
#include "analysis/compare_report.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

ComparedGroup group(const std::string& name, std::size_t count, double mean) {
  ComparedGroup out;
  out.name = name;
  out.values = {name};
  for (std::size_t job = 0; job < 4; ++job)
    out.counts.add(job < count ? ValueStatus::counted : ValueStatus::without_value);
  out.mean.count = count;
  out.mean.mean = mean;
  return out;
}

Comparison comparison(const char* metric, Unit unit, std::optional<int> taps, std::vector<ComparedGroup> groups) {
  Comparison out;
  out.metric = {metric, unit, RecordField::Better::less};
  out.by = {"strategy"};
  out.groups = std::move(groups);
  if (taps) out.occasion = Checkpoint::after(*taps);
  return out;
}

TEST(MeansTable, HasARowAGroupAndNumberOfTapsAndAColumnAMetric) {
  EXPECT_EQ(means_table({comparison("rmse_m", Unit::metre, 17, {group("bold", 4, 0.0261), group("shy", 4, 0.0412)}),
                         comparison("first_hit_tap", Unit::none, 17, {group("bold", 3, 4.5), group("shy", 0, 0.0)}),
                         comparison("rmse_m", Unit::metre, 30, {group("bold", 4, 0.00915), group("shy", 4, 0.034)}),
                         comparison("first_hit_tap", Unit::none, 30, {group("bold", 4, 6.25), group("shy", 4, 21)})}),
            "| strategy | taps | rmse_m [mm] | first_hit_tap |\n"
            "|---|---:|---:|---:|\n"
            "| bold | 17 | 26.1 | 4.5 |\n"
            "| shy | 17 | 41.2 | - |\n"
            "| bold | 30 | 9.2 | 6.2 |\n"
            "| shy | 30 | 34.0 | 21.0 |\n"
            "\n"
            "first_hit_tap: mean over the runs that have a value (else no object was found).\n");
}

TEST(MeansTable, OfJobsAsTheyEndedHasNoTaps) {
  EXPECT_EQ(means_table({comparison("footprint_iou", Unit::none, {}, {group("a|b", 4, 0.734)})}),
            "| strategy | footprint_iou |\n|---|---:|\n| a\\|b | 0.73 |\n");
}

TEST(MeansTable, SaysWhatIsInNoMeanAndLeavesOutWhatIsLeftOut) {
  Comparison one = comparison("rmse_m", Unit::metre, {}, {group("bold", 4, 0.02), group("shy", 4, 0.03)});
  for (const ValueStatus status : {ValueStatus::failed, ValueStatus::failed, ValueStatus::unfinished})
    one.groups[0].counts.add(status);
  one.groups[1].counts = {};
  for (int job = 0; job < 4; ++job) one.groups[1].counts.add(ValueStatus::left_out);
  EXPECT_EQ(means_table({one}),
            "| strategy | rmse_m [mm] |\n"
            "|---|---:|\n"
            "| bold | 20 |\n"
            "\n"
            "2 jobs failed and 1 have not ended: the means exclude them.\n");
}

TEST(LatexTable, HasMeansWithTheirIntervalsAndNBetweenTheRulesOfBooktabs) {
  Comparison one = comparison("rmse_m", Unit::metre, 17, {group("out_line", 4, 0.0261), group("[a, b]", 3, 0.0412)});
  one.by_seed = true;
  one.groups[0].mean.clusters = 4;
  one.groups[1].mean.clusters = 3;
  one.groups[0].mean.interval = {0.0242, 0.0281};
  EXPECT_EQ(latex_table({one}),
            "% \\usepackage{booktabs}\n"
            "% mean [95 % interval of the mean] and number of jobs; units of the intervals: 3 to 4 seeds\n"
            "% rmse_m: mean over the runs that have a value (else no truth is known).\n"
            "\\begin{tabular}{lrrr}\n"
            "\\toprule\n"
            "strategy & taps & rmse\\_m [mm] & $n$ \\\\\n"
            "\\midrule\n"
            "out\\_line & 17 & $26.1\\ [24.2, 28.1]$ & 4 \\\\\n"
            "{[a, b]} & 17 & $41.2$ & 3 \\\\\n"
            "\\bottomrule\n"
            "\\end{tabular}\n");
}

TEST(LatexTable, HasTheDigitsOfEachIntervalTwoOfItsHalfWidthAndAsManyDecimalsOfMeanAndBounds) {
  const auto cell = [](double mean, double low, double high, Unit unit = Unit::metre) {
    Comparison one = comparison("rmse_m", unit, {}, {group("x", 4, mean), group("other", 4, 2 * mean)});
    one.groups[0].mean.interval = {low, high};
    const std::string table = latex_table({one});
    const auto begin = table.find("x & ", table.find("midrule")) + 4;
    return table.substr(begin, table.find(" &", begin) - begin);
  };
  EXPECT_EQ(cell(0.013405, 0.012913, 0.013857), "$13.40\\ [12.91, 13.86]$") << "0.47 to either side";
  EXPECT_EQ(cell(0.0134, 0.0100, 0.0168), "$13.4\\ [10.0, 16.8]$") << "3.4";
  EXPECT_EQ(cell(0.1341, 0.1, 0.168), "$134\\ [100, 168]$") << "34";
  EXPECT_EQ(cell(1234.5, 1000.0, 1469.0, Unit::none), "$1234\\ [1000, 1469]$") << "234: whole numbers";
  EXPECT_EQ(cell(0.7, 0.6988, 0.7012, Unit::none), "$0.7000\\ [0.6988, 0.7012]$") << "0.0012";
  EXPECT_EQ(cell(-0.00004, -0.011, 0.011, Unit::none), "$0.000\\ [-0.011, 0.011]$") << "no minus of a zero";
}

TEST(LatexTable, HasNForEachMetricWhereTheyDifferAndNoCommandOfAName) {
  const std::string table =
      latex_table({comparison("rmse_m", Unit::metre, {}, {group("a&b\\c%~^{}$#", 4, 0.0261)}),
                   comparison("first_hit_tap", Unit::none, {}, {group("a&b\\c%~^{}$#", 0, 0.0)})});
  EXPECT_NE(table.find("{lrrrr}"), std::string::npos) << table;
  EXPECT_NE(
      table.find(
          "\na\\&b\\textbackslash{}c\\%\\textasciitilde{}\\textasciicircum{}\\{\\}\\$\\# & $26.1$ & 4 & -- & 0 \\\\\n"),
      std::string::npos)
      << table;
}

}  // namespace
}  // namespace palpate
