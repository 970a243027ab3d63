// SPDX-License-Identifier: MIT
#include "objective.hpp"

#include "regular/regular_factor.hpp"

#include <palpate/math.hpp>

#include <cmath>
#include <limits>

namespace palpate::fitting {
namespace {

constexpr double kLogTwoPi = 1.83787706640934548356;
/// Steepness of the smooth limits. Beyond a limit, the objective decreases per point by kWall times the squared
/// distance in e-folds.
constexpr double kWall = 1.0;
/// Targets count as equal if their relative deviation is smaller than this.
constexpr double kRounding = 1e-9;

Eigen::VectorXd exponentials(const double* logs, Eigen::Index count) {
  return Eigen::Map<const Eigen::VectorXd>(logs, count).unaryExpr([](double x) { return math::exp(x); });
}

/// Returns the dot product of two arrays of `lines` lines, each of eight numbers.
double product(const double* a, const double* b, Eigen::Index lines) {
  using Numbers = Eigen::Map<const Eigen::VectorXd, Eigen::AlignedMax>;
  return Numbers(a, 8 * lines).dot(Numbers(b, 8 * lines));
}

}  // namespace

double FitModel::total(double value) const {
  const auto n = static_cast<double>(size());
  return value * n * static_cast<double>(outputs()) - n * scales.unaryExpr(&math::log).sum();
}

FitModel model_of(const FitProblem& problem, bool fit_means) {
  FitModel model{problem.points, {}, {}, {}, problem.kernel, problem.mean_ratio, {}, fit_means, {}};
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

FitModel part_of(const FitModel& all, Eigen::Index least) {
  FitModel part = all;
  const Eigen::Index count = std::max(least, all.size() / 2);
  part.points.resize(count, 2);
  part.targets.resize(count, all.outputs());
  for (Eigen::Index i = 0; i < count; ++i) {
    part.points.row(i) = all.points.row(i * all.size() / count);
    part.targets.row(i) = all.targets.row(i * all.size() / count);
  }
  return part;
}

Eigen::VectorXd present(const FitProblem& problem, const FitModel& model) {
  const std::vector<KernelParameter> parameters = problem.kernel.parameters();
  const auto count = static_cast<Eigen::Index>(parameters.size());
  const Eigen::Index outputs = model.outputs();
  Eigen::VectorXd x(count + 1 + outputs * (model.fit_means ? 2 : 1));
  for (Eigen::Index p = 0; p < count; ++p) x(p) = math::log(parameters[static_cast<std::size_t>(p)].value);
  x(count) = 2.0 * math::log(problem.noise_ratio);
  for (Eigen::Index i = 0; i < outputs; ++i) {
    const FitOutput& output = problem.outputs[model.used[static_cast<std::size_t>(i)]];
    x(count + 1 + i) = 2.0 * math::log(output.signal / model.scales(i));
  }
  if (model.fit_means) x.tail(outputs) = model.means;
  return x;
}

void take(const Eigen::VectorXd& x, const FitModel& model, FitProblem& problem) {
  const Eigen::Index outputs = model.outputs();
  const Eigen::Index count = x.size() - 1 - outputs * (model.fit_means ? 2 : 1);
  problem.kernel.set_parameters(exponentials(x.data(), count));
  problem.noise_ratio = math::exp(0.5 * x(count));
  for (Eigen::Index i = 0; i < outputs; ++i) {
    FitOutput& output = problem.outputs[model.used[static_cast<std::size_t>(i)]];
    output.signal = model.scales(i) * math::exp(0.5 * x(count + 1 + i));
    if (model.fit_means) output.mean = model.centres(i) + model.scales(i) * x(count + 1 + outputs + i);
  }
}

Objective::Objective(const FitModel& model, Measure measure, const std::vector<HyperPrior>& expectations, bool priors)
    : model_(model),
      measure_(measure),
      expectations_(expectations),
      priors_(priors),
      parameters_(static_cast<Eigen::Index>(model.kernel.parameters().size())),
      matrix_(model.size()),
      upper_(model.size()),
      places_(8 * matrix_.strips(), 2),
      slopes_(static_cast<std::size_t>(8 * matrix_.strips() * matrix_.strips() * parameters_)),
      own_(model.size()),
      standard_(model.size(), model.outputs()),
      solved_(Eigen::MatrixXd::Zero(8 * matrix_.strips(), model.outputs())) {
  for (Eigen::Index i = 0; i < places_.rows(); ++i) places_.row(i) = model.points.row(std::min(i, model.size() - 1));
}

bool Objective::evaluate(const double* x, double* value, double* gradient) {
  ++evaluations_;
  const Eigen::Index m = model_.outputs();
  const double* log_signals = x + parameters_ + 1;
  set_kernel(x);
  fill(gradient != nullptr);
  if (!decompose(math::exp(x[parameters_]))) return false;
  for (Eigen::Index i = 0; i < m; ++i) {
    const double mean = model_.fit_means ? log_signals[m + i] : model_.means(i);
    standard_.col(i) = (model_.targets.col(i).array() - mean) * math::exp(-0.5 * log_signals[i]);
  }
  solve(standard_);
  if (gradient != nullptr || measure_ == Measure::leave_one_out) invert();
  if (gradient != nullptr) std::fill(gradient, gradient + size(), 0.0);
  if (measure_ == Measure::log_marginal_likelihood) {
    *value = likelihood(log_signals);
    if (gradient != nullptr) likelihood_gradient(gradient);
  } else {
    *value = leave_one_out(gradient);
    for (Eigen::Index i = 0; i < m; ++i) *value -= 0.5 * static_cast<double>(model_.size()) * log_signals[i];
  }
  if (gradient != nullptr && model_.fit_means) {
    for (Eigen::Index i = 0; i < m; ++i) gradient[parameters_ + 1 + m + i] *= math::exp(-0.5 * log_signals[i]);
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
  if (!decompose(math::exp(log_noise))) return -std::numeric_limits<double>::infinity();
  solve(model_.targets.rowwise() - model_.means.transpose());
  // The part of an output's likelihood that depends on the signal is -(square / signal^2 + n * log(signal^2)) / 2.
  log_signals = (squares_ / n).unaryExpr(&math::log);
  const Eigen::Index m = model_.outputs();
  squares_.setConstant(n);
  return likelihood(log_signals.data()) / (n * static_cast<double>(m));
}

void Objective::set_kernel(const double* logs) {
  const Eigen::VectorXd values = exponentials(logs, parameters_);
  model_.kernel.set_parameters(values);
}

void Objective::fill(bool slopes) {
  using Lines = Eigen::Map<Eigen::MatrixXd, Eigen::AlignedMax>;
  for (Eigen::Index s = 0; s < matrix_.strips(); ++s) {
    const auto own = places_.middleRows(8 * s, 8);
    const auto others = model_.points.topRows(columns(s));
    Lines value(matrix_.at(s, 0)->numbers, 8, columns(s));
    if (slopes) {
      Lines out(slopes_[static_cast<std::size_t>(slopes_of(s))].numbers, 8, columns(s) * parameters_);
      model_.kernel.derivatives(own, others, value, out);
    } else {
      model_.kernel.covariance(own, others, value);
    }
  }
}

bool Objective::decompose(double noise) {
  noise_ = noise;
  const Eigen::Index n = model_.size();
  // Smooth lower limit of the noise. It equals the first jitter of RegularFactor and is always added, because the
  // objective would otherwise have a step. It is too small to affect the gradient noticeably. If a matrix is still
  // singular, it is rejected, and the search turns back.
  const double floor = kFirstJitter * static_cast<double>(n) * kEpsilon * matrix_(0, 0);
  for (Eigen::Index i = 0; i < n; ++i) own_(i) = matrix_(i, i) += noise + floor;
  if (!factorise(matrix_, reciprocals_)) return false;
  log_determinant_ = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double pivot = matrix_(i, i);
    if (!is_regular(pivot * pivot, i, own_(i))) return false;
    log_determinant_ += 2.0 * math::log(pivot);
  }
  return true;
}

void Objective::solve(const Eigen::MatrixXd& targets) {
  const Eigen::Index n = model_.size();
  solved_.topRows(n) = targets;
  solved_.bottomRows(solved_.rows() - n).setZero();
  for (Eigen::Index i = 0; i < targets.cols(); ++i) solve_lower(matrix_, solved_.col(i));
  squares_ = solved_.colwise().squaredNorm();
  if (!(model_.mean_ratio > 0.0)) return;
  // The inverse of K + r^2 * 1 * 1^T, where 1 is a vector of ones, is computed by the Sherman-Morrison-Woodbury
  // formula.
  ones_ = Eigen::VectorXd::Zero(solved_.rows());
  ones_.head(n).setOnes();
  solve_lower(matrix_, ones_);
  const double prior = model_.mean_ratio * model_.mean_ratio;
  const double precision = 1.0 / prior + ones_.squaredNorm();
  ones_ /= std::sqrt(precision);
  log_determinant_ += math::log(precision * prior);
  for (Eigen::Index i = 0; i < targets.cols(); ++i) {
    const double common = ones_.dot(solved_.col(i));
    solved_.col(i) -= common * ones_;
    squares_(i) -= common * common;
  }
}

/// Replaces L by K^-1. Applies L^-T to the vectors to which L^-1 was applied.
void Objective::invert() {
  invert_transposed(matrix_, reciprocals_, upper_);
  for (Eigen::Index i = 0; i < solved_.cols(); ++i) multiply_upper(upper_, solved_.col(i));
  if (model_.mean_ratio > 0.0) multiply_upper(upper_, ones_);
  square_upper(upper_, matrix_);
}

double Objective::likelihood(const double* log_signals) const {
  const auto n = static_cast<double>(model_.size());
  double sum = 0.0;
  for (Eigen::Index i = 0; i < model_.outputs(); ++i)
    sum -= 0.5 * (squares_(i) + log_determinant_ + n * (kLogTwoPi + log_signals[i]));
  return sum;
}

void Objective::likelihood_gradient(double* gradient) {
  const Eigen::Index n = model_.size();
  const Eigen::Index m = model_.outputs();
  for (Eigen::Index i = 0; i < m; ++i) {
    gradient[parameters_ + 1 + i] += 0.5 * (squares_(i) - static_cast<double>(n));
    if (model_.fit_means) gradient[parameters_ + 1 + m + i] += solved_.col(i).sum();
  }
  // dF/dK = (sum over the outputs of alpha * alpha^T - m * K^-1) / 2, with alpha = K^-1 * standard_.
  const auto outputs = static_cast<double>(m);
  for (Eigen::Index s = 0; s < matrix_.strips(); ++s) {
    Eigen::Map<Eigen::MatrixXd, Eigen::AlignedMax> adjoint(matrix_.at(s, 0)->numbers, 8, columns(s));
    adjoint *= -0.5 * outputs;
    const auto add = [&](double weight, const auto& numbers) {
      adjoint.noalias() += numbers.segment(8 * s, 8) * (weight * numbers.head(columns(s))).transpose();
    };
    for (Eigen::Index i = 0; i < m; ++i) add(0.5, solved_.col(i));
    if (model_.mean_ratio > 0.0) add(0.5 * outputs, ones_);
  }
  contract(gradient);
}

double Objective::leave_one_out(double* gradient) {
  const Eigen::Index n = model_.size();
  const Eigen::Index m = model_.outputs();
  Eigen::MatrixXd inverse = matrix_.mirrored();
  const auto ones = ones_.head(ones_.size() > 0 ? n : 0);
  if (ones.size() > 0) inverse.noalias() -= ones * ones.transpose();
  const Eigen::ArrayXd own = inverse.diagonal();  // 1 / variance of each leave-one-out prediction
  double sum = 0.5 * static_cast<double>(m) * (own.unaryExpr(&math::log) - kLogTwoPi).sum();
  Eigen::ArrayXd weight = Eigen::ArrayXd::Zero(n);
  Eigen::MatrixXd adjoint = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < m; ++i) {
    const Eigen::ArrayXd ratio = solved_.col(i).head(n).array() / own;  // target minus leave-one-out prediction
    const double squares = (solved_.col(i).head(n).array() * ratio).sum();
    sum -= 0.5 * squares;
    if (gradient == nullptr) continue;
    weight += 0.5 * (1.0 / own + ratio.square());
    const Eigen::VectorXd turned = inverse * ratio.matrix();
    adjoint.selfadjointView<Eigen::Lower>().rankUpdate(turned, solved_.col(i).head(n), 0.5);
    gradient[parameters_ + 1 + i] += 0.5 * (squares - static_cast<double>(n));
    if (model_.fit_means) gradient[parameters_ + 1 + m + i] += turned.sum();
  }
  if (gradient == nullptr) return sum;
  const Eigen::MatrixXd scaled = inverse * weight.sqrt().matrix().asDiagonal();
  adjoint.selfadjointView<Eigen::Lower>().rankUpdate(scaled, -1.0);
  adjoint.triangularView<Eigen::StrictlyUpper>() = adjoint.transpose();
  for (Eigen::Index j = 0; j < n; ++j) matrix_.put(j, adjoint.col(j).tail(n - j / 8 * 8));
  contract(gradient);
  return sum;
}

void Objective::contract(double* gradient) const {
  double trace = 0.0;
  for (Eigen::Index i = 0; i < model_.size(); ++i) trace += matrix_(i, i);
  gradient[parameters_] += noise_ * trace;
  for (Eigen::Index s = 0; s < matrix_.strips(); ++s) {
    const double* const adjoint = matrix_.at(s, 0)->numbers;
    for (Eigen::Index p = 0; p < parameters_; ++p) {
      const double* const slopes = slopes_[static_cast<std::size_t>(slopes_of(s) + p * columns(s))].numbers;
      // A diagonal tile has all its entries. A tile to the left of it also stands for the symmetric tile to the right.
      gradient[p] +=
          2.0 * product(adjoint, slopes, 8 * s) + product(adjoint + 64 * s, slopes + 64 * s, columns(s) - 8 * s);
    }
  }
}

double Objective::expectations(const double* x, double* gradient) const {
  double sum = 0.0;
  const auto points = static_cast<double>(model_.size());
  for (std::size_t i = 0; i < expectations_.size(); ++i) {
    const HyperPrior& one = expectations_[i];
    if (priors_) {
      const double z = (x[i] - one.centre) / one.spread;
      sum -= 0.5 * (z * z + kLogTwoPi) + math::log(one.spread);
      if (gradient != nullptr) gradient[i] -= z / one.spread;
    }
    const double beyond = x[i] > one.most ? x[i] - one.most : x[i] < one.least ? x[i] - one.least : 0.0;
    sum -= kWall * points * beyond * beyond;
    if (gradient != nullptr) gradient[i] -= 2.0 * kWall * points * beyond;
  }
  return sum;
}

}  // namespace palpate::fitting
