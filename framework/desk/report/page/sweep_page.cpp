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

#include <algorithm>
#include <map>

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// A swept key: its values in the order in which they are shown, as numbers if all are of one dimension, else as in the
/// sweep, what stands for no such option first; and for each job which of them it has.
Json json_of_key(const Sweep& sweep, const std::string& key) {
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
  std::vector<std::size_t> of_job(sweep.jobs.size());
  for (std::size_t i = 0; i < groups.size(); ++i) {
    values.push_back(groups[i].values.front());
    for (const JobResult& one : groups[i].jobs) of_job[static_cast<std::size_t>(one.job->index)] = i;
  }
  return {{"name", key}, {"values", values}, {"of_job", of_job}};
}

/// The columns of the results that hold numbers and nothing else: one for each job, null where a job has none.
Json json_of_columns(const std::vector<Row>& results, const std::vector<JobResult>& jobs) {
  Json columns = Json::array();
  for (const std::string& name : columns_of(results)) {
    if (name == "job" || name == "id" || name == "seed") continue;
    std::vector<CellNumber> cells;
    for (const JobResult& job : jobs) cells.push_back(number_of(job.row != nullptr ? job.row->find(name) : nullptr));
    if (std::any_of(cells.begin(), cells.end(), [](const CellNumber& cell) { return cell.is_text; })) continue;
    if (std::none_of(cells.begin(), cells.end(), [](const CellNumber& cell) { return cell.value; })) continue;
    Json numbers;
    for (const CellNumber& cell : cells) numbers.push_back(cell.value);
    const std::string better = find_column(name, {name}, "").better_words();
    columns.push_back({{"name", name}, {"better", better}, {"numbers", numbers}});
  }
  return columns;
}

/// What became of a job: from its row, or, without one, from its directory as it is now.
RunStatus standing_of(const Row* row, const fs::path& directory) {
  if (row != nullptr)
    return {is_done(*row) ? RunStatus::State::done : RunStatus::State::failed, 0, row->text("stop_reason")};
  RunStatus out = read_ending(directory);
  // Who ended since the rows were read was running then.
  const bool ended = out.state == RunStatus::State::done || out.state == RunStatus::State::failed;
  if (ended || is_running(directory)) return {RunStatus::State::running, 0, ""};
  return out;
}

Json json_of_jobs(const Sweep& sweep, const std::vector<JobResult>& results, const OnProgress& progress) {
  Json jobs;
  for (const auto& [job, row] : results) {
    const fs::path directory = job_directory(sweep, *job);
    const RunStatus standing = standing_of(row, directory);
    std::error_code none;
    jobs.push_back({{"index", job->index},
                    {"id", job->id},
                    {"state", state_name(standing.state)},
                    {"reason", standing.stop_reason},
                    {"reported", fs::exists(directory / "report.html", none)}});
    progress(static_cast<int>(jobs.size()), static_cast<int>(results.size()));
  }
  return jobs;
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
std::vector<std::string> first_looks() {
  std::vector<std::string> names{main_error()};
  for (const RecordField& field : summary_fields()) {
    if (field.first_look && field.name != main_error()) names.push_back(field.name);
  }
  return names;
}

}  // namespace

std::string sweep_page(const Sweep& sweep, const OnProgress& progress) {
  return make_page(palpate_asset_sweep, sweep_data(sweep, progress), "");
}

Json sweep_data(const Sweep& sweep, const OnProgress& progress) {
  const std::vector<Row> results = sweep_results(sweep);
  const std::vector<JobResult> jobs = group_jobs(sweep, results, {}).front().jobs;
  const fs::path directory = fs::absolute(sweep.directory / "").lexically_normal().parent_path();
  Json keys = Json::array();
  for (const std::string& key : sweep.keys) keys.push_back(json_of_key(sweep, key));
  return {{"version", kVersion},
          {"name", sweep_name(sweep)},
          {"id", directory.filename().string()},
          {"folder", (sweep.directory / "").lexically_normal().parent_path().string()},
          {"keys", keys},
          {"jobs", json_of_jobs(sweep, jobs, progress)},
          {"columns", json_of_columns(results, jobs)},
          {"first_looks", first_looks()},
          {"factors", interval_factors(sweep.jobs.size())},
          {"config", to_yaml(read_run_config(sweep.directory))}};
}

}  // namespace palpate
