// SPDX-License-Identifier: MIT
#include "gp/robust_surface.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Possible signals of the surface, as shares of the configured signal. Small signals are included because a surface
/// may be nearly flat.
constexpr double kSignals[] = {1.0, 0.3, 0.1};
/// Possible noises of a tap, as shares of the configured noise. The configured noise describes an inexact arm; the
/// smaller noise describes an exact arm.
constexpr double kNoises[] = {1.0, 1.0 / 6.0};
/// Standard deviation of the broad signal, as a share of the configured signal, and its length scale, divided by the
/// length scale of the kernel.
constexpr double kBroadSignal = 0.5;
constexpr double kBroadScale = 2.5;
/// Noise, as a share of the signal, below which heights of inliers may contradict a GP; see update().
constexpr double kExactNoise = 0.03;
/// Noises for the comparison in update(), as shares of the signal. The largest noise is about the residual of a kernel
/// that is much too smooth. The smallest noise is that of an exact arm.
constexpr double kRoughNoises[] = {0.3, 0.06, 0.01};
/// Natural logarithm of the evidence ratio 10, which is strong evidence (Jeffreys 1961).
constexpr double kStrongEvidence = 2.3;

OutlierProblem problem_of(const GaussianProcess& gp, const VectorView& prior, const Eigen::VectorXd& extra_variance) {
  const GpSettings& settings = gp.settings();
  OutlierProblem out;
  const auto taps = static_cast<Eigen::Index>(gp.size());
  out.covariance.resize(taps, taps);
  gp.kernel().covariance(gp.positions(), gp.positions(), out.covariance);
  const Points closer = gp.positions() / kBroadScale;
  out.broad_covariance.resize(taps, taps);
  gp.kernel().covariance(closer, closer, out.broad_covariance);
  out.heights = gp.targets().array() - settings.mean;
  out.prior = prior;
  out.extra_variance = extra_variance;
  for (const double share : kSignals) out.signals.push_back(share * settings.signal);
  for (const double share : kNoises) out.noises.push_back(share * settings.noise);
  out.broad_signal = kBroadSignal * settings.signal;
  out.mean_deviation = settings.mean_ratio * settings.signal;
  out.outlier_deviation = math::hypot(settings.signal, out.mean_deviation);
  return out;
}

}  // namespace

void RobustSurface::update(const GaussianProcess& gp, const VectorView& prior, const Eigen::VectorXd& extra_variance) {
  const GpSettings& settings = gp.settings();
  excludes_outliers_ = gp.size() > 0 && settings.noise > 0.0;
  posterior_.probability = prior;
  report_.jitter = 0.0;
  report_.redundant_taps = 0;
  if (!excludes_outliers_) return;
  OutlierProblem problem = problem_of(gp, prior, extra_variance);
  posterior_ = infer_outliers(problem);
  if (settings.noise < kExactNoise * settings.signal) {
    problem.noises.clear();
    for (const double share : kRoughNoises) problem.noises.push_back(share * settings.signal);
    const OutlierPosterior rough = infer_outliers(problem);
    excludes_outliers_ = !(rough.log_evidence > posterior_.log_evidence + kStrongEvidence);
    if (!excludes_outliers_) {
      posterior_.probability = rough.probability;
      posterior_.report = rough.report;
    }
  }
  report_.add(posterior_.report);
}

void RobustSurface::reset() {
  clamped_ = 0;
  posterior_ = {};
  excludes_outliers_ = false;
  covered_ = 0;
}

void RobustSurface::update_covariances(const GaussianProcess& gp) {
  const Eigen::Index taps = gp.size();
  if (generation_ != gp.generation()) covered_ = 0;
  generation_ = gp.generation();
  if (covariances_.cols() < taps) {
    const Eigen::Index room = std::max(2 * covariances_.cols(), taps);
    covariances_.conservativeResize(candidates_.size(), room);
    broad_.conservativeResize(candidates_.size(), room);
  }
  const PointsView places = gp.positions();
  const Points closer = candidates_.points / kBroadScale;
  for (; covered_ < taps; ++covered_) {
    const auto place = places.middleRows(covered_, 1);
    gp.kernel().covariance(candidates_.points, place, covariances_.middleCols(covered_, 1));
    gp.kernel().covariance(closer, Points(place / kBroadScale), broad_.middleCols(covered_, 1));
  }
}

void RobustSurface::read_mean(const GaussianProcess& gp, Eigen::VectorXd& out) {
  if (!excludes_outliers_) return gp.read_mean(0, out);
  update_covariances(gp);
  out = covariances_.leftCols(covered_) * posterior_.a.segment(1, covered_) +
        broad_.leftCols(covered_) * posterior_.a.tail(covered_);
  out.array() += posterior_.a(0) + gp.settings().mean;
}

void RobustSurface::read_variance(const GaussianProcess& gp, Eigen::VectorXd& out) {
  if (!excludes_outliers_) return gp.read_variance(0, out);
  update_covariances(gp);
  // b is symmetric, so z^T b z needs only half of the products. The products of one batch of candidates fit into the
  // cache.
  constexpr Eigen::Index kBatch = 128;
  Eigen::MatrixXd half = posterior_.b.triangularView<Eigen::StrictlyUpper>();
  half.diagonal() = 0.5 * posterior_.b.diagonal();
  Eigen::MatrixXd z = Eigen::MatrixXd::Ones(kBatch, half.rows());
  out.resize(candidates_.size());
  gp.kernel().variance(candidates_.points, out);
  out *= posterior_.s2;
  Eigen::MatrixXd products(kBatch, half.cols());
  for (Eigen::Index first = 0; first < out.size(); first += kBatch) {
    const Eigen::Index count = std::min(kBatch, out.size() - first);
    z.block(0, 1, count, covered_) = covariances_.block(first, 0, count, covered_);
    z.block(0, 1 + covered_, count, covered_) = broad_.block(first, 0, count, covered_);
    products.noalias() = z * half.triangularView<Eigen::Upper>();
    out.segment(first, count) += 2.0 * products.cwiseProduct(z).rowwise().sum().head(count);
  }
  // Near taps, rounding may make a variance negative.
  clamped_ = static_cast<int>((out.array() < 0.0).count());
  out = out.cwiseMax(0.0);
}

RobustSurface::Height RobustSurface::at(const GaussianProcess& gp, int candidate) const {
  const auto place = candidates_.points.middleRows(candidate, 1);
  const Points closer = place / kBroadScale;
  const Eigen::Index taps = this->taps();
  Eigen::VectorXd z(1 + 2 * taps);
  z(0) = 1.0;
  Eigen::MatrixXd column(taps, 1);
  gp.kernel().covariance(gp.positions().topRows(taps), place, column);
  z.segment(1, taps) = column;
  gp.kernel().covariance(Points(gp.positions().topRows(taps) / kBroadScale), closer, column);
  z.tail(taps) = column;
  Eigen::VectorXd own(1);
  gp.kernel().variance(place, own);
  return {z.dot(posterior_.a) + gp.settings().mean, std::max(0.0, posterior_.s2 * own(0) + z.dot(posterior_.b * z))};
}

}  // namespace palpate
