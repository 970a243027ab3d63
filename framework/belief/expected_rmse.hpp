// SPDX-License-Identifier: MIT
// The RMSE of the reconstructed scene that the belief expects, without the truth: for `stop.expected_rmse`.
//
// A cell is on an object with probability p. If it is, its height above the desk is believed to be m, with variance v;
// if not, it is 0. So the square of its error is expected to be
//     p v + (1 - p) m^2    where it is reconstructed at m (p >= 1/2): either the height is wrong, or the outline,
//     p (v + m^2)          where it is reconstructed as desk,
// and v with `surface: single`, which has one process for object and desk. The expected rmse is the root of the mean
// of these over the candidates, and by Jensen's inequality not below the mean of the rmse.
//
// v is in the unit of `belief.height.signal`, which in most configs is a convention and not a property of the object.
// With K the covariance of n heights r in signals, their level taken out, r^T K^-1 r / (n - 1) is the likeliest ratio
// of the true variance to that of the config (Rasmussen and Williams 2006, section 5.4.1). Few taps say little of it, a
// single one nothing: as a start, the relief of an object counts as being as large as its height, with the weight of
// one tap. With the mean square height h^2 in signals of the taps on an object, v is multiplied by
//     (h^2 + r^T K^-1 r) / n,
// and by n + 1 in place of n where no level is taken out.
#pragma once

#include "belief/metrics.hpp"
#include "gp/gaussian_process.hpp"

#include <palpate/types.hpp>

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpate {

/// Returns the mean over all cells of the expected square error, square metres: for cells that are on an object with
/// `probability`, and then at a height above the desk with `mean` and `variance`.
double expected_square(const Eigen::VectorXd& probability, const Eigen::VectorXd& mean,
                       const Eigen::VectorXd& variance);

/// Returns the factor by which the variances of `heights` fit its taps, if those on an object have the mean square
/// `square` (square metres) above the desk.
double variance_ratio(const GaussianProcess& heights, double square);

/// Returns the expected RMSE over the candidates, metres; nullopt before the first object contact, and where it is not
/// finite. `variance`: of maps.height, square metres; `heights`: the GP behind both, null before it is built;
/// `object_contacts`: all that it has learnt from.
std::optional<double> expected_rmse(const SurfaceMaps& maps, const Eigen::VectorXd& variance,
                                    const GaussianProcess* heights, const std::vector<Touch>& object_contacts);

}  // namespace palpate
