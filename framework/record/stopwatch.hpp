// SPDX-License-Identifier: MIT
// Times and memory of a process, for the summary of a run.
#pragma once

#include <chrono>
#include <cstdint>

namespace palpate {

/// Measures the wall time and the CPU time of the current thread since the construction of the stopwatch.
class Stopwatch {
 public:
  Stopwatch();
  double wall_seconds() const;
  double cpu_seconds() const;

 private:
  std::chrono::steady_clock::time_point wall_;
  double cpu_;
};

/// Returns the peak memory of this process.
std::int64_t peak_rss_bytes();

}  // namespace palpate
