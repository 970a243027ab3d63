// SPDX-License-Identifier: MIT
#include "solids/free_paths.hpp"

#include "solids/nonnegative_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace palpate {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// A point of a free path.
struct FreePathPoint {
  std::size_t way;
  ResidualKernel::Place place;
  double distance;      ///< signed distance to the assembly, metres
  double inside = 0.0;  ///< depth inside the surface at the last evaluation, metres
  bool taken = false;
};

/// Returns the points of free paths that are near the surface of the assembly or inside it. `reach`: bound of the mean
/// of the residual GP given the contacts alone, metres.
std::vector<FreePathPoint> passages_of(const ResidualKernel& kernel, const Assembly& solids,
                                       const std::vector<SurfaceTouch>& touches, double reach) {
  constexpr double kStep = 0.0015;
  constexpr double kDeviations = 3.0;
  const double deepest = std::min(kMaxResidual, kDeviations * kernel.deviation());
  const double near = std::max(deepest, reach);
  std::vector<FreePathPoint> out;
  for (std::size_t way = 0; way < touches.size(); ++way) {
    const std::size_t first = out.size();
    for (double along = 0.0; along < touches[way].length;) {
      const Vector3d at = touches[way].line.origin + along * touches[way].line.direction;
      const double distance = solids.distance(at);
      if (!(distance >= -deepest)) {  // skip the path: the residual GP cannot correct so large an error of the assembly
        out.resize(first);
        break;
      }
      if (distance < near) out.push_back({way, {at, solids.normal(at)}, distance});
      along += std::max(kStep, distance - near);
    }
  }
  return out;
}

/// Returns the deepest point of each stretch of a path inside the surface. A point that is already in the data ends a
/// stretch.
std::vector<FreePathPoint*> deepest(const std::vector<FreePathPoint*>& passages, double noise) {
  std::vector<FreePathPoint*> out;
  const FreePathPoint* before = nullptr;
  for (FreePathPoint* const one : passages) {
    const bool broken = !one->taken && one->inside > noise;
    if (broken && before != nullptr && before->way == one->way) {
      if (one->inside > out.back()->inside) out.back() = one;
    } else if (broken) {
      out.push_back(one);
    }
    before = broken ? one : nullptr;
  }
  return out;
}

/// Computes how far these points are inside the surface of the residual GP, metres.
void update_inside(const ResidualKernel& kernel, const ResidualData& known, const std::vector<FreePathPoint*>& some) {
  ResidualKernel::Places places;
  for (const FreePathPoint* const one : some) places.push_back(one->place);
  const VectorXd means = known.means(kernel, places);
  for (std::size_t i = 0; i < some.size(); ++i)
    some[i]->inside = means(static_cast<Eigen::Index>(i)) - some[i]->distance;
}

/// Updates all points and returns the points that are inside the surface or near it.
std::vector<FreePathPoint*> find_close(const ResidualKernel& kernel, const ResidualData& known,
                                       const std::vector<FreePathPoint*>& all) {
  constexpr double kClose = 0.003;  // metres: held points elsewhere usually move the surface outwards by less
  update_inside(kernel, known, all);
  std::vector<FreePathPoint*> out;
  std::copy_if(all.begin(), all.end(), std::back_inserter(out),
               [&](const FreePathPoint* one) { return one->inside > -kClose; });
  return out;
}

/// Fit of the residual GP to contacts and to the free points that hold the surface back. Let A = L * L' be the
/// covariance of the contacts, noise included. C is the covariance between the contacts and the free points, and V =
/// L^-1 * C. In NonnegativeSolver, S is then the covariance of the free points given the contacts, plus the noise of
/// the free points. d is the depth of the free points inside the surface that the contacts alone determine.
class ConstrainedFit {
 public:
  ConstrainedFit(const ResidualKernel& kernel, const ResidualData& contacts)
      : kernel_(kernel), contacts_(contacts), between_(contacts.weights.size(), 0) {}

