// SPDX-License-Identifier: MIT
#include "space/skin.hpp"

#include "gp/factor.hpp"
#include "gp/tolerances.hpp"

#include <palpate/error.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace palpate {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// What is farther off the solids is of something that they do not have.
constexpr double kFarthest = 0.012;

/// At distances that any length scale may have, in some directions, from two places.
bool knows_distances_alone(const Kernel& kernel) {
  Eigen::MatrixXd one(1, 1);
  const auto between = [&](double x, double y, double dx, double dy) {
    Points a(1, 2), b(1, 2);
    a << x, y;
    b << x + dx, y + dy;
    kernel.covariance(a, b, one);
    return one(0, 0);
  };
  const double unit = between(0.0, 0.0, 0.0, 0.0);
  constexpr double kRounding = 1e-8;
  for (double r = 1e-7; r < 4.0; r *= 2.0) {
    const double known = between(0.0, 0.0, r, 0.0);
    for (const double angle : {0.0, 0.7, 0.5 * kHalfTurn, 2.3}) {
      for (const double base : {0.0, 0.13}) {
        const double found = between(base, -0.5 * base, r * std::cos(angle), r * std::sin(angle));
        if (!(std::abs(found - known) <= kRounding * unit)) return false;
      }
    }
  }
  return true;
}

/// The linear problem l >= 0, w = S l - d >= 0, l . w = 0 for a positive definite S, by changing what is 0 in blocks
/// (Judice and Pires 1994); where blocks make no progress, one at a time, which ends for certain (Murty 1974). Says
/// which l are not 0.
std::vector<Eigen::Index> complementary(const MatrixXd& s, const VectorXd& d) {
  const Eigen::Index n = d.size();
  const double rounding = 1e-12 * d.cwiseAbs().maxCoeff();
  std::vector<bool> in(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) in[static_cast<std::size_t>(i)] = d(i) > 0.0;
  std::vector<Eigen::Index> chosen;
  std::size_t fewest = static_cast<std::size_t>(n) + 1;
  constexpr int kPatience = 3;
  int patience = kPatience;
  for (Eigen::Index tries = 0; tries < 100 + 10 * n; ++tries) {
    chosen.clear();
    for (Eigen::Index i = 0; i < n; ++i) {
      if (in[static_cast<std::size_t>(i)]) chosen.push_back(i);
    }
    const VectorXd some = MatrixXd(s(chosen, chosen)).ldlt().solve(VectorXd(d(chosen)));
    VectorXd slack = s(Eigen::all, chosen) * some - d;
    for (std::size_t k = 0; k < chosen.size(); ++k)
      slack(chosen[k]) = some(static_cast<Eigen::Index>(k)) < 0.0 ? -2.0 * rounding : 0.0;
    std::vector<std::size_t> wrong;
    for (Eigen::Index i = 0; i < n; ++i) {
      if (slack(i) < -rounding) wrong.push_back(static_cast<std::size_t>(i));
    }
    if (wrong.empty()) break;
    if (wrong.size() < fewest) {
      fewest = wrong.size();
      patience = kPatience;
    } else if (--patience < 0) {
      wrong.erase(wrong.begin(), wrong.end() - 1);
    }
    for (const std::size_t i : wrong) in[i] = !in[i];
  }
  return chosen;
}

/// The lower triangle of a covariance, row by row, each diagonal entry with its noise and a share `jitter` of itself:
/// false where that is not positive definite in double precision.
bool factorise(Factor& factor, const MatrixXd& covariance, const std::vector<int>& which, const VectorXd& noise,
               double jitter) {
  factor.clear();
  VectorXd before(static_cast<Eigen::Index>(which.size()));
  for (std::size_t i = 0; i < which.size(); ++i) {
    const auto n = static_cast<Eigen::Index>(i);
    for (Eigen::Index k = 0; k < n; ++k) before(k) = covariance(which[static_cast<std::size_t>(k)], which[i]);
    if (!factor.append(before.head(n), (1.0 + jitter) * covariance(which[i], which[i]) + noise(which[i]))) return false;
  }
  return true;
}

}  // namespace

Skin::Skin(std::shared_ptr<const Kernel> kernel, const SkinSettings& settings, const simd::Table& loops)
    : kernel_(std::move(kernel)), settings_(settings), loops_(loops) {
  if (!knows_distances_alone(*kernel_)) {
    throw Error("kernel", "is not one of the distance alone, as surface: implicit needs it",
                "choose one with a single length scale, such as matern32");
  }
  kernel_->variance(Points::Zero(1, 2), Eigen::Map<VectorXd>(&unit_, 1));
}

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

