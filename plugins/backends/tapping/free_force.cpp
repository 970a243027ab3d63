// SPDX-License-Identifier: MIT
#include "tapping/free_force.hpp"

#include <algorithm>

namespace palpate::tapping {
namespace {

/// Strength of the prior of the slope: (noise of a reading / expected slope)^2 = (1.5 N / 50 N/m)^2, in m^2. It is
/// added to the sum of squared heights.
constexpr double kSlopePrior = 0.0009;
/// Weight of the tare, as a number of readings. The tare dominates the line while there are few readings.
constexpr double kTareWeight = 5.0;

}  // namespace

void FreeForce::tare(double zero) {
  tare_ = zero;
  samples_.clear();
}

FreeForce::LinearForce FreeForce::line(double height) const {
  double count = 0.0;
  double heights = 0.0;
  double forces = 0.0;
  const auto counts = [&](const Sample& one) {
    return one.height >= height + gap_ && one.height <= height + gap_ + kLength;
  };
  for (const Sample& one : samples_) {
    if (!counts(one)) continue;
    count += 1.0;
    heights += one.height;
    forces += one.force;
  }
  if (count == 0.0) return {tare_, height, 0.0};
  const double middle = heights / count;
  const double level = (forces + kTareWeight * tare_) / (count + kTareWeight);
  double square = kSlopePrior;
  double product = 0.0;
  for (const Sample& one : samples_) {
    if (!counts(one)) continue;
    square += (one.height - middle) * (one.height - middle);
    product += (one.height - middle) * (one.force - forces / count);
  }
  LinearForce out{level, middle, std::clamp(product / square, -kMostDrift, kMostDrift)};
  const double most = kMostOffset + kMostDrift * std::max(0.0, top_ - height);
  out.force += std::clamp(out.at(height), tare_ - most, tare_ + most) - out.at(height);
  return out;
}

}  // namespace palpate::tapping
