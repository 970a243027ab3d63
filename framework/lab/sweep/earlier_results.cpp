// SPDX-License-Identifier: MIT
#include "sweep/earlier_results.hpp"

#include "config/hash.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/recording.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// Of a kept summary: the hash of the whole run's.
constexpr const char* kOf = "of_summary";

std::int64_t taps_of(const Row& summary) { return static_cast<std::int64_t>(summary.number("taps").value_or(0.0)); }

fs::path file_of(const fs::path& job, int taps) { return job / fmt::format("summary_at_{}.json", taps); }

}  // namespace

EarlierResults::EarlierResults(const Sweep& sweep, std::vector<int> taps)
    : sweep_(sweep), taps_(std::move(taps)), summaries_(sweep_summaries(sweep)) {
  std::sort(taps_.begin(), taps_.end());
  taps_.erase(std::unique(taps_.begin(), taps_.end()), taps_.end());
  std::int64_t most = 0;
  for (const std::optional<Row>& summary : summaries_) most = std::max(most, summary ? taps_of(*summary) : 0);
  if (most > 0 && taps_.back() > most) {
    throw Error("command line", fmt::format("--at: no job made {} taps", taps_.back()),
                fmt::format("the most are {}", most));
  }
  for (std::size_t job = 0; job < sweep_.jobs.size(); ++job) {
    const bool lacks =
        std::any_of(taps_.begin(), taps_.end(), [&](int count) { return is_longer(job, count) && !kept(job, count); });
    if (lacks) missing_.push_back(job);
  }
}

bool EarlierResults::is_longer(std::size_t job, int taps) const {
  const std::optional<Row>& summary = summaries_[job];
  return summary && summary->text("status") == "done" && taps_of(*summary) > taps;
}

std::optional<Row> EarlierResults::kept(std::size_t job, int taps) const {
  const fs::path file = file_of(job_directory(sweep_, sweep_.jobs[job]), taps);
  if (!is_there(file)) return std::nullopt;
  std::optional<Row> row = parse_json_row(read_file(file));
  if (!row) return std::nullopt;
  const Scalar* of = row->find(kOf);
  if (of == nullptr || *of != Scalar(hash_of(to_json_line(*summaries_[job])))) return std::nullopt;
  row->erase(kOf);
  return row;
}

void EarlierResults::compute(const Workshop& workshop, std::size_t job) const {
  const fs::path directory = job_directory(sweep_, sweep_.jobs[job]);
  refuse_link(directory.parent_path());
  refuse_link(directory);
  std::vector<int> shorter;
  std::copy_if(taps_.begin(), taps_.end(), std::back_inserter(shorter),
               [&](int count) { return is_longer(job, count); });
  const std::vector<Row> rows = summaries_after(workshop, read_recording(workshop, directory), shorter);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Row row = rows[i];
    row.add(kOf, hash_of(to_json_line(*summaries_[job])));
    write_file(file_of(directory, shorter[i]), to_json_text(row));
  }
}

std::vector<Row> EarlierResults::write(int taps) const {
  std::vector<std::optional<Row>> summaries = summaries_;
  for (std::size_t job = 0; job < summaries.size(); ++job) {
    if (!is_longer(job, taps)) continue;
    summaries[job] = kept(job, taps);
    if (summaries[job]) continue;
    throw Error(job_directory(sweep_, sweep_.jobs[job]).string(), fmt::format("has no summary at {} taps", taps),
                "it was removed while it was needed: ask again", Error::Kind::run);
  }
  std::vector<Row> rows = sweep_results(sweep_, summaries);
  write_file(sweep_.directory / fmt::format("results_at_{}.csv", taps), to_csv(rows));
  return rows;
}

}  // namespace palpate
