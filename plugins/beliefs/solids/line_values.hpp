// SPDX-License-Identifier: MIT
// The quantities of lines by the solids and the residual GP that are believed.
#pragma once

#include "solids/line_sampler.hpp"
#include "solids/residual_gp.hpp"
#include "solids/solids.hpp"

#include <palpate/belief_quantities.hpp>
#include <palpate/random.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// N values of each quantity that is read.
class LineValues {
 public:
  /// `desk`: its height, metres.
  explicit LineValues(double desk) : desk_(desk) {}

  /// Computes the quantities of `lines` that are in `reads`. `random`: of expected_discovery.
  void compute(const SampledLines& lines, const Solids& solids, const ResidualGp& residual_gp, const QuantitySet& reads,
               Random random);

  /// Returns the quantities of the last compute(), among them names that have no array.
  const QuantitySet& reads() const { return reads_; }
  /// Returns those of them that have arrays.
  QuantitySet available() const;
  /// Returns the array of a quantity; null for names that have none, empty unless the last compute() read the quantity.
  const Eigen::VectorXd* find(std::string_view quantity) const;

  /// Number of variances of the last compute() that rounding had taken below 0, and factorisations of all of them.
  int variances_clamped() const { return clamped_; }
  const FactorReport& factors() const { return factors_; }

 private:
  Line line(const SampledLines& lines, Eigen::Index index) const;
  void find_contacts(const SampledLines& lines, const Assembly& best);
  void compute_deviations(const ResidualGp& residual_gp);
  void compute_reductions(const Solids& solids, const ResidualGp& residual_gp);
  void compute_discovery(const SampledLines& lines, const Solids& solids, Random random);

  double desk_;
  QuantitySet reads_;
  Eigen::VectorXd distance_;          ///< along each line to the most probable assembly, or to the end
  ResidualGp::Places places_;         ///< where lines meet it
  std::vector<Eigen::Index> meets_;   ///< the lines that meet it there
  Eigen::VectorXd incidence_cosine_;  ///< 0 without an object
  Eigen::VectorXd surface_std_;       ///< likewise
  Eigen::VectorXd uncertainty_;       ///< (surface_std / largest)^2 of lines along the normal, else 0
  Eigen::VectorXd std_reduction_, expected_discovery_;
  int clamped_ = 0;
  FactorReport factors_;
};

}  // namespace palpate
