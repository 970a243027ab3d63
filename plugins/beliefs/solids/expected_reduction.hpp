// SPDX-License-Identifier: MIT
// Expected reduction of the uncertainty of a surface by one tap.
//
// The signed distance (positive outwards) from the surface of the most probable assembly to the true surface is
// modelled as a GP. Its mean is the mean of the residual GP; its covariance is
//
//     k(x, x') + (1 / K) * sum over assemblies j of d_j(x) * d_j(x')
//
// where k is the residual GP's prior, and K is the number of assemblies. d_j(x) is the signed distance from the surface
// of the most probable assembly to that of assembly j near x, clipped to 2 cm. So a touch also reduces the uncertainty
// at other positions: at near ones because the residual GP is smooth, and at others where the assemblies deviate
// together. With an additional contact at a position y, with the same noise, the variance is
//
//     Var(x | y) = Var(x) - Cov(x, y)^2 / (Var(y) + noise^2),
//
// for any result of the tap. The reduction is the mean over the surface of sd(x) - sd(x | y). This is active learning
// by Cohn's criterion (Cohn 1996), with standard deviations instead of variances.
#pragma once

#include "solids/assembly_sampler.hpp"
#include "solids/residual_gp.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace palpate {

/// Returns for each place the reduction by a touch there. The reduction is the decrease of the mean standard deviation
/// over all places, metres, between 0 and this mean. All places must be near the surface of the most probable assembly.
/// The work grows with the square of their number. Adds jitter, a variance in square metres, and redundant rows to
/// `report`. Never throws.
Eigen::VectorXd expected_reductions(const AssemblySampler& solids, const ResidualGp& residual_gp,
                                    const ResidualGp::Places& places, FactorReport* report = nullptr);

/// A subset of the places, evenly spread: the first place in each cube for each direction of the normal. The side of
/// the cubes is at least 8 mm, and large enough that at most `most` places remain. `stands_for` maps each place to the
/// index of its representative.
struct Representatives {
  ResidualGp::Places places;
  std::vector<std::size_t> stands_for;
};
Representatives representatives(const ResidualGp::Places& places, std::size_t most);

}  // namespace palpate
