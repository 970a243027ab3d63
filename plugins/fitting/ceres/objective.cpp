// SPDX-License-Identifier: MIT
#include "objective.hpp"

#include "symmetric.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::fitting {
namespace {

constexpr double kLogTwoPi = 1.83787706640934548356;
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Steepness of the walls: e-folds beyond a limit, squared, each cost this much per point.
constexpr double kWall = 1.0;
/// Deviations of targets below this share of their size are rounding.
constexpr double kRounding = 1e-9;

}  // namespace

double Model::total(double value) const {
  const auto n = static_cast<double>(size());
  return value * n * static_cast<double>(outputs()) - n * scales.array().log().sum();
}

Model model_of(const FitProblem& problem, bool fit_means) {
  Model model{problem.points, {}, {}, {}, problem.kernel, problem.mean_ratio, {}, fit_means, {}};
  const bool open = fit_means || problem.mean_ratio > 0.0;
  for (std::size_t i = 0; i < problem.outputs.size(); ++i) {
    const FitOutput& output = problem.outputs[i];
    const double centre = open ? output.targets.mean() : output.mean;
    const double scale = (output.targets.array() - centre).abs().maxCoeff();
    if (!std::isfinite(scale) || !(scale > kRounding * output.targets.cwiseAbs().maxCoeff())) continue;
    const Eigen::Index last = model.outputs();
    model.used.push_back(i);
    model.targets.conservativeResize(problem.points.rows(), last + 1);
    model.targets.col(last) = (output.targets.array() - centre) / scale;
    for (Eigen::VectorXd* one : {&model.centres, &model.scales, &model.means}) one->conservativeResize(last + 1);
    model.centres(last) = centre;
    model.scales(last) = scale;
    model.means(last) = (output.mean - centre) / scale;
  }
  return model;
}

Model part_of(const Model& all, Eigen::Index least) {
  Model part = all;
  const Eigen::Index count = std::max(least, all.size() / 2);
  part.points.resize(count, 2);
  part.targets.resize(count, all.outputs());
  for (Eigen::Index i = 0; i < count; ++i) {
    part.points.row(i) = all.points.row(i * all.size() / count);
    part.targets.row(i) = all.targets.row(i * all.size() / count);
  }
  return part;
}

Eigen::VectorXd present(const FitProblem& problem, const Model& model) {
  const std::vector<KernelParameter> parameters = problem.kernel.parameters();
  const auto count = static_cast<Eigen::Index>(parameters.size());
  const Eigen::Index outputs = model.outputs();
  Eigen::VectorXd x(count + 1 + outputs * (model.fit_means ? 2 : 1));
  for (Eigen::Index p = 0; p < count; ++p) x(p) = std::log(parameters[static_cast<std::size_t>(p)].value);
  x(count) = 2.0 * std::log(problem.noise_ratio);
  for (Eigen::Index i = 0; i < outputs; ++i) {
    const FitOutput& output = problem.outputs[model.used[static_cast<std::size_t>(i)]];
    x(count + 1 + i) = 2.0 * std::log(output.signal / model.scales(i));
  }
  if (model.fit_means) x.tail(outputs) = model.means;
  return x;
}

void take(const Eigen::VectorXd& x, const Model& model, FitProblem& problem) {
  const Eigen::Index outputs = model.outputs();
  const Eigen::Index count = x.size() - 1 - outputs * (model.fit_means ? 2 : 1);
  problem.kernel.set_parameters(x.head(count).array().exp().matrix());
  problem.noise_ratio = std::exp(0.5 * x(count));
  for (Eigen::Index i = 0; i < outputs; ++i) {
    FitOutput& output = problem.outputs[model.used[static_cast<std::size_t>(i)]];
    output.signal = model.scales(i) * std::exp(0.5 * x(count + 1 + i));
    if (model.fit_means) output.mean = model.centres(i) + model.scales(i) * x(count + 1 + outputs + i);
  }
}

Objective::Objective(const Model& model, Measure measure, const std::vector<Expectation>& expectations, bool priors)
    : model_(model),
      measure_(measure),
      expectations_(expectations),
      priors_(priors),
      parameters_(static_cast<Eigen::Index>(model.kernel.parameters().size())),
      covariance_(model.size(), model.size()),
      slopes_(model.size(), model.size() * parameters_),
      adjoint_(model.size(), model.size()),
      standard_(model.size(), model.outputs()) {}

