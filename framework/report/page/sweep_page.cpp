// SPDX-License-Identifier: MIT
#include "report/page/sweep_page.hpp"

#include "analysis/column.hpp"
#include "analysis/compare_plan.hpp"
#include "analysis/groups.hpp"
#include "analysis/importance.hpp"
#include "analysis/pareto.hpp"
#include "config/catch_error.hpp"
#include "config/quantity.hpp"
#include "config/yaml.hpp"
#include "record/build_info.hpp"
#include "record/run_directory.hpp"
#include "report/page/page.hpp"
#include "report/page/sweep_curves.hpp"
#include "report/page/sweep_race.hpp"
#include "sweep/read_jobs.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// Returns a swept key, its values, and for each job the index of its value. Values are sorted if all of them are
/// numbers with the same unit; otherwise they keep the order of the sweep. The value "" of jobs without this option
/// comes first.
Json json_of_key(const Sweep& sweep, const std::vector<JobResult>& jobs, const std::string& key) {
  std::vector<JobGroup> groups = group_jobs(sweep, {}, {key});
  std::map<std::string, double> numbers;
  std::optional<Unit> unit;
  bool comparable = true;
  for (const JobGroup& group : groups) {
    const std::string& value = group.values.front();
    if (value.empty()) continue;
    const std::optional<AnyQuantity> number = any_quantity(value);
    comparable = comparable && number && (!unit || *unit == number->unit);
    if (!comparable) break;
    unit = number->unit;
    numbers[value] = number->value;
  }
  std::stable_sort(groups.begin(), groups.end(), [&](const JobGroup& a, const JobGroup& b) {
    const std::string& first = a.values.front();
    const std::string& second = b.values.front();
    if (first.empty() || second.empty()) return first.empty() && !second.empty();
    return comparable && numbers.at(first) < numbers.at(second);
  });
  Json values;
  std::vector<std::size_t> of_all(sweep.jobs.size());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    values.push_back(groups[i].values.front());
    for (const JobResult& one : groups[i].jobs) of_all[static_cast<std::size_t>(one.job->index)] = i;
  }
  std::vector<std::size_t> of_job;
  for (const JobResult& one : jobs) of_job.push_back(of_all[static_cast<std::size_t>(one.job->index)]);
  return {{"name", key}, {"values", values}, {"of_job", of_job}};
}

/// A column of results.csv as numbers, one per job on the page.
struct NumberColumn {
  Column column;
  std::vector<std::optional<double>> numbers;
};

/// Returns the columns of the results that hold only numbers. If a key and a result have the same name, the column
/// holds the result.
std::vector<NumberColumn> number_columns(const std::vector<Row>& results, const std::vector<JobResult>& jobs) {
  std::vector<NumberColumn> columns;
  const std::vector<std::string> names = names_of(results);
  for (const std::string& name : names) {
    if (name == "job" || name == "id" || name == "seed" || name != field_name(name)) continue;
    const bool hidden = std::find(names.begin(), names.end(), kOfRun + name) != names.end();
    NumberColumn column{find_column(name, {name}, ""), {}};
    bool any = false;
    bool is_text = false;
    std::size_t near = 0;
    for (const JobResult& job : jobs) {
      const Scalar* const cell = job.row == nullptr ? nullptr
                                 : hidden           ? result_of(*job.row, name)
                                                    : job.row->find(name, near);
      const CellNumber number = number_of(cell);
      any = any || number.value;
      is_text = is_text || number.is_text;
      column.numbers.push_back(number.value);
    }
    if (any && !is_text) columns.push_back(std::move(column));
  }
  return columns;
}

Json json_of_column(const NumberColumn& one) {
  return {{"name", one.column.name},
          {"better", one.column.better_words()},
          {"numbers", one.numbers},
          {"is_cost", can_be_cost(one.column)},
          {"is_error", can_be_error(one.column)}};
}

