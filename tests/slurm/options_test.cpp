// SPDX-License-Identifier: MIT
// What is refused before anybody asks Slurm; these need no daemons.
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

/// The one line with which palpate refuses `words`, having made and begun nothing.
std::string refusal(std::vector<std::string> words, const std::vector<std::string>& more) {
  const test::TemporaryFolder folder;
  words.insert(words.end(), more.begin(), more.end());
  const Ended ended = test::palpate(words, folder.path());
  EXPECT_EQ(ended.status, 2) << ended.err;
  EXPECT_EQ(lines(ended.err), 1) << ended.err;
  EXPECT_EQ(ended.out, "");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  return ended.err;
}

TEST(SlurmOptions, AreRefusedForThisMachine) {
  const std::vector<std::string> sweep{"sweep", paper(), "seed=1,2"};
  const std::vector<std::vector<std::string>> all{{"--partition", "x"},  {"--task-time", "5"},     {"--account", "x"},
                                                  {"--sbatch=--mem=4G"}, {"--jobs-per-task", "1"}, {"--wait"}};
  for (const std::vector<std::string>& option : all) {
    const std::string name = option.front().substr(0, option.front().find('='));
    EXPECT_THAT(
        refusal(sweep, option),
        StartsWith("command line: " + name + " needs a cluster, but the launcher is 'local', add --launcher slurm"));
    std::vector<std::string> local = option;
    local.insert(local.end(), {"--launcher", "local"});
    EXPECT_THAT(refusal(sweep, local), HasSubstr("needs a cluster"));
    EXPECT_THAT(refusal({"resume", "./nowhere"}, option), HasSubstr("needs a cluster"));
  }
}

TEST(SlurmOptions, ThatMakeNoSenseAreRefused) {
  const std::vector<std::string> sweep{"sweep", paper(), "seed=1,2", "--launcher", "slurm"};
  EXPECT_THAT(refusal(sweep, {"--sbatch=mem=4G"}), HasSubstr("--sbatch: 'mem=4G' is not an option of sbatch"));
  EXPECT_THAT(refusal(sweep, {"--sbatch=--array=0"}), HasSubstr("--array cannot be set with --sbatch"));
  EXPECT_THAT(refusal(sweep, {"--junit", "x.xml"}), HasSubstr("--junit: results exist only after all jobs have ended"));
  EXPECT_THAT(refusal(sweep, {"--jobs-per-task", "0"}), HasSubstr("--jobs-per-task"));
  EXPECT_THAT(refusal({"sweep", paper(), "seed=1,2"}, {"--launcher", "pbs"}), HasSubstr("{local,slurm}"));
}

TEST(SlurmOptions, LeaveNoSweepBehindWhereSlurmIsNotInstalled) {
  const test::TemporaryFolder folder;
  const Ended ended =
      test::run_program({test::program_file().string(), "sweep", paper(), "seed=1,2", "--launcher", "slurm"},
                        folder.path(), {"PATH=/nowhere"});
  EXPECT_EQ(ended.status, 2) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("sbatch: is not installed, or not on PATH"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SlurmOptions, AreForSweepsOnlyAndChunksAreWhole) {
  const test::TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"run", paper(), "--quiet", "--runs", "single"}, folder.path()).status, 0);
  const Ended single =
      test::palpate({"resume", only_run(folder.path() / "single").string(), "--launcher", "slurm"}, folder.path());
  EXPECT_EQ(single.status, 2);
  EXPECT_THAT(single.err, HasSubstr("is not a sweep"));
  ASSERT_EQ(test::palpate({"sweep", paper(), "seed=1,2", "--quiet"}, folder.path()).status, 0);
  const Ended chunk = test::palpate({"resume", only_run(folder.path() / "runs").string(), "--launcher", "slurm",
                                     "--jobs", "1", "--jobs-per-task", "2"},
                                    folder.path());
  EXPECT_EQ(chunk.status, 2);
  EXPECT_THAT(chunk.err, HasSubstr("--jobs and --jobs-per-task exclude each other"));
}

}  // namespace
}  // namespace palpate
