// SPDX-License-Identifier: MIT
// How well does the race of `palpate tune` find the best setting of a grid? Takes recorded sweeps in which all settings
// have run on the same seeds. Replays the race in random orders of the seeds, with all jobs of the grid as its budget.
// The mean over all recorded seeds counts as the truth. Prints for each grid the share of the jobs that the race used,
// the mean regret of its winner, and the share of orders whose winner is near the best setting.
//     race_grid ORDERS RESULTS_CSV=METRIC ...
// Exit code 1: a figure misses what the table of docs/tuning.md promises (metrics in metres).
#include "support/populations.hpp"
#include "support/race.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>

namespace palpate {
namespace {

constexpr double kMostJobs = 0.25;
constexpr double kMostRegret = 0.03e-3;  ///< metres
constexpr double kNear = 0.2e-3;         ///< metres
constexpr double kLeastNear = 0.95;

int run(int orders, const std::vector<std::string>& arguments) {
  int missed = 0;
  fmt::print("{:<20} {:>8} {:>6} {:>7} {:>11} {:>6}\n", "grid", "settings", "seeds", "jobs", "regret [mm]", "near");
  for (const std::string& one : arguments) {
    const auto sign = one.rfind('=');
    const test::Population population = test::read_population(one.substr(0, sign), one.substr(sign + 1));
    RaceTable grid;
    for (const auto& group : population.values) grid.insert(grid.end(), group.begin(), group.end());
    const std::vector<double> truth = means_of(grid);
    const double best = truth[ranked(grid).front()];
    double jobs = 0.0;
    double regret = 0.0;
    int near = 0;
    for (int sample = 0; sample < orders; ++sample) {
      Random random(static_cast<std::uint64_t>(sample), "race_grid");
      std::vector<std::size_t> order(population.seeds());
      for (std::size_t i = 0; i < order.size(); ++i) {
        order[i] = i;
        std::swap(order[i], order[random.index(i + 1)]);
      }
      const test::RaceEnd outcome = test::run_race(
          {false, 0.0}, grid.size(), grid.size() * order.size(),
          [&](std::size_t setting, std::size_t seed) { return grid[setting][order[seed]]; }, nullptr, nullptr,
          order.size());  // the seeds are used up before the budget, because lost settings leave jobs over
      jobs += static_cast<double>(outcome.jobs) / static_cast<double>(grid.size() * order.size()) / orders;
      regret += (truth[outcome.winner] - best) / orders;
      near += truth[outcome.winner] - best <= kNear ? 1 : 0;
    }
    const double share = static_cast<double>(near) / orders;
    const bool good = jobs <= kMostJobs && regret <= kMostRegret && share >= kLeastNear;
    fmt::print("{:<20} {:>8} {:>6} {:>6.1f} % {:>10.3f} {:>5.1f} %{}\n", population.name, grid.size(),
               population.seeds(), 100.0 * jobs, 1e3 * regret, 100.0 * share, good ? "" : "  MISSES");
    missed += good ? 0 : 1;
  }
  return missed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace palpate

int main(int count, char** words) {
  try {
    if (count < 3) throw std::runtime_error("usage: race_grid ORDERS RESULTS_CSV=METRIC ...");
    return palpate::run(std::atoi(words[1]), {words + 2, words + count});
  } catch (const std::exception& error) {
    fmt::print(stderr, "race_grid: {}\n", error.what());
    return 2;
  }
}
