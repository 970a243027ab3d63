// SPDX-License-Identifier: MIT
// The least of a quadratic form whose unknowns are not negative, and become more:
//
//     1/2 l' S l - d' l,   l >= 0
//
// By the active-set method of Lawson and Hanson (Solving Least Squares Problems, 1974, chapter 23), each time from the
// last optimum. It goes from one set of unknowns that are not 0 to the next, and each lowers the form by more than
// rounding, or is not taken: no set comes twice, and no bound on their number is needed.
#pragma once

#include "gp/factor.hpp"

#include <Eigen/Core>

#include <vector>

namespace palpate {

class Nonnegative {
 public:
  /// More unknowns, m to the n before: `s` are the last m columns of S, n + m rows, `d` has m values.
  void append(const Eigen::MatrixXd& s, const Eigen::VectorXd& d);
  void solve();

  /// The unknowns that are not 0, in the order in which they became so, and their values.
  const std::vector<int>& held() const { return held_; }
  const Eigen::VectorXd& values() const { return values_; }
  /// Unknowns that stay 0 because, with those that were held, S was not positive definite in double precision.
  int redundant_taps() const { return set_aside_; }

 private:
  enum class Is { free, held, aside };
  /// Adds one to those that are held; where their part of S is not positive definite then, sets it aside: false.
  bool hold(int unknown);
  /// Holds these again, and no others.
  void hold_only(const std::vector<int>& unknowns);
  /// What the values of those held would be if they might be negative.
  Eigen::VectorXd unbounded() const;
  /// To the optimum of those held; lets go whoever becomes 0 on the way.
  void settle();

  Eigen::MatrixXd s_;
  Eigen::VectorXd d_;
  std::vector<Is> is_;
  std::vector<int> held_;
  Eigen::VectorXd values_;
  Factor factor_;  ///< of the part of S that belongs to those held
  int set_aside_ = 0;
};

}  // namespace palpate
