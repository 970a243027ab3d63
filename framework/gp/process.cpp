// SPDX-License-Identifier: MIT
#include "gp/process.hpp"

#include "gp/tolerances.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {
namespace {

constexpr double kLogTwoPi = 1.83787706640934548356;

}  // namespace

Process::Process(std::shared_ptr<Kernel> kernel, const ProcessSettings& settings, const Points& candidates)
    : kernel_(std::move(kernel)), settings_(settings), candidates_(candidates), prior_(candidates.rows()) {
  kernel_->variance(candidates_, prior_);
  mean_ = Eigen::VectorXd::Zero(candidates_.rows());
  if (settings_.mean_ratio > 0.0) explained_ = mean_;
  variance_ = prior_;
}

void Process::reserve(int taps) {
  if (targets_.size() >= taps) return;
  const int capacity = std::max(32, 2 * taps);
  points_.conservativeResize(capacity, 2);
  targets_.conservativeResize(capacity);
  factored_.conservativeResize(capacity, 2);
  reduced_.conservativeResize(capacity);
  constant_.conservativeResize(capacity);
  rows_.conservativeResize(candidates_.rows(), capacity);
  covariance_.resize(capacity);
}

void Process::add(const Target& place, double value) {
  reserve(size_ + 1);
  points_(size_, 0) = place.x;
  points_(size_, 1) = place.y;
  targets_(size_) = value;
  ++size_;
  if (!append(size_ - 1)) rebuild();
}

bool Process::append(int tap) {
  const int row = factor_.size();
  factored_.row(row) = points_.row(tap);
  const auto place = factored_.row(row);
  kernel_->covariance(factored_.topRows(row), place, covariance_.head(row));
  double own = 0.0;
  kernel_->variance(place, Eigen::Map<Eigen::VectorXd>(&own, 1));
  const double ratio = settings_.noise / settings_.signal;
  if (!factor_.append(covariance_.head(row), own + ratio * ratio + jitter_)) return false;

  const double pivot = factor_.last_pivot();
  const VectorView before = factor_.last_row();
  const double target = (targets_(tap) - settings_.mean) / settings_.signal;
  reduced_(row) = (target - before.dot(reduced_.head(row))) / pivot;

  auto column = rows_.col(row);
  kernel_->covariance(candidates_, place, column);
  if (row > 0) column.noalias() -= rows_.leftCols(row) * before;
  column /= pivot;
  mean_ += reduced_(row) * column;
  variance_ -= column.cwiseAbs2();
  if (settings_.mean_ratio > 0.0) {
    constant_(row) = (1.0 - before.dot(constant_.head(row))) / pivot;
    explained_ += constant_(row) * column;
  }
  return true;
}

bool Process::refactor(const std::vector<int>& taps) {
  factor_.clear();
  mean_.setZero();
  explained_.setZero();
  variance_ = prior_;
  return std::all_of(taps.begin(), taps.end(), [this](int tap) { return append(tap); });
}

void Process::rebuild() {
  std::vector<int> taps(static_cast<std::size_t>(size_));
  std::iota(taps.begin(), taps.end(), 0);
  const double unit = size_ * kEpsilon * prior_.maxCoeff();
  while (!refactor(taps)) {
    if (jitter_ >= kLastJitter * unit) {
      // What is left of a matrix that no jitter makes positive definite: the taps that are independent of each other.
      Eigen::MatrixXd covariance(size_, size_);
      kernel_->covariance(points_.topRows(size_), points_.topRows(size_), covariance);
      const double ratio = settings_.noise / settings_.signal;
      covariance.diagonal().array() += ratio * ratio + jitter_;
      ++pivoted_;
      taps = independent_rows(covariance);
      // The guards of both factorisations differ by rounding: what the second refuses ends the list.
      refactor(taps);
      return;
    }
    jitter_ = std::min(std::max(kFirstJitter * unit, 10.0 * jitter_), kLastJitter * unit);
    ++jitter_raised_;
  }
}

