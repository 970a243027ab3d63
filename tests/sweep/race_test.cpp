// SPDX-License-Identifier: MIT
// The race of `palpate tune`: which settings it drops, and which one wins.
#include "support/race.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using test::RaceEnd;
using test::run_race;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

/// Settings with these means. Seeds shift all settings alike, and each run has noise of its own.
RaceTable drawn(const std::vector<double>& means, std::size_t seeds, double noise, std::uint64_t number) {
  Random random(number, "race_test");
  RaceTable out(means.size());
  for (std::size_t seed = 0; seed < seeds; ++seed) {
    const double shift = 100.0 * random.normal();
    for (std::size_t i = 0; i < means.size(); ++i) out[i].push_back(means[i] + shift + noise * random.normal());
  }
  return out;
}

TEST(Losers, AreJudgedByTheTTestOfThePrintedTables) {
  // The differences 1, 2, 3, 4 have the mean 2.5 and the variance 5 / 3. With a single difference, the moderated
  // variance is the same. t = 2.5 / sqrt(5 / 3 / 4) = 3.873 with 3 + 4 degrees of freedom: p is between 0.0025 (4.029)
  // and 0.005 (3.499).
  const RaceTable table{{0.0, 0.0, 0.0, 0.0}, {1.0, 2.0, 3.0, 4.0}};
  EXPECT_THAT(find_losers(table, 0.01, 1), IsEmpty());
  const std::vector<Loser> losers = find_losers(table, 0.025, 1);
  ASSERT_THAT(losers, SizeIs(1));
  EXPECT_EQ(losers[0].row, 1U);
  EXPECT_EQ(losers[0].seeds, 4U);
  EXPECT_DOUBLE_EQ(losers[0].difference, 2.5);
  EXPECT_NEAR(largest_disadvantage(table), 2.5 + 2.353 * std::sqrt(5.0 / 12.0), 1e-3) << "t of 3 degrees at 95 %";
}

TEST(Losers, AreJudgedByTheVarianceOfTheOtherSettingsToo) {
  // Four differences with the variances 0, 1, 1 and 4. The median of the better two is 1 / 2; m is 3. On 4 seeds, the
  // first one has the variance 3 * (1 / 2) / 6 = 1 / 4 and t = 1 / sqrt(1 / 16) = 4 with 6 degrees of freedom: p is
  // between 0.0025 (4.317) and 0.005 (3.707). Its own variance alone would give p = 0.
  const double a = std::sqrt(3.0) / 2.0;
  const RaceTable table{{0.0, 0.0, 0.0, 0.0},
                        {1.0, 1.0, 1.0, 1.0},
                        {2.0 - a, 2.0 + a, 2.0 - a, 2.0 + a},
                        {3.0 - a, 3.0 + a, 3.0 - a, 3.0 + a},
                        {4.0 - 2.0 * a, 4.0 + 2.0 * a, 4.0 - 2.0 * a, 4.0 + 2.0 * a}};
  const std::vector<Loser> losers = find_losers(table, 0.5, 1);
  ASSERT_THAT(losers, SizeIs(4));
  EXPECT_EQ(losers.back().row, 1U);
  EXPECT_GT(losers.back().p, 0.0025);
  EXPECT_LT(losers.back().p, 0.005);
}

TEST(Losers, DoNotDependOnAShiftOfAllSettingsOnASeedNorOnTheirOrder) {
  const RaceTable table = drawn({0.0, 1.0, 2.0, 0.5, 3.0}, 8, 1.0, 1);
  RaceTable shifted = table;
  for (std::vector<double>& row : shifted) {
    for (std::size_t seed = 0; seed < row.size(); ++seed) row[seed] += 17.0 * static_cast<double>(seed);
  }
  std::reverse(shifted.begin(), shifted.end());
  const std::vector<Loser> one = find_losers(table, 0.05, 1);
  const std::vector<Loser> other = find_losers(shifted, 0.05, 1);
  ASSERT_THAT(one, SizeIs(other.size()));
  ASSERT_FALSE(one.empty());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].row, 4 - other[i].row);
    EXPECT_NEAR(one[i].p, other[i].p, 1e-9);
  }
}

TEST(Losers, LeaveTheSettingsThatAreToBeKept) {
  const RaceTable table = drawn({0.0, 10.0, 20.0, 30.0, 40.0}, 6, 0.1, 2);
  EXPECT_THAT(find_losers(table, 0.05, 1), SizeIs(4));
  const std::vector<Loser> losers = find_losers(table, 0.05, 3);
  ASSERT_THAT(losers, SizeIs(2));
  EXPECT_EQ(losers[0].row, 4U) << "the worst first";
  EXPECT_EQ(losers[1].row, 3U);
}

