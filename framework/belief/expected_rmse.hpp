// SPDX-License-Identifier: MIT
// Expected RMSE of the reconstruction, computed from the belief without knowledge of the true scene. The stop rule
// `expected_rmse` uses it.
//
// A cell is on an object with probability p. On an object, its height above the desk has mean m and variance v;
// otherwise the height is 0. The expected squared error is
//     p v + (1 - p) m^2    if the cell is reconstructed with the height m, because p >= 1/2;
//     p (v + m^2)          if the cell is reconstructed as desk.
// With `surface: single`, which has one GP for object and desk, the expected squared error is v. The expected RMSE is
// the root of the mean of these squared errors over the candidates. By Jensen's inequality it is at least the mean
// RMSE.
//
// v scales with `belief.height.signal`, which most configs set by convention and not from the object. Let r be n
// measured heights, divided by the signal and without their constant level, and let K be their covariance. Then r^T
// K^-1 r / (n - 1) is the most likely ratio of the true variance to the configured variance (Rasmussen and Williams
// 2006, section 5.4.1). A few taps determine this ratio poorly, and a single tap not at all. So the ratio has a prior
// with the weight of one tap. The prior assumes that the heights of an object vary by as much as the height of the
// object itself. Let h^2 be the mean squared height of the object taps, divided by the squared signal. Then v is
// multiplied by
//     (h^2 + r^T K^-1 r) / n,
// The divisor is n + 1 instead of n if no constant level is removed.
#pragma once

#include "belief/metrics.hpp"
#include "gp/gaussian_process.hpp"

#include <palpate/types.hpp>

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace palpate {

/// Returns the mean over all cells of the expected squared error, square metres. A cell is on an object with
/// `probability`. Its height above the desk then has `mean` and `variance`.
double expected_square(const Eigen::VectorXd& probability, const Eigen::VectorXd& mean,
                       const Eigen::VectorXd& variance);

/// Returns the factor by which the variances of the GP `heights` must be multiplied to agree with the heights of its
/// taps. `square`: mean squared height of the object taps above the desk, square metres.
double variance_ratio(const GaussianProcess& heights, double square);

/// Returns the expected RMSE over the candidates, metres; nullopt before the first object contact, or if the result is
/// not finite. `variance`: variance of maps.height, square metres; `heights`: the GP that computed maps.height and
/// `variance`, null before this GP is built; `object_contacts`: all contacts with objects.
std::optional<double> expected_rmse(const SurfaceMaps& maps, const Eigen::VectorXd& variance,
                                    const GaussianProcess* heights, const std::vector<Touch>& object_contacts);

}  // namespace palpate
