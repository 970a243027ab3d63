// SPDX-License-Identifier: MIT
#include "launch/local_launcher.hpp"

#include "launch/conduct.hpp"
#include "record/run_directory.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <functional>

namespace palpate {
namespace {

/// A sweep of two jobs, neither of which has begun.
class TwoJobs : public testing::Test {
 protected:
  TwoJobs() {
    folder_.write("manifest.jsonl", "");
    for (const Job& job : sweep_.jobs) folder_.write("jobs/" + job.id + "/config.yaml", "");
  }

  using ConfigOf = std::function<ResolvedConfig(std::size_t job)>;

  LocalLauncher launcher(const ConfigOf& config_of) const {
    return LocalLauncher({workshop_, sweep_, config_of, {}, {}});
  }
  std::filesystem::path job(std::size_t index) const { return job_directory(sweep_, sweep_.jobs[index]); }

  const test::TemporaryFolder folder_;
  const Sweep sweep_{folder_.path(), {}, {Job{0, "000000000000", {}}, Job{1, "111111111111", {}}}};
  const Installation installation_;
  const PluginHost host_{{}};
  const Workshop workshop_{host_, installation_, {}, nullptr};
};

/// Returns at once whatever it is given.
class Returning : public Launcher {
 public:
  void submit(const std::vector<std::size_t>& jobs) override { state_.returned = jobs; }
  State poll(double) override { return state_; }
  void cancel() override {}

  State state_;
};

TEST_F(TwoJobs, StayOpenWhileAnotherProcessHasTheirArmWhichIsSaidOnce) {
  LocalLauncher local = launcher([](std::size_t) -> ResolvedConfig {
    throw Error("backend", "the arm \xc2\x9b[31mleft is used by process 7", "wait until that process has ended",
                Error::Kind::busy);
  });
  testing::internal::CaptureStderr();
  const bool all_recorded = conduct(local, sweep_, standing_of(sweep_, {0, 1}), nullptr, [](const SweepProgress&) {});
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "job 0: backend: the arm \\x9b[31mleft is used by process 7, wait until that process has ended\n");
  EXPECT_TRUE(all_recorded);
  EXPECT_THAT(standing_of(sweep_, {0, 1}).open, testing::ElementsAre(0, 1));
}

TEST_F(TwoJobs, RunOneAfterTheOtherWithoutAPauseThatAnybodySees) {
  LocalLauncher local = launcher([](std::size_t) -> ResolvedConfig { throw Error("", "it cannot be read"); });
  std::vector<int> running;
  testing::internal::CaptureStderr();
  conduct(local, sweep_, standing_of(sweep_, {0, 1}), nullptr,
          [&](const SweepProgress& now) { running.push_back(now.running); });
  testing::internal::GetCapturedStderr();
  ASSERT_GE(running.size(), 2U);
  EXPECT_EQ(running.back(), 0);
  running.pop_back();
  EXPECT_THAT(running, testing::Each(1));
}

TEST_F(TwoJobs, AreDoneByTheirRecordsThoughAnotherNodesFilesAreNotSeenYet) {
  Returning cluster;
  const Standing begun = standing_of(sweep_, {0, 1});
  for (std::size_t index : {0, 1}) {
    RunDirectory held(job(index));
    held.begin(Tree::map({}));
    held.end(Ending::How::done, "tap budget", {});
    std::filesystem::remove(job(index) / kSummaryFile);
  }
  SweepProgress last;
  EXPECT_TRUE(conduct(cluster, sweep_, begun, nullptr, [&](const SweepProgress& now) { last = now; }));
  EXPECT_EQ(last.done, 2);
  EXPECT_EQ(last.failed, 0);
  EXPECT_THAT(standing_of(sweep_, {0, 1}, Also::nothing).open, testing::IsEmpty());
  EXPECT_THAT(standing_of(sweep_, {0, 1}).open, testing::ElementsAre(0, 1)) << "whoever resumes writes the files";
}

TEST_F(TwoJobs, ThatAreKilledBeforeTheirAttemptIsNotedAreNotBegunForEver) {
  const auto dies = [](std::size_t) -> ResolvedConfig {
    std::raise(SIGKILL);
    throw std::logic_error("survived");
  };
  LocalLauncher local = launcher(dies);
  local.submit({0});
  Launcher::State state;
  int polls = 0;
  do state = local.poll(10.0);
  while (!state.empty_handed() && ++polls < 20);
  EXPECT_TRUE(state.empty_handed());
  EXPECT_THAT(state.returned, testing::ElementsAre(0));
  EXPECT_THAT(read_ending(job(0)).stop_reason, testing::EndsWith("in attempt 3"));
}

}  // namespace
}  // namespace palpate
