// SPDX-License-Identifier: MIT
// A race of `palpate tune` whose results are computed in place of runs.
#pragma once

#include "tune/race.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace palpate::test {

struct RaceEnd {
  std::size_t jobs = 0;
  std::size_t winner = 0;
  std::vector<std::size_t> front;
  std::string reason;  ///< "" if all seeds were used up
  std::vector<Loser> losers;
  std::size_t settings = 0;
};

/// Returns the result of a setting on a seed. Settings that join have the next numbers.
using RaceResult = std::function<double(std::size_t setting, std::size_t seed)>;

/// Runs a race. `check` is called with each decision. `cost`: a second metric, or null. `seeds`: number of seeds that
/// have results; if the race needs more, the setting with the best mean wins.
inline RaceEnd run_race(const RaceRules& rules, std::size_t settings, std::size_t budget, const RaceResult& value,
                        const std::function<void(const RaceDecision&)>& check = nullptr,
                        const RaceResult& cost = nullptr, std::size_t seeds = std::numeric_limits<std::size_t>::max()) {
  RaceTable results(settings);
  RaceTable costs(settings);
  RaceState state;
  state.budget = budget;
  state.stage_end = first_stage_end(rules, budget);
  for (std::size_t i = 0; i < settings; ++i) state.racing.push_back(i);
  RaceEnd out;
  for (;;) {
    for (const std::size_t setting : state.racing) {
      for (std::size_t seed = results[setting].size(); seed < state.seeds; ++seed, ++out.jobs) {
        results[setting].push_back(value(setting, seed));
        if (cost) costs[setting].push_back(cost(setting, seed));
      }
    }
    RaceDecision decision = decide(rules, state, results, cost ? &costs : nullptr, budget, out.jobs);
    if (check) check(decision);
    out.losers.insert(out.losers.end(), decision.losers.begin(), decision.losers.end());
    for (std::size_t i = 0; i < decision.new_settings; ++i) {
      decision.state.racing.push_back(results.size());
      results.emplace_back();
      costs.emplace_back();
    }
    out.settings = results.size();
    out.reason = decision.end;
    out.front = decision.front;
    state = decision.state;
    if (decision.end.empty() && state.seeds > seeds) {
      RaceTable left;
      for (const std::size_t setting : state.racing) left.push_back(results[setting]);
      out.front = {state.racing[ranked(left).front()]};
    }
    if (out.front.empty()) continue;
    out.winner = out.front.front();
    return out;
  }
}

}  // namespace palpate::test
