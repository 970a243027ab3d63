// SPDX-License-Identifier: MIT
// The output of a sweep on the terminal: progress, failures, values of jobs.
#pragma once

#include "cli/program.hpp"
#include "launch/execute_jobs.hpp"
#include "sweep/sweep.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::cli {

/// Prints the progress of a sweep on stderr: jobs done, running and failed, rate, and time left. A terminal shows one
/// live line. Other outputs get one line per tenth of the jobs, and a last line if the line before has running jobs.
/// With is_followed(), each state gets its own line.
class SweepLine {
 public:
  explicit SweepLine(bool quiet);
  void show(const SweepProgress& progress);

 private:
  bool quiet_;
  bool terminal_;
  int tenth_ = 0;
  int running_ = 0;  ///< number in the last line
  std::chrono::steady_clock::time_point begun_;
  std::chrono::steady_clock::time_point shown_;
};

/// Reads the sweeps and runs that `words` name as one sweep, and prints its notes on stderr: see read_pooled() and
/// find_records(). Throws Error.
Sweep read_records(const std::vector<std::string>& words, const std::vector<std::string>& by);

/// Calls `work` for each of these jobs in child processes, `workers` at a time (default: number of cores), and shows
/// the progress. Returns false after an interrupt; finished work is kept. Throws Error.
bool compute_jobs(const Program& program, const std::vector<std::size_t>& jobs, std::optional<int> workers,
                  const std::function<void(std::size_t job)>& work);

/// Returns the end of the name of a file about the jobs that satisfy a condition, for example "_where_1f2e3d"; "" for
/// no condition.
std::string where_suffix(const std::string& where);

/// Returns the values of the swept keys of a job, each after a `gap`, for example " taps=17 seed=3".
std::string values_text(const Sweep& sweep, const Job& job, const char* gap);

/// Prints one line per failed job with its keys and its reason, up to a limit.
void print_failures(const Sweep& sweep, const std::vector<SweepFailure>& failures);

}  // namespace palpate::cli
