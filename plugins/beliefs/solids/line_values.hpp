// SPDX-License-Identifier: MIT
// Values of candidate lines under the current solids and residual GP.
#pragma once

#include "solids/line_sampler.hpp"
#include "solids/residual_gp.hpp"
#include "solids/solids.hpp"

#include <palpate/quantity.hpp>
#include <palpate/random.hpp>

#include <Eigen/Core>

#include <vector>

namespace palpate {

/// N values per quantity. A quantity is empty before compute(), and if `reads` does not contain it.
class LineValues {
 public:
  /// `desk`: its height, metres.
  explicit LineValues(double desk) : desk_(desk) {}

  /// Computes the quantities of `lines` that are in `reads`. `random` is used for expected_discovery.
  void compute(const SampledLines& lines, const Solids& solids, const ResidualGp& residual_gp, const QuantitySet& reads,
               Random random);

  /// Returns the values of a quantity; null if this class does not compute it.
  const Eigen::VectorXd* find(std::string_view quantity) const;

  /// Return the number of variances that rounding made negative in the last compute(), and the report of its
  /// factorisations.
  int variances_clamped() const { return clamped_; }
  const FactorReport& factors() const { return factors_; }

 private:
  Line line(const SampledLines& lines, Eigen::Index index) const;
  void find_contacts(const SampledLines& lines, const Assembly& best);
  void compute_deviations(const ResidualGp& residual_gp);
  void compute_reductions(const Solids& solids, const ResidualGp& residual_gp);
  void compute_discovery(const SampledLines& lines, const Solids& solids, Random random);

  double desk_;
  Eigen::VectorXd distance_;          ///< distance along each line to the most probable assembly, or to the end
  ResidualGp::Places places_;         ///< where lines meet that assembly
  std::vector<Eigen::Index> meets_;   ///< indices of the lines that meet it
  Eigen::VectorXd incidence_cosine_;  ///< 0 for lines that meet no object
  Eigen::VectorXd surface_std_;       ///< 0 for lines that meet no object
  Eigen::VectorXd uncertainty_;       ///< (surface_std / largest surface_std)^2 for lines along the normal, else 0
  Eigen::VectorXd std_reduction_, expected_discovery_;
  int clamped_ = 0;
  FactorReport factors_;
};

}  // namespace palpate
