// SPDX-License-Identifier: MIT
#include "gp/process.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr double kLogTwoPi = 1.83787706640934548356;

}  // namespace

Process::Process(std::shared_ptr<Kernel> kernel, const ProcessSettings& settings, const Points& candidates)
    : kernel_(std::move(kernel)), settings_(settings), candidates_(candidates), prior_(candidates.rows()) {
  kernel_->variance(candidates_, prior_);
  mean_ = Eigen::VectorXd::Zero(candidates_.rows());
  variance_ = prior_;
}

void Process::reserve(int taps) {
  if (targets_.size() >= taps) return;
  const int capacity = std::max(32, 2 * taps);
  points_.conservativeResize(capacity, 2);
  targets_.conservativeResize(capacity);
  reduced_.conservativeResize(capacity);
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

bool Process::append(int index) {
  const auto place = points_.row(index);
  kernel_->covariance(points_.topRows(index), place, covariance_.head(index));
  double own = 0.0;
  kernel_->variance(place, Eigen::Map<Eigen::VectorXd>(&own, 1));
  const double ratio = settings_.noise / settings_.signal;
  if (!factor_.append(covariance_.head(index), own + ratio * ratio + jitter_)) return false;

  const double pivot = factor_.last_pivot();
  const VectorView row = factor_.last_row();
  const double target = (targets_(index) - settings_.mean) / settings_.signal;
  reduced_(index) = (target - row.dot(reduced_.head(index))) / pivot;

  auto column = rows_.col(index);
  kernel_->covariance(candidates_, place, column);
  if (index > 0) column.noalias() -= rows_.leftCols(index) * row;
  column /= pivot;
  mean_ += reduced_(index) * column;
  variance_ -= column.cwiseAbs2();
  return true;
}

void Process::rebuild() {
  const double unit = size_ * std::numeric_limits<double>::epsilon() * std::max(1.0, prior_.maxCoeff());
  for (;;) {
    factor_.clear();
    mean_.setZero();
    variance_ = prior_;
    int done = 0;
    while (done < size_ && append(done)) ++done;
    if (done == size_) return;
    jitter_ = std::max(10.0 * unit, 10.0 * jitter_);
    ++jitter_raised_;
  }
}

FitSummary Process::fit(const Fitting& fitting, Random& random) {
  const Eigen::VectorXd relative = targets_.head(size_).array() - settings_.mean;
  FitProblem problem{points_.topRows(size_), relative, *kernel_, settings_.signal, settings_.noise};
  FitSummary summary = fitting.fit(problem, random);
  if (summary.changed) {
    kernel_->variance(candidates_, prior_);
    jitter_ = 0.0;
    rebuild();
  }
  return summary;
}

Eigen::VectorXd Process::mean() const { return (settings_.signal * mean_.array() + settings_.mean).matrix(); }

Eigen::VectorXd Process::variance() const { return variance_.cwiseMax(0.0) * (settings_.signal * settings_.signal); }

Eigen::VectorXd Process::relative_variance() const { return variance_.cwiseMax(0.0).cwiseQuotient(prior_); }

int Process::variances_clamped() const { return static_cast<int>((variance_.array() < 0.0).count()); }

double Process::log_marginal_likelihood() const {
  if (size_ == 0) return 0.0;
  return -0.5 * (reduced_.head(size_).squaredNorm() + factor_.log_determinant() + size_ * kLogTwoPi) -
         size_ * std::log(settings_.signal);
}

}  // namespace palpate
