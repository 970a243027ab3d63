// SPDX-License-Identifier: MIT
#include "launch/local_launcher.hpp"

#include "launch/execute_jobs.hpp"
#include "record/run_directory.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

namespace palpate {
namespace {

/// A sweep of two jobs that have not begun.
class TwoJobs : public testing::Test {
 protected:
  TwoJobs() {
    folder_.write(kFolder + "/manifest.jsonl", "");
    for (const Job& job : sweep_.jobs) folder_.write(kFolder + "/jobs/" + job.id + "/config.yaml", kConfig);
  }

  LocalLauncher launcher() const { return LocalLauncher({environment_, sweep_, {}, {}}); }
  std::filesystem::path job(std::size_t index) const { return job_directory(sweep_, sweep_.jobs[index]); }

  inline static const std::string kFolder =
      "a\xc2\x9b"
      "b";
  /// An invalid config, with a plugin that does not exist.
  static constexpr const char* kConfig = "kernel: {type: nowhere}\n";

  const test::TemporaryFolder folder_;
  const Sweep sweep_{folder_.path() / kFolder, {}, {Job{0, "000000000000", {}}, Job{1, "111111111111", {}}}};
  const Installation installation_;
  PluginHost host_{{}};
  const RunEnvironment environment_{host_, installation_, {}, nullptr};
};

/// A launcher that returns all jobs at once.
class Returning : public Launcher {
 public:
  void submit(const std::vector<std::size_t>& jobs) override { state_.returned = jobs; }
  PollResult poll(double) override { return state_; }
  void cancel() override {}

  PollResult state_;
};

TEST_F(TwoJobs, WithoutAFolderAreNotRecordedWhichIsSaidInPrintableText) {
  std::filesystem::remove_all(job(0));
  LocalLauncher local = launcher();
  testing::internal::CaptureStderr();
  EXPECT_FALSE(execute_jobs(local, sweep_, read_job_states(sweep_, {0}), nullptr, [](const SweepProgress&) {}));
  EXPECT_THAT(testing::internal::GetCapturedStderr(),
              testing::ContainsRegex("^job 0: .*a\\\\x9bb/jobs/000000000000: is missing, it has no config.yaml"));
}

TEST_F(TwoJobs, AreDoneByTheirRecordsThoughAnotherNodesFilesAreNotSeenYet) {
  Returning cluster;
  const JobStates begun = read_job_states(sweep_, {0, 1});
  for (std::size_t index : {0, 1}) {
    RunDirectory held(job(index));
    held.begin(Tree::map({}));
    held.end({Ending::EndKind::done, "tap budget", {}, {}});
    std::filesystem::remove(job(index) / kSummaryFile);
  }
  SweepProgress last;
  EXPECT_TRUE(execute_jobs(cluster, sweep_, begun, nullptr, [&](const SweepProgress& now) { last = now; }));
  EXPECT_EQ(last.done, 2);
  EXPECT_EQ(last.failed, 0);
  EXPECT_THAT(read_job_states(sweep_, {0, 1}, JobCheck::nothing).open, testing::IsEmpty());
  EXPECT_THAT(read_job_states(sweep_, {0, 1}).open, testing::ElementsAre(0, 1)) << "whoever resumes writes the files";
}

TEST_F(TwoJobs, ThatAreKilledBeforeTheirAttemptIsNotedAreNotBegunForEver) {
  // The callback runs while the config is read, when the error needs a similar name.
  host_.set_group_names([](const std::string&) {
    std::raise(SIGKILL);
    return std::vector<std::string>();
  });
  LocalLauncher local = launcher();
  local.submit({0});
  Launcher::PollResult state;
  int polls = 0;
  do state = local.poll(10.0);
  while (!state.empty_handed() && ++polls < 20);
  EXPECT_TRUE(state.empty_handed());
  EXPECT_THAT(state.returned, testing::ElementsAre(0));
  EXPECT_THAT(read_ending(job(0)).stop_reason, testing::EndsWith("in attempt 3"));
}

}  // namespace
}  // namespace palpate
