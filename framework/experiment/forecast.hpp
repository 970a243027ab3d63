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
//     (h^2 + r^T K^-1 r) / n.
//
// Two things the expectation cannot see. The errors of neighbouring cells go together, so that the rmse of one scene
// strays from what is expected, and a rule that looks after each tap stops where the belief is lucky: the expectation
// has to be within the bound with a margin, kCaution. And a belief about the object that was touched says nothing of
// another one, or of a leg that no tap has led to: so much of the area has to be near a tap that little room is left
// for them. Both numbers were chosen on runs over seven scenes, and checked on others: stopping_table in
// tests/benchmark makes the table.
#pragma once

#include "experiment/tap_belief.hpp"

#include <optional>

namespace palpate {

/// What is to be expected of the scene as it would be reconstructed now.
struct Forecast {
  std::optional<double> rmse;  ///< metres; absent before the first hit, and where it is not finite
  double unsearched = 1.0;     ///< share of the candidates that lie farther than kSearched from every contact
};

/// How far around it a contact speaks for: half the width of an object that would not be overlooked, metres.
constexpr double kSearched = 0.03;

/// How many times the expected rmse has to be below the bound.
constexpr double kCaution = 1.75;

/// Whether the rmse is below `bound` (metres) for what can be said, at most `unsearched` of the area left aside.
bool good_enough(const Forecast& forecast, double bound, double unsearched);

/// The mean over all cells of the square that is expected of the error, in square metres: for cells that are on an
/// object with `probability`, and then at a height above the desk with `mean` and `variance`.
double expected_square(const Eigen::VectorXd& probability, const Eigen::VectorXd& mean,
                       const Eigen::VectorXd& variance);

/// By what the variances of `heights` are to be multiplied so that they fit its taps, of which those on an object have
/// the mean square `square` (square metres) above the desk.
double variance_ratio(const Process& heights, double square);

/// Takes in the contacts of a run, and forecasts.
class Forecaster {
 public:
  /// `candidates` must outlive it.
  explicit Forecaster(const Candidates& candidates);

  /// A contact at `place`; `hit` is its height above the desk, metres, if it is on an object.
  void observe(const Target& place, std::optional<double> hit);

  /// `belief` knows of the same contacts; builds the models that the reconstruction needs.
  Forecast forecast(const TapBelief& belief) const;

 private:
  const Candidates& candidates_;
  Eigen::Array<bool, Eigen::Dynamic, 1> searched_;  ///< of each candidate: a contact is near
  double squares_ = 0.0;                            ///< of the heights of the hits
  int hits_ = 0;
};

}  // namespace palpate
