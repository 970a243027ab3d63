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

std::int64_t taps_of(const Row& summary) { return static_cast<std::int64_t>(summary.number("taps").value_or(0.0)); }

fs::path file_of(const fs::path& job, const Occasion& occasion) {
  return job / fmt::format("summary_{}.json", occasion.key());
}

}  // namespace

std::string summary_hash(const Row& summary) { return hash_of(to_json_line(summary)); }

EarlierResults::EarlierResults(const Sweep& sweep, std::vector<Occasion> occasions)
    : sweep_(sweep), occasions_(std::move(occasions)), summaries_(sweep_summaries(sweep)) {
  std::int64_t most = 0;
  for (const std::optional<Row>& summary : summaries_) most = std::max(most, summary ? taps_of(*summary) : 0);
  for (const Occasion& one : occasions_) {
    if (most == 0 || one.taps().value_or(0) <= most) continue;
    throw Error("command line", fmt::format("--at: no job made {} taps", *one.taps()),
                fmt::format("the most are {}", most));
  }
  for (std::size_t job = 0; job < sweep_.jobs.size(); ++job) {
    const bool lacks = std::any_of(occasions_.begin(), occasions_.end(),
                                   [&](const Occasion& one) { return is_longer(job, one) && !kept(job, one); });
    if (lacks) missing_.push_back(job);
  }
}

bool EarlierResults::is_longer(std::size_t job, const Occasion& occasion) const {
  const std::optional<Row>& summary = summaries_[job];
  return summary && summary->text("status") == "done" && taps_of(*summary) > occasion.taps().value_or(0);
}

std::optional<Row> EarlierResults::kept(std::size_t job, const Occasion& occasion) const {
  const fs::path file = file_of(job_directory(sweep_, sweep_.jobs[job]), occasion);
  if (!is_there(file)) return std::nullopt;
  std::optional<Row> row = parse_json_row(read_file(file));
  if (!row) return std::nullopt;
  const Scalar* of = row->find(kOfSummary);
  if (of == nullptr || *of != Scalar(summary_hash(*summaries_[job]))) return std::nullopt;
  row->erase(kOfSummary);
  return row;
}

void EarlierResults::compute(const Workshop& workshop, std::size_t job) const {
  const fs::path directory = job_directory(sweep_, sweep_.jobs[job]);
  refuse_link(directory.parent_path());
  refuse_link(directory);
  const Row& whole = *summaries_[job];
  std::vector<Occasion> wanted;
  std::copy_if(occasions_.begin(), occasions_.end(), std::back_inserter(wanted),
               [&](const Occasion& one) { return is_longer(job, one); });
  const std::vector<std::optional<Row>> rows = summaries_at(workshop, read_recording(workshop, directory), wanted);
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    Row row = rows[i].value_or(whole);
    if (!wanted[i].taps()) row.add(kReached, rows[i].has_value());
    row.add(kOfSummary, summary_hash(whole));
    write_file(file_of(directory, wanted[i]), to_json(row));
  }
}

std::vector<Row> EarlierResults::write(const Occasion& occasion) const {
  std::vector<std::optional<Row>> summaries = summaries_;
  for (std::size_t job = 0; job < summaries.size(); ++job) {
    if (!is_longer(job, occasion)) continue;
    summaries[job] = kept(job, occasion);
    if (summaries[job]) continue;
    throw Error(job_directory(sweep_, sweep_.jobs[job]).string(), fmt::format("has no summary {}", occasion.words()),
                "it was removed during the command: repeat the command", Error::Kind::run);
  }
  std::vector<Row> rows = sweep_results(sweep_, std::move(summaries));
  write_file(sweep_.directory / fmt::format("results_{}.csv", occasion.key()), to_csv(rows));
  return rows;
}

}  // namespace palpate
