// SPDX-License-Identifier: MIT
#include "gp/gaussian_process.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace palpate {
namespace {

constexpr double kLogTwoPi = 1.83787706640934548356;

constexpr double kUnbound = std::numeric_limits<double>::infinity();
constexpr loops::Reading kAsItIs{-kUnbound, kUnbound, 1.0, 0.0};

}  // namespace

GaussianProcess::GaussianProcess(std::shared_ptr<Kernel> kernel, std::vector<GpSettings> outputs,
                                 const Candidates& candidates, EngineSettings posterior)
    : kernel_(std::move(kernel)),
      outputs_(std::move(outputs)),
      candidates_(candidates),
      posterior_(std::move(posterior)) {
  const std::string why = objection(posterior_, *kernel_, candidates_);
  if (!why.empty()) throw Error("engine", "cannot be used here: " + why);
  take_prior();
  choose();
  reserve(1);
}

void GaussianProcess::take_prior() {
  prior_.resize(candidates_.size());
  kernel_->variance(candidates_.points, prior_);
  same_prior_ = prior_.minCoeff() == prior_.maxCoeff();
  if (same_prior_) prior_.conservativeResize(1);
}

void GaussianProcess::reserve(int taps) {
  if (targets_.rows() >= taps) return;
  // What is expected, within reason, so that no tap has to make room; then twice as much every time.
  constexpr int kMostExpected = 4096;
  const int capacity = std::max(std::min(posterior_.taps, kMostExpected), targets_.rows() == 0 ? taps : 2 * taps);
  const auto columns = static_cast<Eigen::Index>(outputs_.size()) + (with_constant() ? 1 : 0);
  points_.conservativeResize(capacity, 2);
  targets_.conservativeResize(capacity, static_cast<Eigen::Index>(outputs_.size()));
  trust_.conservativeResize(capacity);
  factored_.conservativeResize(capacity, 2);
  reduced_.conservativeResize(capacity, columns);
  weights_.conservativeResize(capacity, columns);
  scratch_.resize(capacity);
  factor_.reserve(capacity);
  choice_.engine->reserve(capacity);
}

void GaussianProcess::choose(double error) {
  choice_ = choose_engine(posterior_, *kernel_, candidates_, error);
  taken_ = kNothing;
  choice_.engine->reserve(static_cast<int>(targets_.rows()));
}

void GaussianProcess::add(const Target& place, const VectorView& values) {
  reserve(size_ + 1);
  points_(size_, 0) = place.x;
  points_(size_, 1) = place.y;
  targets_.row(size_) = values.transpose();
  trust_(size_) = 1.0;
  ++size_;
  if (!append(size_ - 1)) rebuild();
}

bool GaussianProcess::trust(const VectorView& shares) {
  if (shares == trust_.head(size_)) return false;
  trust_.head(size_) = shares;
  rebuild();
  return true;
}

bool GaussianProcess::correct(const VectorView& values) {
  if (values == targets_.col(0).head(size_)) return false;
  targets_.col(0).head(size_) = values;
  rebuild();
  return true;
}

bool GaussianProcess::move(const PointsView& places) {
  if (places == points_.topRows(size_)) return false;
  points_.topRows(size_) = places;
  ++generation_;
  rebuild();
  return true;
}

bool GaussianProcess::append(int tap) {
  const int row = factor_.size();
  factored_.row(row) = points_.row(tap);
  // Not row(row): a row at compile time would be copied to the heap where a view of points is asked for.
  const auto place = factored_.middleRows(row, 1);
  kernel_->covariance(factored_.topRows(row), place, scratch_.head(row));
  double own = 0.0;
  kernel_->variance(place, Eigen::Map<Eigen::VectorXd>(&own, 1));
  if (!factor_.append(scratch_.head(row), own + noise_ratio() * noise_ratio() / trust_(tap) + report_.jitter))
    return false;

  const VectorView before = factor_.row(row);
  const auto reduce = [&](Eigen::Index column, double value) {
    reduced_(row, column) = (value - before.dot(reduced_.col(column).head(row))) / factor_.pivot(row);
  };
  for (Eigen::Index k = 0; k < targets_.cols(); ++k) {
    const GpSettings& output = settings(static_cast<int>(k));
    reduce(k, (targets_(tap, k) - output.mean) / output.signal);
  }
  if (with_constant()) reduce(targets_.cols(), 1.0);
  return true;
}

