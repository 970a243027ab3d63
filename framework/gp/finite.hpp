// SPDX-License-Identifier: MIT
// Checks that all values of a map are finite.
#pragma once

#include <palpate/error.hpp>

#include <Eigen/Core>

#include <fmt/format.h>

#include <cmath>

namespace palpate {

/// Returns the same as Eigen's allFinite(), in a fraction of the time.
inline bool all_finite(const Eigen::VectorXd& values) {
  return std::isfinite(values.sum()) || values.allFinite();  // a finite sum has finite terms
}

/// Throws Error (the run fails) unless all values of a map, named `name`, are finite. `taps`: number of taps so far.
inline void require_finite(const Eigen::VectorXd& map, const char* name, int taps) {
  if (all_finite(map)) return;
  throw Error("maps", fmt::format("{} is not a finite number everywhere after tap {}", name, taps),
              "choose a larger belief.height.noise or a shorter kernel.length_scale, or check for heights that no arm "
              "can report",
              Error::Kind::run);
}

}  // namespace palpate
