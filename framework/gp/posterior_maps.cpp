// SPDX-License-Identifier: MIT
#include "gp/posterior_maps.hpp"

#include "regular/regular_factor.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace palpate {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr loops::MapTransform kUnchanged{-kUnbounded, kUnbounded, 1.0, 0.0};

}  // namespace

PosteriorMaps::PosteriorMaps(const Kernel& kernel, const CandidateGrid& candidates, EngineSettings settings,
                             int outputs, bool unknown_mean)
    : kernel_(kernel),
      candidates_(candidates),
      settings_(std::move(settings)),
      outputs_(outputs),
      unknown_mean_(unknown_mean) {
  const std::string why = objection(settings_, kernel_, candidates_);
  if (!why.empty()) throw Error("engine", "cannot be used here: " + why);
  take_hyperparameters();
}

void PosteriorMaps::reserve(int taps) {
  weights_.conservativeResize(taps, columns());
  inverse_.resize(taps);
  choice_.engine->reserve(taps);
}

void PosteriorMaps::take_hyperparameters() {
  prior_.resize(candidates_.size());
  kernel_.variance(candidates_.points, prior_);
  if (prior_.minCoeff() == prior_.maxCoeff()) prior_.conservativeResize(1);
  choose(0.0);
}

void PosteriorMaps::choose(double error) {
  choice_ = choose_engine(settings_, kernel_, candidates_, error);
  restart();
  choice_.engine->reserve(static_cast<int>(weights_.rows()));
}

void PosteriorMaps::show(int outputs) {
  if (outputs <= shown_) return;
  shown_ = outputs;
  restart();
}

void PosteriorMaps::update(const FactoredTaps& taps) {
  noise_ = taps.noise;
  unknown_ = taps.unknown;
  take_rows(taps);
  if (settings_.engine != EngineSettings::Kind::automatic) return;
  const double error = error_bound();
  if (!(error > settings_.accuracy)) return;
  choose(error);
  take_rows(taps);
}

void PosteriorMaps::take_rows(const FactoredTaps& taps) {
  if (rows_ == kNoRows) {
    inverse_norms_ = 0.0;
    choice_.engine->restart(shown_ + (unknown_mean_ ? 1 : 0), prior_);
    rows_ = 0;
  }
  for (; rows_ < taps.factor.size(); ++rows_) absorb(taps, rows_);
}

void PosteriorMaps::absorb(const FactoredTaps& taps, int row) {
  Engine& engine = *choice_.engine;
  VectorOut inverse = inverse_.head(engine.needs_inverse() ? row + 1 : 0);
  if (engine.needs_inverse()) {
    taps.factor.inverse_row(row, inverse);
    const double norm = inverse.lpNorm<1>();
    inverse_norms_ += norm * norm;
    weights_.row(row).setZero();
    for (Eigen::Index k = 0; k < columns(); ++k) weights_.col(k).head(row + 1) += taps.solved(row, k) * inverse;
  }
  std::array<double, loops::kMeans> coefficients{};
  for (int k = 0; k < shown_; ++k) coefficients[static_cast<std::size_t>(k)] = taps.solved(row, k);
  if (unknown_mean_) coefficients[static_cast<std::size_t>(shown_)] = taps.solved(row, outputs_);
  engine.absorb(
      {taps.positions.topRows(row + 1), taps.factor.row(row), taps.factor.pivot(row), inverse, coefficients.data()});
}

void PosteriorMaps::read_mean(int output, double signal, double mean, Eigen::VectorXd& out) const {
  const MapTiles& maps = choice_.engine->maps();
  out.resize(candidates_.size());
  if (!unknown_) return maps.read_mean(output, {-kUnbounded, kUnbounded, signal, mean}, out);
  maps.read_mean(output, kUnchanged, out);
  Eigen::VectorXd explained(out.size());
  maps.read_mean(shown_, kUnchanged, explained);
  out.array() = signal * (out.array() + unknown_->mean * (1.0 - explained.array())) + mean;
}

void PosteriorMaps::read_raw_variance(Eigen::VectorXd& out) const {
  const MapTiles& maps = choice_.engine->maps();
  out.resize(candidates_.size());
  maps.read_variance(kUnchanged, out);
  if (!unknown_) return;
  Eigen::VectorXd explained(out.size());
  maps.read_mean(shown_, kUnchanged, explained);
  out.array() += (1.0 - explained.array()).square() / unknown_->precision;
}

template <class Use>
void PosteriorMaps::with_prior(const Use& use) const {
  const double of_mean = unknown_ ? unknown_->prior_variance : 0.0;
  if (prior_.size() == 1) {
    use(Eigen::ArrayXd::Constant(candidates_.size(), prior_(0) + of_mean));
  } else {
    use(prior_.array() + of_mean);
  }
}

void PosteriorMaps::read_variance(double scale, Eigen::VectorXd& out) const {
  if (prior_.size() == 1 && !unknown_) {
    out.resize(candidates_.size());
    return choice_.engine->maps().read_variance({0.0, prior_(0), scale, 0.0}, out);
  }
  read_raw_variance(out);
  with_prior([&](const auto& prior) { out.array() = out.array().max(0.0).min(prior) * scale; });
}

void PosteriorMaps::read_relative_variance(Eigen::VectorXd& out) const {
  read_variance(1.0, out);
  with_prior([&](const auto& prior) {
    if (prior_.size() > 1 || prior(0) != 1.0) out.array() /= prior;  // most priors are 1, and division is slow
  });
}

int PosteriorMaps::variances_clamped() const {
  Eigen::VectorXd variance;
  read_raw_variance(variance);
  Eigen::Index clamped = 0;
  with_prior([&](const auto& prior) {
    // A value that exceeds the prior only by rounding in the last place does not count. Any value below 0 counts.
    clamped = (variance.array() < 0.0 || variance.array() > prior * (1.0 + 4.0 * kEpsilon)).count();
  });
  return static_cast<int>(clamped);
}

double PosteriorMaps::error_bound() const {
  const VectorView errors = choice_.engine->covariance_errors();
  if (errors.size() == 0 || !(errors.maxCoeff() > 0.0)) return 0.0;
  const double prior = largest_prior();
  const double deviation = std::sqrt(prior);
  // L^-1 lengthens a vector by a factor of at most 1 / noise, because each eigenvalue of L L^T is at least noise^2.
  const double row = std::min(errors.maxCoeff() * std::sqrt(inverse_norms_), errors.norm() / noise_) / deviation;
  double variance = 2.0 * row + row * row;
  double mean = 0.0;
  const auto error_of = [&](Eigen::Index column) { return errors.dot(weights_.col(column).head(rows_).cwiseAbs()); };
  for (int k = 0; k < outputs_; ++k) mean = std::max(mean, error_of(k) / deviation);
  if (unknown_) {
    const double explained = weights_.col(outputs_).head(rows_).lpNorm<1>();
    const double error = error_of(outputs_);
    mean += std::abs(unknown_->mean) * error / deviation;
    variance += 2.0 * (1.0 + explained * prior) * error / (unknown_->precision * prior);
  }
  return std::max(mean, variance);
}

}  // namespace palpate
