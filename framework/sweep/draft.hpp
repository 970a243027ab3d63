// SPDX-License-Identifier: MIT
// The directory of a sweep during planning, with a temporary name until all jobs are checked and written.
#pragma once

#include "record/files.hpp"
#include "record/resolved_config.hpp"
#include "sweep/plan.hpp"

#include <filesystem>

namespace palpate {

class SweepDraft {
 public:
  /// Creates a hidden folder in `runs`, and removes the hidden folders of killed processes. Throws Error.
  explicit SweepDraft(std::filesystem::path runs);
  /// Removes the folder, unless it was published.
  ~SweepDraft();
  SweepDraft(const SweepDraft&) = delete;
  SweepDraft& operator=(const SweepDraft&) = delete;

  /// Writes the config of a job.
  void add(const Job& job, const ResolvedConfig& config);

  /// Returns the directory that a job has until the sweep is published. A job that is run there keeps its record.
  std::filesystem::path job_directory(const Job& job) const { return folder_ / "jobs" / job.id; }

  /// Writes config.yaml and manifest.jsonl, and renames the folder to the directory of the sweep. Returns false if the
  /// sweep exists already. The existing sweep is not changed, except that job configs are written again if they were
  /// deleted. Throws Error.
  bool publish(const SweepPlan& plan);

 private:
  /// Writes job configs again if they were deleted, because a job without its config cannot be resumed or replayed.
  void replace_lost(const Sweep& sweep) const;

  std::filesystem::path runs_;
  bool made_runs_;  ///< whether this object created the folder of the runs
  std::filesystem::path folder_;
  FileLock lock_;
};

}  // namespace palpate
