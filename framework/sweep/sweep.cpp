// SPDX-License-Identifier: MIT
#include "sweep/sweep.hpp"

#include "config/hash.hpp"
#include "config/yaml.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/resolved_config.hpp"
#include "record/run.hpp"
#include "sweep/read_jobs.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSweep = "sweep";  ///< field with the id of the sweep
constexpr const char* kManifest = "manifest.jsonl";
constexpr const char* kRound = "round";  ///< first field of the line of a round

FieldList<JobLine> make_job_list() {
  FieldList<JobLine> list;
  list.add("job", "number of the job, from 0", [](const JobLine& line) { return line.job.index; });
  list.add("id", "id of the job's run", [](const JobLine& line) { return line.job.id; });
  // The keys are stored as values, because a dot in a field name would nest the field.
  list.add_family("key_N", "swept key number N, from 0", [](Row& row, const JobLine& line) {
    for (std::size_t i = 0; i < line.keys.size(); ++i) {
      row.add(fmt::format("key_{}", i), line.keys[i]);
      row.add(fmt::format("value_{}", i), line.job.values[i]);
    }
  });
  list.add_family("value_N", "value of that key in the job; empty if the job's plugin has no such option",
                  [](Row&, const JobLine&) {});
  list.add_where([](const JobLine& line) { return !line.sweep.empty(); }, kSweep, "id of the sweep", &JobLine::sweep);
  return list;
}

/// Returns the texts of the fields NAME_0, NAME_1, ...
std::vector<std::string> texts_at(const Row& row, const std::string& name) {
  std::vector<std::string> out;
  for (const auto& [field, value] : row.fields) {
    if (field != fmt::format("{}_{}", name, out.size())) continue;
    if (const auto* text = std::get_if<std::string>(&value)) out.push_back(*text);
  }
  return out;
}

/// Returns whether a top-level key affects the results of the jobs.
bool decides_jobs(const std::string& key) {
  return key != "name" && key != "log" && key != "expect" && key != "complete";
}

std::string job_line(const Sweep& sweep, const Job& job, const std::string& id) {
  return to_json_line(job_list().row({sweep.keys, job, id})) + "\n";
}

/// Returns the line of a round. `before`: the lines before it, from the line of the round before on. That line contains
/// a hash of the lines before it, so the hash of this line covers the whole manifest.
std::string round_line(std::size_t number, const SweepRound& round, const std::string& before) {
  Row row;
  row.add(kRound, static_cast<std::int64_t>(number));
  row.add("jobs", static_cast<std::int64_t>(round.jobs));
  row.fields.insert(row.fields.end(), round.decision.fields.begin(), round.decision.fields.end());
  row.add("chain", hash_of(before + to_json_line(row)));
  return to_json_line(row) + "\n";
}

bool is_id(const std::string& text) { return text.size() == kIdLength && begins_with_id(text); }

/// The content of manifest.jsonl.
struct SweepManifest {
  Sweep sweep;
  std::string id;               ///< id of the sweep, as the lines of the jobs have it
  std::size_t bytes = 0;        ///< number of bytes up to the end of the last line that counts
  std::size_t chain_begin = 0;  ///< where the line of the last round begins; 0 if there is none
};

/// Throws Error, with the line, unless the row is exactly that of its job. The id must be valid, because it is the name
/// of a folder.
void add_job(SweepManifest& manifest, const Row& row, const std::string& place) {
  Sweep& sweep = manifest.sweep;
  if (sweep.jobs.empty()) {
    sweep.keys = texts_at(row, "key");
    manifest.id = row.text(kSweep);
  }
  const Job job{static_cast<int>(sweep.jobs.size()), row.text("id"), texts_at(row, "value")};
  if (!is_id(job.id) || job.values.size() != sweep.keys.size() || manifest.id.empty() ||
      job_list().row({sweep.keys, job, manifest.id}).fields != row.fields)
    throw Error(place, "is not a job of this sweep", "the file is damaged: put it back as it was");
  sweep.jobs.push_back(job);
}

/// Throws Error, with the place, unless the line of this row is that of the next round after the lines `before`, as
/// round_line() takes them.
void add_round(Sweep& sweep, const Row& row, const std::string& line, const std::string& before,
               const std::string& place) {
  SweepRound round{sweep.jobs.size(), row};
  for (const char* const field : {kRound, "jobs", "chain"}) round.decision.erase(field);
  if (round_line(sweep.rounds.size(), round, before) != line + "\n")
    throw Error(place, "is not a round of this sweep, or lines before it were changed",
                "the file is damaged: put it back as it was");
  sweep.rounds.push_back(std::move(round));
}

