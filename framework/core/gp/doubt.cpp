// SPDX-License-Identifier: MIT
#include "gp/doubt.hpp"

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

void DoubtedSurface::judge(const GaussianProcess& process, const VectorView& suspicion,
                           const Eigen::VectorXd& roughness) {
  const GpSettings& settings = process.settings();
  judged_ = process.size() > 0 && settings.noise > 0.0;
  judgement_.doubt = suspicion;
  report_.jitter = 0.0;
  report_.redundant_taps = 0;
  if (!judged_) return;
  Testimony testimony;
  const auto taps = static_cast<Eigen::Index>(process.size());
  testimony.covariance.resize(taps, taps);
  process.kernel().covariance(process.places(), process.places(), testimony.covariance);
  const Points closer = process.places() / kBroader;
  testimony.broad.resize(taps, taps);
  process.kernel().covariance(closer, closer, testimony.broad);
  testimony.heights = process.targets().array() - settings.mean;
  testimony.suspicion = suspicion;
  testimony.roughness = roughness;
  for (const double share : kSignals) testimony.signals.push_back(share * settings.signal);
  for (const double share : kNoises) testimony.noises.push_back(share * settings.noise);
  testimony.broad_signal = kBroadSignal * settings.signal;
  testimony.level = settings.mean_ratio * settings.signal;
  testimony.lie = math::hypot(settings.signal, testimony.level);
  judgement_ = palpate::judge(testimony);
  if (settings.noise < kExact * settings.signal) {
    testimony.noises.clear();
    for (const double share : kRough) testimony.noises.push_back(share * settings.signal);
    const Judgement rough = palpate::judge(testimony);
    judged_ = !(rough.log_evidence > judgement_.log_evidence + kStrong);
    if (!judged_) {
      judgement_.doubt = rough.doubt;
      judgement_.report = rough.report;
    }
  }
  report_.add(judgement_.report);
}

void DoubtedSurface::forget() {
  clamped_ = 0;
  judgement_ = {};
  judged_ = false;
  covered_ = 0;
}

void DoubtedSurface::cover(const GaussianProcess& process) {
  const Eigen::Index taps = process.size();
  if (generation_ != process.generation()) covered_ = 0;
  generation_ = process.generation();
  if (covariances_.cols() < taps) {
    const Eigen::Index room = std::max(2 * covariances_.cols(), taps);
    covariances_.conservativeResize(candidates_.size(), room);
    broad_.conservativeResize(candidates_.size(), room);
  }
  const PointsView places = process.places();
  const Points closer = candidates_.points / kBroader;
  for (; covered_ < taps; ++covered_) {
    const auto place = places.middleRows(covered_, 1);
    process.kernel().covariance(candidates_.points, place, covariances_.middleCols(covered_, 1));
    process.kernel().covariance(closer, Points(place / kBroader), broad_.middleCols(covered_, 1));
  }
}

void DoubtedSurface::read_mean(const GaussianProcess& process, Eigen::VectorXd& out) {
  if (!judged_) return process.read_mean(0, out);
  cover(process);
  out = covariances_.leftCols(covered_) * judgement_.a.segment(1, covered_) +
        broad_.leftCols(covered_) * judgement_.a.tail(covered_);
  out.array() += judgement_.a(0) + process.settings().mean;
}

void DoubtedSurface::read_variance(const GaussianProcess& process, Eigen::VectorXd& out) {
  if (!judged_) return process.read_variance(0, out);
  cover(process);
  // z^T b z by half of the products, as b is symmetric, and so many candidates at a time that theirs stay in the cache.
  constexpr Eigen::Index kTogether = 128;
  Eigen::MatrixXd half = judgement_.b.triangularView<Eigen::StrictlyUpper>();
  half.diagonal() = 0.5 * judgement_.b.diagonal();
  Eigen::MatrixXd z = Eigen::MatrixXd::Ones(kTogether, half.rows());
  out.resize(candidates_.size());
  process.kernel().variance(candidates_.points, out);
  out *= judgement_.s2;
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

DoubtedSurface::Height DoubtedSurface::at(const GaussianProcess& process, int candidate) const {
  const auto place = candidates_.points.middleRows(candidate, 1);
  const Points closer = place / kBroader;
  const Eigen::Index taps = this->taps();
  Eigen::VectorXd z(1 + 2 * taps);
  z(0) = 1.0;
  Eigen::MatrixXd column(taps, 1);
  process.kernel().covariance(process.places().topRows(taps), place, column);
  z.segment(1, taps) = column;
  process.kernel().covariance(Points(process.places().topRows(taps) / kBroader), closer, column);
  z.tail(taps) = column;
  Eigen::VectorXd own(1);
  process.kernel().variance(place, own);
  return {z.dot(judgement_.a) + process.settings().mean,
          std::max(0.0, judgement_.s2 * own(0) + z.dot(judgement_.b * z))};
}

}  // namespace palpate