bool Objective::evaluate(const double* x, double* value, double* gradient) {
  ++evaluations_;
  const Eigen::Index m = model_.outputs();
  const double* log_signals = x + parameters_ + 1;
  set_kernel(x);
  fill(gradient != nullptr);
  if (!decompose(std::exp(x[parameters_]))) return false;
  for (Eigen::Index i = 0; i < m; ++i) {
    const double mean = model_.fit_means ? log_signals[m + i] : model_.means(i);
    standard_.col(i) = (model_.targets.col(i).array() - mean) * std::exp(-0.5 * log_signals[i]);
  }
  solve(standard_);
  if (gradient != nullptr) std::fill(gradient, gradient + size(), 0.0);
  if (measure_ == Measure::log_marginal_likelihood) {
    *value = likelihood(log_signals);
    if (gradient != nullptr) likelihood_gradient(gradient);
  } else {
    *value = leave_one_out(gradient);
    for (Eigen::Index i = 0; i < m; ++i) *value -= 0.5 * static_cast<double>(model_.size()) * log_signals[i];
  }
  if (gradient != nullptr && model_.fit_means) {
    for (Eigen::Index i = 0; i < m; ++i) gradient[parameters_ + 1 + m + i] *= std::exp(-0.5 * log_signals[i]);
  }
  *value += expectations(x, gradient);
  const double unit = 1.0 / static_cast<double>(model_.size() * m);
  *value *= unit;
  bool finite = std::isfinite(*value);
  for (int i = 0; gradient != nullptr && i < size(); ++i) {
    gradient[i] *= unit;
    finite = finite && std::isfinite(gradient[i]);
  }
  return finite;
}

double Objective::profiled(const Eigen::VectorXd& kernel_logs, double log_noise, Eigen::VectorXd& log_signals) {
  ++evaluations_;
  const auto n = static_cast<double>(model_.size());
  set_kernel(kernel_logs.data());
  fill(false);
  if (!decompose(std::exp(log_noise))) return -std::numeric_limits<double>::infinity();
  solve(model_.targets.rowwise() - model_.means.transpose());
  // In the likelihood of an output only -(square / signal^2 + n log signal^2) / 2 depends on the signal.
  log_signals = (squares_ / n).array().log();
  const Eigen::Index m = model_.outputs();
  squares_.setConstant(n);
  return likelihood(log_signals.data()) / (n * static_cast<double>(m));
}

void Objective::set_kernel(const double* logs) {
  const Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXd>(logs, parameters_).array().exp();
  model_.kernel.set_parameters(values);
}

void Objective::fill(bool slopes) {
  const Eigen::Index n = model_.size();
  Points one(1, 2);
  for (Eigen::Index j = 0; j < n; ++j) {
    one.row(0) = model_.points.row(j);
    const auto below = model_.points.bottomRows(n - j);
    if (slopes) {
      model_.kernel.derivatives(below, one, covariance_.col(j).tail(n - j),
                                slopes_.middleCols(j * parameters_, parameters_).bottomRows(n - j));
    } else {
      model_.kernel.covariance(below, one, covariance_.col(j).tail(n - j));
    }
  }
}

bool Objective::decompose(double noise) {
  noise_ = noise;
  // The smooth lower limit of the noise: what keeps the matrix positive definite in double precision, as jitter does in
  // a process. Too small to enter the gradient.
  const double floor = 10.0 * static_cast<double>(model_.size()) * kEpsilon * covariance_(0, 0);
  covariance_.diagonal().array() += noise + floor;
  if (!factorise(covariance_)) return false;
  log_determinant_ = 2.0 * covariance_.diagonal().array().log().sum();
  return true;
}

void Objective::solve(const Eigen::MatrixXd& targets) {
  const auto factor = covariance_.triangularView<Eigen::Lower>();
  const auto transposed = covariance_.transpose().triangularView<Eigen::Upper>();
  solved_ = factor.solve(targets);
  squares_ = solved_.colwise().squaredNorm();
  transposed.solveInPlace(solved_);
  if (!(model_.mean_ratio > 0.0)) return;
  // K + r^2 1 1^T by the formulas of Sherman, Morrison and Woodbury.
  Eigen::VectorXd ones = Eigen::VectorXd::Ones(model_.size());
  factor.solveInPlace(ones);
  const double prior = model_.mean_ratio * model_.mean_ratio;
  const double precision = 1.0 / prior + ones.squaredNorm();
  transposed.solveInPlace(ones);
  ones_ = ones / std::sqrt(precision);
  log_determinant_ += std::log(precision * prior);
  for (Eigen::Index i = 0; i < targets.cols(); ++i) {
    const double common = ones_.dot(targets.col(i));
    solved_.col(i) -= common * ones_;
    squares_(i) -= common * common;
  }
}

