// SPDX-License-Identifier: MIT
#include "gp/robust_surface.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Of the signal of the config: a surface may go up and down as far as that, or be nearly flat.
constexpr double kSignals[] = {1.0, 0.3, 0.1};
/// Of the noise of the config, which is that of a rough arm: a perfect one is more exact.
constexpr double kNoises[] = {1.0, 1.0 / 6.0};
/// Of the signal, and how many times as far as the kernel's its covariance reaches.
constexpr double kBroadSignal = 0.5;
constexpr double kBroader = 2.5;
/// Of the signal. Below the first a process claims to be exact, which few surfaces keep to: see judge(). The others are
/// the noises by which it is contradicted, from those of a good arm to what a kernel that is much too smooth leaves
/// over.
constexpr double kExact = 0.03;
constexpr double kRough[] = {0.3, 0.06, 0.01};
/// Strong evidence, a ratio of ten (Jeffreys 1961), as a natural logarithm.
constexpr double kStrong = 2.3;

}  // namespace

void RobustSurface::update(const GaussianProcess& process, const VectorView& suspicion,
                           const Eigen::VectorXd& roughness) {
  const GpSettings& settings = process.settings();
  judged_ = process.size() > 0 && settings.noise > 0.0;
  posterior_.probability = suspicion;
  report_.jitter = 0.0;
  report_.redundant_taps = 0;
  if (!judged_) return;
  OutlierProblem problem;
  const auto taps = static_cast<Eigen::Index>(process.size());
  problem.covariance.resize(taps, taps);
  process.kernel().covariance(process.positions(), process.places(), problem.covariance);
  const Points closer = process.positions() / kBroader;
  problem.broad_covariance.resize(taps, taps);
  process.kernel().covariance(closer, closer, problem.broad_covariance);
  problem.heights = process.targets().array() - settings.mean;
  problem.prior = suspicion;
  problem.extra_variance = roughness;
  for (const double share : kSignals) problem.signals.push_back(share * settings.signal);
  for (const double share : kNoises) problem.noises.push_back(share * settings.noise);
  problem.broad_signal = kBroadSignal * settings.signal;
  problem.mean_deviation = settings.mean_ratio * settings.signal;
  problem.outlier_deviation = math::hypot(settings.signal, problem.mean_deviation);
  posterior_ = infer_outliers(problem);
  if (settings.noise < kExact * settings.signal) {
    problem.noises.clear();
    for (const double share : kRough) problem.noises.push_back(share * settings.signal);
    const OutlierPosterior rough = infer_outliers(problem);
    judged_ = !(rough.log_evidence > posterior_.log_evidence + kStrong);
    if (!judged_) {
      posterior_.probability = rough.probability;
      posterior_.report = rough.report;
    }
  }
  report_.add(posterior_.report);
}

void RobustSurface::reset() {
  clamped_ = 0;
  posterior_ = {};
  judged_ = false;
  covered_ = 0;
}

void RobustSurface::cover(const GaussianProcess& process) {
  const Eigen::Index taps = process.size();
  if (generation_ != process.generation()) covered_ = 0;
  generation_ = process.generation();
  if (covariances_.cols() < taps) {
    const Eigen::Index room = std::max(2 * covariances_.cols(), taps);
    covariances_.conservativeResize(candidates_.size(), room);
    broad_.conservativeResize(candidates_.size(), room);
  }
  const PointsView places = process.positions();
  const Points closer = candidates_.points / kBroader;
  for (; covered_ < taps; ++covered_) {
    const auto place = places.middleRows(covered_, 1);
    process.kernel().covariance(candidates_.points, place, covariances_.middleCols(covered_, 1));
    process.kernel().covariance(closer, Points(place / kBroader), broad_.middleCols(covered_, 1));
  }
}

void RobustSurface::read_mean(const GaussianProcess& process, Eigen::VectorXd& out) {
  if (!judged_) return process.read_mean(0, out);
  cover(process);
  out = covariances_.leftCols(covered_) * posterior_.a.segment(1, covered_) +
        broad_.leftCols(covered_) * posterior_.a.tail(covered_);
  out.array() += posterior_.a(0) + process.settings().mean;
}

void RobustSurface::read_variance(const GaussianProcess& process, Eigen::VectorXd& out) {
  if (!judged_) return process.read_variance(0, out);
  cover(process);
  // z^T b z by half of the products, as b is symmetric, and so many candidates at a time that theirs stay in the cache.
  constexpr Eigen::Index kTogether = 128;
  Eigen::MatrixXd half = posterior_.b.triangularView<Eigen::StrictlyUpper>();
  half.diagonal() = 0.5 * posterior_.b.diagonal();
  Eigen::MatrixXd z = Eigen::MatrixXd::Ones(kTogether, half.rows());
  out.resize(candidates_.size());
  process.kernel().variance(candidates_.points, out);
  out *= posterior_.s2;
  Eigen::MatrixXd products(kTogether, half.cols());
  for (Eigen::Index first = 0; first < out.size(); first += kTogether) {
    const Eigen::Index count = std::min(kTogether, out.size() - first);
    z.block(0, 1, count, covered_) = covariances_.block(first, 0, count, covered_);
    z.block(0, 1 + covered_, count, covered_) = broad_.block(first, 0, count, covered_);
    products.noalias() = z * half.triangularView<Eigen::Upper>();
    out.segment(first, count) += 2.0 * products.cwiseProduct(z).rowwise().sum().head(count);
  }
  // Rounding may leave less than nothing where taps are close.
  clamped_ = static_cast<int>((out.array() < 0.0).count());
  out = out.cwiseMax(0.0);
}

RobustSurface::Height RobustSurface::at(const GaussianProcess& process, int candidate) const {
  const auto place = candidates_.points.middleRows(candidate, 1);
  const Points closer = place / kBroader;
  const Eigen::Index taps = this->taps();
  Eigen::VectorXd z(1 + 2 * taps);
  z(0) = 1.0;
  Eigen::MatrixXd column(taps, 1);
  process.kernel().covariance(process.positions().topRows(taps), place, column);
  z.segment(1, taps) = column;
  process.kernel().covariance(Points(process.positions().topRows(taps) / kBroader), closer, column);
  z.tail(taps) = column;
  Eigen::VectorXd own(1);
  process.kernel().variance(place, own);
  return {z.dot(posterior_.a) + process.settings().mean,
          std::max(0.0, posterior_.s2 * own(0) + z.dot(posterior_.b * z))};
}

}  // namespace palpate
