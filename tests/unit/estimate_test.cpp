// SPDX-License-Identifier: MIT
#include "launch/estimate.hpp"

#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>

namespace palpate {
namespace {

using test::shared_host;
using test::shipped_config;

/// Seconds that one run of the config computes here, on the scene itself.
double seconds_of(const ResolvedConfig& config) {
  const auto begin = std::chrono::steady_clock::now();
  Experiment experiment(config.options, shared_host(), nullptr);
  test::Collector collector;
  experiment.run(collector);
  experiment.result();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

TEST(Estimate, IsOfTheSizeOfWhatAJobComputes) {
  // So small that it ends in its share of time, a busy machine and sanitizers notwithstanding.
  const ResolvedConfig config = shipped_config("paper/object_i.yaml", {"taps=4", "candidates.count=8"});
  const std::optional<Estimate> estimate = estimate_job(
      shared_host(), [&](std::size_t) { return config; }, 40);
  ASSERT_TRUE(estimate);
  EXPECT_FALSE(estimate->at_least);
  // Not a time, but a ratio, and a wide one. What a job costs beside its computing comes on top.
  const double seconds = seconds_of(config);
  EXPECT_GT(estimate->job_seconds, seconds / 50);
  EXPECT_LT(estimate->job_seconds, seconds * 50 + 0.02);
}

TEST(Estimate, OfLongJobsIsALeastOne) {
  const ResolvedConfig config =
      shipped_config("paper/object_i.yaml", {"taps=2000", "candidates.count=47", "posterior=dense"});
  const std::optional<Estimate> estimate = estimate_job(
      shared_host(), [&](std::size_t) { return config; }, 2);
  ASSERT_TRUE(estimate);
  EXPECT_TRUE(estimate->at_least);
  EXPECT_GT(estimate->job_seconds, 0.05);
}

TEST(Estimate, MakesNoBackend) {
  // This one would start a program that does not exist.
  const ResolvedConfig config = shipped_config("process.yaml", {"backend.command=/does/not/exist"});
  EXPECT_TRUE(estimate_job(
      shared_host(), [&](std::size_t) { return config; }, 3));
}

TEST(Estimate, IsNoneWhereNoJobCanBeBuiltOrItsProcessBreaksDown) {
  EXPECT_FALSE(estimate_job(
      shared_host(), [](std::size_t) -> ResolvedConfig { throw Error("", "no config"); }, 3));
  EXPECT_FALSE(estimate_job(
      shared_host(), [](std::size_t) -> ResolvedConfig { std::_Exit(0); }, 3));
  EXPECT_FALSE(estimate_job(
      shared_host(), [](std::size_t) -> ResolvedConfig { return {}; }, 0));
}

TEST(Estimate, LooksAtJobsFromAllOfASweep) {
  // Of a thousand jobs the first half is quick; whoever looked at it alone would not see the second.
  const ResolvedConfig quick = shipped_config("paper/object_i.yaml", {"taps=4"});
  const ResolvedConfig slow = shipped_config("paper/object_i.yaml", {"taps=2000", "posterior=dense"});
  const std::optional<Estimate> estimate = estimate_job(
      shared_host(), [&](std::size_t job) { return job < 500 ? quick : slow; }, 1000);
  ASSERT_TRUE(estimate);
  EXPECT_TRUE(estimate->at_least);
  EXPECT_GT(estimate->job_seconds, 0.02);
}

}  // namespace
}  // namespace palpate
