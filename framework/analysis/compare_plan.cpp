// SPDX-License-Identifier: MIT
#include "analysis/compare_plan.hpp"

#include "analysis/groups.hpp"
#include "analysis/mean_output.hpp"
#include "config/catch_error.hpp"
#include "config/hash.hpp"
#include "config/quantity.hpp"
#include "record/resolved_config.hpp"
#include "record/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

namespace palpate {
namespace {

[[noreturn]] void reject(const Tree& at, const std::string& reason, const std::string& hint) {
  throw Error(at.place.text(), "compare" + reason, hint);
}

/// Calls `check`, whose errors name options of `palpate compare`. Throws its error with the location of `value` and
/// with the key of the block.
template <class Check>
void check_value(const Tree& value, const Check& check) {
  const std::optional<Error> trouble = catch_error(check);
  if (!trouble) return;
  reject(value, "." + trouble->reason().substr(std::string("--").size()), trouble->hint());
}

/// Returns the names of all results of a run, or only of the numbers that can be compared.
std::vector<std::string> result_names(bool only_comparable) {
  std::vector<std::string> out;
  for (const RecordField& one : summary_fields()) {
    if (!only_comparable || (one.type != RecordField::Type::text && one.name != "seed")) out.push_back(one.name);
  }
  return out;
}

/// Returns the texts of a name, or of a list of names.
std::vector<std::string> names_in(const Tree& value) {
  std::vector<std::string> out;
  for_all(value, [&](const Tree& one) { one.is_scalar() ? out.push_back(one.text) : void(); });
  return out;
}

}  // namespace

ComparePlan::ComparePlan(const Tree& block) : written(block) {
  static const std::vector<std::string> names{"metric", "by", "seeds", "baseline", "where", "difference"};
  constexpr const char* kExample = "write compare: {metric: rmse_m, by: acquisition, seeds: 40}";
  if (!block.is_map()) reject(block, ": expects a map", kExample);
  for (const Tree::Entry& entry : block.entries) check_option(entry.key, entry.place, names, "compare");
  for (const char* key : {"metric", "by", "seeds"}) {
    if (block.find(key) == nullptr) reject(block, fmt::format(": '{}' is missing", key), kExample);
  }
  const Tree& columns = *block.find("metric");
  metrics = names_in(columns);
  if (metrics.empty()) reject(columns, ".metric: is empty", kExample);
  for (const std::string& one : metrics)
    check_value(columns, [&] { find_column(one, result_names(true), "--metric"); });
  by = names_in(*block.find("by"));
  if (const Tree* group = block.find("baseline")) baseline = group->text;
  if (const Tree* condition = block.find("where")) WhereCondition{*condition}, where = condition->text;
  seeds = static_cast<std::size_t>(std::max<std::int64_t>(0, read_integer(*block.find("seeds"), "compare.seeds")));
  if (const Tree* least = block.find("difference")) {
    difference = read_quantity(*least, "compare.difference", unit_of_column(field_name(metrics.front())));
    if (!(*difference > 0.0)) reject(*least, ".difference: is not above 0", "leave it out, or write for example 1 mm");
  }
  hash = hash_of(block.canonical()).substr(0, kIdLength);
}

void ComparePlan::check(const Sweep& sweep) const {
  check_value(*written.find("by"), [&] { check_group_keys(sweep, by); });
  const std::vector<JobGroup> groups = group_jobs(sweep, {}, by);
  if (groups.size() < 2) reject(*written.find("by"), ".by: the sweep has only one group", "sweep several values");
  if (baseline) check_value(*written.find("baseline"), [&] { check_baseline(sweep, by, *baseline); });
  if (where) {
    const WhereCondition condition(*written.find("where"));
    const std::vector<std::string> fields = result_names(false);
    const JobCondition known(sweep, fields, &condition);
    for (const JobGroup& group : groups) known.keeps(group.jobs.front());
  }
  for (const JobGroup& group : groups) {
    std::set<std::string> found;
    for (const JobResult& one : group.jobs) found.insert(value_of(sweep, *one.job, "seed"));
    if (found.size() > 1 && found.size() == seeds) continue;
    const std::string name = fmt::format("{}", fmt::join(shown_values(group.values), ", "));
    reject(*written.find("seeds"), fmt::format(".seeds: group '{}' has {} seeds, not {}", name, found.size(), seeds),
           "sweep the planned number of seeds, change the plan, or remove it by compare=none");
  }
}

std::string ComparePlan::words() const {
  std::string out = fmt::format("{} by {}{}{}, {} seeds", metrics.front(), fmt::join(by, ", "),
                                where ? " where " + *where : "", baseline ? ", baseline " + *baseline : "", seeds);
  if (difference) out += fmt::format(", differences from {} matter", written.find("difference")->text);
  if (metrics.size() > 1) out += fmt::format(", secondary {}", fmt::join(metrics.begin() + 1, metrics.end(), ", "));
  return one_line(out);
}

std::optional<ComparePlan> plan_in(const Tree& config) {
  const Tree* block = config.find("compare");
  return block != nullptr && block->text != "none" ? std::optional<ComparePlan>(*block) : std::nullopt;
}

std::optional<ComparePlan> recorded_plan(const std::vector<std::filesystem::path>& records) {
  std::optional<ComparePlan> out;
  for (const std::filesystem::path& one : records) {
    std::optional<ComparePlan> plan = is_sweep(one) ? plan_in(read_run_config(one)) : std::nullopt;
    if (!plan || (out && out->hash != plan->hash)) return std::nullopt;
    out = std::move(plan);
  }
  return out;
}

std::string mark_planned(std::vector<Comparison>& comparisons, const std::optional<ComparePlan>& plan,
                         bool is_planned) {
  if (!plan) return "chosen afterwards";
  for (Comparison& one : comparisons) one.plan = plan->hash, one.planned = is_planned;
  if (!is_planned) return fmt::format("chosen afterwards: the plan {} is another comparison", plan->hash);
  comparisons.front().difference = plan->difference;
  std::string out = fmt::format("planned before the first run (plan {}): {}", plan->hash, plan->words());
  std::size_t least = SIZE_MAX;
  for (const ComparedGroup& group : comparisons.front().groups) {
    if (!group.counts.all_are(ValueStatus::left_out)) least = std::min(least, group.mean.clusters);
  }
  if (least != plan->seeds)
    out +=
        fmt::format("; {}{} seeds {}have values", least, least < plan->seeds ? fmt::format(" of {}", plan->seeds) : "",
                    plan->where ? "satisfy the condition and " : "");
  return out;
}

}  // namespace palpate