SweepManifest read_sweep_manifest(const fs::path& directory) {
  const fs::path file = directory / kManifest;
  const std::string text = read_file(file);
  SweepManifest out{{directory, {}, {}}, {}};
  JsonLinesReader reader(file);
  std::size_t begin = 0;
  for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n', begin)) {
    const std::string line = text.substr(begin, end - begin);
    const Row row = reader.read(line);
    const bool is_round = !row.fields.empty() && row.fields.front().first == kRound;
    if (is_round) {
      add_round(out.sweep, row, line, text.substr(out.chain_begin, begin - out.chain_begin), reader.place());
      out.chain_begin = begin;
    } else {
      add_job(out, row, reader.place());
    }
    begin = end + 1;
    if (is_round || out.sweep.rounds.empty()) out.bytes = begin;
  }
  // A manifest without rounds is complete before the first job starts, so an incomplete line means damage.
  if (out.sweep.rounds.empty() && out.bytes != text.size())
    throw Error(file.string(), "ends in the middle of a line", "the file is damaged");
  if (!out.sweep.rounds.empty()) out.sweep.jobs.resize(out.sweep.rounds.back().jobs);
  if (out.sweep.jobs.empty()) throw Error(file.string(), "lists no jobs", "the file is damaged");
  return out;
}

}  // namespace

const FieldList<JobLine>& job_list() {
  static const FieldList<JobLine> list = make_job_list();
  return list;
}

std::string manifest_text(const Sweep& sweep, const std::string& id) {
  std::string text;
  std::size_t next = 0;
  std::size_t chain_begin = 0;
  const auto add_jobs = [&](std::size_t end) {
    for (; next < end; ++next) text += job_line(sweep, sweep.jobs[next], id);
  };
  for (std::size_t round = 0; round < sweep.rounds.size(); ++round) {
    add_jobs(sweep.rounds[round].jobs);
    const std::string line = round_line(round, sweep.rounds[round], text.substr(chain_begin));
    chain_begin = text.size();
    text += line;
  }
  add_jobs(sweep.jobs.size());
  return text;
}

std::string sweep_id(const Tree& config, const Sweep& sweep) {
  Tree identity = Tree::map();
  // Parse the text of the config, so that the id equals the one that read_sweep() later computes from the file.
  Tree parsed = parse_yaml(to_yaml(config), "config.yaml");
  parsed.erase_path(kThreads);
  for (const char* const group : {"belief.engine", "belief"}) {
    const Tree* const left = parsed.find_path(group);
    if (left != nullptr && left->is_map() && left->entries.empty()) parsed.erase_path(group);
  }
  for (Tree::Entry& entry : parsed.entries) {
    if (decides_jobs(entry.key)) identity.entries.push_back(std::move(entry));
  }
  // Later rounds add jobs, so the jobs do not identify a sweep with rounds.
  return hash_of(identity.canonical() + (sweep.rounds.empty() ? manifest_text(sweep, "") : "")).substr(0, kIdLength);
}

std::vector<std::size_t> all_jobs(const Sweep& sweep) {
  std::vector<std::size_t> jobs(sweep.jobs.size());
  std::iota(jobs.begin(), jobs.end(), std::size_t{0});
  return jobs;
}

fs::path job_directory(const Sweep& sweep, const Job& job) {
  return job.directory.empty() ? sweep.directory / "jobs" / job.id : job.directory;
}

std::string sweep_name(const Sweep& sweep) {
  if (!sweep.name.empty()) return sweep.name;
  const auto key = std::find(sweep.keys.begin(), sweep.keys.end(), "name");
  const auto at = static_cast<std::size_t>(key - sweep.keys.begin());
  const auto same = [&](const Job& job) { return job.values[at] == sweep.jobs.front().values[at]; };
  if (key != sweep.keys.end() && std::all_of(sweep.jobs.begin(), sweep.jobs.end(), same))
    return sweep.jobs.front().values[at];
  const Tree config = read_run_config(sweep.directory);
  const Tree* name = config.find("name");
  return name != nullptr ? name->text : "experiment";
}

Sweep read_sweep(const fs::path& directory) {
  if (!is_sweep(directory))
    throw Error(directory.string(), "is not the directory of a sweep", "it has no manifest.jsonl");
  SweepManifest manifest = read_sweep_manifest(directory);
  Sweep& sweep = manifest.sweep;
  if (sweep_id(read_run_config(directory), sweep) != manifest.id)
    throw Error(directory.string(), "config.yaml or manifest.jsonl was changed after this sweep started",
                "restore the old file, or run the changed config with 'palpate sweep'");
  return std::move(sweep);
}

