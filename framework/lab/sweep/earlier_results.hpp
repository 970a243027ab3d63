// SPDX-License-Identifier: MIT
// results.csv as it would be, had the jobs of a sweep stopped after fewer taps. Each job's part is kept in its
// directory, beside the hash of the summary that it belongs to: a job that ran again since then is computed again.
#pragma once

#include "record/session.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

/// A sweep whose jobs are looked at after each of some numbers of taps.
class EarlierResults {
 public:
  /// `taps` are at least 1. Reads the summaries of all jobs. Throws Error for a number that no job reached, and for a
  /// damaged sweep. `sweep` must outlive it.
  EarlierResults(const Sweep& sweep, std::vector<int> taps);

  /// The jobs that ended well after more taps than asked for and have nothing kept, or nothing that still holds.
  const std::vector<std::size_t>& missing() const { return missing_; }

  /// Computes one of them, for all numbers of taps, and keeps it. Throws Error.
  void compute(const Workshop& workshop, std::size_t job) const;

  /// The rows after so many taps, one of the numbers asked for; also left as results_at_<taps>.csv in the sweep's
  /// directory. A job that ended before has its own row, and so has one that failed. Throws Error while one is missing.
  std::vector<Row> write(int taps) const;

 private:
  std::optional<Row> kept(std::size_t job, int taps) const;
  /// Whether the job has taps behind the `taps`-th that are to be left away.
  bool is_longer(std::size_t job, int taps) const;

  const Sweep& sweep_;
  std::vector<int> taps_;  ///< ascending
  std::vector<std::optional<Row>> summaries_;
  std::vector<std::size_t> missing_;
};

}  // namespace palpate
