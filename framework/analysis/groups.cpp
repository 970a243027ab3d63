// SPDX-License-Identifier: MIT
#include "analysis/groups.hpp"

#include "analysis/mean_output.hpp"
#include "config/tree.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>

namespace palpate {
std::vector<std::string> others(const std::vector<std::string>& names, const std::vector<std::string>& without) {
  std::vector<std::string> out;
  for (const std::string& name : names) {
    if (!is_one_of(without, name)) out.push_back(name);
  }
  return out;
}

std::string value_of(const Sweep& sweep, const Job& job, const std::string& key) {
  const auto at = std::find(sweep.keys.begin(), sweep.keys.end(), key);
  return at != sweep.keys.end() ? job.values[static_cast<std::size_t>(at - sweep.keys.begin())] : std::string();
}

std::vector<std::string> shown_values(const std::vector<std::string>& values) {
  std::vector<std::string> out;
  for (const std::string& one : values) out.push_back(one.empty() ? "(none)" : one_line(one));
  return out;
}

std::vector<JobGroup> group_jobs(const Sweep& sweep, const std::vector<Row>& results,
                                 const std::vector<std::string>& keys) {
  std::vector<const Row*> rows(sweep.jobs.size(), nullptr);
  for (const Row& row : results) rows.at(static_cast<std::size_t>(row.number("job").value())) = &row;
  std::vector<JobGroup> groups;
  std::map<std::vector<std::string>, std::size_t> found;
  for (const Job& job : sweep.jobs) {
    std::vector<std::string> values;
    for (const std::string& key : keys) values.push_back(value_of(sweep, job, key));
    const auto [at, is_new] = found.emplace(values, groups.size());
    if (is_new) groups.push_back({std::move(values), {}});
    groups[at->second].jobs.push_back({&job, rows[static_cast<std::size_t>(job.index)]});
  }
  return groups;
}

std::vector<double> values_of(const JobGroup& group, const std::string& column, const std::string& option) {
  std::vector<double> out;
  for (const JobResult& job : group.jobs) {
    const JobValue one = value_of_job(job.row, column, option);
    if (one.status == ValueStatus::counted) out.push_back(one.value);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<std::string> setting_keys(const Sweep& sweep) { return others(sweep.keys, {"seed"}); }

std::vector<std::string> varying_keys(const Sweep& sweep, const std::vector<std::string>& keys) {
  std::vector<std::string> out;
  std::copy_if(keys.begin(), keys.end(), std::back_inserter(out), [&](const std::string& key) {
    return std::any_of(sweep.jobs.begin(), sweep.jobs.end(), [&](const Job& job) {
      return value_of(sweep, job, key) != value_of(sweep, sweep.jobs.front(), key);
    });
  });
  return out;
}

std::vector<std::string> scene_keys(const Sweep& sweep) {
  std::vector<std::string> out = varying_keys(sweep, sweep.keys);
  const auto is_other = [](const std::string& key) { return key != "scene" && key.rfind("scene.", 0) != 0; };
  out.erase(std::remove_if(out.begin(), out.end(), is_other), out.end());
  return out;
}

void check_group_keys(const Sweep& sweep, const std::vector<std::string>& keys) {
  for (auto key = keys.begin(); key != keys.end(); ++key) {
    if (*key == "seed") {
      const std::vector<std::string> settings = setting_keys(sweep);
      throw Error("command line", "--by: the seed repeats a job and cannot form groups",
                  settings.empty() ? "sweep the key whose values you want to compare" : suggestion(*key, settings));
    }
    if (!is_one_of(sweep.keys, *key))
      throw Error("command line", fmt::format("--by: this sweep does not vary '{}'", *key),
                  suggestion(*key, setting_keys(sweep)));
    if (std::find(keys.begin(), key, *key) != key)
      throw Error("command line", fmt::format("--by: '{}' is named twice", *key), "name it once");
  }
}

Column find_metric(const Sweep& sweep, const std::string& name, const std::vector<std::string>& columns) {
  if (is_one_of(sweep.keys, name) && (name == "seed" || find_summary_field(name) == nullptr))
    throw Error("command line", fmt::format("--metric: '{}' is a swept key, not a result", name),
                name == "seed" ? "name a field of the summary" : "use it with --by");
  return find_column(name, columns, "--metric");
}

JobCondition::JobCondition(const Sweep& sweep, const std::vector<std::string>& columns, const WhereCondition* where)
    : sweep_(sweep), columns_(columns), where_(where), names_(columns) {
  for (const std::string& key : others(sweep.keys, columns)) names_.push_back(key);
}

bool JobCondition::keeps(const JobResult& job) const {
  if (where_ == nullptr) return true;
  const WhereCondition::Values value_in_job = [&](const std::string& name) -> std::optional<WhereCondition::Value> {
    if (is_one_of(sweep_.keys, name)) return WhereCondition::Value{value_of(sweep_, *job.job, name)};
    const std::string field = field_name(name);
    if (!is_one_of(columns_, name) && (field == name || !is_one_of(columns_, field))) return std::nullopt;
    const Scalar* value = job.row != nullptr ? result_of(*job.row, name) : nullptr;
    return WhereCondition::Value{value != nullptr ? written_in(field, *value) : std::string(), true};
  };
  return where_->holds(value_in_job, names_);
}

StatisticalUnits::StatisticalUnits(const Sweep& sweep, const std::vector<Row>& results)
    : sweep_(sweep), are_seeds_(!varying_keys(sweep, {"seed"}).empty()) {
  if (are_seeds_) return;
  for (const std::string& name : names_of(results)) {
    if (!is_one_of(sweep.keys, name) && name != "job" && name != "id" && !depends_on_machine(name))
      compared_.insert(name);
  }
}

std::string StatisticalUnits::of(const JobResult& job) const {
  if (are_seeds_) return value_of(sweep_, *job.job, "seed");
  std::string out;
  if (job.row == nullptr) return out;
  for (const auto& [name, value] : job.row->fields) {
    if (compared_.count(name) > 0) out += csv_cell(value) + ",";
  }
  return out;
}

void UnitClusters::add(const std::string& unit, double value) {
  const auto [at, is_new] = places_.emplace(unit, clusters_.size());
  if (is_new) clusters_.emplace_back();
  clusters_[at->second].push_back(value);
}

std::string key_words(const Sweep& sweep, const Job& job, const std::vector<std::string>& keys, bool with_keys) {
  std::string out;
  for (const std::string& key : keys) {
    const std::string value = value_of(sweep, job, key);
    if (value.empty()) continue;
    out += fmt::format("{}{}{}", out.empty() ? "" : ", ", with_keys ? key + "=" : std::string(), value);
  }
  return one_line(out);
}

}  // namespace palpate
