// SPDX-License-Identifier: MIT
// What a person sees of a sweep while it goes on, and at its end.
#pragma once

#include "launch/conduct.hpp"
#include "sweep/sweep.hpp"

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace palpate::cli {

/// Prints a live line of a sweep on a terminal, else a line per tenth, on stderr: done, running, failed, rate, time
/// left.
class SweepLine {
 public:
  explicit SweepLine(bool quiet);
  void show(const SweepProgress& progress);

 private:
  bool quiet_;
  bool terminal_;
  int tenth_ = 0;
  std::chrono::steady_clock::time_point begun_;
  std::chrono::steady_clock::time_point shown_;
};

/// A line a failed job with its keys and its reason; of very many, the first.
void print_failures(const Sweep& sweep, const std::vector<SweepFailure>& failures);

/// The table, the failures and the place of a sweep; `initial_taps` as sweep_table() asks for them.
void print_sweep(const Sweep& sweep, const std::vector<Row>& results, const SweepReport& report,
                 const std::function<std::optional<int>(std::size_t job)>& initial_taps);

}  // namespace palpate::cli
