// SPDX-License-Identifier: MIT
#include "gp/gaussian_process.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace palpate {
namespace {

constexpr double kLogTwoPi = 1.83787706640934548356;

bool is_positive(double value) { return std::isfinite(value) && value > 0.0; }

}  // namespace

GaussianProcess::GaussianProcess(std::shared_ptr<Kernel> kernel, std::vector<GpSettings> outputs,
                                 const CandidateGrid& candidates, EngineSettings engine)
    : kernel_(std::move(kernel)),
      outputs_(std::move(outputs)),
      maps_(*kernel_, candidates, std::move(engine), static_cast<int>(outputs_.size()),
            outputs_.front().mean_ratio > 0.0) {
  reserve(1);
}

void GaussianProcess::reserve(int taps) {
  if (targets_.rows() >= taps) return;
  // Memory for the expected number of taps is reserved, up to a limit, so that no tap allocates memory. Beyond the
  // limit, the capacity doubles.
  constexpr int kMostExpected = 4096;
  const int capacity = std::max(std::min(maps_.settings().taps, kMostExpected), targets_.rows() == 0 ? taps : 2 * taps);
  positions_.conservativeResize(capacity, 2);
  targets_.conservativeResize(capacity, static_cast<Eigen::Index>(outputs_.size()));
  trust_.conservativeResize(capacity);
  factor_.reserve(capacity);
  factored_.conservativeResize(capacity, 2);
  solved_.conservativeResize(capacity, maps_.columns());
  covariance_.resize(capacity);
  maps_.reserve(capacity);
}

void GaussianProcess::add(const Target& position, const VectorView& values) {
  reserve(size_ + 1);
  positions_(size_, 0) = position.x;
  positions_(size_, 1) = position.y;
  targets_.row(size_) = values.transpose();
  trust_(size_) = 1.0;
  ++size_;
  if (!append(size_ - 1)) rebuild();
}

bool GaussianProcess::set_positions(const PointsView& positions) {
  if (!replace(positions_.topRows(size_), positions)) return false;
  ++generation_;
  return true;
}

/// Appends a tap to the factor. Returns false if the factor would become singular.
bool GaussianProcess::append(int tap) {
  const int row = factor_.size();
  factored_.row(row) = positions_.row(tap);
  // middleRows() is used instead of row(): row() has one row at compile time, and the conversion to a PointsView would
  // copy it to the heap.
  const auto position = factored_.middleRows(row, 1);
  kernel_->covariance(factored_.topRows(row), position, covariance_.head(row));
  double own = 0.0;
  kernel_->variance(position, Eigen::Map<Eigen::VectorXd>(&own, 1));
  if (!factor_.append(covariance_.head(row), own + noise_ratio() * noise_ratio() / trust_(tap) + report_.jitter))
    return false;
  const VectorView earlier = factor_.row(row);
  const auto solve = [&](Eigen::Index column, double value) {
    solved_(row, column) = (value - earlier.dot(solved_.col(column).head(row))) / factor_.pivot(row);
  };
  for (Eigen::Index k = 0; k < targets_.cols(); ++k) {
    const GpSettings& output = settings(static_cast<int>(k));
    solve(k, (targets_(tap, k) - output.mean) / output.signal);
  }
  if (solved_.cols() > targets_.cols()) solve(targets_.cols(), 1.0);
  return true;
}

/// Factorises these taps in their order. Returns false at the first tap that makes the factor singular.
bool GaussianProcess::factorise(const std::vector<int>& taps) {
  factor_.clear();
  maps_.restart();
  return std::all_of(taps.begin(), taps.end(), [this](int tap) { return append(tap); });
}

