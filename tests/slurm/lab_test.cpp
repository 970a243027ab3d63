// SPDX-License-Identifier: MIT
// The cluster of the tests leaves nothing running, however a test ends.
#include "launch/job.hpp"
#include "slurm_lab.hpp"
#include "slurm_words.hpp"
#include "support/programs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>

#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

using test::eventually;

// 85 s of robot time take half an hour: nobody waits for the end.
constexpr const char* kForEver = "backend.pace=20";

/// Starts a cluster with a job that does not end, and returns its processes.
std::vector<int> occupy(const SlurmLab& lab) {
  EXPECT_EQ(lab.palpate(on_slurm({"sweep", paper(), kForEver, "seed=range(0,2)"})).status, 0);
  const Sweep sweep = sweep_in(lab.folder());
  EXPECT_TRUE(eventually([&] { return attempts_of(job_at(sweep, 1)) == 1 && attempts_of(job_at(sweep, 0)) == 1; }));
  return lab.processes();
}

bool any_runs(const std::vector<int>& processes) {
  return std::any_of(processes.begin(), processes.end(), [](int pid) { return test::running(pid); });
}

TEST_F(Slurm, TheClusterOfATestLeavesNothingBehind) {
  std::vector<int> processes;
  fs::path folder;
  {
    const SlurmLab lab;
    processes = occupy(lab);
    folder = lab.folder();
    // Three daemons, and of each job a slurmstepd, the task and the job's own process.
    EXPECT_GE(processes.size(), 3U + 2U * 3U);
  }
  EXPECT_FALSE(any_runs(processes));
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(Slurm, TheClusterOfATestThatIsKilledEndsToo) {
  const test::TemporaryFolder folder;
  const fs::path list = folder.path() / "processes";
  const int test = ::fork();
  if (test == 0) {
    ::setenv("TMPDIR", folder.path().c_str(), 1);
    const SlurmLab lab;
    std::string text;
    for (const int pid : occupy(lab)) text += std::to_string(pid) + "\n";
    std::ofstream(list.string() + ".tmp") << text;
    fs::rename(list.string() + ".tmp", list);
    for (;;) ::pause();
  }
  const bool up = eventually([&] { return fs::exists(list); });
  ::kill(test, SIGKILL);
  ::waitpid(test, nullptr, 0);
  ASSERT_TRUE(up);
  std::vector<int> processes;
  std::ifstream in(list);
  for (int pid = 0; in >> pid;) processes.push_back(pid);
  EXPECT_GE(processes.size(), 9U);
  EXPECT_TRUE(eventually([&] { return !any_runs(processes); }));
}

}  // namespace
}  // namespace palpate
