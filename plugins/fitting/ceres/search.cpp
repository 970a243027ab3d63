// SPDX-License-Identifier: MIT
// The only file that sees Ceres.
#include "search.hpp"

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate::fitting {
namespace {

/// The objective, turned over and in the coordinates of a metric, as Ceres wants it.
class Descent final : public ceres::FirstOrderFunction {
 public:
  Descent(Objective& objective, const Eigen::VectorXd& start, const Eigen::MatrixXd& metric)
      : objective_(objective), start_(start), metric_(metric) {}

  int NumParameters() const override { return objective_.size(); }

  bool Evaluate(const double* u, double* cost, double* gradient) const override {
    const Eigen::VectorXd x = start_ + metric_ * Eigen::Map<const Eigen::VectorXd>(u, start_.size());
    Eigen::VectorXd slope(start_.size());
    if (!objective_.evaluate(x.data(), cost, gradient != nullptr ? slope.data() : nullptr)) return false;
    *cost = -*cost;
    if (gradient != nullptr) {
      Eigen::Map<Eigen::VectorXd>(gradient, start_.size()).noalias() = -metric_.transpose() * slope;
    }
    return true;
  }

 private:
  Objective& objective_;
  const Eigen::VectorXd& start_;
  const Eigen::MatrixXd& metric_;
};

std::string first_sentence(const std::string& message) { return message.substr(0, message.find_first_of(".\n")); }

Eigen::VectorXd within_limits(Eigen::VectorXd x, const std::vector<Expectation>& expectations) {
  for (std::size_t i = 0; i < expectations.size(); ++i) {
    double& one = x(static_cast<Eigen::Index>(i));
    one = std::clamp(one, expectations[i].least, expectations[i].most);
  }
  return x;
}

}  // namespace

Spot ascend(Objective& objective, const Eigen::VectorXd& start, const Eigen::MatrixXd& metric, double tolerance) {
  ceres::GradientProblemSolver::Options options;
  options.logging_type = ceres::SILENT;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = 200;
  options.gradient_tolerance = tolerance;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-10;
  const ceres::GradientProblem problem(new Descent(objective, start, metric));
  Eigen::VectorXd u = Eigen::VectorXd::Zero(start.size());
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, u.data(), &summary);
  const Eigen::VectorXd x = start + metric * u;
  // An ascent that ends in trouble has still come as far as it says, but for one that could not begin.
  const bool valid = !summary.iterations.empty() && std::isfinite(summary.final_cost) && x.allFinite();
  return {x, -summary.final_cost, valid, first_sentence(summary.message)};
}

Eigen::MatrixXd metric_at(Objective& objective, const Eigen::VectorXd& spot) {
  constexpr double kStep = 1e-3;      // in logarithms: far above rounding, far below any change of curvature
  constexpr double kFlattest = 1e-3;  // a curvature below this is as good as none
  const Eigen::Index size = spot.size();
  Eigen::MatrixXd curvature(size, size);
  Eigen::VectorXd here(size);
  double value = 0.0;
  if (!objective.evaluate(spot.data(), &value, here.data())) return Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    Eigen::VectorXd there = spot;
    there(i) += kStep;
    Eigen::VectorXd slope(size);
    if (!objective.evaluate(there.data(), &value, slope.data())) return Eigen::MatrixXd::Identity(size, size);
    curvature.col(i) = (here - slope) / kStep;
  }
  const Eigen::MatrixXd symmetric = 0.5 * (curvature + curvature.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  const Eigen::VectorXd scale = solver.eigenvalues().cwiseAbs().cwiseMax(kFlattest).cwiseSqrt().cwiseInverse();
  return solver.eigenvectors() * scale.asDiagonal() * solver.eigenvectors().transpose();
}

Eigen::VectorXd look_around(Objective& objective, const Model& model, const Eigen::VectorXd& now,
                            const std::vector<Expectation>& expectations) {
  constexpr int kLengths = 4;
  constexpr std::array<double, 2> kNoises{1e-3, 1e-1};  // squared ratios: a clean surface, a noisy one
  const std::vector<KernelParameter> parameters = model.kernel.parameters();
  const auto count = static_cast<Eigen::Index>(parameters.size());
  const double extent = (model.points.colwise().maxCoeff() - model.points.colwise().minCoeff()).maxCoeff();
  const double spacing = 0.7 * extent / std::sqrt(static_cast<double>(model.size()));

  Eigen::VectorXd best = now;
  double best_value = -std::numeric_limits<double>::infinity();
  const auto consider = [&](Eigen::VectorXd x) {
    Eigen::VectorXd signals;
    const double value = objective.profiled(x.head(count), x(count), signals);
    if (!(value > best_value)) return;
    x.segment(count + 1, model.outputs()) = signals;
    best = x;
    best_value = value;
  };
  consider(now);
  for (int i = 0; extent > 0.0 && i < kLengths; ++i) {
    Eigen::VectorXd x = now;
    const double length = std::log(spacing) + (std::log(extent) - std::log(spacing)) * i / (kLengths - 1);
    for (Eigen::Index p = 0; p < count; ++p) {
      if (parameters[static_cast<std::size_t>(p)].unit == Unit::metre) x(p) = length;
    }
    for (const double noise : kNoises) {
      x(count) = std::log(noise);
      consider(x);
    }
  }
  return within_limits(best, expectations);
}

Eigen::VectorXd random_start(const std::vector<Expectation>& expectations, Random& random) {
  Eigen::VectorXd x(static_cast<Eigen::Index>(expectations.size()));
  for (std::size_t i = 0; i < expectations.size(); ++i) {
    x(static_cast<Eigen::Index>(i)) = expectations[i].centre + (4.0 * random.uniform() - 2.0) * expectations[i].spread;
  }
  return within_limits(x, expectations);
}

}  // namespace palpate::fitting
