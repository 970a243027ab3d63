// SPDX-License-Identifier: MIT
#include "analysis/pareto.hpp"

#include "analysis/column.hpp"
#include "analysis/readable.hpp"
#include "config/quantity.hpp"
#include "config/yaml.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <map>
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
  return {name, column.unit, column.better == SummaryField::Better::more};
}

/// Collects what belongs to one setting while the jobs are gone through.
struct Collected {
  Setting setting;
  std::vector<double> cost;
  std::vector<double> error;
};

void add_job(Collected& one, const Row* row, const ParetoKey& cost, const ParetoKey& error) {
  ++one.setting.jobs;
  if (row == nullptr) {
    ++one.setting.unfinished;
  } else if (!is_done(*row)) {
    ++one.setting.failed;
  } else {
    const std::optional<double> paid = number_in(*row, cost.name, "--cost");
    const std::optional<double> missed = number_in(*row, error.name, "--error");
    if (!paid || !missed) {
      ++one.setting.without_value;
      return;
    }
    one.cost.push_back(*paid);
    one.error.push_back(*missed);
  }
}

/// The keys that have more than one value, with their values; a name is one line.
std::string name_of(const std::vector<std::string>& keys, const std::vector<bool>& differs,
                    const std::vector<std::string>& values) {
  std::string name;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (differs[i]) name += (name.empty() ? "" : ", ") + keys[i] + "=" + values[i];
  }
  return name.empty() ? "the only setting" : one_line(name);
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
  std::vector<std::size_t> kept;  // positions of the keys that make a setting
  for (std::size_t i = 0; i < sweep.keys.size(); ++i) {
    if (sweep.keys[i] == "seed") continue;
    kept.push_back(i);
    pareto.keys.push_back(sweep.keys[i]);
  }
  std::map<std::int64_t, const Row*> rows;
  for (const Row& row : results) rows[std::get<std::int64_t>(*row.find("job"))] = &row;

  std::vector<Collected> collected;
  std::map<std::vector<std::string>, std::size_t> found;
  std::vector<bool> differs(kept.size(), false);
  for (std::size_t job = 0; job < sweep.jobs.size(); ++job) {
    std::vector<std::string> values;
    for (const std::size_t i : kept) values.push_back(sweep.jobs[job].values[i]);
    const auto [at, is_new] = found.emplace(values, collected.size());
    if (is_new) {
      collected.emplace_back();
      collected.back().setting.first_job = job;
      collected.back().setting.values = values;
      const std::vector<std::string>& first = collected.front().setting.values;
      for (std::size_t i = 0; i < values.size(); ++i) differs[i] = differs[i] || values[i] != first[i];
    }
    const auto row = rows.find(sweep.jobs[job].index);
    add_job(collected[at->second], row != rows.end() ? row->second : nullptr, pareto.cost, pareto.error);
  }
  for (Collected& one : collected) {
    one.setting.cost = estimate_mean(one.cost);
    one.setting.error = estimate_mean(one.error);
    one.setting.name = name_of(pareto.keys, differs, one.setting.values);
    pareto.jobs += one.setting.jobs;
    pareto.unfinished += one.setting.unfinished;
    pareto.settings.push_back(std::move(one.setting));
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