TEST(Losers, AreRareAmongEqualSettings) {
  int dropped = 0;
  for (std::uint64_t number = 0; number < 1000; ++number)
    dropped += static_cast<int>(find_losers(drawn({0.0, 0.0}, 6, 1.0, number), 0.05, 1).size());
  // The worse of two equal settings is tested, so the share is twice the one-sided level.
  EXPECT_LT(dropped, 130);
  EXPECT_GT(dropped, 40);
}

TEST(Dominated, AreSettingsThatAreWorseInOneMetricAndNotBetterInTheOther) {
  const RaceTable errors = drawn({1.0, 5.0, 5.0, 9.0, 1.0}, 8, 0.1, 1);
  // The second setting is cheaper than the first one, the third dearer; the fourth is the cheapest of all; the fifth
  // costs the same as the first one, and is as good.
  const std::vector<double> cost{10.0, 5.0, 20.0, 1.0, 10.0};
  RaceTable costs;
  for (const double one : cost) costs.emplace_back(8, one);
  const std::vector<Loser> losers = find_dominated(errors, costs, 0.01, 1);
  ASSERT_THAT(losers, SizeIs(1));
  EXPECT_EQ(losers[0].row, 2U);
  EXPECT_NEAR(losers[0].difference, 4.0, 0.3);
  EXPECT_THAT(find_dominated(errors, costs, 0.01, 5), IsEmpty()) << "all are to be kept";
}

TEST(Dominated, AreNoneIfEachSettingIsTheBestInSomething) {
  RaceTable errors;
  RaceTable costs;
  for (int i = 0; i < 5; ++i) {
    errors.emplace_back(6, i);
    costs.emplace_back(6, -i);
  }
  EXPECT_THAT(find_dominated(errors, costs, 0.05, 1), IsEmpty());
  EXPECT_THAT(front_of_means(errors, costs), ElementsAre(0, 1, 2, 3, 4));
  costs[2] = std::vector<double>(6, 0.5);
  EXPECT_THAT(front_of_means(errors, costs), ElementsAre(0, 1, 3, 4)) << "the second is as good and cheaper";
  EXPECT_THAT(front_of_means({{1.0, 1.0}, {1.0, 1.0}}, {{2.0, 2.0}, {1.0, 1.0}}), ElementsAre(1)) << "equal errors";
}

TEST(Race, OfTwoMetricsKeepsSettingsFromBothEndsOfTheFront) {
  const RaceTable noise = drawn(std::vector<double>(500, 0.0), 500, 0.5, 8);
  std::vector<double> position;  // error is the position, cost its negative, both plus a distance from the front
  std::vector<double> distance;
  Random random(4, "front");
  for (int i = 0; i < 40; ++i) {
    position.push_back(20.0 * random.uniform());
    distance.push_back(10.0 * random.uniform());
  }
  const auto above_front = [&](std::size_t one, std::size_t seed) { return noise[one][seed] + distance[one]; };
  const RaceEnd end = run_race(
      {true, 0.0}, 40, 500, [&](std::size_t one, std::size_t seed) { return position[one] + above_front(one, seed); },
      [&](const RaceDecision& decision) {
        for (std::size_t i = 0; i < decision.new_settings; ++i) {
          const std::size_t parent = decision.elites[random.index(decision.elites.size())];
          position.push_back(position[parent] + random.uniform() - 0.5);
          distance.push_back(std::abs(distance[parent] + 2.0 * (random.uniform() - 0.7)));
        }
      },
      [&](std::size_t one, std::size_t seed) { return above_front(one, seed) - position[one]; });
  ASSERT_GE(end.front.size(), 3U);
  std::vector<double> kept;
  for (const std::size_t one : end.front) {
    kept.push_back(position[one]);
    EXPECT_LT(distance[one], 3.0);
  }
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end(), [](double a, double b) { return a < b - 1.5; }));
  EXPECT_LT(*std::min_element(kept.begin(), kept.end()), 6.0);
  EXPECT_GT(*std::max_element(kept.begin(), kept.end()), 14.0);
}