Skin::Table Skin::table_of(const std::vector<Row>& rows) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  Table out{Eigen::MatrixX3d(n, 3), Eigen::MatrixX3d(n, 3), Eigen::MatrixX3d(n, 3)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    out.at.row(i) = row.place.at;
    out.normal.row(i) = row.place.normal;
    out.along.row(i) = row.along;
    out.slopes |= !row.along.isZero(0.0);
  }
  return out;
}

MatrixXd Skin::covariances(const Table& a, const Table& b) const {
  MatrixXd out(a.at.rows(), b.at.rows());
  Points apart = Points::Zero(out.size(), 2);
  covariances(a, b, apart, out);
  return out;
}

void Skin::covariances(const Table& a, const Table& b, Points& apart, MatrixOut out) const {
  const Eigen::Index n = a.at.rows();
  const Eigen::Index m = b.at.rows();
  for (Eigen::Index j = 0; j < m; ++j) {
    apart.col(0).segment(j * n, n) =
        ((a.at.col(0).array() - b.at(j, 0)).square() + (a.at.col(1).array() - b.at(j, 1)).square() +
         (a.at.col(2).array() - b.at(j, 2)).square())
            .sqrt();
  }
  kernel_->covariance(apart.topRows(n * m), Points::Zero(1, 2), Eigen::Map<MatrixXd>(out.data(), n * m, 1));
  if (a.slopes || b.slopes) {
    VectorXd across(n * m), along(n * m);
    kernel_->slope_covariance(apart.col(0).head(n * m), across, along);
    for (Eigen::Index j = 0; j < m; ++j) {
      const bool slope = !b.along.row(j).isZero(0.0);
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index pair = j * n + i;
        const auto way = a.at.row(i) - b.at.row(j);
        // Of which slope: where there is none these are 0.
        const double from = way.dot(a.along.row(i));
        const double to = way.dot(b.along.row(j));
        if (a.along.row(i).isZero(0.0)) {
          if (slope) out(i, j) = across(pair) * to;
        } else if (!slope) {
          out(i, j) = -across(pair) * from;
        } else {
          const double r = apart(pair, 0);
          const double both = r > 0.0 ? (from / r) * (to / r) : 0.0;  // at 0 distance `along` and `across` are alike
          out(i, j) = across(pair) * a.along.row(i).dot(b.along.row(j)) + (along(pair) - across(pair)) * both;
        }
      }
    }
  }
  const double half = 0.5 * signal_ * signal_;
  for (Eigen::Index j = 0; j < m; ++j) {
    out.col(j).array() *=
        half *
        (1.0 + (a.normal.col(0) * b.normal(j, 0) + a.normal.col(1) * b.normal(j, 1) + a.normal.col(2) * b.normal(j, 2))
                   .array());
  }
}

std::vector<Skin::Row> Skin::contacts_of(const Composition& solids, const std::vector<SurfaceTouch>& touches) const {
  std::vector<Row> out;
  std::vector<Row> slopes;
  for (const SurfaceTouch& touch : touches) {
    if (!touch.contact || touch.desk) continue;
    const Place place{touch.end(), normal(solids, touch.end())};
    const double off = solids.distance(place.at);
    if (!(std::abs(off) <= kFarthest)) continue;
    out.push_back({place, Vector3d::Zero(), off, settings_.noise, false});
    // Where the composition's surface is turned by more than that, it is another than the one that is felt.
    constexpr double kTurned = 0.5;
    if (!touch.normal || touch.normal->dot(place.normal) < kTurned) continue;
    if (!kernel_->has_slopes()) {
      throw Error("kernel", "has no slopes at every place, and normals that a tool feels are slopes",
                  "choose matern32, matern52 or rbf");
    }
    const Vector3d one = touch.normal->unitOrthogonal();
    for (const Vector3d& across : {one, Vector3d(touch.normal->cross(one))})
      slopes.push_back({place, across, across.dot(place.normal), settings_.tilt, false});
  }
  out.insert(out.end(), slopes.begin(), slopes.end());
  return out;
}

