// SPDX-License-Identifier: MIT
#include "sweep/tap_summaries.hpp"

#include "config/trouble.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/recording.hpp"
#include "sweep/earlier_results.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSummariesFile = "summaries.jsonl";

/// 0 where the summary has no number that can be one of taps: who reads the record says what is wrong with it.
std::size_t taps_made(const Row& summary) {
  constexpr double kMost = 1e9;
  const double taps = summary.number("taps").value_or(0.0);
  return taps >= 1.0 && taps <= kMost ? static_cast<std::size_t>(taps) : 0;
}

bool has_ended_well(const std::optional<Row>& summary) {
  return summary && summary->text("status") == "done" && taps_made(*summary) > 0;
}

/// Numbers and flags alone: texts are in the summary, and what is null has no line.
Row numbers_of(const Row& summary) {
  Row out;
  for (const auto& [name, value] : summary.fields) {
    if (!std::holds_alternative<std::monostate>(value) && !std::holds_alternative<std::string>(value))
      out.add(name, value);
  }
  return out;
}

}  // namespace

TapSummaries::TapSummaries(const Sweep& sweep, Use use)
    : sweep_(sweep), use_(std::move(use)), summaries_(sweep_summaries(sweep)) {
  for (std::size_t job = 0; job < sweep_.jobs.size(); ++job) {
    if (has_ended_well(summaries_[job]) && !hand_over(job)) missing_.push_back(job);
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
  // What somebody has damaged is computed again, as what is not there.
  const auto trouble = trouble_in([&] { rows = read_json_lines(file).rows; });
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

void TapSummaries::compute(const Workshop& workshop, std::size_t job) const {
  const fs::path directory = job_directory(sweep_, sweep_.jobs[job]);
  refuse_link(directory.parent_path());
  refuse_link(directory);
  const Row& whole = *summaries_[job];
  // Read first: as many taps as the summary says are in the record, or it is refused.
  const Recording recording = read_recording(workshop, directory);
  std::vector<Occasion> all;
  for (std::size_t taps = 1; taps < taps_made(whole); ++taps) all.push_back(Occasion::after(static_cast<int>(taps)));
  const std::string hash = summary_hash(whole);
  std::string lines;
  for (const std::optional<Row>& summary : summaries_at(workshop, recording, all)) {
    Row row = numbers_of(*summary);
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
  for (const std::size_t job : missing_) hand_over(job);
}

}  // namespace palpate
