// SPDX-License-Identifier: MIT
// The launcher of this machine: a child process a job, forked from this one, which has the plugins loaded already. A
// job that crashes costs that child alone, and children die with this process, however it dies: nothing goes on behind
// the back of `resume`.
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
  /// At its end it kills what still runs.
  explicit LocalLauncher(LaunchOrder order) : order_(std::move(order)) {}

  void submit(const std::vector<std::size_t>& jobs) override;
  State poll(double seconds) override;
  void cancel() override;

 private:
  using Clock = std::chrono::steady_clock;
  /// A job under way.
  struct Running {
    std::size_t job = 0;
    std::unique_ptr<ChildProcess> process;
  };

  /// Returns false where this process may have no more files or children, and has to go on with those it has.
  bool start(std::size_t job);
  /// In the child.
  JobEnd run(std::size_t job) const;
  void conclude(std::size_t job, const ChildProcess& process, State& state);
  void was_killed(std::size_t job, int signal, State& state);
  std::filesystem::path directory_of(std::size_t job) const {
    return job_directory(order_.sweep, order_.sweep.jobs[job]);
  }

  LaunchOrder order_;
  std::deque<std::size_t> waiting_;
  std::vector<std::size_t> later_;  ///< that others had in hand, to be looked at again
  Clock::time_point again_;         ///< when
  std::vector<Running> running_;
  std::map<std::size_t, int> kills_;  ///< of each job's processes
  bool cancelled_ = false;
};

}  // namespace palpate