FitSummary Process::fit(const std::vector<Process*>& processes, const Fitting& fitting, Random& random) {
  Process& first = *processes.front();
  std::vector<double> old;
  for (const KernelParameter& one : first.kernel_->parameters()) old.push_back(one.value);
  std::vector<ProcessSettings> fitted;
  fitted.reserve(processes.size());
  double noise_ratio = first.settings_.noise / first.settings_.signal;
  FitProblem problem{first.points_.topRows(first.size_), *first.kernel_, noise_ratio, first.settings_.mean_ratio, {}};
  for (const Process* process : processes) {
    fitted.push_back(process->settings_);
    problem.outputs.push_back({process->targets_.head(process->size_), fitted.back().signal, fitted.back().mean});
  }
  FitSummary summary = fitting.fit(problem, random);
  if (!summary.changed) return summary;

  bool sound = std::isfinite(noise_ratio) && noise_ratio >= 0.0;
  for (const KernelParameter& one : first.kernel_->parameters()) sound &= std::isfinite(one.value) && one.value > 0.0;
  for (const ProcessSettings& one : fitted) {
    sound &= std::isfinite(one.signal) && one.signal > 0.0 && std::isfinite(one.mean);
  }
  if (!sound) {
    first.kernel_->set_parameters(Eigen::Map<const Eigen::VectorXd>(old.data(), static_cast<Eigen::Index>(old.size())));
    summary.changed = false;
    summary.failed = true;
    summary.reason = "a number that is not finite and positive was refused; " + summary.reason;
    return summary;
  }
  for (std::size_t i = 0; i < processes.size(); ++i) {
    Process& process = *processes[i];
    process.settings_ = fitted[i];
    process.settings_.noise = noise_ratio * fitted[i].signal;
    process.kernel_->variance(process.candidates_, process.prior_);
    process.jitter_ = 0.0;
    process.rebuild();
  }
  return summary;
}

double Process::constant_precision() const {
  return 1.0 / prior_of_constant() + constant_.head(factor_.size()).squaredNorm();
}

Eigen::VectorXd Process::mean() const {
  Eigen::VectorXd standard = mean_;
  if (settings_.mean_ratio > 0.0) {
    const int n = factor_.size();
    const double constant = constant_.head(n).dot(reduced_.head(n)) / constant_precision();
    standard.array() += constant * (1.0 - explained_.array());
  }
  return (settings_.signal * standard.array() + settings_.mean).matrix();
}

Eigen::VectorXd Process::standard_variance() const {
  if (!(settings_.mean_ratio > 0.0)) return variance_;
  return variance_.array() + (1.0 - explained_.array()).square() / constant_precision();
}

Eigen::VectorXd Process::variance() const {
  const Eigen::VectorXd prior = prior_.array() + prior_of_constant();
  return standard_variance().cwiseMax(0.0).cwiseMin(prior) * (settings_.signal * settings_.signal);
}

Eigen::VectorXd Process::relative_variance() const {
  const Eigen::VectorXd prior = prior_.array() + prior_of_constant();
  return standard_variance().cwiseMax(0.0).cwiseMin(prior).cwiseQuotient(prior);
}

int Process::variances_clamped() const {
  const Eigen::ArrayXd variance = standard_variance();
  // A last digit above the prior is no news; below 0 every digit is.
  const Eigen::ArrayXd most = (prior_.array() + prior_of_constant()) * (1.0 + 4.0 * kEpsilon);
  return static_cast<int>((variance < 0.0 || variance > most).count());
}

double Process::log_marginal_likelihood() const {
  const int n = factor_.size();
  if (n == 0) return 0.0;
  double square = reduced_.head(n).squaredNorm();
  double log_determinant = factor_.log_determinant();
  if (settings_.mean_ratio > 0.0) {
    const double common = constant_.head(n).dot(reduced_.head(n));
    square -= common * common / constant_precision();
    log_determinant += std::log(constant_precision() * prior_of_constant());
  }
  return -0.5 * (square + log_determinant + n * kLogTwoPi) - n * std::log(settings_.signal);
}

}  // namespace palpate
