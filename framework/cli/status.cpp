// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "launch/job.hpp"
#include "record/run_directory.hpp"
#include "sweep/sweep.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <map>

namespace palpate::cli {
namespace {

/// Reads the config without resolving it: a status needs no plugin.
void print_run(const std::filesystem::path& directory) {
  const Tree config = read_run_config(directory);
  const RunStatus status = read_status(directory);
  const auto text_at = [&](const char* key) {
    const Tree* value = config.find(key);
    return value != nullptr ? value->text : std::string("?");
  };
  const std::string reason = status.stop_reason.empty() ? "" : ": " + status.stop_reason;
  fmt::print("{}: {} after {} of {} taps{}\n", text_at("name"), state_name(status.state), status.taps, text_at("taps"),
             reason);
}

/// From the jobs' directories alone: whoever runs them, a scheduler or a process that has died, is not asked.
void print_sweep_status(const Sweep& sweep) {
  std::map<RunStatus::State, int> counts;
  std::vector<SweepFailure> failures;
  for (std::size_t i = 0; i < sweep.jobs.size(); ++i) {
    const std::filesystem::path directory = job_directory(sweep, sweep.jobs[i]);
    RunStatus status = read_ending(directory);
    const bool held = status.state != RunStatus::State::done && is_running(directory);
    // Who ended between the two questions has written meanwhile what the first one missed.
    if (!held && status.state != RunStatus::State::done) status = read_ending(directory);
    ++counts[held ? RunStatus::State::running : status.state];
    if (!held && status.state == RunStatus::State::failed) {
      failures.push_back({i, attempts_of(directory), status.stop_reason});
    }
  }
  fmt::print("{} jobs", sweep.jobs.size());
  for (const auto state : {RunStatus::State::done, RunStatus::State::running, RunStatus::State::failed,
                           RunStatus::State::unfinished, RunStatus::State::absent}) {
    fmt::print(", {} {}", counts[state], state_name(state));
  }
  fmt::print("\n");
  print_failures(sweep, failures);
}

}  // namespace

int status(const std::string& directory) {
  if (is_sweep(directory)) {
    print_sweep_status(read_sweep(directory));
  } else {
    print_run(directory);
  }
  return kDone;
}

}  // namespace palpate::cli
