// SPDX-License-Identifier: MIT
// What the jobs of a sweep had come to after each of their taps: the summaries that they would have, had their budgets
// ended there. They are computed from the recorded taps when somebody asks, and kept in each job's directory as
// summaries.jsonl, a line per tap but the last, each with the hash of the summary that they belong to: a job that ran
// again since then is computed again.
#pragma once

#include "record/session.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace palpate {

/// Returns the taps of a job by its summary, 0 where it has no number that can be one: who reads the record says what
/// is wrong with it.
std::size_t taps_made(const Row& summary);

class TapSummaries {
 public:
  /// Takes the rows of a job: its summary after 1, 2, ... taps; the last row is that of the whole run.
  using Use = std::function<void(std::size_t job, const std::vector<Row>& rows)>;

  /// Reads the summaries of all jobs, and hands `use` the rows of each job that ended well after more than `fewest`
  /// taps and has all of them kept. Each file is read once, and no rows are held. Throws Error for a damaged sweep.
  /// `sweep` must outlive the object.
  TapSummaries(const Sweep& sweep, Use use, std::size_t fewest = 0);

  /// Returns whether some job of the sweep has something kept; much cheaper than an object.
  static bool any_kept(const Sweep& sweep);

  /// Returns the summary of each job; none of a job that has not ended.
  const std::vector<std::optional<Row>>& whole() const { return summaries_; }

  /// Returns those of these jobs that have nothing kept that still holds.
  const std::vector<std::size_t>& missing() const { return missing_; }

  /// Computes one of them and keeps it. Throws Error.
  void compute(const Workshop& workshop, std::size_t job) const;

  /// Hands over the rows of missing(), which compute() has kept since, by whichever process. Throws Error.
  void read_missing() const;

 private:
  std::optional<std::vector<Row>> kept(std::size_t job) const;
  /// Returns whether the rows of a job were there to hand over.
  bool hand_over(std::size_t job) const;

  const Sweep& sweep_;
  Use use_;
  std::vector<std::optional<Row>> summaries_;
  std::vector<std::size_t> missing_;
};

}  // namespace palpate
