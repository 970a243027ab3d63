// SPDX-License-Identifier: MIT
#include "analysis/groups.hpp"

#include "analysis/column.hpp"
#include "analysis/readable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace palpate {

std::string value_of(const Sweep& sweep, const Job& job, const std::string& key) {
  const auto at = std::find(sweep.keys.begin(), sweep.keys.end(), key);
  return at != sweep.keys.end() ? job.values[static_cast<std::size_t>(at - sweep.keys.begin())] : std::string();
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
    if (one.fate == Fate::counted) out.push_back(one.value);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<std::string> setting_keys(const Sweep& sweep) {
  std::vector<std::string> out = sweep.keys;
  out.erase(std::remove(out.begin(), out.end(), "seed"), out.end());
  return out;
}

std::vector<std::string> varying_keys(const Sweep& sweep, const std::vector<std::string>& keys) {
  std::vector<std::string> out;
  std::copy_if(keys.begin(), keys.end(), std::back_inserter(out), [&](const std::string& key) {
    return std::any_of(sweep.jobs.begin(), sweep.jobs.end(), [&](const Job& job) {
      return value_of(sweep, job, key) != value_of(sweep, sweep.jobs.front(), key);
    });
  });
  return out;
}

JobUnits::JobUnits(const Sweep& sweep, const std::vector<Row>& results)
    : sweep_(sweep), are_seeds_(!varying_keys(sweep, {"seed"}).empty()) {
  if (are_seeds_) return;
  for (const std::string& name : columns_of(results)) {
    const bool is_key = std::find(sweep.keys.begin(), sweep.keys.end(), name) != sweep.keys.end();
    if (!is_key && name != "job" && name != "id" && !depends_on_machine(name)) compared_.insert(name);
  }
}

std::string JobUnits::of(const JobResult& job) const {
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
