// SPDX-License-Identifier: MIT
// What the jobs of a sweep had come to after each of their taps: the numbers that their summaries would have, had their
// budgets ended there. They are computed from the recorded taps when somebody asks, and kept in each job's directory as
// summaries.jsonl, a line per tap but the last, beside the hash of the summary that they belong to.
#pragma once

#include "record/session.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

class TapSummaries {
 public:
  /// Reads the summaries of all jobs, and which of them have something kept. Throws Error for a damaged sweep. `sweep`
  /// must outlive the object.
  explicit TapSummaries(const Sweep& sweep);

  /// Returns whether some job of the sweep has something kept; much cheaper than an object.
  static bool any_kept(const Sweep& sweep);

  /// Returns the jobs that ended well after more than one tap and have nothing kept that still holds.
  const std::vector<std::size_t>& missing() const { return missing_; }

  /// Computes one of them and keeps it. Throws Error.
  void compute(const Workshop& workshop, std::size_t job) const;

  /// Returns a row per tap: numbers and flags of the summary after 1, 2, ... taps; the last row is the whole summary of
  /// the job. None for a job that failed or has not ended, and for one of missing().
  std::optional<std::vector<Row>> of(std::size_t job) const;

 private:
  std::optional<std::vector<Row>> kept(std::size_t job) const;

  const Sweep& sweep_;
  std::vector<std::optional<Row>> summaries_;
  std::vector<std::size_t> missing_;
};

}  // namespace palpate
