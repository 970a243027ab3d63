// SPDX-License-Identifier: MIT
// Beliefs, kernels and fits that are as a test wants them.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/fitting.hpp>
#include <palpate/kernel.hpp>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate::test {

/// A belief whose values a test writes down, and the quantities that were read.
class WrittenBelief final : public BeliefView {
 public:
  Candidates lines;
  TapsSoFar tapped;
  std::map<std::string, Eigen::VectorXd, std::less<>> arrays;
  HypothesisSample sample;
  mutable QuantitySet read;

  const Candidates& candidates() const override { return lines; }
  const TapsSoFar& taps() const override { return tapped; }
  const Eigen::VectorXd& values(std::string_view quantity) const override {
    read.insert(std::string(quantity));
    return arrays.at(std::string(quantity));
  }
  std::optional<double> scalar(std::string_view) const override { return std::nullopt; }
  const HypothesisSample& hypotheses() const override {
    read.insert(quantity::kHypotheses);
    return sample;
  }
};

/// Any function of two places, a covariance or not. It has no parameters.
class FormulaKernel final : public Kernel {
 public:
  using Place = Eigen::RowVector2d;
  explicit FormulaKernel(std::function<double(const Place& a, const Place& b)> formula)
      : formula_(std::move(formula)) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) out(i, j) = formula_(a.row(i), b.row(j));
    }
  }
  void variance(const PointsView& a, VectorOut out) const override {
    for (Eigen::Index i = 0; i < a.rows(); ++i) out(i) = formula_(a.row(i), a.row(i));
  }
  std::vector<KernelParameter> parameters() const override { return {}; }

 private:
  std::function<double(const Place&, const Place&)> formula_;
};

/// A fit that is due at every tap and always does the same.
class ChangingFit final : public Fitting {
 public:
  explicit ChangingFit(std::function<void(FitProblem&)> change) : change_(std::move(change)) {}
  bool due(int) const override { return true; }
  FitSummary fit(FitProblem& problem, Random&) const override {
    change_(problem);
    return {true, false, 0.0, 1, "changed"};
  }

 private:
  std::function<void(FitProblem&)> change_;
};

}  // namespace palpate::test