void append_round(const Sweep& sweep, const std::vector<Job>& jobs, const Row& decision) {
  const fs::path file = sweep.directory / kManifest;
  const SweepManifest manifest = read_sweep_manifest(sweep.directory);
  std::string text = read_file(file).substr(0, manifest.bytes);
  const std::size_t before = text.size();
  for (const Job& job : jobs) text += job_line(sweep, job, manifest.id);
  text +=
      round_line(sweep.rounds.size(), {sweep.jobs.size() + jobs.size(), decision}, text.substr(manifest.chain_begin));
  AppendFile manifest_file(file);
  manifest_file.cut(before);  // removes jobs without the line of their round
  manifest_file.append(text.substr(before), true);
  manifest_file.flush();
}

std::vector<Row> write_results(const Sweep& sweep) {
  const FileLock lock = FileLock::wait_for(sweep.directory / "lock");
  std::vector<Row> results = sweep_results(sweep);
  write_file(sweep.directory / "results.csv", to_csv(results));
  return results;
}

std::vector<std::optional<Row>> sweep_summaries(const Sweep& sweep) {
  std::vector<std::optional<Row>> summaries;
  summaries.reserve(sweep.jobs.size());
  read_jobs(sweep, all_jobs(sweep), read_outcome,
            [&](std::size_t, std::optional<Row> one) { summaries.push_back(std::move(one)); });
  return summaries;
}

Row result_row(const Sweep& sweep, const Job& job, Row summary) {
  Row row;
  row.fields.reserve(2 + sweep.keys.size() + summary.fields.size());
  row.add("job", job.index);
  row.add("id", job.id);
  for (std::size_t i = 0; i < sweep.keys.size(); ++i) row.add(sweep.keys[i], job.values[i]);
  const auto behind = static_cast<std::ptrdiff_t>(row.fields.size());
  for (auto& field : summary.fields) {
    const auto same = [&](const auto& one) { return one.first == field.first; };
    const auto keys = row.fields.begin();
    const auto key = std::find_if(keys, keys + behind, same);
    const bool hidden = key != keys + behind;
    if (hidden && csv_cell(key->second) == csv_cell(field.second)) continue;
    if (hidden) field.first = kOfRun + field.first;
    row.fields.push_back(std::move(field));
  }
  return row;
}

std::string field_name(const std::string& column) {
  const std::string prefix = kOfRun;
  return column.compare(0, prefix.size(), prefix) == 0 ? column.substr(prefix.size()) : column;
}

const Scalar* result_of(const Row& row, const std::string& name) {
  const std::string field = field_name(name);
  const Scalar* found = row.find(field);
  // The values of swept keys are texts.
  if (found == nullptr || !std::holds_alternative<std::string>(*found)) return found;
  const Scalar* of_run = row.find(kOfRun + field);
  return of_run != nullptr ? of_run : found;
}

std::vector<Row> sweep_results(const Sweep& sweep) { return sweep_results(sweep, sweep_summaries(sweep)); }

std::vector<Row> sweep_results(const Sweep& sweep, std::vector<std::optional<Row>> summaries) {
  std::vector<Row> rows;
  rows.reserve(sweep.jobs.size());
  for (const Job& job : sweep.jobs) {
    std::optional<Row>& summary = summaries[static_cast<std::size_t>(job.index)];
    if (summary) rows.push_back(result_row(sweep, job, *std::exchange(summary, std::nullopt)));
  }
  return rows;
}

std::vector<RunOutcome> outcomes_of(const Sweep& sweep) {
  std::vector<RunOutcome> runs;
  const auto seed = std::find(sweep.keys.begin(), sweep.keys.end(), "seed") - sweep.keys.begin();
  std::vector<std::optional<Row>> summaries = sweep_summaries(sweep);
  for (const Job& job : sweep.jobs) {
    RunOutcome run;
    if (seed < static_cast<std::ptrdiff_t>(sweep.keys.size())) run.seed = job.values[static_cast<std::size_t>(seed)];
    run.label = fmt::format("job {}", job.index);
    run.name = run.label;
    for (std::size_t i = 0; i < sweep.keys.size(); ++i)
      run.name += fmt::format("{}{}={}", i == 0 ? ": " : ", ", sweep.keys[i], job.values[i]);
    run.summary = std::move(summaries[static_cast<std::size_t>(job.index)]);
    if (!run.summary) {
      run.failure = "has not ended";
    } else if (run.summary->text("status") != "done") {
      run.failure = run.summary->text("stop_reason");
      if (run.failure.empty()) run.failure = "failed";
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace palpate
