// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
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

void print_sweep_status(const Sweep& sweep) {
  std::map<RunStatus::State, int> counts;
  std::string failures;
  for (const Job& job : sweep.jobs) {
    const RunStatus status = read_status(job_directory(sweep, job));
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

int status(const std::string& directory) {
  if (is_sweep(directory)) {
    print_sweep_status(read_sweep(directory));
  } else {
    print_run(directory);
  }
  return kDone;
}

}  // namespace palpate::cli