void GaussianProcess::absorb(int row) {
  Engine& engine = *choice_.engine;
  VectorOut inverse = scratch_.head(engine.needs_inverse() ? row + 1 : 0);
  if (engine.needs_inverse()) {
    factor_.inverse_row(row, inverse);
    const double norm = inverse.lpNorm<1>();
    inverse_norms_ += norm * norm;
    weights_.row(row).setZero();
    for (Eigen::Index k = 0; k < reduced_.cols(); ++k) weights_.col(k).head(row + 1) += reduced_(row, k) * inverse;
  }
  std::array<double, loops::kMeans> coefficients{};
  for (int k = 0; k < shown_; ++k) coefficients[static_cast<std::size_t>(k)] = reduced_(row, k);
  if (with_constant()) coefficients[static_cast<std::size_t>(shown_)] = reduced_(row, targets_.cols());
  engine.absorb({factored_.topRows(row + 1), factor_.row(row), factor_.pivot(row), inverse, coefficients.data()});
}

void GaussianProcess::show(int outputs) {
  if (outputs <= shown_) return;
  shown_ = outputs;
  taken_ = kNothing;
}

void GaussianProcess::update_maps() {
  take_rows();
  if (posterior_.engine != EngineSettings::Kind::automatic) return;
  const double error = error_bound();
  if (!(error > posterior_.accuracy)) return;
  choose(error);
  take_rows();
}

void GaussianProcess::require_maps() const {
  if (taken_ != factor_.size()) throw std::logic_error("a map of a GP is read that is older than its taps");
}

void GaussianProcess::take_rows() {
  if (taken_ == kNothing) {
    inverse_norms_ = 0.0;
    choice_.engine->restart(shown_ + (with_constant() ? 1 : 0), prior_);
    taken_ = 0;
  }
  for (; taken_ < factor_.size(); ++taken_) absorb(taken_);
}

double GaussianProcess::error_bound() const {
  require_maps();
  const VectorView errors = choice_.engine->covariance_errors();
  const int n = factor_.size();
  if (errors.size() == 0 || !(errors.maxCoeff() > 0.0)) return 0.0;
  const double prior = prior_.maxCoeff();
  const double deviation = std::sqrt(prior);
  // L^-1 makes nothing longer than 1 / noise times, as no eigenvalue of L L^T is less than what is on its diagonal
  // alone.
  const double noise = std::sqrt(noise_ratio() * noise_ratio() + report_.jitter);
  const double row = std::min(errors.maxCoeff() * std::sqrt(inverse_norms_), errors.norm() / noise) / deviation;
  double variance = 2.0 * row + row * row;
  double mean = 0.0;
  // What the errors make of a column of K^-1 (targets, 1).
  const auto error_of = [&](Eigen::Index column) { return errors.dot(weights_.col(column).head(n).cwiseAbs()); };
  for (Eigen::Index k = 0; k < targets_.cols(); ++k) mean = std::max(mean, error_of(k) / deviation);
  if (with_constant()) {
    const double explained = weights_.col(targets_.cols()).head(n).lpNorm<1>();
    const double error = error_of(targets_.cols());
    mean += std::abs(constant_mean()) * error / deviation;
    variance += 2.0 * (1.0 + explained * prior) * error / (constant_precision() * prior);
  }
  return std::max(mean, variance);
}

bool GaussianProcess::refactor(const std::vector<int>& taps) {
  factor_.clear();
  taken_ = kNothing;
  return std::all_of(taps.begin(), taps.end(), [this](int tap) { return append(tap); });
}

void GaussianProcess::rebuild() {
  std::vector<int> taps(static_cast<std::size_t>(size_));
  std::iota(taps.begin(), taps.end(), 0);
  const auto pivot = [&] {
    // What is left of a matrix that no jitter makes positive definite: the taps that are independent of each other.
    Eigen::MatrixXd covariance(size_, size_);
    kernel_->covariance(points_.topRows(size_), points_.topRows(size_), covariance);
    covariance.diagonal().array() += noise_ratio() * noise_ratio() / trust_.head(size_).array() + report_.jitter;
    taps = independent_rows(covariance);
    // The guards of both factorisations differ by rounding: what the second refuses ends the list.
    refactor(taps);
  };
  regularise(
      report_, size_, prior_.maxCoeff(), [&] { return refactor(taps); }, pivot);
}