double Objective::likelihood(const double* log_signals) const {
  const auto n = static_cast<double>(model_.size());
  double sum = 0.0;
  for (Eigen::Index i = 0; i < model_.outputs(); ++i) {
    sum -= 0.5 * (squares_(i) + log_determinant_ + n * (kLogTwoPi + log_signals[i]));
  }
  return sum;
}

void Objective::likelihood_gradient(double* gradient) {
  const Eigen::Index n = model_.size();
  const Eigen::Index m = model_.outputs();
  for (Eigen::Index i = 0; i < m; ++i) {
    gradient[parameters_ + 1 + i] += 0.5 * (squares_(i) - static_cast<double>(n));
    if (model_.fit_means) gradient[parameters_ + 1 + m + i] += solved_.col(i).sum();
  }
  // dF/dK = (sum of alpha alpha^T over the outputs - m K^-1) / 2.
  invert_factored(covariance_);
  const auto outputs = static_cast<double>(m);
  for (Eigen::Index j = 0; j < n; ++j) {
    auto column = adjoint_.col(j).tail(n - j);
    column = (-0.5 * outputs) * covariance_.col(j).tail(n - j);
    for (Eigen::Index i = 0; i < m; ++i) column += (0.5 * solved_(j, i)) * solved_.col(i).tail(n - j);
    if (model_.mean_ratio > 0.0) column += (0.5 * outputs * ones_(j)) * ones_.tail(n - j);
  }
  contract(gradient);
}

double Objective::leave_one_out(double* gradient) {
  const Eigen::Index n = model_.size();
  const Eigen::Index m = model_.outputs();
  invert_factored(covariance_);
  mirror(covariance_);
  if (model_.mean_ratio > 0.0) covariance_.noalias() -= ones_ * ones_.transpose();
  const Eigen::ArrayXd own = covariance_.diagonal();  // 1 / variance of each prediction
  double sum = 0.5 * static_cast<double>(m) * (own.log() - kLogTwoPi).sum();
  Eigen::ArrayXd weight = Eigen::ArrayXd::Zero(n);
  if (gradient != nullptr) adjoint_.setZero();
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::ArrayXd ratio = solved_.col(i).array() / own;  // target - prediction
    const double squares = (solved_.col(i).array() * ratio).sum();
    sum -= 0.5 * squares;
    if (gradient == nullptr) continue;
    weight += 0.5 * (1.0 / own + ratio.square());
    const Eigen::VectorXd turned = covariance_ * ratio.matrix();
    adjoint_.selfadjointView<Eigen::Lower>().rankUpdate(turned, solved_.col(i), 0.5);
    gradient[parameters_ + 1 + i] += 0.5 * (squares - static_cast<double>(n));
    if (model_.fit_means) gradient[parameters_ + 1 + m + i] += turned.sum();
  }
  if (gradient == nullptr) return sum;
  const Eigen::MatrixXd scaled = covariance_ * weight.sqrt().matrix().asDiagonal();
  adjoint_.selfadjointView<Eigen::Lower>().rankUpdate(scaled, -1.0);
  contract(gradient);
  return sum;
}

void Objective::contract(double* gradient) const {
  const Eigen::Index n = model_.size();
  gradient[parameters_] += noise_ * adjoint_.diagonal().sum();
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index p = 0; p < parameters_; ++p) {
      const auto slope = slopes_.col(j * parameters_ + p);
      gradient[p] += adjoint_(j, j) * slope(j) + 2.0 * adjoint_.col(j).tail(n - j - 1).dot(slope.tail(n - j - 1));
    }
  }
}

double Objective::expectations(const double* x, double* gradient) const {
  double sum = 0.0;
  const auto points = static_cast<double>(model_.size());
  for (std::size_t i = 0; i < expectations_.size(); ++i) {
    const Expectation& one = expectations_[i];
    if (priors_) {
      const double z = (x[i] - one.centre) / one.spread;
      sum -= 0.5 * (z * z + kLogTwoPi) + std::log(one.spread);
      if (gradient != nullptr) gradient[i] -= z / one.spread;
    }
    const double beyond = x[i] > one.most ? x[i] - one.most : x[i] < one.least ? x[i] - one.least : 0.0;
    sum -= kWall * points * beyond * beyond;
    if (gradient != nullptr) gradient[i] -= 2.0 * kWall * points * beyond;
  }
  return sum;
}

}  // namespace palpate::fitting
