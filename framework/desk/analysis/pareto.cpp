// SPDX-License-Identifier: MIT
#include "analysis/pareto.hpp"

#include "analysis/column.hpp"
#include "analysis/groups.hpp"
#include "config/quantity.hpp"
#include "config/yaml.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace palpate {
namespace {

constexpr const char* kCommandLine = "command line";

ParetoKey make_key(const std::string& name, const std::vector<std::string>& columns, const char* option) {
  const Column column = find_column(name, columns, option);
  if (name == "coverage_95") {
    throw Error(kCommandLine, fmt::format("{}: coverage_95 is best at 0.95, neither small nor large", option),
                "nlpd judges heights and intervals together");
  }
  return {name, column.unit, column.better == RecordField::Better::more};
}

/// The jobs of one setting, counted, and their means.
Setting make_setting(const JobGroup& group, const ParetoKey& cost, const ParetoKey& error) {
  Setting out;
  out.values = group.values;
  out.first_job = static_cast<std::size_t>(group.jobs.front().job->index);
  std::vector<double> costs;
  std::vector<double> errors;
  for (const JobResult& one : group.jobs) {
    ++out.jobs;
    if (one.row == nullptr) {
      ++out.unfinished;
    } else if (!is_done(*one.row)) {
      ++out.failed;
    } else {
      const std::optional<double> paid = number_in(*one.row, cost.name, "--cost");
      const std::optional<double> missed = number_in(*one.row, error.name, "--error");
      if (paid && missed) {
        costs.push_back(*paid);
        errors.push_back(*missed);
      } else {
        ++out.without_value;
      }
    }
  }
  out.cost = estimate_mean(costs);
  out.error = estimate_mean(errors);
  return out;
}

/// As a quantity of which less is better.
double loss(const ParetoKey& key, double value) { return key.more_is_better ? -value : value; }

void number_front(Pareto& pareto) {
  std::vector<Setting*> complete;
  std::vector<ParetoPoint> points;
  for (Setting& setting : pareto.settings) {
    if (!setting.complete()) continue;
    complete.push_back(&setting);
    points.push_back({setting.cost.mean, loss(pareto.error, setting.error.mean)});
  }
  const std::vector<bool> front = non_dominated(points);
  int number = 0;
  for (std::size_t i = 0; i < complete.size(); ++i) {
    if (front[i]) complete[i]->front = ++number;
  }
}

}  // namespace

std::vector<bool> non_dominated(const std::vector<ParetoPoint>& points) {
  // By cost, and by error among equal costs: a point is dominated if some point before it, of less cost, is at most as
  // large in error, or one of equal cost is smaller.
  std::vector<std::size_t> order(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return points[a].cost < points[b].cost || (points[a].cost == points[b].cost && points[a].error < points[b].error);
  });
  std::vector<bool> front(points.size(), false);
  const ParetoPoint* last = nullptr;  // the best error so far
  for (const std::size_t i : order) {
    const ParetoPoint& point = points[i];
    const bool twin = last != nullptr && point.cost == last->cost && point.error == last->error;
    if (last != nullptr && !(point.error < last->error) && !twin) continue;
    front[i] = true;
    last = &point;
  }
  return front;
}

Pareto make_pareto(const Sweep& sweep, const std::vector<Row>& results, const std::string& cost,
                   const std::string& error) {
  if (results.empty()) {
    throw Error(sweep.directory.string(), "no job of this sweep has ended", "'palpate resume' carries on");
  }
  Pareto pareto;
  const std::vector<std::string> columns = columns_of(results);
  pareto.cost = make_key(cost, columns, "--cost");
  pareto.error = make_key(error, columns, "--error");
  if (pareto.cost.more_is_better) {
    throw Error(kCommandLine, fmt::format("--cost: more of {} is better, so it is no cost", cost),
                "give it to --error");
  }
  pareto.keys = setting_keys(sweep);
  const std::vector<std::string> differing = varying_keys(sweep, pareto.keys);
  for (const JobGroup& group : group_jobs(sweep, results, pareto.keys)) {
    Setting setting = make_setting(group, pareto.cost, pareto.error);
    std::vector<std::string> values;
    for (const std::string& key : differing) values.push_back(value_of(sweep, *group.jobs.front().job, key));
    setting.name = key_words(differing, values, true);
    if (setting.name.empty()) setting.name = "the only setting";
    pareto.jobs += setting.jobs;
    pareto.unfinished += setting.unfinished;
    pareto.settings.push_back(std::move(setting));
  }
  std::stable_sort(pareto.settings.begin(), pareto.settings.end(), [&](const Setting& a, const Setting& b) {
    const bool has_a = a.cost.count > 0;
    const bool has_b = b.cost.count > 0;
    if (!has_a || !has_b) return has_a && !has_b;
    if (a.cost.mean != b.cost.mean) return a.cost.mean < b.cost.mean;
    return loss(pareto.error, a.error.mean) < loss(pareto.error, b.error.mean);
  });
  number_front(pareto);
  return pareto;
}

double read_bound(const Pareto& pareto, const std::string& within) {
  return read_quantity(parse_value(within, kCommandLine), "--within", pareto.error.unit);
}

double cautious_end(const Pareto& pareto, const Setting& setting) {
  return pareto.error.more_is_better ? setting.error.interval->low : setting.error.interval->high;
}

const Setting* cheapest_within(const Pareto& pareto, double bound) {
  // They stand in the order of cost, and of error where costs are equal.
  const auto found = std::find_if(pareto.settings.begin(), pareto.settings.end(), [&](const Setting& one) {
    return one.complete() && one.error.interval &&
           loss(pareto.error, cautious_end(pareto, one)) <= loss(pareto.error, bound);
  });
  return found != pareto.settings.end() ? &*found : nullptr;
}

const Setting* best_bounded(const Pareto& pareto) {
  const Setting* best = nullptr;
  for (const Setting& one : pareto.settings) {
    if (!one.complete() || !one.error.interval) continue;
    const double end = loss(pareto.error, cautious_end(pareto, one));
    if (best == nullptr || end < loss(pareto.error, cautious_end(pareto, *best))) best = &one;
  }
  return best;
}

}  // namespace palpate
