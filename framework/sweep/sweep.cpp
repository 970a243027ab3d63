// SPDX-License-Identifier: MIT
#include "sweep/sweep.hpp"

#include "config/hash.hpp"
#include "config/yaml.hpp"
#include "experiment/resolved.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/session.hpp"
#include "sweep/statistics.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace palpate {

namespace fs = std::filesystem;

namespace {

std::string text_at(const Row& row, const std::string& name) {
  const Scalar* value = row.find(name);
  return value != nullptr ? csv_cell(*value) : std::string();
}

}  // namespace

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

Sweep read_sweep(const fs::path& directory) {
  Sweep sweep{directory, {}, {}};
  for (const Row& row : read_json_lines(directory / "manifest.jsonl").rows) {
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
  const std::string name = fs::absolute(directory).lexically_normal().filename().string();
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

namespace {

std::string spread(std::vector<double> values, const char* format, double scale) {
  if (values.empty()) return "-";
  std::sort(values.begin(), values.end());
  const auto shown = [&](double share) { return fmt::format(fmt::runtime(format), quantile(values, share) * scale); };
  return fmt::format("{} ({}-{})", shown(0.5), shown(0.1), shown(0.9));
}

struct Group {
  std::string name;
  int runs = 0;
  int dead = 0;
  int found = 0;
  int failed = 0;
  std::vector<double> on_surface_live, on_surface_all, rmse_live;
};

}  // namespace

std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results, int initial_taps) {
  std::vector<Group> groups;
  for (const Row& row : results) {
    std::string name;
    for (const std::string& key : sweep.keys) {
      const std::string value = text_at(row, key);
      if (key == "seed" || value.empty()) continue;
      name += (name.empty() ? "" : ", ") + (sweep.keys.size() > 2 ? key + "=" : std::string()) + value;
    }
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& one) { return one.name == name; });
    if (group == groups.end()) group = groups.insert(groups.end(), Group{name, 0, 0, 0, 0, {}, {}, {}});
    ++group->runs;
    if (text_at(row, "status") != "done") {
      ++group->failed;
      continue;
    }
    const std::string hit = text_at(row, "first_hit_tap");
    const bool dead = hit.empty() || std::stoi(hit) > initial_taps;
    group->dead += dead ? 1 : 0;
    group->found += hit.empty() ? 0 : 1;
    const double on_surface = std::stod(text_at(row, "on_surface_taps"));
    group->on_surface_all.push_back(on_surface);
    if (dead) continue;
    group->on_surface_live.push_back(on_surface);
    if (const std::string error = text_at(row, "rmse_height_m"); !error.empty())
      group->rmse_live.push_back(std::stod(error));
  }
  std::size_t width = 8;
  for (const Group& group : groups) width = std::max(width, group.name.size());
  std::string out =
      fmt::format("{:<{}}  {:>5}  {:>11}  {:>7}  {:>6}  {:>22}  {:>22}  {:>18}\n", "group", width, "runs",
                  "dead starts", "found", "failed", "on-surface, live", "on-surface, all", "height cm, live");
  for (const Group& group : groups) {
    const int ended = std::max(1, group.runs - group.failed);
    out += fmt::format("{:<{}}  {:>5}  {:>10.1f}%  {:>6.1f}%  {:>6}  {:>22}  {:>22}  {:>18}\n", group.name, width,
                       group.runs, 100.0 * group.dead / ended, 100.0 * group.found / ended, group.failed,
                       spread(group.on_surface_live, "{:.0f}", 1.0), spread(group.on_surface_all, "{:.0f}", 1.0),
                       spread(group.rmse_live, "{:.1f}", 100.0));
  }
  return out + "dead start: no tap on the object among the initial ones; live: all others. Median (10 %-90 %).\n";
}

}  // namespace palpate
