// SPDX-License-Identifier: MIT
// results.csv as it would be, had the jobs of a sweep stopped earlier. Each job's part is kept in its directory, beside
// the hash of the summary that it belongs to: a job that ran again since then is computed again.
#pragma once

#include "record/occasion.hpp"
#include "record/session.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// What says of a row at a goal whether the job has got there.
inline constexpr const char* kReached = "reached";

/// What names in a kept row the hash of the summary of the whole run.
inline constexpr const char* kOfSummary = "of_summary";
std::string summary_hash(const Row& summary);

/// A sweep whose jobs are looked at at some occasions.
class EarlierResults {
 public:
  /// Reads the summaries of all jobs. Throws Error for a number of taps that no job reached, and for a damaged sweep.
  /// `sweep` must outlive it.
  EarlierResults(const Sweep& sweep, std::vector<Occasion> occasions);

  /// The jobs that ended well, perhaps after one of the occasions, and have nothing kept, or nothing that still holds.
  const std::vector<std::size_t>& missing() const { return missing_; }

  /// Computes one of them, at all occasions, and keeps it. Throws Error.
  void compute(const Workshop& workshop, std::size_t job) const;

  /// The rows at one of the occasions; also left as results_<key>.csv in the sweep's directory. A job for which it has
  /// not come has its own row, and so has one that failed; where that cannot be seen, `reached` says so. Throws Error
  /// while one is missing.
  std::vector<Row> write(const Occasion& occasion) const;

 private:
  std::optional<Row> kept(std::size_t job, const Occasion& occasion) const;
  /// Whether the job may have taps behind that occasion, which are to be left away.
  bool is_longer(std::size_t job, const Occasion& occasion) const;

  const Sweep& sweep_;
  std::vector<Occasion> occasions_;
  std::vector<std::optional<Row>> summaries_;
  std::vector<std::size_t> missing_;
};

}  // namespace palpate