  /// Adds free points, all with the same noise, to `paths`. Replaces the free points of `known` by those that hold the
  /// surface back in the new optimum.
  void add(const std::vector<ResidualKernel::ResidualDatum>& rows, FreePaths& paths, ResidualData& known) {
    const auto lower = contacts_.lower.triangularView<Eigen::Lower>();
    paths.points.insert(paths.points.end(), rows.begin(), rows.end());
    const ResidualKernel::DatumTable table = ResidualKernel::table_of(rows);
    const auto m = static_cast<Eigen::Index>(rows.size());
    MatrixXd with = kernel_.covariances(contacts_.table, table);
    VectorXd inside = with.transpose() * contacts_.weights;
    for (Eigen::Index i = 0; i < m; ++i) inside(i) -= rows[static_cast<std::size_t>(i)].target;
    lower.solveInPlace(with);
    between_.conservativeResize(Eigen::NoChange, between_.cols() + m);
    between_.rightCols(m) = with;
    MatrixXd left = kernel_.covariances(ResidualKernel::table_of(paths.points), table);
    left.noalias() -= between_.transpose() * with;
    left.diagonal(m - left.rows()).array() += rows.front().noise * rows.front().noise;
    pull_.append(left, inside);
    pull_.solve();
    paths.redundant = pull_.redundant_taps();

    VectorXd shift = between_(Eigen::all, pull_.held()) * pull_.values();
    lower.transpose().solveInPlace(shift);
    known.rows = contacts_.rows;
    for (const int i : pull_.held()) known.rows.push_back(paths.points[static_cast<std::size_t>(i)]);
    known.table = ResidualKernel::table_of(known.rows);
    known.weights.resize(contacts_.weights.size() + pull_.values().size());
    known.weights << contacts_.weights + shift, -pull_.values();
  }

 private:
  const ResidualKernel& kernel_;
  const ResidualData contacts_;
  MatrixXd between_;  ///< V
  NonnegativeSolver pull_;
};

}  // namespace

/// Returns the smaller of two bounds. The first bound is certain: |g(x)| <= ||g|| * sqrt(k(x, x)) in the kernel's
/// Hilbert space, with ||g||^2 = w' * K * w and (K + N) * w = targets. K is the covariance of the data, N their noise
/// variances and w their weights. With many rows, this bound is several times too large. The second bound is empirical.
/// In several hundred fits, |g| between the data exceeded its largest value at the data by at most 20 %; kBetween
/// allows 50 %. If the data contain slopes, kMaxResidual replaces the largest value.
double ResidualData::reach(const ResidualKernel& kernel) const {
  constexpr double kBetween = 1.5;
  double square = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ResidualKernel::ResidualDatum& row = rows[i];
    const double weight = weights(static_cast<Eigen::Index>(i));
    square += weight * (row.target - row.noise * row.noise * weight);
    largest = std::max(largest, std::abs(row.target));
  }
  const double certain = kernel.deviation() * std::sqrt(std::max(0.0, square));
  return std::min(certain, kBetween * (table.slopes ? kMaxResidual : largest));
}

VectorXd ResidualData::means(const ResidualKernel& kernel, const ResidualKernel::Places& places) const {
  VectorXd out(static_cast<Eigen::Index>(places.size()));
  kernel.for_blocks(places, table, [&](Eigen::Index first, Eigen::Index count, const Eigen::Map<MatrixXd>& k) {
    out.segment(first, count).noalias() = k.topRows(count) * weights;
  });
  return out;
}

FreePaths hold_free_paths(const ResidualKernel& kernel, const Assembly& solids,
                          const std::vector<SurfaceTouch>& touches, double contact_noise, ResidualData& known) {
  // The noise of a path is at least 0.1 mm. This keeps the problem far from singular, however many adjacent points hold
  // the surface back.
  constexpr double kLeast = 1e-4;
  constexpr int kRounds = 16;
  const double noise = std::max(kLeast, contact_noise);
  std::vector<FreePathPoint> passages = passages_of(kernel, solids, touches, known.reach(kernel));
  std::vector<FreePathPoint*> all;
  for (FreePathPoint& one : passages) all.push_back(&one);
  FreePaths out;
  ConstrainedFit fit(kernel, known);
  std::vector<FreePathPoint*> close = find_close(kernel, known, all);
  for (int round = 0;; ++round) {
    std::vector<FreePathPoint*> more = deepest(close, noise);
    if (round == kRounds || (more.empty() && round > 0)) {
      close = find_close(kernel, known, all);
      more = deepest(close, noise);
    }
    if (more.empty()) return out;
    if (round == kRounds) {
      for (std::size_t i = 0; i < more.size(); ++i) out.violated += i == 0 || more[i]->way != more[i - 1]->way ? 1 : 0;
      return out;
    }
    std::vector<ResidualKernel::ResidualDatum> rows;
    for (FreePathPoint* const one : more) {
      one->taken = true;
      rows.push_back({one->place, Vector3d::Zero(), one->distance, noise, true});
    }
    fit.add(rows, out, known);
    update_inside(kernel, known, close);
  }
}

}  // namespace palpate