void Skin::take_in(std::vector<Row> rows, int already_aside) {
  Table table = table_of(rows);
  MatrixXd covariance = covariances(table, table);
  const auto n = static_cast<Eigen::Index>(rows.size());
  VectorXd noise(n), targets(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    noise(i) = row.noise * row.noise;
    targets(i) = row.target;
  }
  std::vector<int> taken(rows.size());
  std::iota(taken.begin(), taken.end(), 0);
  Factor factor(loops_);
  factor.reserve(static_cast<int>(n));
  const double unit = static_cast<double>(n) * kEpsilon;
  while (!factorise(factor, covariance, taken, noise, jitter_)) {
    if (jitter_ >= kLastJitter * unit) {
      ++pivoted_;
      covariance.diagonal() += jitter_ * covariance.diagonal() + noise;
      taken = independent_rows(covariance);
      std::stable_partition(taken.begin(), taken.end(), [&](int i) { return !rows[static_cast<std::size_t>(i)].free; });
      factorise(factor, covariance, taken, VectorXd::Zero(n), 0.0);
      taken.resize(static_cast<std::size_t>(factor.size()));  // the guards of both differ by rounding
      break;
    }
    jitter_ = std::min(std::max(kFirstJitter * unit, 10.0 * jitter_), kLastJitter * unit);
    ++jitter_raised_;
  }
  set_aside_ = already_aside + static_cast<int>(n) - factor.size();
  if (factor.size() < n) {
    std::vector<Row> kept;
    for (const int i : taken) kept.push_back(rows[static_cast<std::size_t>(i)]);
    rows = kept;
    targets = VectorXd(targets(taken));
    table = table_of(rows);
  }
  Lower lower = Lower::Zero(factor.size(), factor.size());
  for (int i = 0; i < factor.size(); ++i) {
    lower.row(i).head(i) = factor.row(i);
    lower(i, i) = factor.pivot(i);
  }
  lower.triangularView<Eigen::Lower>().solveInPlace(targets);
  lower.triangularView<Eigen::Lower>().transpose().solveInPlace(targets);
  const auto certain = std::count_if(rows.begin(), rows.end(), [](const Row& row) { return !row.free; });
  known_ = {std::move(rows), certain, std::move(table), std::move(lower), std::move(targets)};
}

/// A point of a free way.
struct Skin::Passage {
  std::size_t way;
  Place place;
  double distance;  ///< to the composition
  bool taken = false;
};

std::vector<Skin::Passage> Skin::passages(const Composition& solids, const std::vector<SurfaceTouch>& touches) const {
  constexpr double kStep = 0.0015;
  constexpr double kDeviations = 3.0;  // farther out g never is
  const double near = std::min(kFarthest, kDeviations * signal_);
  std::vector<Passage> out;
  for (std::size_t way = 0; way < touches.size(); ++way) {
    const std::size_t first = out.size();
    for (double along = 0.0; along < touches[way].length;) {
      const Vector3d at = touches[way].line.origin + along * touches[way].line.direction;
      const double distance = solids.distance(at);
      if (!(distance >= -near)) {  // the composition is wrong here, not the skin
        out.resize(first);
        break;
      }
      if (distance < near) out.push_back({way, {at, normal(solids, at)}, distance});
      along += std::max(kStep, distance - near);
    }
  }
  return out;
}

std::vector<Skin::Row> Skin::broken(std::vector<Passage>& passages) const {
  constexpr double kLeast = 1e-4;
  Places places;
  for (const Passage& one : passages) places.push_back(one.place);
  const VectorXd means = this->means(places);
  std::vector<Row> out;
  for (std::size_t i = 0; i < passages.size();) {
    const std::size_t way = passages[i].way;
    double most = std::max(kLeast, settings_.noise);
    Passage* deepest = nullptr;
    for (; i < passages.size() && passages[i].way == way; ++i) {
      const double inside = means(static_cast<Eigen::Index>(i)) - passages[i].distance;
      if (passages[i].taken || !(inside > most)) continue;
      most = inside;
      deepest = &passages[i];
    }
    if (!deepest) continue;
    deepest->taken = true;
    out.push_back({deepest->place, Vector3d::Zero(), deepest->distance, settings_.noise, true});
  }
  return out;
}

std::vector<Skin::Row> Skin::holding(const Known& contacts) const {
  const Table free = table_of(free_);
  MatrixXd between = covariances(free, free);
  MatrixXd with = covariances(contacts.table, free);
  VectorXd inside = with.transpose() * contacts.weights;
  for (Eigen::Index i = 0; i < inside.size(); ++i) {
    const Row& row = free_[static_cast<std::size_t>(i)];
    inside(i) -= row.target;
    between(i, i) += row.noise * row.noise + kFirstJitter * kEpsilon * between(i, i);
  }
  contacts.lower.triangularView<Eigen::Lower>().solveInPlace(with);
  between -= with.transpose() * with;
  std::vector<Row> out;
  for (const Eigen::Index i : complementary(between, inside)) out.push_back(free_[static_cast<std::size_t>(i)]);
  return out;
}

