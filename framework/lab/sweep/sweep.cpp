// SPDX-License-Identifier: MIT
#include "sweep/sweep.hpp"

#include "config/hash.hpp"
#include "config/yaml.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/resolved.hpp"
#include "record/session.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSweep = "sweep";  ///< the field with the id

/// A line of manifest.jsonl but for the sweep's id, which is a hash of these.
Row manifest_row(const std::vector<std::string>& keys, const Job& job) {
  Row row;
  row.add("job", job.index);
  row.add("id", job.id);
  // A dot in a key would nest it: the keys of a manifest stand flat, in the order of the sweep.
  for (std::size_t i = 0; i < keys.size(); ++i) {
    row.add(fmt::format("key_{}", i), keys[i]);
    row.add(fmt::format("value_{}", i), job.values[i]);
  }
  return row;
}

/// The texts at `name` 0, 1, ... for as long as there are any.
std::vector<std::string> texts_at(const Row& row, const std::string& name) {
  std::vector<std::string> out;
  for (const auto& [field, value] : row.fields) {
    if (field != fmt::format("{}_{}", name, out.size())) continue;
    if (const auto* text = std::get_if<std::string>(&value)) out.push_back(*text);
  }
  return out;
}

bool is_id(const std::string& text) { return text.size() == kIdLength && begins_with_id(text); }

}  // namespace

std::string manifest_text(const Sweep& sweep, const std::string& id) {
  std::string text;
  for (const Job& job : sweep.jobs) {
    Row row = manifest_row(sweep.keys, job);
    row.add(kSweep, id);
    text += to_json_line(row) + "\n";
  }
  return text;
}

std::string sweep_id(const Tree& config, const Sweep& sweep) {
  Tree identity = Tree::map();
  // As it reads back: what is compared later is the file.
  for (Tree::Entry& entry : parse_yaml(to_yaml(config), "config.yaml").entries) {
    if (enters_id(entry.key)) identity.entries.push_back(std::move(entry));
  }
  std::string all = identity.canonical();
  for (const Job& job : sweep.jobs) all += to_json_line(manifest_row(sweep.keys, job)) + "\n";
  return hash_of(all).substr(0, kIdLength);
}

fs::path job_directory(const Sweep& sweep, const Job& job) { return sweep.directory / "jobs" / job.id; }

std::string sweep_name(const Sweep& sweep) {
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
  Sweep sweep{directory, {}, {}};
  const fs::path file = directory / "manifest.jsonl";
  const JsonLines lines = read_json_lines(file);
  // Complete before the first job began: a line without its end is damage, not work under way.
  if (lines.bytes != fs::file_size(file))
    throw Error(file.string(), "ends in the middle of a line", "the file is damaged");
  if (lines.rows.empty()) throw Error(file.string(), "lists no job", "the file is damaged");
  sweep.keys = texts_at(lines.rows.front(), "key");
  const std::string id = lines.rows.front().text(kSweep);
  for (const Row& row : lines.rows) {
    const Job job{static_cast<int>(sweep.jobs.size()), row.text("id"), texts_at(row, "value")};
    // What is read must be all that the line says, and an id is the name of a folder: nothing of it is believed before.
    const bool whole = is_id(job.id) && job.values.size() == sweep.keys.size();
    Row said = whole ? manifest_row(sweep.keys, job) : Row();
    if (whole && said.fields == row.fields) {
      throw Error(directory.string(), "an older palpate made this sweep: nothing tells whether its jobs were changed",
                  "results.csv is good still; 'palpate sweep' on config.yaml in it makes it anew");
    }
    said.add(kSweep, id);
    if (!whole || said.fields != row.fields) {
      throw Error(fmt::format("{}:{}", file.string(), job.index + 1), "is no job of this sweep",
                  "the file is damaged: put it back as it was");
    }
    sweep.jobs.push_back(job);
  }
  if (sweep_id(read_run_config(directory), sweep) != id) {
    throw Error(directory.string(), "config.yaml or manifest.jsonl was changed since this sweep began",
                "put the old one back, or run the changed config with 'palpate sweep'");
  }
  return sweep;
}

std::vector<std::optional<Row>> write_results(const Sweep& sweep) {
  const FileLock lock = FileLock::wait_for(sweep.directory / "lock");
  remove_neighbours(sweep.directory, {"results.csv"});
  std::vector<std::optional<Row>> summaries = sweep_summaries(sweep);
  write_file(sweep.directory / "results.csv", to_csv(sweep_results(sweep, summaries)));
  return summaries;
}

std::vector<std::optional<Row>> sweep_summaries(const Sweep& sweep) {
  std::vector<std::optional<Row>> summaries;
  for (const Job& job : sweep.jobs) {
    summaries.push_back(read_outcome(job_directory(sweep, job)));
  }
  return summaries;
}

std::vector<Row> sweep_results(const Sweep& sweep) { return sweep_results(sweep, sweep_summaries(sweep)); }

std::vector<Row> sweep_results(const Sweep& sweep, const std::vector<std::optional<Row>>& summaries) {
  std::vector<Row> rows;
  for (const Job& job : sweep.jobs) {
    const std::optional<Row>& summary = summaries[static_cast<std::size_t>(job.index)];
    if (!summary) continue;
    Row row;
    row.add("job", job.index);
    row.add("id", job.id);
    for (std::size_t i = 0; i < sweep.keys.size(); ++i) row.add(sweep.keys[i], job.values[i]);
    for (const auto& field : summary->fields) {
      if (row.find(field.first) == nullptr) row.fields.push_back(field);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::vector<RunOutcome> outcomes_of(const Sweep& sweep, const std::vector<std::optional<Row>>& summaries) {
  std::vector<RunOutcome> runs;
  for (const Job& job : sweep.jobs) {
    RunOutcome run;
    run.label = fmt::format("job {}", job.index);
    run.name = run.label;
    for (std::size_t i = 0; i < sweep.keys.size(); ++i)
      run.name += fmt::format("{}{}={}", i == 0 ? ": " : ", ", sweep.keys[i], job.values[i]);
    run.summary = summaries[static_cast<std::size_t>(job.index)];
    if (!run.summary) {
      run.failure = "has not run to its end";
    } else if (run.summary->text("status") != "done") {
      run.failure = run.summary->text("stop_reason");
      if (run.failure.empty()) run.failure = "failed";
    }
    runs.push_back(std::move(run));
  }
  return runs;
}

}  // namespace palpate
