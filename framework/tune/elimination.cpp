// SPDX-License-Identifier: MIT
#include "tune/elimination.hpp"

#include "analysis/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

namespace palpate {
namespace {

constexpr double kMostPriorSeeds = 4.0;

/// Returns the weight of the variance of the other settings, in degrees of freedom. It is 0 if there are only two
/// settings, whose single variance says nothing more than itself.
double prior_seeds(const RaceTable& table) {
  return std::min(kMostPriorSeeds, static_cast<double>(table.size()) - 2.0);
}

/// Paired differences of one setting to the best one.
struct Difference {
  std::size_t row = 0;
  double mean = 0.0;
  double variance = 0.0;  ///< moderated
};

/// Returns the differences of all settings but the best one, in the order of their means.
std::vector<Difference> differences(const RaceTable& table) {
  const std::vector<std::size_t> order = ranked(table);
  const std::vector<double>& best = table[order.front()];
  const auto seeds = static_cast<double>(best.size());
  std::vector<Difference> out;
  for (auto row = order.begin() + 1; row != order.end(); ++row) {
    std::vector<double> paired(best.size());
    for (std::size_t seed = 0; seed < best.size(); ++seed) paired[seed] = table[*row][seed] - best[seed];
    const double mean = mean_of(paired);
    double squares = 0.0;
    for (const double one : paired) squares += (one - mean) * (one - mean);
    out.push_back({*row, mean, squares / (seeds - 1.0)});
  }
  std::vector<double> better;
  for (std::size_t i = 0; i < (out.size() + 1) / 2; ++i) better.push_back(out[i].variance);
  std::sort(better.begin(), better.end());
  const double typical = quantile(better, 0.5);
  const double prior = prior_seeds(table);
  for (Difference& one : out) one.variance = ((seeds - 1.0) * one.variance + prior * typical) / (seeds - 1.0 + prior);
  return out;
}

}  // namespace

std::vector<double> means_of(const RaceTable& table) { return cluster_means(table); }

std::vector<std::size_t> ranked(const RaceTable& table) {
  const std::vector<double> means = means_of(table);
  std::vector<std::size_t> order(table.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return means[a] < means[b]; });
  return order;
}

std::vector<Loser> find_losers(const RaceTable& table, double alpha, std::size_t keep) {
  std::vector<Loser> out;
  if (table.size() <= keep || table.size() < 2) return out;
  const auto seeds = static_cast<double>(table.front().size());
  std::vector<Difference> all = differences(table);
  for (auto one = all.rbegin(); one != all.rend() && table.size() - out.size() > keep; ++one) {
    if (!(one->mean > 0.0)) continue;
    const double error = std::sqrt(one->variance / seeds);
    const double p = error > 0.0 ? student_tail(one->mean / error, seeds - 1.0 + prior_seeds(table)) : 0.0;
    if (p < alpha) out.push_back({one->row, table.front().size(), one->mean, p});
  }
  return out;
}

std::vector<Loser> find_dominated(const RaceTable& table, const RaceTable& costs, double alpha, std::size_t keep) {
  std::vector<Loser> out;
  std::vector<bool> is_out(table.size());
  // The loss of a row against another one; nullopt if it does not lose.
  const auto loss = [&](const RaceTable& from, std::size_t row, std::size_t other) -> std::optional<Loser> {
    const std::vector<Loser> losers = find_losers({from[other], from[row]}, alpha, 1);
    return !losers.empty() && losers.front().row == 1 ? std::optional(losers.front()) : std::nullopt;
  };
  for (std::size_t row = 0; row < table.size() && table.size() - out.size() > keep; ++row) {
    for (std::size_t other = 0; other < table.size() && !is_out[row]; ++other) {
      if (other == row || is_out[other]) continue;
      std::optional<Loser> worse = loss(table, row, other);
      const std::optional<Loser> dearer = loss(costs, row, other);
      if (worse ? !dearer && costs[row] != costs[other] : !dearer || table[row] != table[other]) continue;
      if (!worse) worse = dearer;
      worse->row = row;
      out.push_back(*worse);
      is_out[row] = true;
    }
  }
  return out;
}

std::vector<std::size_t> front_of_means(const RaceTable& table, const RaceTable& costs) {
  const std::vector<double> mean = means_of(table);
  const std::vector<double> cost = means_of(costs);
  std::vector<std::size_t> order = ranked(table);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::make_pair(mean[a], cost[a]) < std::make_pair(mean[b], cost[b]);
  });
  std::vector<std::size_t> out;
  for (const std::size_t row : order) {
    if (out.empty() || cost[row] < cost[out.back()]) out.push_back(row);
  }
  return out;
}

double largest_disadvantage(const RaceTable& table) {
  if (table.size() < 2) return 0.0;
  const auto seeds = static_cast<double>(table.front().size());
  const double factor = student_quantile(0.95, seeds - 1.0 + prior_seeds(table));
  double out = 0.0;
  for (const Difference& one : differences(table))
    out = std::max(out, one.mean + factor * std::sqrt(one.variance / seeds));
  return out;
}

}  // namespace palpate