/// Numbers the units of statistics (StatisticalUnits) from 0. Returns for each job the number of its unit.
std::vector<std::size_t> unit_numbers(const Sweep& sweep, const std::vector<Row>& results,
                                      const std::vector<JobResult>& jobs) {
  const StatisticalUnits units(sweep, results);
  std::map<std::string, std::size_t> numbers;
  std::vector<std::size_t> of_job;
  for (const JobResult& one : jobs) of_job.push_back(numbers.emplace(units.of(one), numbers.size()).first->second);
  return of_job;
}

/// The jobs on a page that differ only in the seed.
struct PageSetting {
  std::vector<std::size_t> jobs;  ///< indices of the jobs
  std::size_t scene = 0;
};

std::vector<PageSetting> settings_of(const Sweep& sweep, const std::vector<JobResult>& jobs) {
  const std::vector<std::string> scenes = scene_keys(sweep);
  std::map<int, std::size_t> places;  // index of each job in `jobs`, by the index of the job in the sweep
  for (std::size_t i = 0; i < jobs.size(); ++i) places[jobs[i].job->index] = i;
  std::map<std::string, std::size_t> known;
  std::vector<PageSetting> out;
  for (const JobGroup& group : group_jobs(sweep, {}, setting_keys(sweep))) {
    const std::string scene = key_words(sweep, *group.jobs.front().job, scenes, true);
    PageSetting setting{{}, known.emplace(scene, known.size()).first->second};
    for (const JobResult& one : group.jobs) {
      if (const auto found = places.find(one.job->index); found != places.end()) setting.jobs.push_back(found->second);
    }
    if (!setting.jobs.empty()) out.push_back(std::move(setting));
  }
  return out;
}

/// Means of a column over the done jobs of each setting.
using Estimates = std::vector<MeanEstimate>;

Estimates estimate_settings(const std::vector<PageSetting>& settings, const std::vector<JobResult>& jobs,
                            const NumberColumn& column, const std::vector<std::size_t>& units) {
  Estimates out;
  for (const PageSetting& setting : settings) {
    UnitClusters clusters;
    for (const std::size_t job : setting.jobs) {
      if (jobs[job].row != nullptr && is_done(*jobs[job].row) && column.numbers[job])
        clusters.add(std::to_string(units[job]), *column.numbers[job]);
    }
    out.push_back(estimate_mean(clusters.clusters()));
  }
  return out;
}

/// Returns the mean of each setting, half the width of its 95 % interval, and the numbers of values and of clusters.
Json json_of_estimates(const Estimates& estimates) {
  Json out = Json::array();
  for (const auto& [count, clusters, mean, ends] : estimates)
    out.push_back(
        {count > 0 ? Json(mean) : Json(), ends ? Json((ends->high - ends->low) / 2.0) : Json(), count, clusters});
  return out;
}

/// Returns the settings on the Pareto fronts of all pairs of cost and error, sorted by scene and cost: {cost: {error:
/// [settings]}}.
Json json_of_fronts(const std::vector<PageSetting>& settings, const std::vector<NumberColumn>& columns,
                    const std::vector<Estimates>& estimates) {
  Json out = Json::object();
  std::vector<std::size_t> by_cost(settings.size());
  std::iota(by_cost.begin(), by_cost.end(), std::size_t{0});
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (!can_be_cost(columns[c].column)) continue;
    const Estimates& cost = estimates[c];
    std::sort(by_cost.begin(), by_cost.end(), [&](std::size_t a, std::size_t b) {
      return std::tuple(settings[a].scene, cost[a].mean, a) < std::tuple(settings[b].scene, cost[b].mean, b);
    });
    for (std::size_t e = 0; e < columns.size(); ++e) {
      if (!can_be_error(columns[e].column)) continue;
      const double sign = columns[e].column.better == RecordField::Better::more ? -1.0 : 1.0;
      std::vector<FrontPoint> complete;
      for (const std::size_t i : by_cost) {
        if (std::min(cost[i].count, estimates[e][i].count) == settings[i].jobs.size())
          complete.push_back({i, settings[i].scene, cost[i].mean, sign * estimates[e][i].mean});
      }
      out[columns[c].column.name][columns[e].column.name] = front_of(complete);
    }
  }
  return out;
}

