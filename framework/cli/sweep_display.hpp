// SPDX-License-Identifier: MIT
// The output of a sweep on the terminal: progress, failures, and values of jobs.
#pragma once

#include "cli/command_context.hpp"
#include "launch/execute_jobs.hpp"
#include "sweep/sweep.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::cli {

/// Prints the progress of a sweep on stderr: numbers of done, running and failed jobs, rate, and remaining time. On a
/// terminal, one line is updated in place. Elsewhere, a line is printed per tenth of the jobs. At the end, another line
/// is printed if the last printed line shows running jobs. If is_followed() is true, each update is a separate line.
class SweepLine {
 public:
  explicit SweepLine(bool quiet);
  /// `line`: text in place of the numbers of done, running and failed jobs; "": none.
  void show(const SweepProgress& progress, std::string line = {});

 private:
  bool quiet_;
  bool terminal_;
  int tenth_ = 0;
  int running_ = 0;  ///< number of running jobs in the last line
  std::chrono::steady_clock::time_point begun_;
  std::chrono::steady_clock::time_point shown_;
};

/// Reads the sweeps and runs that `words` name, as one sweep (see read_pooled() and find_records()). Prints notes about
/// the pooling on stderr. Throws Error.
Sweep read_records(const std::vector<std::string>& words, const std::vector<std::string>& by);

/// Calls `work` for each of `jobs` in child processes and shows the progress. At most `workers` processes run at a
/// time; the default is the number of cores. Returns false after an interrupt. Finished work is kept. Throws Error.
bool compute_jobs(const CommandEnvironment& program, const std::vector<std::size_t>& jobs, std::optional<int> workers,
                  const std::function<void(std::size_t job)>& work);

/// Returns a suffix for names of files about the jobs that satisfy `where`: "_where_" and a hash of the condition.
/// Returns "" if there is no condition.
std::string where_suffix(const std::string& where);

/// Returns the swept keys of a job with their values, with `gap` before each key, for example " taps=17 seed=3".
std::string values_text(const Sweep& sweep, const Job& job, const char* gap);

/// Prints one line per failed job with its keys and its reason. The number of lines is limited.
void print_failures(const Sweep& sweep, const std::vector<FailedJob>& failures);

}  // namespace palpate::cli
