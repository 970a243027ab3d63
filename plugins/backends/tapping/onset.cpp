// SPDX-License-Identifier: MIT
// Onset and slope of the force in a descent.
#include "tapping/guarded_tap.hpp"

#include <algorithm>

namespace palpate::tapping {
namespace {

/// Length of the first window at the bottom of a descent, metres. If the rise starts above it, its length doubles.
constexpr double kFirstWindow = 0.02;
/// Largest accepted height of an onset above the bottom, as a fraction of the window's length.
constexpr double kInside = 0.6;

/// Returns the sum of squares that the best hinge with this kink explains: the reduction relative to a constant force.
/// Returns a negative number if the force would fall with the depth.
double explained(const std::vector<Sample>& samples, double kink) {
  const auto n = static_cast<double>(samples.size());
  double depth = 0.0;
  double force = 0.0;
  for (const Sample& one : samples) {
    depth += std::max(0.0, kink - one.height);
    force += one.force;
  }
  depth /= n;
  force /= n;
  double square = 0.0;
  double product = 0.0;
  for (const Sample& one : samples) {
    const double d = std::max(0.0, kink - one.height) - depth;
    square += d * d;
    product += d * (one.force - force);
  }
  return square == 0.0 || product < 0.0 ? -1.0 : product * product / square;
}

}  // namespace

double slope_below(const std::vector<Sample>& samples, double kink) {
  const auto n = static_cast<double>(samples.size());
  double depth = 0.0;
  for (const Sample& one : samples) depth += std::max(0.0, kink - one.height) / n;
  double square = 0.0;
  double product = 0.0;
  for (const Sample& one : samples) {
    const double d = std::max(0.0, kink - one.height) - depth;
    square += d * d;
    product += d * one.force;
  }
  return square > 0.0 ? product / square : 0.0;
}

std::optional<double> onset(const std::vector<Sample>& samples) {
  if (samples.size() < 4) return std::nullopt;
  std::vector<double> heights;
  for (const Sample& one : samples) heights.push_back(one.height);
  std::sort(heights.begin(), heights.end());
  heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
  if (heights.size() < 3) return std::nullopt;
  // Between neighbouring heights, the fit changes smoothly with the kink. The best height is therefore a neighbour of
  // the best kink.
  std::size_t best = 0;
  double most = -1.0;
  for (std::size_t i = 1; i < heights.size(); ++i) {
    const double here = explained(samples, heights[i]);
    if (here > most * (1.0 + 1e-12) || (most < 0.0 && here >= 0.0)) {
      most = here;
      best = i;
    }
  }
  if (!(most > 0.0)) return std::nullopt;
  double low = heights[best - 1];
  double high = heights[std::min(best + 1, heights.size() - 1)];
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i) {
    const double left = low + (high - low) / 3.0;
    const double right = high - (high - low) / 3.0;
    if (explained(samples, left) * (1.0 + 1e-12) >= explained(samples, right)) {
      high = right;
    } else {
      low = left;
    }
  }
  return 0.5 * (low + high);
}

std::optional<double> onset_of_descent(const std::vector<Sample>& descent) {
  if (descent.empty()) return std::nullopt;
  const double bottom = descent.back().height;
  for (double window = kFirstWindow;; window *= 2.0) {
    const auto first =
        std::find_if(descent.begin(), descent.end(), [&](const Sample& one) { return one.height < bottom + window; });
    const std::optional<double> found = onset({first, descent.end()});
    // A kink at the upper end means that the window starts within the rise.
    const bool inside = found && *found - bottom < kInside * window;
    if (inside || first == descent.begin()) return found;
  }
}

}  // namespace palpate::tapping