/// Returns for each job whether it is on the page: every `step`-th job, in a list of all jobs sorted by setting. Every
/// setting therefore has about the same share of its jobs on the page.
std::vector<bool> drawn_jobs(const Sweep& sweep, std::size_t step) {
  std::vector<bool> drawn(sweep.jobs.size(), true);
  if (step == 1) return drawn;
  std::size_t place = 0;
  for (const JobGroup& setting : group_jobs(sweep, {}, setting_keys(sweep))) {
    for (const JobResult& one : setting.jobs) drawn[static_cast<std::size_t>(one.job->index)] = place++ % step == 0;
  }
  return drawn;
}

/// Counts all jobs by their state, and failures by their reason.
class Tally {
 public:
  void add(const Job& job, const RunStatus& standing) {
    ++counts_[state_name(standing.state)];
    if (standing.state != RunStatus::State::failed) return;
    const auto [at, is_new] = places_.emplace(standing.stop_reason, failures_.size());
    if (is_new) failures_.push_back({&job, standing.stop_reason, 0});
    ++failures_[at->second].jobs;
  }

  Json json(const Sweep& sweep, std::size_t step) const {
    constexpr std::size_t kMostReasons = 12;
    const std::vector<std::string> keys = varying_keys(sweep, sweep.keys);
    Json failures = Json::array();
    for (const Failure& one : failures_) {
      if (failures.size() == kMostReasons) break;
      failures.push_back({{"reason", one.reason},
                          {"jobs", one.jobs},
                          {"first", one.first->index},
                          {"words", key_words(sweep, *one.first, keys, true)}});
    }
    return {{"jobs", sweep.jobs.size()},
            {"step", step},
            {"counts", counts_},
            {"failures", failures},
            {"reasons", failures_.size()}};
  }

 private:
  struct Failure {
    const Job* first;
    std::string reason;
    std::size_t jobs;
  };
  std::map<std::string, std::size_t> counts_;  ///< numbers of jobs by state
  std::vector<Failure> failures_;              ///< one entry per reason
  std::map<std::string, std::size_t> places_;  ///< indices in `failures_` by reason
};

Json json_of_job(const Job& job, const RunStatus& standing, const fs::path& directory) {
  std::error_code none;
  return {{"index", job.index},
          {"id", job.id},
          {"state", state_name(standing.state)},
          {"reason", standing.stop_reason},
          {"reported", fs::exists(directory / "report.html", none)}};
}

/// The jobs on a page, and the counts of all jobs.
struct PageJobs {
  std::vector<Row> results;  ///< rows of the jobs that have ended
  std::vector<JobResult> jobs;
  Json described;
  Tally tally;
};

/// Reads all jobs and keeps the drawn_jobs().
PageJobs read_page_jobs(const Sweep& sweep, std::size_t step, const OnProgress& progress) {
  const std::vector<bool> drawn = drawn_jobs(sweep, step);
  PageJobs out;
  out.results.reserve(sweep.jobs.size() / step + 1);  // The elements must not move, because `jobs` points to them.
  int looked_at = 0;
  read_jobs(sweep, all_jobs(sweep), read_standing, [&](std::size_t index, RunStatus now) {
    const Job& job = sweep.jobs[index];
    out.tally.add(job, now);
    if (drawn[index]) {
      out.described.push_back(json_of_job(job, now, job_directory(sweep, job)));
      if (now.end) out.results.push_back(result_row(sweep, job, std::move(now.end->summary)));
      out.jobs.push_back({&job, now.end ? &out.results.back() : nullptr});
    }
    progress(++looked_at, static_cast<int>(sweep.jobs.size()));
  });
  return out;
}

/// Returns a sentence that states whether a comparison was planned before the first run.
std::string planned_sentence(const Sweep& sweep) {
  const std::optional<ComparePlan> plan = recorded_plan({sweep.directory});
  if (!plan) return "No comparison was planned before the first run: comparisons on this page were chosen afterwards.";
  return "Planned before the first run (plan " + plan->hash + "): " + plan->words() +
         ". Other comparisons on this page were chosen afterwards.";
}

