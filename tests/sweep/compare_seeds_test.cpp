// SPDX-License-Identifier: MIT
// Seeds as the units of a comparison: jobs of a seed are resampled together, copies count once, and missing values
// satisfy no condition.
#include "support/clusters.hpp"
#include "support/made_sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using test::each_alone;
using test::MadeJob;
using test::MadeSweep;
using ::testing::HasSubstr;
using ::testing::Not;

/// Returns a sweep over strategy, kernel and seed. Each seed has its own level, and kernels add little to it.
std::vector<MadeJob> seeds_that_matter(int seeds, const std::vector<std::string>& kernels) {
  std::vector<MadeJob> jobs;
  for (std::size_t kernel = 0; kernel < kernels.size(); ++kernel) {
    for (int seed = 0; seed < seeds; ++seed) {
      const double level = 0.01 * (seed * seed * 7919 % 101);
      const double little = 1e-3 * static_cast<double>((seed * 31 + static_cast<int>(kernel) * 17) % 7);
      jobs.push_back({"a", kernels[kernel], seed, 0.2});
      jobs.push_back({"b", kernels[kernel], seed, 0.1 + level + little});
    }
  }
  return jobs;
}

TEST(CompareSeeds, ResamplesSeedsWithAllOfTheirJobs) {
  // The reference averages the same numbers over the kernels first.
  const Comparison four = MadeSweep(seeds_that_matter(20, {"k0", "k1", "k2", "k3"})).by({"acquisition"});
  std::vector<double> means(20, 0.0);
  std::vector<double> differences(20, 0.0);
  for (const MadeJob& one : seeds_that_matter(20, {"k0", "k1", "k2", "k3"})) {
    if (one.strategy == "b") means[static_cast<std::size_t>(one.seed)] += *one.rmse / 4;
  }
  for (std::size_t seed = 0; seed < 20; ++seed) differences[seed] = means[seed] - 0.2;
  const MeanEstimate& group = four.groups[1].mean;
  EXPECT_EQ(group.count, 80U);
  EXPECT_EQ(group.clusters, 20U);
  const MeanInterval of_means = *bootstrap_mean(each_alone(means)).interval;
  EXPECT_NEAR(group.interval->low, of_means.low, 1e-9);
  EXPECT_NEAR(group.interval->high, of_means.high, 1e-9);
  const ComparedPair& pair = four.pairs[0];
  const MeanInterval of_differences = *bootstrap_mean(each_alone(differences)).interval;
  EXPECT_EQ(pair.difference.count, 80U);
  EXPECT_NEAR(pair.difference.interval->low, of_differences.low, 1e-9);
  EXPECT_NEAR(pair.difference.interval->high, of_differences.high, 1e-9);
  EXPECT_EQ(*pair.test.p, *signed_rank_test(means, std::vector<double>(20, 0.2)).p);
  EXPECT_EQ(pair.test.higher + pair.test.equal + pair.test.lower, 20U);
  const MeanInterval of_jobs = *bootstrap_mean(each_alone([&] {
                                  std::vector<double> all;
                                  for (int copy = 0; copy < 4; ++copy)
                                    all.insert(all.end(), means.begin(), means.end());
                                  return all;
                                }()))
                                    .interval;
  EXPECT_GT(of_means.high - of_means.low, 1.9 * (of_jobs.high - of_jobs.low)) << "as if there were 80 seeds";
}

