// SPDX-License-Identifier: MIT
// A sweep's directory while its jobs are still being checked: it is made under another name and appears under its own
// only when it is complete.
#pragma once

#include "record/files.hpp"
#include "record/resolved.hpp"
#include "sweep/plan.hpp"

#include <filesystem>
#include <string>

namespace palpate {

class SweepDraft {
 public:
  /// Makes a hidden folder in `runs`, and removes those of processes that were killed over theirs. Throws Error.
  explicit SweepDraft(std::filesystem::path runs);
  /// Removes what did not become a sweep.
  ~SweepDraft();
  SweepDraft(const SweepDraft&) = delete;
  SweepDraft& operator=(const SweepDraft&) = delete;

  /// Writes the config of a job.
  void add(const Job& job, const ResolvedConfig& config);

  /// Writes config.yaml and manifest.jsonl and gives all of it the name of the sweep. Returns false, and leaves
  /// what is there alone, when that sweep exists already; but where the config of a job was deleted it is put back.
  /// Throws Error.
  bool publish(const SweepPlan& plan);

 private:
  /// A job without its config would run, but could be neither carried on nor replayed.
  void replace_lost(const Sweep& sweep) const;

  std::filesystem::path runs_;
  bool made_runs_;  ///< the folder of the runs was not there before
  std::filesystem::path folder_;
  FileLock lock_;
};

}  // namespace palpate
