// SPDX-License-Identifier: MIT
#include "report/page/sweep_page.hpp"

#include "analysis/column.hpp"
#include "analysis/groups.hpp"
#include "analysis/statistics.hpp"
#include "config/quantity.hpp"
#include "config/yaml.hpp"
#include "record/build_info.hpp"
#include "record/run_directory.hpp"
#include "report/page/assets.hpp"
#include "report/page/json_text.hpp"
#include "report/page/page.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <map>

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// A swept key: its values in the order of the sweep, where they stand as numbers if all are of one dimension, and for
/// each job which of them it has.
std::string json_of_key(const Sweep& sweep, std::size_t key) {
  std::vector<std::string> values;
  std::map<std::string, std::size_t> found;
  std::vector<std::size_t> of_job;
  for (const Job& job : sweep.jobs) {
    const auto [at, is_new] = found.emplace(job.values[key], values.size());
    if (is_new) values.push_back(job.values[key]);
    of_job.push_back(at->second);
  }
  std::vector<std::string> numbers;
  std::optional<Unit> unit;
  bool all = true;
  for (const std::string& value : values) {
    const std::optional<AnyQuantity> number = any_quantity(value);
    numbers.push_back(number ? json_value(number->value) : "null");
    if (value.empty()) continue;  // where the plugin has no such option
    all = all && number && (!unit || *unit == number->unit);
    if (number) unit = number->unit;
  }
  return json_object({{"name", json_quoted(sweep.keys[key])},
                      {"values", json_texts(values)},
                      {"numbers", all && unit ? json_list(numbers) : "null"},
                      {"of_job", json_list_of(of_job, [](std::size_t value) { return std::to_string(value); })}});
}

/// A column of the results with a number for each job, null where a job has none; none for columns without numbers.
std::optional<std::string> json_of_column(const std::string& name, const std::vector<const Row*>& rows) {
  std::vector<std::string> numbers;
  bool any = false;
  for (const Row* row : rows) {
    const CellNumber number = number_of(row != nullptr ? row->find(name) : nullptr);
    if (number.is_text) return {};
    any = any || number.value;
    numbers.push_back(number.value ? json_value(*number.value) : "null");
  }
  if (!any) return {};
  const Column column = find_column(name, {name}, "");
  return json_object(
      {{"name", json_quoted(name)}, {"better", json_quoted(column.better_words())}, {"numbers", json_list(numbers)}});
}

std::string json_of_columns(const std::vector<Row>& results, const std::vector<const Row*>& rows) {
  std::vector<std::string> columns;
  for (const std::string& name : columns_of(results)) {
    if (name == "job" || name == "id" || name == "seed") continue;
    if (const std::optional<std::string> column = json_of_column(name, rows)) columns.push_back(*column);
  }
  return json_list(columns);
}

/// What became of a job: from its row, or, without one, from its directory as it is now.
RunStatus standing_of(const Row* row, const fs::path& directory) {
  RunStatus out;
  if (row != nullptr) {
    out.state = is_done(*row) ? RunStatus::State::done : RunStatus::State::failed;
    out.stop_reason = row->text("stop_reason");
    return out;
  }
  out = read_ending(directory);
  // Who ended since the rows were read was running then.
  const bool ended = out.state == RunStatus::State::done || out.state == RunStatus::State::failed;
  if (ended || is_running(directory)) return {RunStatus::State::running, 0, ""};
  return out;
}

std::string json_of_jobs(const Sweep& sweep, const std::vector<const Row*>& rows, const OnProgress& progress) {
  std::vector<std::string> jobs;
  for (const Job& job : sweep.jobs) {
    const fs::path directory = job_directory(sweep, job);
    const RunStatus standing = standing_of(rows[static_cast<std::size_t>(job.index)], directory);
    std::error_code none;
    const bool reported = fs::exists(directory / "report.html", none);
    jobs.push_back(json_list({json_quoted(job.id), json_quoted(state_name(standing.state)),
                              json_quoted(standing.stop_reason), reported ? "1" : "0"}));
    progress(static_cast<int>(jobs.size()), static_cast<int>(sweep.jobs.size()));
  }
  return json_list(jobs);
}

/// The factors of the 95 % intervals of means over 2, 3, ... jobs, as many as a setting may have.
std::string json_of_factors(std::size_t jobs) {
  constexpr std::size_t kMostJobs = 2000;  // from here on it changes by less than 1 in 1000
  std::vector<std::string> factors;
  for (std::size_t degrees = 1; degrees < std::min(jobs, kMostJobs); ++degrees)
    factors.push_back(json_value(student_factor(degrees)));
  return json_list(factors);
}

/// The fields that are worth a first look: the main error, and the others in the order of the summary.
std::vector<std::string> first_looks() {
  std::vector<std::string> names{main_error()};
  for (const RecordField& field : summary_fields()) {
    if (field.first_look && field.name != main_error()) names.push_back(field.name);
  }
  return names;
}

std::string id_of(const Sweep& sweep) {
  return fs::absolute(sweep.directory / "").lexically_normal().parent_path().filename().string();
}

}  // namespace

std::string sweep_page(const Sweep& sweep, const OnProgress& progress) {
  const std::vector<Row> results = sweep_results(sweep);
  std::vector<const Row*> rows;  // of each job
  const std::vector<JobGroup> all = group_jobs(sweep, results, {});
  for (const JobResult& job : all.front().jobs) rows.push_back(job.row);
  const Tree config = read_run_config(sweep.directory);
  std::vector<std::string> keys;
  for (std::size_t key = 0; key < sweep.keys.size(); ++key) keys.push_back(json_of_key(sweep, key));
  const std::vector<std::pair<std::string, std::string>> data{{"version", json_quoted(kVersion)},
                                                              {"name", json_quoted(sweep_name(sweep))},
                                                              {"id", json_quoted(id_of(sweep))},
                                                              {"keys", json_list(keys)},
                                                              {"jobs", json_of_jobs(sweep, rows, progress)},
                                                              {"columns", json_of_columns(results, rows)},
                                                              {"first_looks", json_texts(first_looks())},
                                                              {"factors", json_of_factors(sweep.jobs.size())},
                                                              {"config", json_quoted(to_yaml(config))}};
  return make_page(sweep_script(), json_object(data), "");
}

}  // namespace palpate
