// SPDX-License-Identifier: MIT
// Summaries of a sweep's jobs after each of their taps, as if the budget had ended at that tap. They are computed from
// the recorded taps on demand, and stored in the job's directory as summaries.jsonl. The file has one line per tap
// except the last, each with the hash of the final summary. If this hash differs from the hash of the job's summary,
// the job was run again, and its rows are computed again.
#pragma once

#include "record/run.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace palpate {

/// Returns the number of taps of a job from its summary; 0 for an invalid number, which readers of the record report.
std::size_t taps_made(const Row& summary);

class TapSummaries {
 public:
  /// A function that receives the rows of a job: its summaries after 1, 2, ... taps. The last row is the final summary.
  using Use = std::function<void(std::size_t job, const std::vector<Row>& rows)>;

  /// Reads the summaries of all jobs. Calls `use` for each job that is done after more than `fewest` taps and has valid
  /// stored rows. Each file is read once, and the rows are not kept in memory. Throws Error for a damaged sweep.
  /// `sweep` must outlive the object.
  TapSummaries(const Sweep& sweep, Use use, std::size_t fewest = 0);

  /// Returns whether any job has stored rows, without reading them.
  static bool any_kept(const Sweep& sweep);

  /// Returns the summary of each job; nullopt for a job that has not ended.
  const std::vector<std::optional<Row>>& whole() const { return summaries_; }

  /// Returns the jobs without valid stored rows.
  const std::vector<std::size_t>& missing() const { return missing_; }

  /// Computes and stores the rows of `job`, one of the jobs in missing(). Throws Error.
  void compute(const RunEnvironment& environment, std::size_t job) const;

  /// Calls `use` for the jobs in missing(). This process or others must have stored their rows after the construction
  /// of this object. Throws Error if rows are still missing.
  void read_missing() const;

 private:
  std::optional<std::vector<Row>> kept(std::size_t job) const;
  /// Calls `use` for a job with valid stored rows. Returns false if it has none.
  bool hand_over(std::size_t job) const;

  const Sweep& sweep_;
  Use use_;
  std::vector<std::optional<Row>> summaries_;
  std::vector<std::size_t> missing_;
};

}  // namespace palpate
