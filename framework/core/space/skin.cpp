// SPDX-License-Identifier: MIT
#include "space/skin.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

using Eigen::Vector3d;

Vector3d Skin::normal(const Composition& solids, const Vector3d& at) {
  constexpr double kStep = 1e-5;
  Vector3d out;
  for (Eigen::Index i = 0; i < 3; ++i) {
    Vector3d step = Vector3d::Zero();
    step(i) = kStep;
    out(i) = solids.distance(at + step) - solids.distance(at - step);
  }
  const double length = out.norm();
  return length > 0.0 ? Vector3d(out / length) : Vector3d::UnitZ();
}

Eigen::VectorXd Skin::covariances(const Place& place, std::size_t count) const {
  const auto n = static_cast<Eigen::Index>(count);
  Points apart = Points::Zero(n, 2);
  Eigen::VectorXd normals(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Place& other = places_[static_cast<std::size_t>(i)];
    apart(i, 0) = (other.at - place.at).norm();
    normals(i) = 0.5 * (1.0 + other.normal.dot(place.normal));
  }
  Eigen::MatrixXd out(n, 1);
  kernel_->covariance(apart, Points::Zero(1, 2), out);
  return signal_ * signal_ * out.col(0).cwiseProduct(normals);
}

void Skin::fit(const Composition& solids, const std::vector<SurfaceTouch>& touches) {
  places_.clear();
  std::vector<double> targets;
  for (const SurfaceTouch& touch : touches) {
    if (!touch.contact || touch.desk) continue;
    const Vector3d end = touch.end();
    const double off = solids.distance(end);
    if (std::abs(off) > 0.012) continue;  // of something that the solids do not have
    places_.push_back({end, normal(solids, end)});
    targets.push_back(off);
  }
  double squares = 0.0;
  for (const double t : targets) squares += t * t;
  const double rms = targets.empty() ? settings_.most : std::sqrt(squares / static_cast<double>(targets.size()));
  constexpr double kLeast = 0.001;
  signal_ = std::clamp(rms, std::min(kLeast, settings_.most), settings_.most);
  const auto n = static_cast<Eigen::Index>(places_.size());
  Eigen::MatrixXd k(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    k.row(i).head(i + 1) =
        covariances(places_[static_cast<std::size_t>(i)], static_cast<std::size_t>(i) + 1).transpose();
    k(i, i) += settings_.noise * settings_.noise;
  }
  factor_.compute(k);
  weights_ =
      n > 0 ? Eigen::VectorXd(factor_.solve(Eigen::Map<const Eigen::VectorXd>(targets.data(), n))) : Eigen::VectorXd();
}

double Skin::mean(const Place& place) const {
  return places_.empty() ? 0.0 : covariances(place, places_.size()).dot(weights_);
}

double Skin::variance(const Place& place) const {
  if (places_.empty()) return signal_ * signal_;
  Eigen::VectorXd k = covariances(place, places_.size());
  factor_.matrixL().solveInPlace(k);
  return std::max(0.0, signal_ * signal_ - k.squaredNorm());
}

}  // namespace palpate
