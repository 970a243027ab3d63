// SPDX-License-Identifier: MIT
#include "solids/residual_gp.hpp"

#include "gp/factor.hpp"

#include <palpate/error.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Factorises the rows `which` of a covariance. Adds its noise, and `jitter` times the entry, to each diagonal entry.
/// Returns the factorised rows. Rows with which the matrix is not positive definite in double precision are left out.
std::vector<int> factorise(Factor& factor, const MatrixXd& covariance, const std::vector<int>& which,
                           const VectorXd& noise, double jitter) {
  factor.clear();
  std::vector<int> taken;
  for (const int i : which) {
    if (factor.append(VectorXd(covariance.col(i)(taken)), (1.0 + jitter) * covariance(i, i) + noise(i)))
      taken.push_back(i);
  }
  return taken;
}

}  // namespace

std::vector<ResidualGp::ResidualDatum> ResidualGp::contacts_of(const Assembly& solids,
                                                               const std::vector<SurfaceTouch>& touches) const {
  std::vector<ResidualDatum> out;
  std::vector<ResidualDatum> slopes;
  for (const SurfaceTouch& touch : touches) {
    if (!touch.contact || touch.desk) continue;
    const Place place{touch.end(), solids.normal(touch.end())};
    const double off = solids.distance(place.at);
    if (!(std::abs(off) <= kMaxResidual)) continue;
    out.push_back({place, Vector3d::Zero(), off, settings_.noise});
    // Smallest cosine between the measured normal and the assembly's normal. Below it, the assembly's nearest surface
    // is not the one that was touched.
    constexpr double kTurned = 0.5;
    if (!touch.normal || touch.normal->dot(place.normal) < kTurned) continue;
    if (!kernel_.has_gradient())
      throw Error("kernel", "is not differentiable everywhere, but measured surface normals need its derivatives",
                  "choose matern32, matern52 or rbf");
    const Vector3d one = touch.normal->unitOrthogonal();
    for (const Vector3d& across : {one, Vector3d(touch.normal->cross(one))})
      slopes.push_back({place, across, across.dot(place.normal), settings_.tilt});
  }
  out.insert(out.end(), slopes.begin(), slopes.end());
  return out;
}

void ResidualGp::take_in(std::vector<ResidualDatum> rows) {
  ResidualKernel::DatumTable table = ResidualKernel::table_of(rows);
  MatrixXd covariance = kernel_.covariances(table, table);
  const auto n = static_cast<Eigen::Index>(rows.size());
  VectorXd noise(n), targets(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ResidualDatum& row = rows[static_cast<std::size_t>(i)];
    noise(i) = row.noise * row.noise;
    targets(i) = row.target;
  }
  std::vector<int> all(rows.size());
  std::iota(all.begin(), all.end(), 0);
  Factor factor;
  factor.reserve(static_cast<int>(n));
  const auto with_jitter = [&] {
    factorise(factor, covariance, all, noise, report_.jitter);
    return factor.size() == n;
  };
  const auto pivot = [&] {
    covariance.diagonal() += report_.jitter * covariance.diagonal() + noise;
    const std::vector<int> taken = factorise(factor, covariance, independent_rows(covariance), VectorXd::Zero(n), 0.0);
    std::vector<ResidualDatum> kept;
    for (const int i : taken) kept.push_back(rows[static_cast<std::size_t>(i)]);
    rows = kept;
    targets = VectorXd(targets(taken));
    table = ResidualKernel::table_of(rows);
  };
  regularise(report_, n, 1.0, with_jitter, pivot);
  report_.redundant_taps = static_cast<int>(n) - factor.size();
  decltype(known_.lower) lower(factor.size(), factor.size());
  lower.setZero();
  for (int i = 0; i < factor.size(); ++i) {
    lower.row(i).head(i) = factor.row(i);
    lower(i, i) = factor.pivot(i);
  }
  lower.triangularView<Eigen::Lower>().solveInPlace(targets);
  lower.triangularView<Eigen::Lower>().transpose().solveInPlace(targets);
  known_ = {std::move(rows), std::move(table), std::move(lower), std::move(targets)};
}

void ResidualGp::fit(const Assembly& solids, const std::vector<SurfaceTouch>& touches) {
  std::vector<ResidualDatum> rows = contacts_of(solids, touches);
  double squares = 0.0;
  int count = 0;
  for (const ResidualDatum& row : rows) {
    if (!row.along.isZero(0.0)) continue;
    squares += row.target * row.target;
    ++count;
  }
  const double rms = count == 0 ? settings_.most : std::sqrt(squares / count);
  constexpr double kLeast = 0.001;
  kernel_.set_signal(std::clamp(rms, std::min(kLeast, settings_.most), settings_.most));
  report_.jitter = 0.0;
  take_in(std::move(rows));
  free_paths_ = hold_free_paths(kernel_, solids, touches, settings_.noise, known_);
  report_.redundant_taps += free_paths_.redundant;
}

ResidualGp::Posterior ResidualGp::posterior(const Places& places) const {
  const auto all = static_cast<Eigen::Index>(places.size());
  Posterior out{VectorXd(all), VectorXd(all)};
  loops::AlignedArray left(loops::kBlock);
  kernel_.for_blocks(places, known_.table, [&](Eigen::Index first, Eigen::Index count, Eigen::Map<MatrixXd> k) {
    out.mean.segment(first, count).noalias() = k.topRows(count) * known_.weights;
    std::fill_n(left.data(), loops::kBlock, deviation() * deviation());
    loops::Update variance{};
    variance.variance = left.data();
    for (Eigen::Index i = 0; i < known_.lower.rows(); ++i)
      loops::absorb_dense({k.data(), k.col(i).data(), &known_.lower(i, 0), static_cast<int>(i), known_.lower(i, i)},
                          variance);
    out.variance.segment(first, count) = Eigen::Map<const VectorXd>(left.data(), count);
  });
  out.clamped = static_cast<int>((out.variance.array() < 0.0).count());
  out.variance = out.variance.cwiseMax(0.0);
  return out;
}

double ResidualGp::mean(const Place& place) const {
  return kernel_.covariances(known_.table, ResidualKernel::table_of({{place}})).col(0).dot(known_.weights);
}

}  // namespace palpate
