// SPDX-License-Identifier: MIT
// Checks that all values of a map are finite.
#pragma once

#include <palpate/error.hpp>

#include <Eigen/Core>

#include <fmt/format.h>

#include <cmath>

namespace palpate {

/// Returns the same as Eigen's allFinite(), but is faster.
inline bool all_finite(const Eigen::VectorXd& values) {
  return std::isfinite(values.sum()) || values.allFinite();  // a finite sum has finite terms
}

/// Throws Error, so that the run fails, if a value of `map` is not finite. `name`: name of the map in the message;
/// `taps`: number of taps so far.
inline void require_finite(const Eigen::VectorXd& map, const char* name, int taps) {
  if (all_finite(map)) return;
  throw Error("maps", fmt::format("{} is not a finite number everywhere after tap {}", name, taps),
              "choose a larger belief.height.noise or a shorter kernel.length_scale, or check for heights that no arm "
              "can report",
              Error::Kind::run);
}

}  // namespace palpate
