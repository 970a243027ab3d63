// SPDX-License-Identifier: MIT
#include "sweep/tap_summaries.hpp"

#include "config/catch_error.hpp"
#include "config/hash.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/run_replay.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSummariesFile = "summaries.jsonl";

/// Field of a stored row: the hash of the final summary of its run.
constexpr const char* kOfSummary = "of_summary";

std::string summary_hash(const Row& summary) { return hash_of(to_json_line(summary)); }

}  // namespace

std::size_t taps_made(const Row& summary) {
  constexpr double kMost = 1e9;
  const double taps = summary.number("taps").value_or(0.0);
  return taps >= 1.0 && taps <= kMost ? static_cast<std::size_t>(taps) : 0;
}

TapSummaries::TapSummaries(const Sweep& sweep, Use use, std::size_t fewest)
    : sweep_(sweep), use_(std::move(use)), summaries_(sweep_summaries(sweep)) {
  for (std::size_t job = 0; job < sweep_.jobs.size(); ++job) {
    const std::optional<Row>& summary = summaries_[job];
    const bool asked = summary && summary->text("status") == "done" && taps_made(*summary) > fewest;
    if (asked && !hand_over(job)) missing_.push_back(job);
  }
}

bool TapSummaries::any_kept(const Sweep& sweep) {
  return std::any_of(sweep.jobs.begin(), sweep.jobs.end(),
                     [&](const Job& job) { return is_there(job_directory(sweep, job) / kSummariesFile); });
}

std::optional<std::vector<Row>> TapSummaries::kept(std::size_t job) const {
  const Row& whole = *summaries_[job];
  if (taps_made(whole) == 1) return std::vector<Row>();
  const fs::path file = job_directory(sweep_, sweep_.jobs[job]) / kSummariesFile;
  if (!is_there(file)) return std::nullopt;
  std::vector<Row> rows;
  // The rows of a damaged file are computed again.
  const auto trouble = catch_error([&] { read_json_lines(file, [&](Row row) { rows.push_back(std::move(row)); }); });
  if (trouble && trouble->kind() == Error::Kind::run) throw *trouble;
  if (trouble) return std::nullopt;
  const Scalar hash(summary_hash(whole));
  const bool holds = std::all_of(rows.begin(), rows.end(), [&](const Row& row) {
    const Scalar* of = row.find(kOfSummary);
    return of != nullptr && *of == hash;
  });
  if (!holds || rows.size() + 1 != taps_made(whole)) return std::nullopt;
  for (Row& row : rows) row.erase(kOfSummary);
  return rows;
}

void TapSummaries::compute(const RunEnvironment& environment, std::size_t job) const {
  const fs::path directory = job_directory(sweep_, sweep_.jobs[job]);
  refuse_link(directory.parent_path());
  refuse_link(directory);
  const Row& whole = *summaries_[job];
  const RecordedRun recording = read_recorded_run(environment.host, directory);
  if (recording.rows.size() < taps_made(whole))
    throw Error(directory.string(), "its record has fewer taps than its summary",
                "the file is damaged, run the job again");
  std::string lines;
  const std::string hash = summary_hash(whole);
  for (Row& row : earlier_summaries(environment, recording)) {
    row.add(kOfSummary, hash);
    lines += to_json_line(row) + "\n";
  }
  write_file(directory / kSummariesFile, lines);
}

bool TapSummaries::hand_over(std::size_t job) const {
  std::optional<std::vector<Row>> rows = kept(job);
  if (!rows) return false;
  rows->push_back(*summaries_[job]);
  use_(job, *rows);
  return true;
}

void TapSummaries::read_missing() const {
  for (const std::size_t job : missing_) {
    if (hand_over(job)) continue;
    throw Error(job_directory(sweep_, sweep_.jobs[job]).string(), "has no summaries after its taps",
                "they were removed during the command: repeat the command", Error::Kind::run);
  }
}

}  // namespace palpate
