// SPDX-License-Identifier: MIT
// Beliefs, kernels and fits that are as a test wants them.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/fitting.hpp>
#include <palpate/kernel.hpp>
#include <palpate/surface_belief.hpp>

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace palpate::test {

/// Maps as they are written down, over 23 cm by 23 cm, and what was read of them.
class WrittenBelief final : public Belief {
 public:
  int count = 0;  ///< of taps
  Area desk{0.23, 0.23};
  Points places;
  Eigen::VectorXd u, w, p, mean, variance;
  OutlineSample sample;
  std::vector<Target> aims;
  std::vector<Touch> contacts;
  mutable Quantities read;

  const Points& candidates() const override { return places; }
  Area area() const override { return desk; }
  int taps() const override { return count; }
  int initial_taps() const override { return std::min(count, 3); }
  const std::vector<Target>& targets() const override { return aims; }
  const std::vector<Touch>& touches() const override { return contacts; }
  const Eigen::VectorXd& uncertainty() const override { return seen(Quantity::uncertainty, u); }
  const Eigen::VectorXd& weight() const override { return seen(Quantity::weight, w); }
  const Eigen::VectorXd& probability() const override { return seen(Quantity::probability, p); }
  const OutlineSample& outlines() const override {
    read = read | Quantity::outlines;
    return sample;
  }
  const Eigen::VectorXd& height_mean() const override { return seen(Quantity::height, mean); }
  const Eigen::VectorXd& height_variance() const override { return seen(Quantity::height, variance); }

 private:
  const Eigen::VectorXd& seen(Quantity one, const Eigen::VectorXd& map) const {
    read = read | one;
    return map;
  }
};

/// A belief from any side that is written down, and what was read of it.
class WrittenSurface final : public SurfaceBelief {
 public:
  int count = 0;  ///< of taps
  std::vector<Approach> lines;
  Eigen::VectorXd ways, found, taken, sigma, square;
  mutable Quantities read;

  const std::vector<Approach>& approaches() const override { return lines; }
  int taps() const override { return count; }
  const Eigen::VectorXd& way() const override { return ways; }
  const Eigen::VectorXd& expected_discovery() const override { return seen(Quantity::expected_discovery, found); }
  const Eigen::VectorXd& std_reduction() const override { return seen(Quantity::std_reduction, taken); }
  const Eigen::VectorXd& deviation() const override { return seen(Quantity::deviation, sigma); }
  const Eigen::VectorXd& incidence_cosine() const override { return seen(Quantity::deviation, square); }

 private:
  const Eigen::VectorXd& seen(Quantity one, const Eigen::VectorXd& of) const {
    read = read | one;
    return of;
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
