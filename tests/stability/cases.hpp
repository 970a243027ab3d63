// SPDX-License-Identifier: MIT
// The extremes at which the Gaussian process is checked: what, where and how much, each under a name.
#pragma once

#include <palpate/types.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace palpate::stability {

/// Where the taps lie. The area is kSide by kSide.
enum class Layout {
  scattered,   ///< uniform at random
  grid,        ///< a regular grid, row by row
  duplicates,  ///< every place tapped twice, the second time later
  one_place,   ///< always the same
  pairs,       ///< two by two, `gap` apart
  collinear,   ///< on a straight line of slope 3 : 4
};

/// What was measured there, times `height`.
enum class Data {
  smooth,    ///< a wave over the area
  rough,     ///< uniform in [-1, 1], also at one and the same place
  constant,  ///< 1 everywhere
  zero,
  labels,  ///< 1 on the right half, 0 elsewhere
};

constexpr double kSide = 0.23;

struct Case {
  std::string name;
  std::string kernel = "rbf";
  int points = 40;
  double length = 0.1;           ///< of the kernel, in sides
  double noise_variance = 1e-8;  ///< square of the unit of the targets
  double signal = 1.0;           ///< unit of the targets
  double mean = 0.0;
  double mean_ratio = 0.0;
  double height = 1.0;
  double offset = 0.0;  ///< added to both coordinates, metres
  double gap = 1e-12;   ///< metres
  Layout layout = Layout::scattered;
  Data data = Data::smooth;
  bool refit = false;  ///< the taps arrive under other hyperparameters, a fit brings those above

  double length_scale() const { return length * kSide; }
  double noise() const { return std::sqrt(noise_variance); }
  double prior() const { return 1.0 + mean_ratio * mean_ratio; }  ///< variance, in squares of the signal
};

/// All of them, in the order of the table.
const std::vector<Case>& cases();

Points places(const Case& one);
Eigen::VectorXd values(const Case& one, const Points& places);

/// Where answers are compared: over the area, at and near taps, and far outside.
Points probes(const Case& one, const Points& places);

}  // namespace palpate::stability
