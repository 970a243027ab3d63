// SPDX-License-Identifier: MIT
// How far off the reconstructed scene is expected to be, from what is believed alone: for `stop.expected_rmse`.
//
// A cell is on an object with probability p. If it is, its height above the desk is believed to be m, with variance v;
// if not, it is 0. So the square of its error is expected to be
//     p v + (1 - p) m^2    where it is reconstructed at m (p >= 1/2): either the height is wrong, or the outline,
//     p (v + m^2)          where it is reconstructed as desk,
// and v with `surface: single`, which has one process for object and desk. The expected rmse is the root of the mean
// of these over the candidates, and by Jensen's inequality not below the mean of the rmse.
//
// v is in the unit of `height.signal`, which in most configs is a convention and not a property of the object. With K
// the covariance of n heights r in signals, their level taken out, r^T K^-1 r / (n - 1) is the likeliest ratio of the
// true variance to that of the config (Rasmussen and Williams 2006, section 5.4.1). Few taps say little of it, a
// single one nothing: as a start, the relief of an object counts as being as large as its height, with the weight of
// one tap. With the mean square height h^2 in signals of the taps on an object, v is multiplied by
//     (h^2 + r^T K^-1 r) / n,
// and by n + 1 in place of n where no level is taken out.
//
// The errors of neighbouring cells go together, so that the rmse of one scene strays from what is expected, and a rule
// that looks after each tap stops where the belief is lucky: the expectation has to be within the bound with a margin.
// What strays most is an object that nobody has touched: it adds little to the expectation, and all of its height to
// the error. So a footprint that knows how probable such a thing is is asked, too, and then less of a margin will do.
// The constants were chosen on runs over seven scenes and checked on others; stopping_table in tests/benchmark makes
// the table.
#pragma once

#include "experiment/tap_belief.hpp"

#include <optional>

namespace palpate {

/// What is to be expected of the scene as it would be reconstructed now.
struct Forecast {
  std::optional<double> rmse = std::nullopt;  ///< metres; absent before the first hit, and where it is not finite
  std::optional<double> left = std::nullopt;  ///< that there is another object: see Footprint::left
};

/// How many times the expected rmse has to be below the bound where it is known what is left, and where it is not.
constexpr double kCaution = 1.55;
constexpr double kMoreCaution = 1.75;
/// The most that may be left: a probability.
constexpr double kMostLeft = 0.23;

/// Whether the rmse is below `bound` (metres) for what can be said.
bool good_enough(const Forecast& forecast, double bound);

/// The mean over all cells of the square that is expected of the error, in square metres: for cells that are on an
/// object with `probability`, and then at a height above the desk with `mean` and `variance`.
double expected_square(const Eigen::VectorXd& probability, const Eigen::VectorXd& mean,
                       const Eigen::VectorXd& variance);

/// By what the variances of `heights` are to be multiplied so that they fit its taps, of which those on an object
/// have the mean square `square` (square metres) above the desk.
double variance_ratio(const GaussianProcess& heights, double square);

/// Takes in the hits of a run, and forecasts.
class Forecaster {
 public:
  /// `height` above the desk, metres.
  void hit(double height);

  /// `belief` knows of the same contacts; what the surface is made of must have been asked for, once there is a hit.
  Forecast forecast(const TapBelief& belief) const;
  /// Contacts on an object so far; without one it forecasts nothing, and reads nothing of the belief.
  int hits() const { return hits_; }

 private:
  double squares_ = 0.0;  ///< of the heights
  int hits_ = 0;
};

}  // namespace palpate
