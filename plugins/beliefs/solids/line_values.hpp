// SPDX-License-Identifier: MIT
// Values of candidate lines under the current solids and residual GP.
#pragma once

#include "solids/line_sampler.hpp"
#include "solids/residual_gp.hpp"
#include "solids/solids.hpp"

#include <palpate/belief_quantities.hpp>
#include <palpate/random.hpp>

#include <Eigen/Core>

#include <functional>
#include <map>
#include <string>
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

  /// Returns the quantities of the last compute(), among them names that have no array.
  const QuantitySet& reads() const { return reads_; }
  /// Returns the arrays of those of them that have one.
  const std::map<std::string, Eigen::VectorXd, std::less<>>& arrays() const { return arrays_; }

  /// Return the number of variances that rounding made negative in the last compute(), and the report of its
  /// factorisations.
  int variances_clamped() const { return clamped_; }
  const FactorReport& factors() const { return factors_; }

 private:
  Line line(const SampledLines& lines, Eigen::Index index) const;
  void find_contacts(const SampledLines& lines, const Assembly& best);
  Eigen::VectorXd deviations(const ResidualGp& residual_gp);
  /// Returns (deviation / largest)^2 of lines along the normal, else 0.
  Eigen::VectorXd uncertainty(const Eigen::VectorXd& deviations) const;
  Eigen::VectorXd reductions(const Solids& solids, const ResidualGp& residual_gp);
  Eigen::VectorXd discovery(const SampledLines& lines, const Solids& solids, Random random) const;

  double desk_;
  QuantitySet reads_;
  std::map<std::string, Eigen::VectorXd, std::less<>> arrays_;
  Eigen::VectorXd distance_;          ///< along each line to the most probable assembly, or to the end
  ResidualGp::Places places_;         ///< where lines meet it
  std::vector<Eigen::Index> meets_;   ///< the lines that meet it there
  Eigen::VectorXd incidence_cosine_;  ///< 0 without an object
  int clamped_ = 0;
  FactorReport factors_;
};

}  // namespace palpate
