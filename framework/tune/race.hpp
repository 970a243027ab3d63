// SPDX-License-Identifier: MIT
// The schedule of a race over settings: which settings run on further seeds, when new settings join, and when the race
// ends. All decisions are pure functions of the recorded results.
//
// The method is iterated racing (López-Ibáñez et al. 2016, The irace package, Operations Research Perspectives 3) with
// the test of find_losers(). All settings run on the first four seeds. After each seed, settings that lose are dropped,
// and the rest run on the next seed. If all keys are lists, this is all. With continuous ranges, such a race is only
// the first of seven stages. In the next five, new settings near the best five join them; the spread of the new
// settings shrinks from stage to stage. In the last stage, the best five race for the rest of the budget.
#pragma once

#include "tune/elimination.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace palpate {

/// Number of seeds on which a setting runs before it can be dropped.
inline constexpr std::size_t kFirstSeeds = 4;
/// Number of settings from which a search continues.
inline constexpr std::size_t kElites = 5;
/// Number of the last stage of a search. Stage 0 races the initial settings; stages between add settings.
inline constexpr std::size_t kLastStage = 6;

/// The rules of a race, which do not change.
struct RaceRules {
  bool is_search = false;  ///< whether settings join in later stages, because a key has a continuous range
  double within = 0.0;     ///< the race ends if largest_disadvantage() is at most this
};

/// The state of a race after a round.
struct RaceState {
  std::size_t stage = 0;
  std::size_t budget = 0;           ///< number of jobs of the whole race, as it was known at the last decision
  std::size_t stage_end = 0;        ///< number of jobs at which the stage ends
  std::size_t seeds = kFirstSeeds;  ///< number of the first seeds on which all racing settings run
  std::vector<std::size_t> racing;  ///< numbers of the settings in the race, ascending
};

/// The decision after a round.
struct RaceDecision {
  RaceState state;
  std::vector<Loser> losers;        ///< Loser::row is the number of a setting
  std::size_t new_settings = 0;     ///< number of settings that join, near `elites`
  std::vector<std::size_t> elites;  ///< best settings, the best first; only if settings join
  double spread = 0.0;              ///< see SearchSpace::near()
  std::string end;                  ///< reason why the race ends; "" if it goes on
  std::vector<std::size_t> front;   ///< setting with the best mean, or the settings on the front; only if the race ends
};

/// Returns the number of initial settings of a search with this budget.
std::size_t initial_settings(std::size_t budget);

/// Returns the number of jobs at which stage 0 ends.
std::size_t first_stage_end(const RaceRules& rules, std::size_t budget);

/// Decides the next round. `results`: one row per setting, with its results on the first seeds; less is better. Each
/// racing setting has at least `state.seeds` results. `costs`: results of a second metric, or null; the race then drops
/// settings that another one dominates (find_dominated()), and the elites are spread over the front. `budget`: number
/// of jobs of the whole race; `jobs`: number so far.
RaceDecision decide(const RaceRules& rules, const RaceState& state, const RaceTable& results, const RaceTable* costs,
                    std::size_t budget, std::size_t jobs);

/// Returns the racing settings on the front of both metrics, the best in the first metric first.
std::vector<std::size_t> front_settings(const RaceState& state, const RaceTable& results, const RaceTable& costs);

}  // namespace palpate
