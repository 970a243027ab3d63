// SPDX-License-Identifier: MIT
#include "sweep/sweep.hpp"

#include "config/hash.hpp"
#include "config/yaml.hpp"
#include "record/json.hpp"
#include "record/run_directory.hpp"
#include "sweep/statistics.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <thread>

namespace palpate {

namespace fs = std::filesystem;

namespace {

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

std::string text_at(const Row& row, const std::string& name) {
  const Scalar* value = row.find(name);
  return value != nullptr ? csv_cell(*value) : std::string();
}

/// A job that failed before its run could begin leaves a summary all the same.
void write_failure(const fs::path& directory, const std::string& id, const std::string& reason) {
  Row row;
  row.add("id", id);
  row.add("status", "failed");
  row.add("stop_reason", reason);
  write_file(directory / "summary.json", to_json_text(row));
}

/// Whether the swept key is one of `expect:`.
bool is_expectation(const Axis& axis) { return axis.key == "expect" || axis.key.compare(0, 7, "expect.") == 0; }

}  // namespace

fs::path job_directory(const Sweep& sweep, const Job& job) { return sweep.directory / "jobs" / job.id; }

SweepPlan plan_sweep(Composer& composer, const PluginHost& host, const fs::path& file, const std::vector<Axis>& axes,
                     const fs::path& runs) {
  SweepPlan plan;
  // What is expected holds for the whole sweep: it is no axis, and it enters no id.
  std::vector<Override> expectations;
  for (const Axis& axis : axes) {
    if (!is_expectation(axis)) continue;
    if (axis.values.size() != 1) {
      throw Error(axis.values.front().place.text(), fmt::format("{}: what is expected cannot be swept", axis.key),
                  "give it one value");
    }
    expectations.push_back({axis.key, axis.values.front()});
  }
  const Tree base = composer.compose(file, expectations);
  std::vector<Axis> all;
  if (const Tree* described = base.find("sweep")) all = config_axes(*described);
  for (const Axis& axis : axes) {
    if (is_expectation(axis)) continue;
    const auto same = std::find_if(all.begin(), all.end(), [&](const Axis& one) { return one.key == axis.key; });
    if (same != all.end()) {
      *same = axis;
    } else {
      all.push_back(axis);
    }
  }
  if (all.empty()) throw Error(file.string(), "nothing to sweep", "give KEY=V1,V2 or a 'sweep:' in the config");
  Tree grid = Tree::map();
  for (const Axis& axis : all) {
    plan.sweep.keys.push_back(axis.key);
    Tree& values = grid.at(axis.key);
    values = Tree::list();
    values.items = axis.values;
  }

  std::string identity;
  std::map<std::string, int> seen;
  for (const Combination& combination : product(all)) {
    // The sweep's own record decides whether surfaces are kept: not by default.
    std::vector<Override> overrides = combination;
    overrides.insert(overrides.end(), expectations.begin(), expectations.end());
    if (base.find_path("log.surface") == nullptr) {
      Tree off = Tree::scalar("false");
      off.set_layer(kGroupLayer);
      overrides.push_back({"log.surface", off});
    }
    ResolvedConfig config = load_experiment(composer, host, file, overrides);
    Job job{static_cast<int>(plan.configs.size()), config.id, {}};
    for (const Override& one : combination) job.values.push_back(value_text(one.value));
    const auto [twin, is_new] = seen.emplace(job.id, job.index);
    if (!is_new) {
      throw Error(file.string(), fmt::format("jobs {} and {} of the sweep are the same run", twin->second, job.index),
                  "a swept key has no effect in one of them, or a value stands twice");
    }
    identity += job.id;
    plan.sweep.jobs.push_back(std::move(job));
    plan.configs.push_back(std::move(config));
  }
  for (const std::string& key : plan.sweep.keys) identity += key;
  plan.config = plan.configs.front().tree;
  plan.config.at("sweep").at("grid") = std::move(grid);
  plan.sweep.directory = runs / slug(plan.configs.front().options.name) / hash_of(identity).substr(0, 12);
  return plan;
}

void prepare_sweep(const SweepPlan& plan) {
  const fs::path& directory = plan.sweep.directory;
  if (is_sweep(directory)) {
    throw Error(directory.string(), "this sweep exists",
                "'palpate resume' carries on, 'palpate status' tells its state");
  }
  fs::create_directories(directory / "jobs");
  write_file(directory / "config.yaml", to_yaml(plan.config));
  std::string manifest;
  for (std::size_t i = 0; i < plan.configs.size(); ++i) {
    const Job& job = plan.sweep.jobs[i];
    fs::create_directory(job_directory(plan.sweep, job));
    write_file(job_directory(plan.sweep, job) / "config.yaml", to_yaml(plan.configs[i].tree));
    manifest += to_json_line(manifest_row(plan.sweep.keys, job)) + "\n";
  }
  write_file(directory / "manifest.jsonl", manifest);
}

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
  return sweep;
}

SweepReport run_sweep(const Workshop& workshop, const Sweep& sweep, const std::vector<ResolvedConfig>* configs,
                      const ResumeOptions& options, int workers,
                      const std::function<void(const SweepProgress&)>& progress) {
  const FileLock lock(sweep.directory / "lock");
  SweepReport report;
  report.counts.jobs = static_cast<int>(sweep.jobs.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  const auto work = [&] {
    for (std::size_t i = next++; i < sweep.jobs.size(); i = next++) {
      if (workshop.interrupted != nullptr && workshop.interrupted->load()) return;
      const Job& job = sweep.jobs[i];
      const fs::path directory = job_directory(sweep, job);
      std::string failure;
      bool broken_off = false;
      try {
        broken_off = (configs != nullptr ? start_run(workshop, (*configs)[i], directory, false, nullptr)
                                         : resume_run(workshop, directory, options, nullptr))
                         .interrupted;
      } catch (const Error& trouble) {
        failure = trouble.what();
        if (read_status(directory).state == RunStatus::State::absent) write_failure(directory, job.id, failure);
      }
      const std::lock_guard guard(mutex);
      if (broken_off) continue;
      ++report.counts.done;
      if (!failure.empty()) {
        ++report.counts.failed;
        report.failures.emplace_back(job, failure);
      }
      if (progress) progress(report.counts);
    }
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < workers; ++i) pool.emplace_back(work);
  work();
  for (std::thread& one : pool) one.join();
  std::sort(report.failures.begin(), report.failures.end(),
            [](const auto& a, const auto& b) { return a.first.index < b.first.index; });
  report.interrupted = workshop.interrupted != nullptr && workshop.interrupted->load();
  write_file(sweep.directory / "results.csv", to_csv(sweep_results(sweep)));
  return report;
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

std::vector<Row> sweep_results(const Sweep& sweep) {
  std::vector<Row> rows;
  const std::vector<std::optional<Row>> summaries = sweep_summaries(sweep);
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
      if (key == "seed") continue;
      name += (name.empty() ? "" : ", ") + (sweep.keys.size() > 2 ? key + "=" : std::string()) + text_at(row, key);
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
