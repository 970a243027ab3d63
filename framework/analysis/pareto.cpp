// SPDX-License-Identifier: MIT
#include "analysis/pareto.hpp"

#include "analysis/groups.hpp"
#include "config/comparison.hpp"
#include "config/quantity.hpp"
#include "config/yaml.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

namespace palpate {
namespace {

Column make_key(const std::string& name, const std::vector<std::string>& columns, const char* option) {
  Column column = find_column(name, columns, option);
  if (!can_be_error(column))
    throw Error("command line", fmt::format("{}: {} is best at 0.95, not at its least or greatest value", option, name),
                "use nlpd, which rates heights and intervals together");
  return column;
}

/// Counts the jobs of a setting and computes its means.
Setting make_setting(const JobGroup& group, const StatisticalUnits& units, const JobCondition& where,
                     const Pareto& pareto) {
  Setting out;
  out.values = group.values;
  out.first_job = static_cast<std::size_t>(group.jobs.front().job->index);
  UnitClusters costs;
  UnitClusters errors;
  for (const JobResult& one : group.jobs) {
    if (!where.keeps(one)) continue;
    const JobValue paid = value_of_job(one.row, pareto.cost.name, "--cost");
    const JobValue missed = value_of_job(one.row, pareto.error.name, "--error");
    const ValueStatus status = std::min(paid.status, missed.status);
    out.counts.add(status);
    if (status != ValueStatus::counted) continue;
    const std::string unit = units.of(one);
    costs.add(unit, paid.value);
    errors.add(unit, missed.value);
  }
  out.cost = estimate_mean(costs.clusters());
  out.error = estimate_mean(errors.clusters());
  return out;
}

/// Returns the value as a loss, of which less is better. The loss is the negative value if more is better.
double loss(const Pareto& pareto, double value) { return pareto.more_is_better() ? -value : value; }

/// Returns the loss at the worse end of the setting's interval.
double cautious_loss(const Pareto& pareto, const Setting& setting) {
  return loss(pareto, pareto.more_is_better() ? setting.error.interval->low : setting.error.interval->high);
}

/// Sorts the settings by scene, cost and loss. Settings without a value come last.
void sort_settings(Pareto& pareto) {
  std::stable_sort(pareto.settings.begin(), pareto.settings.end(), [&](const Setting& a, const Setting& b) {
    if (a.scene != b.scene) return a.scene < b.scene;
    const bool has_a = a.cost.count > 0;
    const bool has_b = b.cost.count > 0;
    if (!has_a || !has_b) return has_a && !has_b;
    if (a.cost.mean != b.cost.mean) return a.cost.mean < b.cost.mean;
    return loss(pareto, a.error.mean) < loss(pareto, b.error.mean);
  });
}

/// Numbers the settings on the front of each scene from 1. The settings must be sorted by scene and cost.
void number_front(Pareto& pareto) {
  std::vector<FrontPoint> points;
  for (std::size_t i = 0; i < pareto.settings.size(); ++i) {
    const Setting& one = pareto.settings[i];
    if (one.complete()) points.push_back({i, one.scene, one.cost.mean, loss(pareto, one.error.mean)});
  }
  const Setting* last = nullptr;
  for (const std::size_t i : front_of(points)) {
    Setting& one = pareto.settings[i];
    one.front = last != nullptr && last->scene == one.scene ? last->front + 1 : 1;
    last = &one;
  }
}

}  // namespace

Pareto make_pareto(const Sweep& sweep, const std::vector<Row>& results, const std::string& cost,
                   const std::string& error, const WhereCondition* where) {
  if (results.empty())
    throw Error(sweep.directory.string(), "no job of this sweep has ended", "run it with 'palpate resume'");
  Pareto pareto;
  const std::vector<std::string> columns = names_of(results);
  pareto.cost = make_key(cost, columns, "--cost");
  pareto.error = make_key(error, columns, "--error");
  if (!can_be_cost(pareto.cost))
    throw Error("command line", fmt::format("--cost: more of {} is better, so it is not a cost", cost),
                "use it with --error");
  pareto.keys = setting_keys(sweep);
  const StatisticalUnits units(sweep, results);
  pareto.by_seed = units.are_seeds();
  const JobCondition condition(sweep, columns, where);
  const std::vector<std::string> scenes = scene_keys(sweep);
  const std::vector<std::string> differing = varying_keys(sweep, pareto.keys);
  for (const JobGroup& group : group_jobs(sweep, results, pareto.keys)) {
    Setting setting = make_setting(group, units, condition, pareto);
    if (setting.counts.all() == 0) continue;
    const std::string scene = key_words(sweep, *group.jobs.front().job, scenes, true);
    const auto place = std::find(pareto.scenes.begin(), pareto.scenes.end(), scene);
    setting.scene = static_cast<std::size_t>(place - pareto.scenes.begin());
    if (place == pareto.scenes.end()) pareto.scenes.push_back(scene);
    setting.name = key_words(sweep, *group.jobs.front().job, differing, true);
    if (setting.name.empty()) setting.name = "the only setting";
    pareto.jobs += setting.counts.all();
    pareto.unfinished += setting.counts.of(ValueStatus::unfinished);
    pareto.settings.push_back(std::move(setting));
  }
  if (pareto.settings.empty())
    throw Error("command line", fmt::format("--where: matches none of the {} jobs", sweep.jobs.size()),
                "check the values in results.csv");
  sort_settings(pareto);
  number_front(pareto);
  return pareto;
}

std::vector<std::size_t> front_of(const std::vector<FrontPoint>& points) {
  std::vector<std::size_t> out;
  const FrontPoint* last = nullptr;  // best point on the front among the points with lower cost
  for (auto begin = points.begin(), end = begin; begin != points.end(); begin = end) {
    end = std::find_if(begin, points.end(), [&](const FrontPoint& one) {
      return std::tie(one.scene, one.cost) != std::tie(begin->scene, begin->cost);
    });
    const auto less = [](const FrontPoint& a, const FrontPoint& b) { return a.loss < b.loss; };
    const FrontPoint& best = *std::min_element(begin, end, less);
    if (last != nullptr && last->scene == best.scene && last->loss <= best.loss) continue;
    for (auto one = begin; one != end; ++one) {
      if (one->loss == best.loss) out.push_back(one->index);
    }
    last = &best;
  }
  return out;
}

bool can_be_error(const Column& column) { return column.name != "coverage_95" && column.name != "surface_coverage_95"; }

bool can_be_cost(const Column& column) { return can_be_error(column) && column.better != RecordField::Better::more; }

double read_bound(const Pareto& pareto, const std::string& within) {
  if (pareto.scenes.size() > 1) {
    const std::string& scene = pareto.scenes.front();
    const auto end = scene.find('=');
    throw Error("command line",
                fmt::format("--within: the sweep has {} scenes, whose best settings may differ", pareto.scenes.size()),
                fmt::format("choose one: --where \"{} == {}\"", scene.substr(0, end),
                            scene.substr(end + 1, scene.find(", ") - end - 1)));
  }
  return read_quantity(parse_value(within, "command line"), "--within", pareto.error.unit);
}

const Setting* cheapest_within(const Pareto& pareto, double bound) {
  // The settings are sorted by cost, then by error, so the first match is the best.
  const auto found = std::find_if(pareto.settings.begin(), pareto.settings.end(), [&](const Setting& one) {
    return one.complete() && one.error.interval &&
           satisfies(cautious_loss(pareto, one), Relation::at_most, loss(pareto, bound));
  });
  return found != pareto.settings.end() ? &*found : nullptr;
}

const Setting* best_bounded(const Pareto& pareto) {
  const Setting* best = nullptr;
  for (const Setting& one : pareto.settings) {
    if (!one.complete() || !one.error.interval) continue;
    if (best == nullptr || cautious_loss(pareto, one) < cautious_loss(pareto, *best)) best = &one;
  }
  return best;
}

}  // namespace palpate
