// SPDX-License-Identifier: MIT
// Minimises a quadratic form over nonnegative unknowns, whose number grows:
//
//     1/2 * l' * S * l - d' * l,   l >= 0
//
// It uses the active-set method of Lawson and Hanson (Solving Least Squares Problems, 1974, chapter 23), started from
// the last optimum. A step changes the set of positive unknowns, and is kept only if it lowers the form by more than
// rounding. So no set occurs twice, and the loop ends without a limit on the number of steps.
#pragma once

#include "gp/factor.hpp"

#include <Eigen/Core>

#include <vector>

namespace palpate {

class NonnegativeSolver {
 public:
  /// Appends m unknowns to the existing n: `s` holds the last m columns of S (n + m rows), `d` has m values.
  void append(const Eigen::MatrixXd& s, const Eigen::VectorXd& d);
  void solve();

  /// Returns the positive unknowns in the order in which they became positive, and their values.
  const std::vector<int>& held() const { return held_; }
  const Eigen::VectorXd& values() const { return values_; }
  /// Returns the number of excluded unknowns. They stay 0, because with them the held part of S is not positive
  /// definite in double precision.
  int redundant_taps() const { return set_aside_; }

 private:
  enum class UnknownState { free, held, aside };
  /// Adds an unknown to the held ones. If their part of S is then not positive definite, excludes it and returns false.
  bool hold(int unknown);
  /// Holds exactly these unknowns.
  void hold_only(const std::vector<int>& unknowns);
  /// Returns the optimal values of the held unknowns without the bounds.
  Eigen::VectorXd unbounded() const;
  /// Moves to the optimum of the held unknowns; releases each one that reaches 0 on the way.
  void settle();

  Eigen::MatrixXd s_;
  Eigen::VectorXd d_;
  std::vector<UnknownState> is_;
  std::vector<int> held_;
  Eigen::VectorXd values_;
  Factor factor_;  ///< factor of the part of S with the held rows and columns
  int set_aside_ = 0;
};

}  // namespace palpate