TEST(CompareSeeds, SaysHowManySeedsThereAreAndWhatFewMean) {
  const Comparison few = MadeSweep(seeds_that_matter(6, {"k", "l"})).by({"acquisition"});
  EXPECT_THAT(compare_tables(few), HasSubstr("   n  seeds  mean [95 % interval]"));
  EXPECT_THAT(compare_tables(few),
              HasSubstr("only 6 seeds: an interval over so few (Student's t) can miss the true mean"));
  EXPECT_THAT(compare_tables(MadeSweep(seeds_that_matter(3, {"k", "l"})).by({"acquisition"})),
              HasSubstr("only 3 seeds: too few for an interval; run 10 or more\n"));
  const Comparison enough = MadeSweep(seeds_that_matter(10, {"k", "l"})).by({"acquisition"});
  EXPECT_THAT(compare_tables(enough), Not(HasSubstr("only")));
  EXPECT_THAT(compare_legend({enough}), HasSubstr("The unit is the seed: all jobs of a seed are resampled together"));
  EXPECT_EQ(compare_rows(enough, "")[0].number("seeds"), 10.0);
  EXPECT_EQ(compare_rows(enough, "")[2].number("seeds"), 10.0);
}

TEST(CompareSeeds, WhereTheSeedIsNotSweptJobsAreTheUnitsAndItSaysSo) {
  std::vector<MadeJob> jobs;
  for (int i = 0; i < 12; ++i) {
    jobs.push_back({"a", "k" + std::to_string(i), 5, 0.1 + 0.01 * (i * 5 % 13)});
    jobs.push_back({"b", "k" + std::to_string(i), 5, 0.2 + 0.01 * (i * 3 % 17)});
  }
  const Comparison made = MadeSweep(jobs).by({"acquisition"});
  EXPECT_FALSE(made.by_seed);
  EXPECT_EQ(made.groups[0].mean.clusters, 12U);
  EXPECT_EQ(made.pairs[0].difference.clusters, 12U);
  EXPECT_THAT(compare_tables(made), Not(HasSubstr("seeds")));
  EXPECT_THAT(compare_legend({made}), HasSubstr("The seed is not swept: the unit is the job"));
  EXPECT_EQ(compare_rows(made, "")[0].cell("seeds"), "");

  for (const MadeJob& one : std::vector<MadeJob>(jobs))
    jobs.push_back({one.strategy, one.kernel + "_copy", 5, one.rmse});
  const Comparison twice = MadeSweep(jobs).by({"acquisition"});
  EXPECT_EQ(twice.groups[1].mean.count, 24U);
  EXPECT_EQ(twice.groups[1].mean.clusters, 12U) << "equal in all that they came to";
  EXPECT_NEAR(twice.groups[1].mean.interval->low, made.groups[1].mean.interval->low, 1e-12);
  EXPECT_EQ(*twice.pairs[0].test.p, *made.pairs[0].test.p);
  EXPECT_THAT(compare_tables(made), Not(HasSubstr("units")));
  EXPECT_THAT(compare_tables(twice), HasSubstr("   n  units  mean [95 % interval]"));
  EXPECT_THAT(compare_tables(twice),
              HasSubstr("\na: 12 of 24 jobs are copies of another run; copies count once in intervals and p\n"));
  EXPECT_EQ(compare_rows(twice, "")[0].number("units"), 12.0);
  EXPECT_EQ(compare_rows(twice, "")[2].number("units"), 12.0);
}

TEST(CompareSeeds, EqualValuesHaveNoIntervalAndItSaysWhy) {
  std::vector<MadeJob> jobs;
  for (int seed = 0; seed < 12; ++seed) {
    jobs.push_back({"a", "k", seed, 0.2});
    jobs.push_back({"b", "k", seed, 0.1 * (1 + seed)});
    jobs.push_back({"c", "k", seed, 0.1 * (1 + seed) + 0.3});  // rounded, so that not all differences are equal
  }
  const Comparison made = MadeSweep(jobs).by({"acquisition"});
  EXPECT_FALSE(made.groups[0].mean.interval);
  EXPECT_TRUE(made.pairs[1].difference.interval) << "c - a";
  EXPECT_FALSE(made.pairs[2].difference.interval) << "c - b";
  EXPECT_THAT(compare_tables(made),
              HasSubstr("\na has no interval: its values are equal in all 12 seeds and show no spread\n"));
  EXPECT_THAT(compare_tables(made), HasSubstr("\nc - b has no interval: its differences are equal in all 12 seeds"));
}

}  // namespace
}  // namespace palpate
