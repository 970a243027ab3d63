// SPDX-License-Identifier: MIT
#include "sweep/sweep.hpp"

#include "config/hash.hpp"
#include "config/yaml.hpp"
#include "experiment/resolved.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/session.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace palpate {

namespace fs = std::filesystem;

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

std::string sweep_id(const Tree& config, const std::vector<Job>& jobs) {
  Tree identity = Tree::map();
  // As it reads back: what is compared later is the file.
  for (Tree::Entry& entry : parse_yaml(to_yaml(config), "config.yaml").entries) {
    if (enters_id(entry.key)) identity.entries.push_back(std::move(entry));
  }
  std::string all = identity.canonical();
  for (const Job& job : jobs) all += job.id;
  return hash_of(all).substr(0, kIdLength);
}

fs::path job_directory(const Sweep& sweep, const Job& job) { return sweep.directory / "jobs" / job.id; }

bool is_sweep(const fs::path& directory) {
  std::error_code none;
  return fs::exists(directory / "manifest.jsonl", none);
}

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
  for (const Row& row : lines.rows) {
    Job job;
    job.index = static_cast<int>(sweep.jobs.size());
    for (const auto& [name, value] : row.fields) {
      const auto* text = std::get_if<std::string>(&value);
      if (text == nullptr) continue;
      if (name == "id") job.id = *text;
      if (name.compare(0, 6, "value_") == 0) job.values.push_back(*text);
      if (name.compare(0, 4, "key_") == 0 && sweep.jobs.empty()) sweep.keys.push_back(*text);
    }
    sweep.jobs.push_back(std::move(job));
  }
  if (sweep.jobs.empty()) throw Error((directory / "manifest.jsonl").string(), "lists no job", "the file is damaged");
  const std::string name = fs::absolute(directory / "").lexically_normal().parent_path().filename().string();
  if (begins_with_id(name) && sweep_id(read_run_config(directory), sweep.jobs) != name.substr(0, kIdLength)) {
    throw Error(directory.string(), "config.yaml or manifest.jsonl was changed since this sweep began",
                "put the old one back, or run the changed config with 'palpate sweep'");
  }
  return sweep;
}

std::vector<std::optional<Row>> write_results(const Sweep& sweep) {
  const FileLock lock = FileLock::wait_for(sweep.directory / "lock");
  std::vector<std::optional<Row>> summaries = sweep_summaries(sweep);
  write_file(sweep.directory / "results.csv", to_csv(sweep_results(sweep, summaries)));
  return summaries;
}

std::vector<std::optional<Row>> sweep_summaries(const Sweep& sweep) {
  std::vector<std::optional<Row>> summaries;
  for (const Job& job : sweep.jobs) {
    summaries.emplace_back();
    const fs::path file = job_directory(sweep, job) / "summary.json";
    std::error_code none;
    if (!fs::exists(file, none)) continue;
    summaries.back() = parse_json_row(read_file(file));
    if (!summaries.back()) throw Error(file.string(), "is not a JSON object", "the file is damaged");
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

}  // namespace palpate
