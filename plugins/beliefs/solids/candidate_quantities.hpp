// SPDX-License-Identifier: MIT
// Values of candidate lines under the current solids and residual GP.
#pragma once

#include "solids/assembly_sampler.hpp"
#include "solids/candidate_lines.hpp"
#include "solids/residual_gp.hpp"

#include <palpate/belief_quantities.hpp>
#include <palpate/random.hpp>

#include <Eigen/Core>

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace palpate {

/// One value per line for each quantity. A quantity is empty before compute(), and if `reads` does not contain it.
class CandidateQuantities {
 public:
  /// `desk`: height of the desk, metres.
  explicit CandidateQuantities(double desk) : desk_(desk) {}

  /// Computes the quantities of `lines` that are in `reads`. `random` is used for expected_discovery.
  void compute(const SampledLines& lines, const AssemblySampler& solids, const ResidualGp& residual_gp,
               const QuantitySet& reads, Random random);

  /// Returns `reads` of the last compute(). It may contain names of quantities without an array.
  const QuantitySet& reads() const { return reads_; }
  /// Returns the computed arrays by the names of their quantities.
  const std::map<std::string, Eigen::VectorXd, std::less<>>& arrays() const { return arrays_; }

  /// Return the number of variances that rounding made negative in the last compute(), and the report of its
  /// factorisations.
  int variances_clamped() const { return clamped_; }
  const FactorReport& factors() const { return factors_; }

 private:
  Line line(const SampledLines& lines, Eigen::Index index) const;
  void find_contacts(const SampledLines& lines, const Assembly& best);
  Eigen::VectorXd deviations(const ResidualGp& residual_gp);
  /// Returns (deviation / largest deviation)^2 for lines along the surface normal, else 0.
  Eigen::VectorXd uncertainty(const Eigen::VectorXd& deviations) const;
  Eigen::VectorXd reductions(const AssemblySampler& solids, const ResidualGp& residual_gp);
  Eigen::VectorXd discovery(const SampledLines& lines, const AssemblySampler& solids, Random random) const;

  double desk_;
  QuantitySet reads_;
  std::map<std::string, Eigen::VectorXd, std::less<>> arrays_;
  /// metres along each line to the most probable assembly, to the desk or to the end of the line
  Eigen::VectorXd distance_;
  ResidualGp::Places places_;         ///< points where lines meet the most probable assembly
  std::vector<Eigen::Index> meets_;   ///< index of the line of each point in places_
  Eigen::VectorXd incidence_cosine_;  ///< 0 for lines that meet no object
  int clamped_ = 0;
  FactorReport factors_;
};

}  // namespace palpate
