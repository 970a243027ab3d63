// SPDX-License-Identifier: MIT
// The directory of a sweep: its jobs as listed when it began, what became of each, and the table made from that.
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
  std::vector<std::string> values;       ///< one for each swept key; "" where the job's plugins have no such option
  std::filesystem::path directory = {};  ///< of a job in a PooledSweep; of others empty: see job_directory()
};

/// A line of manifest.jsonl.
struct JobLine {
  const std::vector<std::string>& keys;
  const Job& job;
  std::string sweep;  ///< its id; "" in what that is a hash of
};
const FieldList<JobLine>& job_list();

/// A sweep's directory: config.yaml, manifest.jsonl, jobs/<id>/, results.csv.
struct Sweep {
  std::filesystem::path directory;
  std::vector<std::string> keys;
  std::vector<Job> jobs;
  std::string name = {};  ///< of a PooledSweep; of others empty: see sweep_name()
};

/// The name of a sweep's directory: a hash of its resolved config, as written, and of its keys and jobs.
std::string sweep_id(const Tree& config, const Sweep& sweep);

/// manifest.jsonl: a job a line. Each carries the sweep's id, so that a change is noticed whatever the folder is
/// called.
std::string manifest_text(const Sweep& sweep, const std::string& id);

/// Reads the manifest of a sweep. Throws Error where there is none, when it is damaged, or when config or manifest are
/// not those that it began with.
Sweep read_sweep(const std::filesystem::path& directory);

/// What it is called: as all its jobs are if that was said on the command line, else as its config says.
std::string sweep_name(const Sweep& sweep);

/// All of a sweep, as indices into Sweep::jobs.
std::vector<std::size_t> all_jobs(const Sweep& sweep);

/// jobs/<id>, or where the job of a PooledSweep was recorded.
std::filesystem::path job_directory(const Sweep& sweep, const Job& job);

/// The summary of each job, none for those that have not ended; see read_outcome().
std::vector<std::optional<Row>> sweep_summaries(const Sweep& sweep);

/// What stands before the name of a field of the summary in results.csv where a swept key has that name.
inline constexpr const char* kOfRun = "summary.";
/// The option that changes no result: how many threads update the maps.
inline constexpr const char* kThreads = "engine.threads";

/// A row of results.csv: job, id, the swept keys, then the fields of the summary. A field with the name of a key stands
/// as `summary.taps`, in the rows in which the two differ.
Row result_row(const Sweep& sweep, const Job& job, Row summary);

/// The field of the summary that `name` means in such a row: `taps`, or `summary.taps`, whether `taps` is swept or not.
/// Null where there is none.
const Scalar* result_of(const Row& row, const std::string& name);
/// `taps` of `summary.taps`, and of itself.
std::string field_name(const std::string& column);

/// All of them, for jobs that ended. Those of very many take much memory: who has summaries gives them away for it.
std::vector<Row> sweep_results(const Sweep& sweep);
std::vector<Row> sweep_results(const Sweep& sweep, std::vector<std::optional<Row>> summaries);

/// Makes results.csv anew from the jobs, as they are once nobody else does the same. Returns its rows. Throws Error.
std::vector<Row> write_results(const Sweep& sweep);

/// Every job of a sweep; one without a summary counts as failed.
std::vector<RunOutcome> outcomes_of(const Sweep& sweep);

}  // namespace palpate
