// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "record/run_directory.hpp"
#include "sweep/sweep.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <map>

namespace palpate::cli {
namespace {

void print_run(const ResolvedConfig& config, const RunStatus& status) {
  const std::string reason = status.stop_reason.empty() ? "" : ": " + status.stop_reason;
  fmt::print("{}: {} after {} of {} taps{}\n", config.options.name, state_name(status.state), status.taps,
             config.options.taps, reason);
}

void print_sweep_status(const Sweep& sweep) {
  std::map<RunStatus::State, int> counts;
  std::string failures;
  for (const Job& job : sweep.jobs) {
    const RunStatus status = read_status(sweep.directory / "jobs" / job.id);
    ++counts[status.state];
    if (status.state == RunStatus::State::failed) {
      failures += fmt::format("failed: job {} ({}): {}\n", job.index, job.id, status.stop_reason);
    }
  }
  fmt::print("{} jobs", sweep.jobs.size());
  for (const auto state : {RunStatus::State::done, RunStatus::State::running, RunStatus::State::failed,
                           RunStatus::State::unfinished, RunStatus::State::absent}) {
    fmt::print(", {} {}", counts[state], state_name(state));
  }
  fmt::print("\n{}", failures);
}

}  // namespace

int status(Program& program, const std::string& directory) {
  if (is_sweep(directory)) {
    print_sweep_status(read_sweep(directory));
  } else {
    print_run(load_run(program.host, directory), read_status(directory));
  }
  return kDone;
}

}  // namespace palpate::cli