void Skin::fit(const Composition& solids, const std::vector<SurfaceTouch>& touches) {
  std::vector<Row> rows = contacts_of(solids, touches);
  double squares = 0.0;
  int count = 0;
  for (const Row& row : rows) {
    if (!row.along.isZero(0.0)) continue;
    squares += row.target * row.target;
    ++count;
  }
  const double rms = count == 0 ? settings_.most : std::sqrt(squares / count);
  constexpr double kLeast = 0.001;
  signal_ = std::clamp(rms, std::min(kLeast, settings_.most), settings_.most);
  free_.clear();
  jitter_ = 0.0;
  take_in(std::move(rows), 0);
  const Known contacts = known_;
  const int aside = set_aside_;
  std::vector<Passage> near = passages(solids, touches);
  constexpr int kRounds = 3;  // what holds at one place moves the surface at others
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Row> more = broken(near);
    if (more.empty()) return;
    free_.insert(free_.end(), more.begin(), more.end());
    rows = contacts.rows;
    const std::vector<Row> hold = holding(contacts);
    rows.insert(rows.end(), hold.begin(), hold.end());
    take_in(std::move(rows), aside);
  }
}

template <class Use>
void Skin::for_pieces(const Places& places, const Use& use) const {
  const Eigen::Index n = known_.table.at.rows();
  simd::Lines numbers(static_cast<std::size_t>(n * simd::kPiece));
  const Eigen::Map<MatrixXd> rows(numbers.data(), simd::kPiece, n);
  Points apart = Points::Zero(n * simd::kPiece, 2);
  for (std::size_t first = 0; first < places.size(); first += simd::kPiece) {
    std::vector<Row> some;
    for (std::size_t i = first; i < first + simd::kPiece; ++i)  // the last ones again, where there are no more
      some.push_back({places[std::min(i, places.size() - 1)], Vector3d::Zero(), 0.0, 0.0, false});
    covariances(table_of(some), known_.table, apart, rows);
    const std::size_t count = std::min<std::size_t>(simd::kPiece, places.size() - first);
    use(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count), rows);
  }
}

VectorXd Skin::means(const Places& places) const {
  VectorXd out(static_cast<Eigen::Index>(places.size()));
  for_pieces(places, [&](Eigen::Index first, Eigen::Index count, const Eigen::Map<MatrixXd>& k) {
    out.segment(first, count).noalias() = k.topRows(count) * known_.weights;
  });
  return out;
}

Skin::Posterior Skin::posterior(const Places& places) const {
  const auto all = static_cast<Eigen::Index>(places.size());
  Posterior out{VectorXd(all), VectorXd(all)};
  simd::Lines left(simd::kPiece);
  for_pieces(places, [&](Eigen::Index first, Eigen::Index count, Eigen::Map<MatrixXd> k) {
    out.mean.segment(first, count).noalias() = k.topRows(count) * known_.weights;
    std::fill_n(left.data(), simd::kPiece, signal_ * signal_ * unit_);
    simd::Update variance{};
    variance.variance = left.data();
    for (Eigen::Index i = 0; i < known_.certain; ++i)
      loops_.absorb_dense({k.data(), &known_.lower(i, 0), static_cast<int>(i), known_.lower(i, i)}, variance);
    out.variance.segment(first, count) = Eigen::Map<const VectorXd>(left.data(), count);
  });
  out.clamped = static_cast<int>((out.variance.array() < 0.0).count());
  out.variance = out.variance.cwiseMax(0.0);
  return out;
}

MatrixXd Skin::prior_covariance(const Places& places) const {
  std::vector<Row> rows;
  for (const Place& place : places) rows.push_back({place, Vector3d::Zero(), 0.0, 0.0, false});
  const Table table = table_of(rows);
  return covariances(table, table);
}

double Skin::mean(const Place& place) const {
  return covariances(known_.table, table_of({{place, Vector3d::Zero(), 0.0, 0.0, false}})).col(0).dot(known_.weights);
}

double Skin::variance(const Place& place) const {
  const Eigen::Index n = known_.certain;
  VectorXd k = covariances(known_.table, table_of({{place, Vector3d::Zero(), 0.0, 0.0, false}})).col(0).head(n);
  known_.lower.topLeftCorner(n, n).triangularView<Eigen::Lower>().solveInPlace(k);
  return std::max(0.0, signal_ * signal_ * unit_ - k.squaredNorm());
}

}  // namespace palpate
