// SPDX-License-Identifier: MIT
// The directory of a sweep: its jobs, their results, and the table results.csv.
#pragma once

#include "record/field.hpp"
#include "record/gate.hpp"
#include "record/row.hpp"
#include "record/run_directory.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// One job of a sweep.
struct Job {
  int index = 0;
  std::string id;
  std::vector<std::string> values;       ///< one value per swept key; "": the plugins of the job lack the option
  std::filesystem::path directory = {};  ///< only in a PooledSweep: see job_directory()
};

/// A line of manifest.jsonl.
struct JobLine {
  const std::vector<std::string>& keys;
  const Job& job;
  std::string sweep;  ///< id of the sweep; "" in the lines that are hashed to make the id
};
const FieldList<JobLine>& job_list();

/// A round of a tuned sweep: jobs that were added together, after all jobs of the earlier rounds had ended.
struct SweepRound {
  std::size_t jobs = 0;  ///< number of jobs of the sweep, those of this round included
  Row decision;          ///< further fields of the round's line in manifest.jsonl: see RaceState
};

/// The directory of a sweep: config.yaml, manifest.jsonl, jobs/<id>/, results.csv.
struct Sweep {
  std::filesystem::path directory;
  std::vector<std::string> keys;
  std::vector<Job> jobs;
  std::string name = {};                ///< only in a PooledSweep: see sweep_name()
  std::vector<SweepRound> rounds = {};  ///< only of a sweep that `palpate tune` made; else empty
};

/// Returns the name of a sweep's directory: a hash of its resolved config and, unless it has rounds, of its keys and
/// its jobs.
std::string sweep_id(const Tree& config, const Sweep& sweep);

/// Returns the text of manifest.jsonl: one line per job, and one line after the jobs of each round. Each line of a job
/// contains the id of the sweep, and each line of a round a hash of itself and of all lines before it. read_sweep()
/// detects changed files by them.
std::string manifest_text(const Sweep& sweep, const std::string& id);

/// Reads the manifest of a sweep. Throws Error if it is missing or damaged, or if config or manifest have changed since
/// the start of the sweep. In a sweep with rounds, jobs without the line of their round do not count, because the
/// process that added them was killed.
Sweep read_sweep(const std::filesystem::path& directory);

/// Appends a round to the manifest of a sweep with rounds. The configs of `jobs` must exist. The lines are on the disk
/// when the function returns. The caller must hold the lock of the sweep and have read `sweep` under it. Throws Error.
void append_round(const Sweep& sweep, const std::vector<Job>& jobs, const Row& decision);

/// Returns the name of the sweep. If `name` is a swept key with the same value in all jobs, as after `name=X` on the
/// command line, returns this value. Otherwise returns `name` of the sweep's config.
std::string sweep_name(const Sweep& sweep);

/// Returns all indices into Sweep::jobs.
std::vector<std::size_t> all_jobs(const Sweep& sweep);

/// Returns jobs/<id>, or the recorded directory of a job in a PooledSweep.
std::filesystem::path job_directory(const Sweep& sweep, const Job& job);

/// Returns the summary of each job; nullopt for a job that has not ended. See read_outcome().
std::vector<std::optional<Row>> sweep_summaries(const Sweep& sweep);

/// Prefix in results.csv for a summary field whose name is also a swept key.
inline constexpr const char* kOfRun = "summary.";
/// The option with the number of threads, which does not affect results.
inline constexpr const char* kThreads = "belief.engine.threads";

/// Returns a row of results.csv: job, id, swept keys, and summary fields. A summary field with the name of a swept key,
/// such as `taps`, is renamed to `summary.taps`. It is left out if it has the same value as the key.
Row result_row(const Sweep& sweep, const Job& job, Row summary);

/// Returns the summary field `name`, for example `taps` or `summary.taps`, in a row of results.csv; null if there is
/// none. Both forms are accepted, even if `taps` is not swept.
const Scalar* result_of(const Row& row, const std::string& name);
/// Removes the prefix: `summary.taps` and `taps` become `taps`.
std::string field_name(const std::string& column);

/// Returns the rows of results.csv for jobs that ended. The second overload consumes the summaries, to save memory.
std::vector<Row> sweep_results(const Sweep& sweep);
std::vector<Row> sweep_results(const Sweep& sweep, std::vector<std::optional<Row>> summaries);

/// Writes results.csv from the jobs and returns its rows. Waits for other processes that do the same. Throws Error.
std::vector<Row> write_results(const Sweep& sweep);

/// Returns the outcomes of all jobs. A job without a summary counts as failed.
std::vector<RunOutcome> outcomes_of(const Sweep& sweep);

}  // namespace palpate
