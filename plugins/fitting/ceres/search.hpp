// SPDX-License-Identifier: MIT
// Finds the largest value of an objective: a coarse look around, then quasi-Newton ascent.
#pragma once

#include "objective.hpp"

#include <palpate/random.hpp>

#include <string>
#include <vector>

namespace palpate::fitting {

/// A place of the search and what is known of it.
struct Spot {
  Eigen::VectorXd x;
  double value = 0.0;
  bool valid = false;  ///< value and gradient were finite on the whole way
  std::string reason;  ///< why the ascent ended
};

/// Ascends from `start` by BFGS with a Wolfe line search (ceres::GradientProblem), until no entry of the gradient in
/// the coordinates of `metric` is above `tolerance`. x = start + metric u, so a metric near the square root of the
/// inverse curvature saves steps; identity where nothing is known.
Spot ascend(Objective& objective, const Eigen::VectorXd& start, const Eigen::MatrixXd& metric, double tolerance);

/// A metric from the curvature at `spot`, by differences of gradients.
Eigen::MatrixXd metric_at(Objective& objective, const Eigen::VectorXd& spot);

/// A start that does not depend on luck: likelihoods over a few length scales and noises, signals at their best, and
/// those of `now`; the best of them. A likelihood has a wide flat region of pure noise, from which no ascent returns.
Eigen::VectorXd look_around(Objective& objective, const Model& model, const Eigen::VectorXd& now,
                            const std::vector<Expectation>& expectations);

/// Within two spreads of what is expected, uniformly.
Eigen::VectorXd random_start(const std::vector<Expectation>& expectations, Random& random);

}  // namespace palpate::fitting
