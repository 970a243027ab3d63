// SPDX-License-Identifier: MIT
#include "tune/race.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kAlphaOfSearch = 0.05;
constexpr double kAlphaOfLists = 0.01;   ///< no setting comes back, so a wrong elimination costs more
constexpr double kLastShare = 0.12;      ///< share of the budget for the last stage
constexpr double kJobsPerSetting = 5.5;  ///< expected number of jobs of a setting that joins: four seeds, and some more
constexpr double kFirstSpread = 0.25;
constexpr double kShrinkage = 0.8;
constexpr double kInitialShare = 12.5;  ///< jobs of the budget per initial setting
constexpr std::size_t kMostInitial = 40;

bool is_last(const RaceRules& rules, const RaceState& state) { return !rules.is_search || state.stage == kLastStage; }

/// Returns the results of the racing settings on the first `state.seeds` seeds.
RaceTable racing_table(const RaceState& state, const RaceTable& results) {
  RaceTable out;
  for (const std::size_t setting : state.racing) {
    const auto begin = results[setting].begin();
    out.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(state.seeds));
  }
  return out;
}

/// Returns the racing settings in the order of their means.
std::vector<std::size_t> ranked_settings(const RaceState& state, const RaceTable& results) {
  std::vector<std::size_t> out;
  for (const std::size_t row : ranked(racing_table(state, results))) out.push_back(state.racing[row]);
  return out;
}

/// Returns up to kElites settings from which a search continues: the best ones, or settings spread evenly over the
/// front.
std::vector<std::size_t> elites_of(const RaceState& state, const RaceTable& results, const RaceTable* costs) {
  std::vector<std::size_t> out = ranked_settings(state, results);
  std::vector<std::size_t> front;
  if (costs != nullptr) front = front_settings(state, results, *costs);
  if (front.size() > kElites) {
    out.clear();
    for (std::size_t i = 0; i < kElites; ++i) out.push_back(front[i * (front.size() - 1) / (kElites - 1)]);
  }
  std::stable_partition(out.begin(), out.end(),
                        [&](std::size_t one) { return std::find(front.begin(), front.end(), one) != front.end(); });
  out.resize(std::min(out.size(), kElites));
  return out;
}

/// Removes the losers from the race and adds them to the decision.
void drop_losers(const RaceRules& rules, const RaceTable& results, const RaceTable* costs, RaceDecision& decision) {
  RaceState& state = decision.state;
  const std::size_t keep = is_last(rules, state) ? 1 : kElites;
  const double alpha = rules.is_search ? kAlphaOfSearch : kAlphaOfLists;
  const RaceTable table = racing_table(state, results);
  for (Loser one : costs != nullptr ? find_dominated(table, racing_table(state, *costs), alpha, keep)
                                    : find_losers(table, alpha, keep)) {
    one.row = state.racing[one.row];
    // A setting of an earlier stage is not dropped before it was compared on all of its seeds.
    if (results[one.row].size() <= state.seeds) decision.losers.push_back(one);
  }
  for (const Loser& one : decision.losers)
    state.racing.erase(std::remove(state.racing.begin(), state.racing.end(), one.row), state.racing.end());
}

/// Begins the next stage of a search: the best settings remain, and others may join.
void begin_stage(const RaceTable& results, const RaceTable* costs, std::size_t budget, std::size_t jobs,
                 RaceDecision& decision) {
  RaceState& state = decision.state;
  std::vector<std::size_t> elites = elites_of(state, results, costs);
  const double left =
      static_cast<double>(budget) - static_cast<double>(jobs) - kLastShare * static_cast<double>(budget);
  // With a small budget, stages are left out, so that at least two settings join in each.
  const auto affordable = static_cast<std::size_t>(std::max(0.0, left / (2.0 * kJobsPerSetting)));
  const std::size_t stages = std::min(kLastStage - state.stage - 1, affordable);
  state.stage = kLastStage - stages;
  const double share = stages > 0 ? left / static_cast<double>(stages) : 0.0;
  const auto joining = static_cast<std::size_t>(share / kJobsPerSetting);
  state.racing = elites;
  std::sort(state.racing.begin(), state.racing.end());
  if (stages == 0) {
    state.stage_end = budget;
    return;
  }
  state.stage_end = jobs + static_cast<std::size_t>(share);
  state.seeds = kFirstSeeds;
  decision.new_settings = joining;
  decision.elites = std::move(elites);
  decision.spread = kFirstSpread * std::pow(kShrinkage, static_cast<double>(state.stage - 1));
}

}  // namespace

std::size_t initial_settings(std::size_t budget) {
  return std::clamp<std::size_t>(static_cast<std::size_t>(static_cast<double>(budget) / kInitialShare), kElites + 1,
                                 kMostInitial);
}

std::size_t first_stage_end(const RaceRules& rules, std::size_t budget) {
  return rules.is_search ? budget / 2 : budget;
}

std::vector<std::size_t> front_settings(const RaceState& state, const RaceTable& results, const RaceTable& costs) {
  std::vector<std::size_t> out;
  for (const std::size_t row : front_of_means(racing_table(state, results), racing_table(state, costs)))
    out.push_back(state.racing[row]);
  return out;
}

RaceDecision decide(const RaceRules& rules, const RaceState& state, const RaceTable& results, const RaceTable* costs,
                    std::size_t budget, std::size_t jobs) {
  RaceDecision out;
  out.state = state;
  // A budget in time is known better after each round, and the end of the stage moves with it.
  if (budget != state.budget) out.state.stage_end = state.stage_end * budget / std::max<std::size_t>(state.budget, 1);
  out.state.budget = budget;
  const auto end = [&](const char* reason) {
    out.end = reason;
    out.front = costs != nullptr ? front_settings(out.state, results, *costs)
                                 : std::vector<std::size_t>{ranked_settings(out.state, results).front()};
    return out;
  };
  for (;;) {
    drop_losers(rules, results, costs, out);
    if (out.state.racing.size() == 1 && is_last(rules, out.state)) return end("one setting is left");
    if (costs == nullptr && largest_disadvantage(racing_table(out.state, results)) <= rules.within)
      return end(rules.within > 0.0 ? "all settings left are within the given difference of the best one"
                                    : "all settings left have the same results");
    // Settings of earlier stages already have results on some of the next seeds.
    const auto lacking = static_cast<std::size_t>(
        std::count_if(out.state.racing.begin(), out.state.racing.end(),
                      [&](std::size_t setting) { return results[setting].size() <= out.state.seeds; }));
    if (jobs + lacking <= out.state.stage_end) {
      ++out.state.seeds;
      if (lacking > 0) return out;
      continue;
    }
    if (is_last(rules, out.state)) return end("the budget is used");
    begin_stage(results, costs, budget, jobs, out);
    if (out.new_settings > 0) return out;
    // In the last stage, the seeds that all settings have in common count.
    out.state.seeds = results[out.state.racing.front()].size();
    for (const std::size_t setting : out.state.racing)
      out.state.seeds = std::min(out.state.seeds, results[setting].size());
  }
}

}  // namespace palpate
