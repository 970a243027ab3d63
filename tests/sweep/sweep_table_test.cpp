// SPDX-License-Identifier: MIT
// The table at the end of a sweep.
#include "analysis/sweep_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <sstream>

namespace palpate {
namespace {

using ::testing::_;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// Returns the table of one job per group, with three initial taps. Each job hits first at tap 2 and has one of
/// `errors`.
std::string table_of(const std::vector<std::string>& keys, const std::vector<std::vector<std::string>>& groups,
                     const std::vector<double>& errors = {}) {
  Sweep sweep{"runs/x/0123456789ab", keys, {}};
  std::vector<Row> results;
  for (const std::vector<std::string>& values : groups) {
    const int index = static_cast<int>(sweep.jobs.size());
    sweep.jobs.push_back({index, "id", values});
    Row row;
    row.add("job", index);
    for (std::size_t i = 0; i < keys.size(); ++i) row.add(keys[i], values[i]);
    row.add("status", "done");
    row.add("first_hit_tap", 2);
    row.add("object_taps", 7);
    row.add("rmse_m", errors.empty() ? 0.021 : errors.at(static_cast<std::size_t>(index)));
    row.add("footprint_iou", 0.8);
    results.push_back(std::move(row));
  }
  return sweep_table(sweep, results, [](std::size_t, const Row&) { return 3; });
}

TEST(SweepTable, IsThisLetterByLetter) {
  EXPECT_EQ(table_of({"kernel", "seed"}, {{"rbf", "1"}, {"matern52", "1"}}, {0.021, 0.0152}),
            "group     runs  no contact   found  object taps, rest  object taps, all  rmse_m [mm]     footprint_iou\n"
            "matern52     1        0.0%  100.0%            7 (7-7)           7 (7-7)   15 (15-15)  0.80 (0.80-0.80)\n"
            "rbf          1        0.0%  100.0%            7 (7-7)           7 (7-7)   21 (21-21)  0.80 (0.80-0.80)\n"
            "no contact: runs without an initial tap on the object; rest: the other runs. Median (10 %-90 %).\n"
            "Groups with the least rmse_m come first.\n");
}

TEST(SweepTable, KeepsTheGroupsOfASceneTogetherEachWithTheLeastErrorFirst) {
  const std::string table = table_of({"acquisition", "scene", "seed"},
                                     {{"a", "cube", "1"}, {"a", "ring", "1"}, {"b", "cube", "1"}, {"b", "ring", "1"}},
                                     {0.03, 0.01, 0.02, 0.04});
  std::vector<std::string> groups;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) groups.push_back(line.substr(0, line.find("  ")));
  EXPECT_THAT(groups, ElementsAre("group", "acquisition=b, scene=cube", "acquisition=a, scene=cube",
                                  "acquisition=a, scene=ring", "acquisition=b, scene=ring", _,
                                  "Groups with the least rmse_m come first, scene by scene."));
}

TEST(SweepTable, NamesAGroupByTheKeysThatVaryAlone) {
  const std::string table = table_of({"name", "kernel", "taps", "seed"},
                                     {{"many", "rbf", "17", "1"}, {"many", "matern52", "17", "1"}}, {0.01, 0.02});
  EXPECT_THAT(table, HasSubstr("\nrbf "));
  EXPECT_THAT(table, Not(HasSubstr("many")));
  EXPECT_THAT(table, Not(HasSubstr("17")));
}

TEST(SweepTable, KeepsItsNumbersToTheWidthOfAScreenThoughGroupsHaveLongNames) {
  const std::string name = "scene=object_i, kernel=rational_quadratic, kernel.length_scale=2.5 cm, kernel.alpha=0.5";
  const std::string table =
      table_of({"scene", "kernel", "kernel.length_scale", "kernel.alpha", "seed"},
               {{"object_i", "rational_quadratic", "2.5 cm", "0.5", "1"}, {"object_ii", "rbf", "1.7 cm", "", "1"}});
  EXPECT_THAT(table, StartsWith("runs  no contact  "));
  std::istringstream lines(table);
  std::size_t at = 0;
  for (std::string line; std::getline(lines, line);) {
    if (at == 0) at = line.find("group");
    EXPECT_LE(std::min(line.size(), line.find("scene=")), 100U) << line;
  }
  EXPECT_THAT(table, HasSubstr("  " + name + "\n"));
  EXPECT_EQ(table.find(name), table.find('\n') + 1 + at) << "under its header";
}

/// Returns the table of two jobs with different seeds, with `fields` in addition to their status.
std::string table_of_seeds(const std::string& status, const std::optional<int>& initial_taps, const Row& fields = {}) {
  const Sweep sweep{"runs/x/0123456789ab", {"seed"}, {{0, "id", {"0"}}, {1, "id", {"1"}}}};
  std::vector<Row> results;
  for (const Job& job : sweep.jobs) {
    Row row = fields;
    row.add("job", job.index);
    row.add("seed", job.values.front());
    row.add("status", status);
    results.push_back(std::move(row));
  }
  return sweep_table(sweep, results, [&](std::size_t, const Row&) { return initial_taps; });
}

TEST(SweepTable, HasNoSharesOfAGroupInWhichNoJobIsDone) {
  EXPECT_THAT(table_of_seeds("failed", 3), HasSubstr("\nall jobs     2           -      -       2 "));
}

TEST(SweepTable, HasNoShareWithoutContactWhereNoConfigTellsWhichTapsWereInitial) {
  Row fields;
  fields.add("first_hit_tap", 2);
  EXPECT_THAT(table_of_seeds("done", 3, fields), HasSubstr("\nall jobs     2        0.0%  100.0%  "));
  EXPECT_THAT(table_of_seeds("done", std::nullopt, fields), HasSubstr("\nall jobs     2           -  100.0%  "));
}

TEST(SweepTable, CountsStartsWithoutAContactThoughTheFirstJobsHaveNotEnded) {
  Sweep sweep{"runs/x/0123456789ab", {"seed"}, {}};
  for (int i = 0; i < 5; ++i) sweep.jobs.push_back({i, "id", {std::to_string(i)}});
  Row row;
  row.add("job", 4);
  row.add("seed", "4");
  row.add("status", "done");
  row.add("first_hit_tap", 2);
  EXPECT_THAT(sweep_table(sweep, {row}, [](std::size_t, const Row&) { return 3; }),
              HasSubstr("\nall jobs     1        0.0%  100.0%  "));
}

TEST(SweepTable, LeavesOutWhatIsNoNumber) {
  Row fields;
  for (const char* name : {"first_hit_tap", "object_taps", "rmse_m", "footprint_iou"}) fields.add(name, "x");
  EXPECT_THAT(table_of_seeds("done", 3, fields), HasSubstr("\nall jobs     2      100.0%   0.0%  "));
}

TEST(SweepTable, NamesAGroupOfJobsThatHaveNoneOfTheKeys) {
  const std::string table = table_of({"kernel.alpha", "seed"}, {{"", "1"}, {"0.5", "1"}});
  EXPECT_THAT(table, HasSubstr("\n(none) "));
}

TEST(SweepTable, HasALineAGroupWhateverIsInItsName) {
  const std::string table = table_of({"name", "seed"}, {{"two\nlines", "1"}, {"one", "1"}});
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 5);
}

}  // namespace
}  // namespace palpate
