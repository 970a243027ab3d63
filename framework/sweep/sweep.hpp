// SPDX-License-Identifier: MIT
// A sweep: every job is checked before the first one starts, each has a run directory of its own, and a table is made
// from those directories.
#pragma once

#include "record/session.hpp"
#include "sweep/expand.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// One job of a sweep.
struct Job {
  int index = 0;
  std::string id;
  std::vector<std::string> values;  ///< one for each swept key
};

/// A sweep's directory: config.yaml, manifest.jsonl, jobs/<id>/, results.csv.
struct Sweep {
  std::filesystem::path directory;
  std::vector<std::string> keys;
  std::vector<Job> jobs;
};

/// Counts while a sweep runs.
struct SweepProgress {
  int jobs = 0;
  int done = 0;
  int failed = 0;
};

struct SweepReport {
  SweepProgress counts;
  bool interrupted = false;
  std::vector<std::pair<Job, std::string>> failures;  ///< with their reasons
};

/// A sweep that is planned but not yet on disk: resolved configs, one a job.
struct SweepPlan {
  Sweep sweep;
  Tree config;  ///< the resolved base with its `sweep:`
  std::vector<ResolvedConfig> configs;
};

/// Composes, resolves and checks every job of `file` with the axes of its `sweep:` and those in `axes`, which replace
/// those of the same key. Jobs that resolve to the same run are refused. Throws Error; touches nothing.
SweepPlan plan_sweep(Composer& composer, const PluginHost& host, const std::filesystem::path& file,
                     const std::vector<Axis>& axes, const std::filesystem::path& runs);

/// Writes config.yaml, manifest.jsonl and the config of every job. Throws Error if the directory holds a sweep.
void prepare_sweep(const SweepPlan& plan);

/// Whether `directory` holds a sweep.
bool is_sweep(const std::filesystem::path& directory);

/// Reads the manifest of a sweep. Throws Error.
Sweep read_sweep(const std::filesystem::path& directory);

/// Runs every job that is not done, in `workers` threads, and rebuilds results.csv. A failed job is skipped unless
/// `options` say otherwise; it never stops the others. `configs` are those of the jobs, or null to read them from the
/// jobs' directories. `progress` is called after every job, one call at a time.
SweepReport run_sweep(const Workshop& workshop, const Sweep& sweep, const std::vector<ResolvedConfig>* configs,
                      const ResumeOptions& options, int workers,
                      const std::function<void(const SweepProgress&)>& progress);

/// jobs/<id>
std::filesystem::path job_directory(const Sweep& sweep, const Job& job);

/// The summary of each job, none for those that have not ended. Throws Error for a damaged one.
std::vector<std::optional<Row>> sweep_summaries(const Sweep& sweep);

/// The rows of results.csv: job, id, the swept keys, then the fields of the summary, for jobs that ended.
std::vector<Row> sweep_results(const Sweep& sweep);

/// Median, spread and dead starts by group: all swept keys but the seed. One line a group under a header.
std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results, int initial_taps);

}  // namespace palpate