FitSummary GaussianProcess::fit(const Fitting& fitting, Random& random) {
  std::vector<double> old;
  for (const KernelParameter& one : kernel_->parameters()) old.push_back(one.value);
  std::vector<GpSettings> fitted = outputs_;
  double ratio = noise_ratio();
  FitProblem problem{points_.topRows(size_), *kernel_, ratio, outputs_.front().mean_ratio, {}, &fit_memory_};
  for (std::size_t k = 0; k < fitted.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    problem.outputs.push_back({targets_.col(column).head(size_), fitted[k].signal, fitted[k].mean});
  }
  FitSummary summary = fitting.fit(problem, random);
  if (!summary.changed) return summary;

  bool sound = std::isfinite(ratio) && ratio >= 0.0;
  for (const KernelParameter& one : kernel_->parameters()) sound &= std::isfinite(one.value) && one.value > 0.0;
  for (const GpSettings& one : fitted) {
    sound &= std::isfinite(one.signal) && one.signal > 0.0 && std::isfinite(one.mean);
  }
  if (!sound) {
    kernel_->set_parameters(Eigen::Map<const Eigen::VectorXd>(old.data(), static_cast<Eigen::Index>(old.size())));
    summary.changed = false;
    summary.failed = true;
    summary.reason = "a number that is not finite and positive was rejected; " + summary.reason;
    return summary;
  }
  ++generation_;
  outputs_ = fitted;
  for (GpSettings& one : outputs_) one.noise = ratio * one.signal;
  take_prior();
  report_.jitter = 0.0;
  choose();
  rebuild();
  return summary;
}

double GaussianProcess::constant_precision() const {
  return 1.0 / prior_of_constant() + reduced_.col(targets_.cols()).head(factor_.size()).squaredNorm();
}

double GaussianProcess::constant_mean() const {
  const int n = factor_.size();
  return reduced_.col(targets_.cols()).head(n).dot(reduced_.col(0).head(n)) / constant_precision();
}

template <class Use>
void GaussianProcess::with_prior(const Use& use) const {
  if (same_prior_) {
    use(Eigen::ArrayXd::Constant(candidates_.size(), prior_(0) + prior_of_constant()));
  } else {
    use(prior_.array() + prior_of_constant());
  }
}

void GaussianProcess::read_mean(int output, Eigen::VectorXd& out) const {
  out.resize(candidates_.size());
  const double signal = settings(output).signal;
  const double mean = settings(output).mean;
  if (!with_constant()) return maps().read_mean(output, {-kUnbound, kUnbound, signal, mean}, out);
  maps().read_mean(output, kAsItIs, out);
  Eigen::VectorXd explained(out.size());
  maps().read_mean(shown_, kAsItIs, explained);
  out.array() = signal * (out.array() + constant_mean() * (1.0 - explained.array())) + mean;
}

void GaussianProcess::read_standard_variance(Eigen::VectorXd& out) const {
  out.resize(candidates_.size());
  maps().read_variance(kAsItIs, out);
  if (with_constant()) {
    Eigen::VectorXd explained(out.size());
    maps().read_mean(shown_, kAsItIs, explained);
    out.array() += (1.0 - explained.array()).square() / constant_precision();
  }
}

void GaussianProcess::read_bound_variance(double scale, Eigen::VectorXd& out) const {
  if (same_prior_ && !with_constant()) {
    out.resize(candidates_.size());
    return maps().read_variance({0.0, prior_(0), scale, 0.0}, out);
  }
  read_standard_variance(out);
  with_prior([&](const auto& prior) { out.array() = out.array().max(0.0).min(prior) * scale; });
}

void GaussianProcess::read_variance(int output, Eigen::VectorXd& out) const {
  read_bound_variance(settings(output).signal * settings(output).signal, out);
}

void GaussianProcess::read_relative_variance(Eigen::VectorXd& out) const {
  read_bound_variance(1.0, out);
  with_prior([&](const auto& prior) {
    if (!same_prior_ || prior(0) != 1.0) out.array() /= prior;  // dividing takes longest, and most priors are 1
  });
}

int GaussianProcess::variances_clamped() const {
  Eigen::VectorXd variance;
  read_standard_variance(variance);
  // A last digit above the prior is no news; below 0 every digit is.
  Eigen::Index clamped = 0;
  with_prior([&](const auto& prior) {
    clamped = (variance.array() < 0.0 || variance.array() > prior * (1.0 + 4.0 * kEpsilon)).count();
  });
  return static_cast<int>(clamped);
}

double GaussianProcess::misfit(int output) const {
  const auto reduced = reduced_.col(output).head(factor_.size());
  if (!with_constant()) return reduced.squaredNorm();
  const double common = reduced_.col(targets_.cols()).head(factor_.size()).dot(reduced);
  return reduced.squaredNorm() - common * common / constant_precision();
}

double GaussianProcess::log_marginal_likelihood(int output) const {
  const int n = factor_.size();
  if (n == 0) return 0.0;
  double log_determinant = factor_.log_determinant();
  if (with_constant()) log_determinant += math::log(constant_precision() * prior_of_constant());
  return -0.5 * (misfit(output) + log_determinant + n * kLogTwoPi) - n * math::log(settings(output).signal);
}

}  // namespace palpate
