// SPDX-License-Identifier: MIT
// By how much a poke is expected to lower what is not known of a surface.
//
// The surface lies outside that of the most probable assembly by an offset that is taken for normal, with mean that
// of the residual GP and the covariance
//
//     k(x, x') + (1 / K) sum over assemblies of d_j(x) d_j(x')
//
// k is the residual GP's prior, and d_j(x) how far outside the surface of assembly j lies there, none more than 2 cm.
// So touches at one place tell of others as far as the residual GP is smooth and as the assemblies agree on what
// belongs together. Given all contacts, and one more with their noise at a place y,
//
//     Var(x | y) = Var(x) - Cov(x, y)^2 / (Var(y) + noise^2),
//
// whatever is found there, and what a poke takes off is the mean over the surface of sd(x) - sd(x | y): in the words of
// the design of experiments, active learning by Cohn's criterion (Cohn 1996), of deviations instead of variances.
#pragma once

#include "solids/residual_gp.hpp"
#include "solids/solids.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace palpate {

/// For each place, near the surface of the most probable assembly, by how much the mean standard deviation over all
/// of them falls when the surface is touched there, metres: from 0 to the mean itself. The work grows with the square
/// of the number of places. Adds to `report` what rounding made necessary, a variance in square metres. Never throws.
Eigen::VectorXd expected_reductions(const Solids& solids, const ResidualGp& residual_gp,
                                    const ResidualGp::Places& places, FactorReport* report = nullptr);

/// Some of the places, evenly: in each cube the first on each side of a wall, the cubes (8 mm or larger) such that it
/// is at most `most`. `stands_for` has for each place the number of that of its cube and side.
struct Representatives {
  ResidualGp::Places places;
  std::vector<std::size_t> stands_for;
};
Representatives representatives(const ResidualGp::Places& places, std::size_t most);

}  // namespace palpate