TEST(Race, OverAListFindsTheBestSettingWithAFractionOfTheRuns) {
  std::vector<double> means;
  for (int i = 0; i < 50; ++i) means.push_back(i);
  int found = 0;
  double jobs = 0.0;
  for (std::uint64_t number = 0; number < 50; ++number) {
    const RaceTable grid = drawn(means, 40, 1.0, number);
    const RaceEnd end = run_race({false, 0.0}, means.size(), 2000,
                                 [&](std::size_t setting, std::size_t seed) { return grid[setting][seed]; });
    found += means[end.winner] < 1.5 ? 1 : 0;
    jobs += static_cast<double>(end.jobs) / 2000.0 / 50.0;
  }
  EXPECT_GE(found, 48);
  EXPECT_LT(jobs, 0.25);
}

TEST(Race, NeverExceedsItsBudgetAndNeverDropsASettingThatItHasToKeep) {
  for (const std::size_t budget : {60U, 100U, 401U, 1000U}) {
    const RaceRules rules{true, 0.0};
    const std::size_t settings = initial_settings(budget);
    const RaceTable noise = drawn(std::vector<double>(500, 0.0), 1000, 5.0, budget);
    const RaceEnd end = run_race(
        rules, settings, budget,
        [&](std::size_t setting, std::size_t seed) { return noise[setting][seed] + static_cast<double>(setting % 7); },
        [&](const RaceDecision& decision) {
          const bool is_over = decision.state.stage == kLastStage || !decision.end.empty();
          EXPECT_GE(decision.state.racing.size(), is_over ? 1 : kElites);
          EXPECT_TRUE(std::is_sorted(decision.state.racing.begin(), decision.state.racing.end()));
        });
    EXPECT_LE(end.jobs, budget);
    EXPECT_GT(end.jobs, budget * 9 / 10) << "budget " << budget;
    EXPECT_GT(end.settings, settings) << "settings joined";
  }
}

TEST(Race, OfASearchMovesToBetterSettings) {
  // A setting that joins is as good as a random one of the elites, plus or minus something.
  std::vector<double> quality;
  Random random(3, "search");
  for (int i = 0; i < 40; ++i) quality.push_back(20.0 + 10.0 * random.uniform());
  const double first = *std::min_element(quality.begin(), quality.end());
  const RaceTable noise = drawn(std::vector<double>(500, 0.0), 500, 1.0, 3);
  const RaceEnd end = run_race(
      {true, 0.0}, 40, 500,
      [&](std::size_t setting, std::size_t seed) { return quality[setting] + noise[setting][seed]; },
      [&](const RaceDecision& decision) {
        for (std::size_t i = 0; i < decision.new_settings; ++i) {
          const double parent = quality[decision.elites[random.index(decision.elites.size())]];
          quality.push_back(parent + 4.0 * (random.uniform() - 0.7));
        }
      });
  EXPECT_LT(quality[end.winner], first - 2.0);
}

TEST(Race, MovesTheEndOfAStageWithABudgetInTime) {
  const RaceTable results = drawn({0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7}, 40, 3.0, 6);
  RaceState state{0, 400, 200, 4, {0, 1, 2, 3, 4, 5, 6, 7}};
  const RaceDecision more = decide({true, 0.0}, state, results, nullptr, 800, 32);
  EXPECT_EQ(more.state.stage_end, 400U);
  const RaceDecision less = decide({true, 0.0}, state, results, nullptr, 100, 52);
  EXPECT_GT(less.state.stage, 0U) << "the first stage had to end at 50 of 100 jobs";
}

TEST(Race, EndsAtOnceIfNoKeyHasAnEffect) {
  const RaceEnd end =
      run_race({true, 0.0}, 32, 400, [](std::size_t, std::size_t seed) { return static_cast<double>(seed); });
  EXPECT_EQ(end.jobs, 32 * kFirstSeeds);
  EXPECT_EQ(end.reason, "all settings left have the same results");
  EXPECT_EQ(end.winner, 0U) << "the config as it stands";
}

TEST(Race, EndsWhenAllSettingsLeftAreWithinTheGivenDifference) {
  const RaceTable noise = drawn({0.0, 0.1, 50.0}, 200, 0.2, 5);
  const auto value = [&](std::size_t setting, std::size_t seed) { return noise[setting][seed]; };
  const RaceEnd end = run_race({false, 1.0}, 3, 600, value);
  EXPECT_EQ(end.reason, "all settings left are within the given difference of the best one");
  EXPECT_LT(end.jobs, 40U);
  EXPECT_NE(end.winner, 2U);
}

}  // namespace
}  // namespace palpate
