// SPDX-License-Identifier: MIT
// Searches for the most probable sets of outliers, for one signal and one noise. outlier_posterior.hpp defines the
// symbols.
#pragma once

#include "gp/outlier_posterior.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate {

/// GP with one signal and one noise that treats all taps as inliers.
struct InlierGp {
  InlierGp(const OutlierProblem& problem, double surface_signal, double tap_noise);

  int taps() const { return static_cast<int>(solved_heights.size()); }
  /// Posterior of the constant in the mean, and the constant's term in the log weight of a set. All values are 0
  /// without a constant.
  struct ConstantPosterior {
    double precision = 0.0;
    double mean = 0.0;
    double log_weight = 0.0;
  };
  /// Returns the posterior of the constant for a set with the sums `ones` = 1^T A' 1 and `heights` = 1^T A' y.
  ConstantPosterior constant(double ones, double heights) const;

  double signal;
  double mean_deviation;           ///< standard deviation of the constant; 0 for none
  Eigen::MatrixXd inverse;         ///< A = K^-1; rows of redundant taps are 0
  Eigen::VectorXd solved_heights;  ///< A y
  Eigen::VectorXd solved_ones;     ///< A 1
  double log_evidence;             ///< log evidence of all heights without the constant, up to a common term
  Eigen::ArrayXd log_odds;         ///< log(pi_i b_i / (1 - pi_i)) per tap, up to a constant
  FactorReport report;
};

/// A set of outliers: the taps of its parent set and one more tap.
struct OutlierSet {
  int parent = -1;  ///< index of the parent; -1 for the empty set
  int tap = -1;
  int remainder = -1;  ///< index of the GP without the taps of the set; -1 if the set was not expanded
  double log_weight = 0.0;
};

/// Finds the most probable sets by a best-first search: it always expands the most probable set that is not expanded
/// yet. To expand a set means to compute the weights of all sets with one more tap. The remainder of a set is the GP
/// without the taps of the set.
///
/// Let A' be the matrix of a parent set. The set with the additional tap i has the matrix A' - u u^T with u = A'_:i /
/// sqrt(A'_ii). So the matrix of a set is A minus one product u u^T per tap of the set. A set shares all but the last
/// of its vectors u with its parent.
class OutlierSearch {
 public:
  OutlierSearch(const InlierGp& gp, const OutlierSearchLimits& limits);

  const std::vector<OutlierSet>& sets() const { return sets_; }
  double largest_log_weight() const { return largest_; }
  double next_weight() const { return next_weight_; }  ///< see OutlierPosterior
  /// Returns an index that is larger than the indices of all remainders of expanded sets.
  int expansions() const { return scratch_; }

  /// Returns the index of a set's remainder: the GP without the taps of the set. If the set was not expanded, the index
  /// is valid until the next call.
  int remainder_of(const OutlierSet& set);
  auto column(int remainder) const { return part(remainder, 0); }          ///< u of the last tap of the set
  auto solved_heights(int remainder) const { return part(remainder, 1); }  ///< A' y
  auto solved_ones(int remainder) const { return part(remainder, 2); }     ///< A' 1

 private:
  static constexpr int kParts = 4;

  Eigen::MatrixXd::ColXpr part(int remainder, int which) {
    return remainders_.col(Eigen::Index{kParts} * remainder + which);
  }
  Eigen::MatrixXd::ConstColXpr part(int remainder, int which) const {
    return remainders_.col(Eigen::Index{kParts} * remainder + which);
  }
  auto diagonal(int remainder) const { return part(remainder, 3); }  ///< diagonal of A'

  const OutlierSet& set_at(int index) const { return sets_[static_cast<std::size_t>(index)]; }
  void compute_remainder(const OutlierSet& set, int to);
  void weigh_extensions(int remainder, Eigen::ArrayXd& out) const;
  void search(const OutlierSearchLimits& limits);
  void extend(int parent, const Eigen::ArrayXd& log_weights, std::size_t expansions_left);
  void add(const OutlierSet& set, const std::uint64_t* bits);
  bool contains(const std::uint64_t* bits) const;

  const InlierGp& gp_;
  std::size_t words_;  ///< number of 64-bit words per set, with one bit per tap
  double log_min_summed_, log_min_expanded_;
  std::vector<OutlierSet> sets_;
  std::vector<std::uint64_t> bits_;
  std::vector<int> waiting_;         ///< sets that may be expanded, the most probable first
  Eigen::MatrixXd remainders_;       ///< kParts columns per remainder
  std::vector<double> log_weights_;  ///< log weight of the set per remainder, without the term of the constant
  int scratch_;                      ///< index of the remainder of sets that were not expanded
  double largest_ = 0.0;
  double next_weight_ = 0.0;
};

}  // namespace palpate
