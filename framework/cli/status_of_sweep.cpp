// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/sweep_display.hpp"
#include "launch/job.hpp"

#include <fmt/format.h>

#include <map>

namespace palpate::cli {

/// From the jobs' directories alone: whoever runs them, a scheduler or a process that has died, is not asked.
int status_of_sweep(Program&, const std::string& directory) {
  const Sweep sweep = read_sweep(directory);
  std::map<RunStatus::State, int> counts;
  std::vector<SweepFailure> failures;
  for (std::size_t i = 0; i < sweep.jobs.size(); ++i) {
    const std::filesystem::path job = job_directory(sweep, sweep.jobs[i]);
    RunStatus status = read_ending(job);
    const bool held = status.state != RunStatus::State::done && is_running(job);
    // Who ended between the two questions has written meanwhile what the first one missed.
    if (!held && status.state != RunStatus::State::done) status = read_ending(job);
    ++counts[held ? RunStatus::State::running : status.state];
    if (!held && status.state == RunStatus::State::failed) {
      failures.push_back({i, attempts_of(job), status.stop_reason});
    }
  }
  fmt::print("{} jobs", sweep.jobs.size());
  for (const auto state : {RunStatus::State::done, RunStatus::State::running, RunStatus::State::failed,
                           RunStatus::State::unfinished, RunStatus::State::absent}) {
    fmt::print(", {} {}", counts[state], state_name(state));
  }
  fmt::print("\n");
  print_failures(sweep, failures);
  return kDone;
}

}  // namespace palpate::cli
