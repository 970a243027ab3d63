// SPDX-License-Identifier: MIT
// The launcher of this machine: one forked child process per job, in which the plugins are already loaded. A crash ends
// only the job's own child. The children end with this process, so no job is still running when a user resumes the
// sweep.
#pragma once

#include "children/child_process.hpp"
#include "launch/job.hpp"
#include "launch/launcher.hpp"

#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace palpate {

class LocalLauncher final : public Launcher {
 public:
  /// The destructor kills the running jobs.
  explicit LocalLauncher(LauncherSetup order) : order_(std::move(order)) {}

  void submit(const std::vector<std::size_t>& jobs) override;
  PollResult poll(double seconds) override;
  void cancel() override;

 private:
  using Clock = std::chrono::steady_clock;
  /// A running job.
  struct RunningJob {
    std::size_t job = 0;
    std::unique_ptr<ChildProcess> process;
  };

  /// Starts a job. Returns false if the limit of processes or files is reached while other jobs run.
  bool start(std::size_t job);
  /// Runs the job; called in its child process.
  JobEnd run(std::size_t job) const;
  void conclude(std::size_t job, const ChildProcess& process, PollResult& state);
  void was_killed(std::size_t job, int signal, PollResult& state);
  std::filesystem::path directory_of(std::size_t job) const {
    return job_directory(order_.sweep, order_.sweep.jobs[job]);
  }

  LauncherSetup order_;
  std::deque<std::size_t> waiting_;
  std::vector<std::size_t> later_;  ///< jobs that other processes run, to be tried again
  Clock::time_point again_;         ///< time of the next try
  std::vector<RunningJob> running_;
  std::map<std::size_t, int> kills_;  ///< number of kills per job
  bool cancelled_ = false;
};

}  // namespace palpate