void GaussianProcess::rebuild() {
  std::vector<int> taps(static_cast<std::size_t>(size_));
  std::iota(taps.begin(), taps.end(), 0);
  const auto pivot = [&] {
    Eigen::MatrixXd covariance(size_, size_);
    kernel_->covariance(positions(), positions(), covariance);
    covariance.diagonal().array() += noise_ratio() * noise_ratio() / trust_.head(size_).array() + report_.jitter;
    taps = independent_rows(covariance);
    // The pivots of independent_rows() and factorise() differ by rounding. factorise() may reject a tap; this tap and
    // all later taps are then redundant, too.
    factorise(taps);
  };
  regularise(
      report_, size_, maps_.largest_prior(), [&] { return factorise(taps); }, pivot);
}

FitSummary GaussianProcess::fit(const Fitting& fitting, Random& random) {
  std::vector<double> old;
  for (const KernelParameter& one : kernel_->parameters()) old.push_back(one.value);
  std::vector<GpSettings> fitted = outputs_;
  double ratio = noise_ratio();
  FitProblem problem{positions(), *kernel_, ratio, outputs_.front().mean_ratio, {}, &fit_memory_};
  for (std::size_t k = 0; k < fitted.size(); ++k)
    problem.outputs.push_back({targets(static_cast<int>(k)), fitted[k].signal, fitted[k].mean});
  FitSummary summary = fitting.fit(problem, random);
  if (!summary.changed) return summary;

  const std::vector<KernelParameter> parameters = kernel_->parameters();
  const bool valid =
      std::isfinite(ratio) && ratio >= 0.0 &&
      std::all_of(parameters.begin(), parameters.end(), [](const auto& one) { return is_positive(one.value); }) &&
      std::all_of(fitted.begin(), fitted.end(),
                  [](const auto& one) { return is_positive(one.signal) && std::isfinite(one.mean); });
  if (!valid) {
    kernel_->set_parameters(Eigen::Map<const Eigen::VectorXd>(old.data(), static_cast<Eigen::Index>(old.size())));
    summary.changed = false;
    summary.failed = true;
    summary.reason = "a number that is not finite and positive was rejected; " + summary.reason;
    return summary;
  }
  ++generation_;
  outputs_ = fitted;
  for (GpSettings& one : outputs_) one.noise = ratio * one.signal;
  report_.jitter = 0.0;
  maps_.take_hyperparameters();
  rebuild();
  return summary;
}

std::optional<UnknownMean> GaussianProcess::unknown_mean() const {
  if (solved_.cols() == targets_.cols()) return std::nullopt;
  const double prior = outputs_.front().mean_ratio * outputs_.front().mean_ratio;
  const auto ones = solved_.col(targets_.cols()).head(factor_.size());
  const double precision = 1.0 / prior + ones.squaredNorm();
  return UnknownMean{ones.dot(solved_.col(0).head(factor_.size())) / precision, precision, prior};
}

GpDiagnostics GaussianProcess::diagnostics(int output) const {
  GpDiagnostics out;
  const int n = factor_.size();
  const double signal = settings(output).signal;
  const auto solved = solved_.col(output).head(n);
  out.misfit = solved.squaredNorm();
  double log_determinant = factor_.log_determinant();
  if (const std::optional<UnknownMean> unknown = unknown_mean()) {
    const double common = solved_.col(targets_.cols()).head(n).dot(solved);
    out.misfit -= common * common / unknown->precision;
    log_determinant += math::log(unknown->precision * unknown->prior_variance);
  }
  if (n > 0)
    out.log_marginal_likelihood = -0.5 * (out.misfit + log_determinant + n * kLogTwoPi) - n * math::log(signal);
  out.factors = report_;
  out.factors.jitter = report_.jitter * signal * signal;
  out.factors.redundant_taps = size_ - n;
  out.condition = factor_.condition();
  return out;
}

void GaussianProcess::update_maps() {
  const double noise = std::sqrt(noise_ratio() * noise_ratio() + report_.jitter);
  maps_.update({factor_, factored_, solved_, noise, unknown_mean()});
}

const PosteriorMaps& GaussianProcess::maps() const {
  if (!maps_.have_rows(factor_.size())) throw std::logic_error("a map of a GP is read that is older than its taps");
  return maps_;
}

}  // namespace palpate
