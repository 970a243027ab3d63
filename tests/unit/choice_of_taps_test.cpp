// SPDX-License-Identifier: MIT
#include "experiment/initial_design.hpp"
#include "experiment/pick_best.hpp"
#include "support/grids.hpp"

#include "support/instruction_sets.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace palpate::test {
namespace {

Pick pick_all(std::initializer_list<double> scores, double scale = 0.0, double tolerance = 1e-8) {
  const std::vector<double> values(scores);
  const Eigen::VectorXd vector =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return pick_best(vector, Allowed::Constant(vector.size(), true), scale, tolerance);
}

TEST(Pick, TakesTheHighestScoreAndNamesTheRunnerUp) {
  const Pick picked = pick_all({0.1, 0.7, 0.3, 0.6});
  EXPECT_EQ(picked.candidate, 1);
  EXPECT_EQ(picked.score, 0.7);
  EXPECT_EQ(picked.ties, 1);
  EXPECT_EQ(picked.runner_up, 3);
  EXPECT_EQ(picked.runner_up_score, 0.6);
  EXPECT_FALSE(picked.flat);
}

TEST(Pick, GivesATieToTheLowestIndexEvenIfAnotherIsHigherByRounding) {
  const Pick picked = pick_all({0.2, 0.5, 0.5 + 1e-15, 0.1});
  EXPECT_EQ(picked.candidate, 1);
  EXPECT_EQ(picked.ties, 2);
  EXPECT_EQ(picked.runner_up, 2);
}

TEST(Pick, JudgesTiesOfTinyScoresByThePriorScale) {
  EXPECT_EQ(pick_all({1e-12, 3e-12, 2e-12}, 0.0).candidate, 1) << "without a scale they are far apart";
  const Pick picked = pick_all({1e-12, 3e-12, 2e-12}, 1.0);
  EXPECT_EQ(picked.candidate, 0) << "with scale 1 they are rounding";
  EXPECT_EQ(picked.flat, "every score is equal");
}

TEST(Pick, SeesThatScoresSayNothing) {
  EXPECT_EQ(pick_all({0.0, 0.0, 0.0}).flat, "no score is positive");
  EXPECT_EQ(pick_all({-1.0, -2.0}).flat, "no score is positive");
  EXPECT_EQ(pick_all({0.5, 0.5}).flat, "every score is equal");
  EXPECT_FALSE(pick_all({0.5}).flat) << "a single candidate is no tie";
}

TEST(Pick, LeavesOutWhatIsNotAllowed) {
  const Eigen::Vector3d scores(0.9, 0.5, 0.7);
  const auto allowed = [](const std::array<bool, 3>& each) { return Eigen::Map<const Allowed>(each.data(), 3).eval(); };
  EXPECT_EQ(pick_best(scores, allowed({false, true, true}), 0.0, 1e-8).candidate, 2);
  EXPECT_EQ(pick_best(scores, allowed({false, true, false}), 0.0, 1e-8).runner_up, -1);
  EXPECT_EQ(pick_best(scores, allowed({false, false, false}), 0.0, 1e-8).candidate, -1);
}

TEST(Pick, IsTheFirstOfTheHighestAmongManyWhicheverLoopsLook) {
  Random random(4, "test/pick");
  for (const int size : {1, 63, 64, 65, 4000}) {
    for (int trial = 0; trial < 20; ++trial) {
      Eigen::VectorXd scores(size);
      Allowed all(size);
      for (int i = 0; i < size; ++i) {
        scores(i) = static_cast<double>(random.index(trial < 10 ? 5 : 100000));  // with many ties, and with few
        all(i) = random.uniform() < 0.7;
      }
      std::vector<int> order;
      for (int i = 0; i < size; ++i) {
        if (all(i)) order.push_back(i);
      }
      std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return scores(a) > scores(b); });
      for (const Instructions set : math::instruction_sets()) {
        const OnInstructions on(set);
        const Pick picked = pick_best(scores, all, 1.0, 1e-12);
        ASSERT_EQ(picked.candidate, order.empty() ? -1 : order[0]);
        ASSERT_EQ(picked.runner_up, order.size() < 2 ? -1 : order[1]);
        ASSERT_EQ(picked.ties,
                  std::count_if(order.begin(), order.end(), [&](int i) { return scores(i) == scores(order[0]); }));
      }
    }
  }
}

TEST(InitialDesign, GivesDifferentCandidatesAndTheSameOnesForTheSameSeed) {
  using Design = InitialOptions::Design;
  const Area area{0.23, 0.23};
  const CandidateGrid candidates = grid_by_count(area, 5);
  for (const Design design : {Design::random, Design::sobol, Design::grid}) {
    for (const std::int64_t count : {1, 3, 24, 25}) {
      InitialOptions options;
      options.design = design;
      options.count = count;
      const std::vector<int> first = initial_design(options, candidates, area, 7);
      EXPECT_EQ(first, initial_design(options, candidates, area, 7));
      EXPECT_EQ(std::set<int>(first.begin(), first.end()).size(), static_cast<std::size_t>(count));
      EXPECT_THAT(first, testing::Each(testing::AllOf(testing::Ge(0), testing::Lt(25))));
    }
  }
}

TEST(InitialDesign, RandomHitsEveryCandidateEquallyOften) {
  const Area area{1.0, 1.0};
  const CandidateGrid candidates = grid_by_count(area, 4);
  std::vector<int> counts(16, 0);
  InitialOptions options;
  constexpr int kSeeds = 4000;
  for (int seed = 0; seed < kSeeds; ++seed) {
    for (const int index : initial_design(options, candidates, area, static_cast<std::uint64_t>(seed))) {
      ++counts[static_cast<std::size_t>(index)];
    }
  }
  // 3 of 16 each time: binomial with mean 750 and standard deviation below 25; five of those.
  for (const int count : counts) EXPECT_NEAR(count, 3.0 / 16.0 * kSeeds, 125);
}

TEST(InitialDesign, SobolSpreadsFourTapsOverTheFourQuarters) {
  const Area area{1.0, 1.0};
  const CandidateGrid candidates = grid_by_count(area, 40);
  InitialOptions options;
  options.design = InitialOptions::Design::sobol;
  options.count = 4;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    std::vector<int> quarters(4, 0);
    for (const int index : initial_design(options, candidates, area, seed)) {
      const Target at = candidates.target(index);
      const std::size_t quarter = (at.x < 0.5 ? 0U : 1U) + (at.y < 0.5 ? 0U : 2U);
      ++quarters[quarter];
    }
    EXPECT_EQ(quarters, std::vector<int>(4, 1)) << "seed " << seed;
  }
}

}  // namespace
}  // namespace palpate::test
