// SPDX-License-Identifier: MIT
// What `stop.expected_rmse` would have said at each tap of a run that it does not stop.
#pragma once

#include "experiment/forecast.hpp"
#include "support/runs.hpp"

#include <optional>
#include <string>
#include <vector>

namespace palpate::test {

/// As it stood after so many taps.
struct Moment {
  int taps = 0;
  Forecast forecast;
  double rmse = 0.0;  ///< the true one, metres; meaningless before the first hit
};

/// All moments of a run, the one before the first tap included.
using Forecasts = std::vector<Moment>;

/// Objects of one piece, and two of two pieces: l and two_blocks.
inline const std::vector<std::string>& stopping_scenes() {
  static const std::vector<std::string> scenes{"object_i",     "object_ii", "dome",      "cylinder",
                                               "tilted_block", "l",         "two_blocks"};
  return scenes;
}

/// Runs the default strategy over 60 taps, objects placed at random.
inline Forecasts forecasts(const std::string& scene, int seed, const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides{"scene=" + scene, "scene.placement=random", "taps=60",
                                     "seed=" + std::to_string(seed), "stop.expected_rmse=1e-6 mm"};
  overrides.insert(overrides.end(), more.begin(), more.end());
  Finished run("default.yaml", overrides);
  Forecasts out;
  for (const TapRecord& tap : run.taps) out.push_back({tap.number - 1, *tap.forecast, tap.errors.rmse.value_or(0)});
  const RunResult last = run.experiment.result();
  out.push_back({last.taps, *last.forecast, *last.errors.rmse});
  return out;
}

/// Where the rule stops such a run.
struct Stop {
  double bound = 0.0;
  std::optional<int> tap;  ///< before the budget is spent
  double rmse = 0.0;       ///< the true one there
  std::optional<int> good_from;
};

inline Stop stop_of(const Forecasts& run, double bound) {
  Stop out;
  out.bound = bound;
  for (const Moment& one : run) {
    if (!one.forecast.rmse || one.rmse > bound) {
      out.good_from.reset();
    } else if (!out.good_from) {
      out.good_from = one.taps;
    }
    if (!out.tap && &one != &run.back() && good_enough(one.forecast, bound)) {
      out.tap = one.taps;
      out.rmse = one.rmse;
    }
  }
  return out;
}

}  // namespace palpate::test
