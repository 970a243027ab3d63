// SPDX-License-Identifier: MIT
#include "report/page/sweep_page.hpp"

#include "analysis/column.hpp"
#include "analysis/groups.hpp"
#include "analysis/statistics.hpp"
#include "config/quantity.hpp"
#include "config/yaml.hpp"
#include "record/build_info.hpp"
#include "record/run_directory.hpp"
#include "report/page/page.hpp"
#include "report/page/sweep_curves.hpp"
#include "sweep/read_jobs.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// A swept key: its values in the order in which they are shown, as numbers if all are of one dimension, else as in the
/// sweep, what stands for no such option first; and for each of `jobs` which of them it has.
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

/// The columns of the results that hold numbers and nothing else: one for each job, null where a job has none. One with
/// the name of a key holds what came out.
Json json_of_columns(const std::vector<Row>& results, const std::vector<JobResult>& jobs) {
  Json columns = Json::array();
  const std::vector<std::string> names = names_of(results);
  for (const std::string& name : names) {
    if (name == "job" || name == "id" || name == "seed" || name != field_name(name)) continue;
    const bool hidden = std::find(names.begin(), names.end(), kOfRun + name) != names.end();
    std::vector<CellNumber> cells;
    std::size_t near = 0;
    for (const JobResult& job : jobs) {
      const Scalar* const cell = job.row == nullptr ? nullptr
                                 : hidden           ? result_of(*job.row, name)
                                                    : job.row->find(name, near);
      cells.push_back(number_of(cell));
    }
    if (std::any_of(cells.begin(), cells.end(), [](const CellNumber& cell) { return cell.is_text; })) continue;
    if (std::none_of(cells.begin(), cells.end(), [](const CellNumber& cell) { return cell.value; })) continue;
    Json numbers;
    for (const CellNumber& cell : cells) numbers.push_back(cell.value);
    const std::string better = find_column(name, {name}, "").better_words();
    columns.push_back({{"name", name}, {"better", better}, {"numbers", numbers}});
  }
  return columns;
}

/// For each of `jobs` the number of its unit of statistics.
Json json_of_units(const Sweep& sweep, const std::vector<Row>& results, const std::vector<JobResult>& jobs) {
  const JobUnits units(sweep, results);
  std::map<std::string, std::size_t> numbers;
  std::vector<std::size_t> of_job;
  for (const JobResult& one : jobs) of_job.push_back(numbers.emplace(units.of(one), numbers.size()).first->second);
  return of_job;
}

/// Which jobs are on the page: every one of so many, along the settings one after the other, so that each has its share
/// and, where they have the same seeds, those of the same.
std::vector<bool> drawn_jobs(const Sweep& sweep, std::size_t step) {
  std::vector<bool> drawn(sweep.jobs.size(), true);
  if (step == 1) return drawn;
  std::size_t place = 0;
  for (const JobGroup& setting : group_jobs(sweep, {}, setting_keys(sweep))) {
    for (const JobResult& one : setting.jobs) drawn[static_cast<std::size_t>(one.job->index)] = place++ % step == 0;
  }
  return drawn;
}

/// What became of all jobs, where not all are on the page.
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
  std::map<std::string, std::size_t> counts_;  ///< by state
  std::vector<Failure> failures_;              ///< one a reason
  std::map<std::string, std::size_t> places_;  ///< of the reasons
};

Json json_of_job(const Job& job, const RunStatus& standing, const fs::path& directory) {
  std::error_code none;
  return {{"index", job.index},
          {"id", job.id},
          {"state", state_name(standing.state)},
          {"reason", standing.stop_reason},
          {"reported", fs::exists(directory / "report.html", none)}};
}

/// The factors of the 95 % intervals of means over 2, 3, ... jobs, as many as a setting may have.
std::vector<double> interval_factors(std::size_t jobs) {
  constexpr std::size_t kMostJobs = 2000;  // from here on it changes by less than 1 in 1000
  std::vector<double> factors;
  for (std::size_t degrees = 1; degrees < std::min(jobs, kMostJobs); ++degrees)
    factors.push_back(student_factor(degrees));
  return factors;
}

/// The fields that are worth a first look: the main error, and the others in the order of the summary.
std::vector<std::string> first_looks(const std::vector<Row>& results) {
  std::vector<std::string> names{main_error(results)};
  for (const RecordField& field : summary_fields()) {
    if (field.first_look && field.name != names.front()) names.push_back(field.name);
  }
  return names;
}

}  // namespace

std::string sweep_page(const Sweep& sweep, const OnProgress& progress, std::size_t most_jobs) {
  Json data = sweep_data(sweep, progress, most_jobs);
  if (Json curves = json_of_curves(sweep); !curves.is_null()) data["curves"] = std::move(curves);
  return make_page(palpate_asset_sweep, data, "");
}

Json sweep_data(const Sweep& sweep, const OnProgress& progress, std::size_t most_jobs) {
  const std::size_t step = (sweep.jobs.size() + most_jobs - 1) / most_jobs;
  const std::vector<bool> drawn = drawn_jobs(sweep, step);
  std::vector<Row> results;
  results.reserve(sweep.jobs.size() / step + 1);  // what is pointed at does not move
  std::vector<JobResult> shown;
  Json jobs;
  Tally tally;
  int looked_at = 0;
  read_jobs(sweep, all_jobs(sweep), read_standing, [&](std::size_t index, RunStatus now) {
    const Job& job = sweep.jobs[index];
    tally.add(job, now);
    if (drawn[index]) {
      jobs.push_back(json_of_job(job, now, job_directory(sweep, job)));
      if (now.end) results.push_back(result_row(sweep, job, std::move(now.end->summary)));
      shown.push_back({&job, now.end ? &results.back() : nullptr});
    }
    progress(++looked_at, static_cast<int>(sweep.jobs.size()));
  });
  const fs::path directory = fs::absolute(sweep.directory / "").lexically_normal().parent_path();
  Json keys = Json::array();
  for (const std::string& key : sweep.keys) keys.push_back(json_of_key(sweep, shown, key));
  Json out{{"version", kVersion},
           {"name", sweep_name(sweep)},
           {"id", directory.filename().string()},
           {"folder", (sweep.directory / "").lexically_normal().parent_path().string()},
           {"keys", keys},
           {"jobs", jobs},
           {"units", json_of_units(sweep, results, shown)},
           {"columns", json_of_columns(results, shown)},
           {"first_looks", first_looks(results)},
           {"factors", interval_factors(sweep.jobs.size())},
           {"scene_keys", scene_keys(sweep)},
           {"config", to_yaml(read_run_config(sweep.directory))}};
  if (step > 1) out["sampled"] = tally.json(sweep, step);
  return out;
}

}  // namespace palpate
