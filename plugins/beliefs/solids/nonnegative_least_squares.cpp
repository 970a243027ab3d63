// SPDX-License-Identifier: MIT
#include "solids/nonnegative_least_squares.hpp"

#include <cmath>

namespace palpate {

using Eigen::Index;
using Eigen::VectorXd;

void NonnegativeSolver::append(const Eigen::MatrixXd& s, const VectorXd& d) {
  const Index n = d_.size();
  const Index m = d.size();
  s_.conservativeResize(n + m, n + m);
  s_.rightCols(m) = s;
  s_.bottomRows(m).leftCols(n) = s.topRows(n).transpose();
  d_.conservativeResize(n + m);
  d_.tail(m) = d;
  is_.resize(static_cast<std::size_t>(n + m), UnknownState::free);
}

bool NonnegativeSolver::hold(int unknown) {
  const bool regular = factor_.append(VectorXd(s_.col(unknown)(held_)), s_(unknown, unknown));
  is_[static_cast<std::size_t>(unknown)] = regular ? UnknownState::held : UnknownState::aside;
  if (regular) {
    held_.push_back(unknown);
  } else {
    ++set_aside_;
  }
  return regular;
}

void NonnegativeSolver::hold_only(const std::vector<int>& unknowns) {
  for (const int one : held_) is_[static_cast<std::size_t>(one)] = UnknownState::free;
  held_.clear();
  factor_.clear();
  for (const int one : unknowns) hold(one);
}

VectorXd NonnegativeSolver::unbounded() const {
  VectorXd out = d_(held_);
  for (int i = 0; i < factor_.size(); ++i) out(i) = (out(i) - factor_.row(i).dot(out.head(i))) / factor_.pivot(i);
  for (int i = factor_.size() - 1; i >= 0; --i) {
    out(i) /= factor_.pivot(i);
    out.head(i) -= out(i) * factor_.row(i);
  }
  return out;
}

void NonnegativeSolver::settle() {
  while (true) {
    const VectorXd best = unbounded();
    // Moves the values towards `best` until the first value reaches 0. That unknown is released, even if rounding
    // leaves its value positive.
    double share = 1.0;
    Index first = -1;
    for (Index i = 0; i < best.size(); ++i) {
      if (best(i) > 0.0) continue;
      const double way = values_(i) > 0.0 ? values_(i) / (values_(i) - best(i)) : 0.0;
      if (first >= 0 && !(way < share)) continue;
      share = way;
      first = i;
    }
    if (first < 0) {
      values_ = best;
      return;
    }
    std::vector<int> kept;
    VectorXd left = VectorXd::Zero(d_.size());
    for (Index i = 0; i < best.size(); ++i) {
      const double value = values_(i) + share * (best(i) - values_(i));
      if (i == first || !(value > 0.0)) continue;
      kept.push_back(held_[static_cast<std::size_t>(i)]);
      left(kept.back()) = value;
    }
    hold_only(kept);
    values_ = left(held_);
  }
}

void NonnegativeSolver::solve() {
  if (d_.size() == 0) return;
  const double rounding = 1e-13 * d_.cwiseAbs().maxCoeff();
  const auto cost = [&] { return -0.5 * values_.dot(VectorXd(d_(held_))); };  // valid only at an optimum
  std::vector<bool> refused(is_.size());
  while (true) {
    const VectorXd pull = d_ - s_(Eigen::all, held_) * values_;
    int next = -1;
    for (int i = 0; i < static_cast<int>(is_.size()); ++i) {
      const auto one = static_cast<std::size_t>(i);
      if (is_[one] == UnknownState::free && !refused[one] && pull(i) > (next < 0 ? rounding : pull(next))) next = i;
    }
    if (next < 0) return;
    const std::vector<int> before = held_;
    const VectorXd values = values_;
    const double least = cost();
    if (!hold(next)) continue;
    values_.conservativeResize(values.size() + 1);
    values_.tail(1).setZero();
    settle();
    // The quadratic form must decrease by more than rounding errors. Otherwise the same set of unknowns, held in
    // another order, could count as an improvement.
    constexpr double kMinRelativeDecrease = 1e-13;
    if (cost() < least - kMinRelativeDecrease * std::abs(least)) continue;
    hold_only(before);
    values_ = values;
    refused[static_cast<std::size_t>(next)] = true;
  }
}

}  // namespace palpate