/// Returns how much each swept key matters for `metric`, as text. Returns "" if this cannot be computed, or if there
/// are so many settings that it would take seconds.
std::string importance_text(const Sweep& sweep, const std::vector<Row>& results, const std::string& metric) {
  constexpr std::size_t kMostSettings = 300;
  std::string out;
  if (group_jobs(sweep, {}, setting_keys(sweep)).size() <= kMostSettings)
    catch_error([&] { out = compute_importance(sweep, results, metric).text; });
  return out;
}

/// Adds to `data` the columns, each with its mean per setting, and the Pareto fronts.
void add_columns(Json& data, const Sweep& sweep, const std::vector<JobResult>& jobs,
                 const std::vector<NumberColumn>& columns, const std::vector<std::size_t>& units) {
  const std::vector<PageSetting> settings = settings_of(sweep, jobs);
  data["setting_jobs"] = Json::array();
  for (const PageSetting& one : settings) data["setting_jobs"].push_back(one.jobs);
  data["columns"] = Json::array();
  std::vector<Estimates> estimates;
  for (const NumberColumn& one : columns) {
    estimates.push_back(estimate_settings(settings, jobs, one, units));
    data["columns"].push_back(json_of_column(one));
    // If each setting has one job, the mean is the value of the job.
    if (settings.size() < jobs.size()) data["columns"].back()["estimates"] = json_of_estimates(estimates.back());
  }
  data["fronts"] = json_of_fronts(settings, columns, estimates);
}

}  // namespace

std::vector<std::string> headline_fields(const std::vector<Row>& results) {
  std::vector<std::string> names{main_error(results)};
  for (const RecordField& field : summary_fields()) {
    if (field.first_look && field.name != names.front()) names.push_back(field.name);
  }
  return names;
}

std::string sweep_page(const Sweep& sweep, const OnProgress& progress, std::size_t most_jobs) {
  Json data = sweep_data(sweep, progress, most_jobs);
  if (Json curves = json_of_curves(sweep); !curves.is_null()) data["curves"] = std::move(curves);
  return make_page(palpate_asset_sweep, data, "");
}

Json sweep_data(const Sweep& sweep, const OnProgress& progress, std::size_t most_jobs) {
  const std::size_t step = (sweep.jobs.size() + most_jobs - 1) / most_jobs;
  const PageJobs page = read_page_jobs(sweep, step, progress);
  const std::vector<NumberColumn> columns = number_columns(page.results, page.jobs);
  const std::vector<std::size_t> units = unit_numbers(sweep, page.results, page.jobs);
  const fs::path directory = fs::absolute(sweep.directory / "").lexically_normal().parent_path();
  Json keys = Json::array();
  for (const std::string& key : sweep.keys) keys.push_back(json_of_key(sweep, page.jobs, key));
  Json out{{"version", kVersion},
           {"name", sweep_name(sweep)},
           {"id", directory.filename().string()},
           {"folder", (sweep.directory / "").lexically_normal().parent_path().string()},
           {"keys", keys},
           {"jobs", page.described},
           {"units_of_jobs", units},
           {"units", display_units(names_of(page.results))},
           {"first_looks", headline_fields(page.results)},
           {"scene_keys", scene_keys(sweep)},
           {"tally", page.tally.json(sweep, step)},
           {"config", to_yaml(read_run_config(sweep.directory))}};
  if (Json race = json_of_race(sweep); !race.is_null()) out["race"] = std::move(race);
  if (sweep.rounds.empty()) out["planned"] = planned_sentence(sweep);
  const std::string metric = out.contains("race") ? out["race"]["metric"].get<std::string>() : main_error(page.results);
  out["importance"] = importance_text(sweep, page.results, metric);
  add_columns(out, sweep, page.jobs, columns, units);
  return out;
}

}  // namespace palpate
