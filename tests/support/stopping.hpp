// SPDX-License-Identifier: MIT
// What `stop.expected_rmse` would have said at each tap of a run that it does not stop.
#pragma once

#include "experiment/stop_rules.hpp"
#include "support/runs.hpp"

#include <optional>
#include <string>
#include <vector>

namespace palpate::test {

/// The state of a run after some taps.
struct Moment {
  int taps = 0;
  std::optional<double> expected_rmse;  ///< metres
  std::optional<double> undiscovered;   ///< probability of an object that no tap has touched
  double rmse = 0.0;                    ///< the true one, metres; meaningless before the first hit
};

/// All moments of a run, the one before the first tap included.
using Moments = std::vector<Moment>;

/// Returns the moment of a recorded state of the belief.
inline Moment moment_of(int taps, const BeliefState& state, double rmse) {
  return {taps, number_of(state, "expected_rmse_m"), number_of(state, "footprint.undiscovered_probability"), rmse};
}

/// Objects of one piece, and two of two pieces: l and two_blocks.
inline const std::vector<std::string>& stopping_scenes() {
  static const std::vector<std::string> scenes{"object_i",     "object_ii", "dome",      "cylinder",
                                               "tilted_block", "l",         "two_blocks"};
  return scenes;
}

/// Runs the default strategy over 60 taps, objects placed at random.
inline Moments moments(const std::string& scene, int seed, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides{"scene=" + scene, "scene.placement=random", "taps=60",
                                     "seed=" + std::to_string(seed), "stop.expected_rmse=1e-6 mm"};
  overrides.insert(overrides.end(), more.begin(), more.end());
  Finished run("default.yaml", overrides);
  Moments out;
  for (const TapRecord& tap : run.taps)
    out.push_back(moment_of(tap.number() - 1, tap.state, tap.errors.rmse.value_or(0)));
  const RunResult last = run.experiment.result();
  out.push_back(moment_of(last.taps, last.state, *last.errors.rmse));
  return out;
}

/// Where the rule stops such a run.
struct Stop {
  double bound = 0.0;
  std::optional<int> tap;  ///< before the budget is spent
  double rmse = 0.0;       ///< the true one there
  std::optional<int> good_from;
};

inline Stop stop_of(const Moments& run, double bound) {
  Stop out;
  out.bound = bound;
  for (const Moment& one : run) {
    if (!one.expected_rmse || one.rmse > bound) {
      out.good_from.reset();
    } else if (!out.good_from) {
      out.good_from = one.taps;
    }
    if (!out.tap && &one != &run.back() && is_good_enough(one.expected_rmse, one.undiscovered, bound)) {
      out.tap = one.taps;
      out.rmse = one.rmse;
    }
  }
  return out;
}

}  // namespace palpate::test
