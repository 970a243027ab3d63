// SPDX-License-Identifier: MIT
// What a person sees of a sweep while it goes on, and at its end.
#pragma once

#include "cli/program.hpp"
#include "launch/conduct.hpp"
#include "sweep/sweep.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::cli {

/// Prints a live line of a sweep on a terminal, else a line per tenth, on stderr: done, running, failed, rate, time
/// left, and at the end once more where the last line has jobs that ran. To the process that is_followed() means it
/// prints each state on a line.
class SweepLine {
 public:
  explicit SweepLine(bool quiet);
  void show(const SweepProgress& progress);

 private:
  bool quiet_;
  bool terminal_;
  int tenth_ = 0;
  int running_ = 0;  ///< in the last line
  std::chrono::steady_clock::time_point begun_;
  std::chrono::steady_clock::time_point shown_;
};

/// Reads the sweeps and runs that `words` mean as one sweep, with its notes on stderr: see read_pooled() and
/// find_records(). Throws Error.
Sweep read_records(const std::vector<std::string>& words, const std::vector<std::string>& by);

/// Has `work` done for each of these jobs by processes of their own, `workers` at a time or as many as there are cores,
/// with a SweepLine. Returns false where that was interrupted: what is done then is kept. Throws Error.
bool compute_jobs(const Program& program, const std::vector<std::size_t>& jobs, std::optional<int> workers,
                  const std::function<void(std::size_t job)>& work);

/// Ends the name of a file about the jobs of which a condition holds: "_where_1f2e3d"; "" for no condition.
std::string where_suffix(const std::string& where);

/// What a job has of the swept keys, each behind a `gap`: " taps=17 seed=3".
std::string values_text(const Sweep& sweep, const Job& job, const char* gap);

/// A line a failed job with its keys and its reason; of very many, the first.
void print_failures(const Sweep& sweep, const std::vector<SweepFailure>& failures);

}  // namespace palpate::cli
