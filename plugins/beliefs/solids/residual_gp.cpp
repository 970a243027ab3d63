// SPDX-License-Identifier: MIT
#include "solids/residual_gp.hpp"

#include "gp/factor.hpp"
#include "solids/nonnegative.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <iterator>
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
        const double found = between(base, -0.5 * base, r * math::cos(angle), r * math::sin(angle));
        if (!(std::abs(found - known) <= kRounding * unit)) return false;
      }
    }
  }
  return true;
}

/// The lower triangle of a covariance, row by row, each diagonal entry with its noise and a share `jitter` of itself.
/// Says which rows it has: those with which it is not positive definite in double precision are left out.
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

ResidualGp::ResidualGp(std::shared_ptr<const Kernel> kernel, const ResidualGpSettings& settings)
    : kernel_(std::move(kernel)), settings_(settings) {
  if (!knows_distances_alone(*kernel_)) {
    throw Error("kernel",
                "depends on more than the distance, but surface: implicit needs a kernel of the distance alone",
                "choose one with a single length scale, such as matern32");
  }
  kernel_->variance(Points::Zero(1, 2), Eigen::Map<VectorXd>(&unit_, 1));
}

Vector3d ResidualGp::normal(const Assembly& solids, const Vector3d& at) {
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

ResidualGp::Table ResidualGp::table_of(const std::vector<Row>& rows) {
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

MatrixXd ResidualGp::covariances(const Table& a, const Table& b) const {
  MatrixXd out(a.at.rows(), b.at.rows());
  Points apart = Points::Zero(out.size(), 2);
  covariances(a, b, apart, out);
  return out;
}

MatrixXd ResidualGp::covariance(const std::vector<Row>& rows) const {
  const Table table = table_of(rows);
  return covariances(table, table);
}

void ResidualGp::covariances(const Table& a, const Table& b, Points& apart, MatrixOut out) const {
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
    kernel_->gradient_covariance(apart.col(0).head(n * m), across, along);
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

std::vector<ResidualGp::Row> ResidualGp::contacts_of(const Assembly& solids,
                                                     const std::vector<SurfaceTouch>& touches) const {
  std::vector<Row> out;
  std::vector<Row> slopes;
  for (const SurfaceTouch& touch : touches) {
    if (!touch.contact || touch.desk) continue;
    const Place place{touch.end(), normal(solids, touch.end())};
    const double off = solids.distance(place.at);
    if (!(std::abs(off) <= kFarthest)) continue;
    out.push_back({place, Vector3d::Zero(), off, settings_.noise, false});
    // Where the assembly's surface is turned by more than that, it is another than the one that is felt.
    constexpr double kTurned = 0.5;
    if (!touch.normal || touch.normal->dot(place.normal) < kTurned) continue;
    if (!kernel_->has_gradient()) {
      throw Error("kernel", "is not differentiable everywhere, but measured surface normals need its derivatives",
                  "choose matern32, matern52 or rbf");
    }
    const Vector3d one = touch.normal->unitOrthogonal();
    for (const Vector3d& across : {one, Vector3d(touch.normal->cross(one))})
      slopes.push_back({place, across, across.dot(place.normal), settings_.tilt, false});
  }
  out.insert(out.end(), slopes.begin(), slopes.end());
  return out;
}

void ResidualGp::take_in(std::vector<Row> rows) {
  Table table = table_of(rows);
  MatrixXd covariance = covariances(table, table);
  const auto n = static_cast<Eigen::Index>(rows.size());
  VectorXd noise(n), targets(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
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
    std::vector<Row> kept;
    for (const int i : taken) kept.push_back(rows[static_cast<std::size_t>(i)]);
    rows = kept;
    targets = VectorXd(targets(taken));
    table = table_of(rows);
  };
  regularise(report_, n, 1.0, with_jitter, pivot);
  report_.redundant_taps = static_cast<int>(n) - factor.size();
  Lower lower = Lower::Zero(factor.size(), factor.size());
  for (int i = 0; i < factor.size(); ++i) {
    lower.row(i).head(i) = factor.row(i);
    lower(i, i) = factor.pivot(i);
  }
  lower.triangularView<Eigen::Lower>().solveInPlace(targets);
  lower.triangularView<Eigen::Lower>().transpose().solveInPlace(targets);
  known_ = {std::move(rows), std::move(table), std::move(lower), std::move(targets)};
}

/// A point of a free way.
struct ResidualGp::Passage {
  std::size_t way;
  Place place;
  double distance;      ///< to the assembly
  double inside = 0.0;  ///< the surface, when that was last looked at
  bool taken = false;

  bool broken(double noise) const { return !taken && inside > noise; }
};

std::vector<ResidualGp::Passage> ResidualGp::passages(const Assembly& solids,
                                                      const std::vector<SurfaceTouch>& touches) const {
  constexpr double kStep = 0.0015;
  constexpr double kDeviations = 3.0;
  const double deepest = std::min(kFarthest, kDeviations * deviation());
  const double near = std::max(deepest, reach());
  std::vector<Passage> out;
  for (std::size_t way = 0; way < touches.size(); ++way) {
    const std::size_t first = out.size();
    for (double along = 0.0; along < touches[way].length;) {
      const Vector3d at = touches[way].line.origin + along * touches[way].line.direction;
      const double distance = solids.distance(at);
      if (!(distance >= -deepest)) {  // the assembly is wrong here, not the residual GP
        out.resize(first);
        break;
      }
      if (distance < near) out.push_back({way, {at, normal(solids, at)}, distance});
      along += std::max(kStep, distance - near);
    }
  }
  return out;
}

void ResidualGp::look_at(const std::vector<Passage*>& passages) const {
  Places places;
  for (const Passage* const one : passages) places.push_back(one->place);
  const VectorXd means = this->means(places);
  for (std::size_t i = 0; i < passages.size(); ++i)
    passages[i]->inside = means(static_cast<Eigen::Index>(i)) - passages[i]->distance;
}

std::vector<ResidualGp::Passage*> ResidualGp::deepest(const std::vector<Passage*>& passages) const {
  std::vector<Passage*> out;
  const Passage* before = nullptr;
  for (Passage* const one : passages) {
    const bool broken = one->broken(noise_of_ways());
    if (broken && before != nullptr && before->way == one->way) {
      if (one->inside > out.back()->inside) out.back() = one;
    } else if (broken) {
      out.push_back(one);
    }
    before = broken ? one : nullptr;
  }
  return out;
}

/// With A the covariance of the contacts, noise included, as A = L L', and V = L^-1 of that with the free points, S of
/// Nonnegative is the covariance of the free points when the contacts are known, d by how much they are inside then.
void ResidualGp::keep_free(std::vector<Passage> passages) {
  const Known contacts = known_;
  const auto lower = contacts.lower.triangularView<Eigen::Lower>();
  const Eigen::Index n = contacts.weights.size();
  MatrixXd known(n, 0);  // V
  Nonnegative pull;
  const int aside = report_.redundant_taps;
  std::vector<Passage*> all, close;
  for (Passage& one : passages) all.push_back(&one);
  const auto look_at_all = [&] {
    constexpr double kClose = 0.003;  // what holds elsewhere moves the surface by less, as a rule, if it does outwards
    look_at(all);
    close.clear();
    std::copy_if(all.begin(), all.end(), std::back_inserter(close),
                 [&](const Passage* one) { return one->inside > -kClose; });
  };
  look_at_all();
  constexpr int kRounds = 16;
  for (int round = 0;; ++round) {
    std::vector<Passage*> more = deepest(close);
    if (more.empty() && round > 0) {
      look_at_all();
      more = deepest(close);
    }
    if (more.empty()) return;
    if (round == kRounds) {
      look_at_all();
      more = deepest(close);
      for (std::size_t i = 0; i < more.size(); ++i)
        violated_free_paths_ += i == 0 || more[i]->way != more[i - 1]->way ? 1 : 0;
      return;
    }
    std::vector<Row> rows;
    for (Passage* const one : more) {
      one->taken = true;
      rows.push_back({one->place, Vector3d::Zero(), one->distance, noise_of_ways(), true});
    }
    free_.insert(free_.end(), rows.begin(), rows.end());
    const Table table = table_of(rows);
    const auto m = static_cast<Eigen::Index>(rows.size());
    MatrixXd with = covariances(contacts.table, table);
    VectorXd inside = with.transpose() * contacts.weights;
    for (Eigen::Index i = 0; i < m; ++i) inside(i) -= rows[static_cast<std::size_t>(i)].target;
    lower.solveInPlace(with);
    known.conservativeResize(n, known.cols() + m);
    known.rightCols(m) = with;
    MatrixXd left = covariances(table_of(free_), table);
    left.noalias() -= known.transpose() * with;
    left.diagonal(m - left.rows()).array() += noise_of_ways() * noise_of_ways();
    pull.append(left, inside);
    pull.solve();
    report_.redundant_taps = aside + pull.redundant_taps();

    VectorXd shift = known(Eigen::all, pull.held()) * pull.values();
    lower.transpose().solveInPlace(shift);
    known_.rows = contacts.rows;
    for (const int i : pull.held()) known_.rows.push_back(free_[static_cast<std::size_t>(i)]);
    known_.table = table_of(known_.rows);
    known_.weights.resize(n + pull.values().size());
    known_.weights << contacts.weights + shift, -pull.values();
    look_at(close);
  }
}

double ResidualGp::noise_of_ways() const {
  constexpr double kLeast = 1e-4;
  return std::max(kLeast, settings_.noise);
}

/// |g(x)| <= ||g|| sqrt(k(x, x)) in the kernel's space, ||g||^2 = w' K w, where (K + N) w is what is known: for
/// certain, but with many rows several times too much. Where values alone are known, g is larger between them than at
/// them, by a fifth at most in some hundred fits of runs: half leaves room.
double ResidualGp::reach() const {
  constexpr double kBetween = 1.5;
  double square = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < known_.rows.size(); ++i) {
    const Row& row = known_.rows[i];
    const double weight = known_.weights(static_cast<Eigen::Index>(i));
    square += weight * (row.target - row.noise * row.noise * weight);
    largest = std::max(largest, std::abs(row.target));
  }
  const double certain = deviation() * std::sqrt(std::max(0.0, square));
  return std::min(certain, kBetween * (known_.table.slopes ? kFarthest : largest));
}

void ResidualGp::fit(const Assembly& solids, const std::vector<SurfaceTouch>& touches) {
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
  violated_free_paths_ = 0;
  report_.jitter = 0.0;
  take_in(std::move(rows));
  keep_free(passages(solids, touches));
}

template <class Use>
void ResidualGp::for_blocks(const Places& places, const Use& use) const {
  const Eigen::Index n = known_.table.at.rows();
  loops::AlignedArray numbers(static_cast<std::size_t>(n * loops::kBlock));
  const Eigen::Map<MatrixXd> rows(numbers.data(), loops::kBlock, n);
  Points apart = Points::Zero(n * loops::kBlock, 2);
  for (std::size_t first = 0; first < places.size(); first += loops::kBlock) {
    std::vector<Row> some;
    for (std::size_t i = first; i < first + loops::kBlock; ++i)  // the last ones again, where there are no more
      some.push_back({places[std::min(i, places.size() - 1)], Vector3d::Zero(), 0.0, 0.0, false});
    covariances(table_of(some), known_.table, apart, rows);
    const std::size_t count = std::min<std::size_t>(loops::kBlock, places.size() - first);
    use(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(count), rows);
  }
}

VectorXd ResidualGp::means(const Places& places) const {
  VectorXd out(static_cast<Eigen::Index>(places.size()));
  for_blocks(places, [&](Eigen::Index first, Eigen::Index count, const Eigen::Map<MatrixXd>& k) {
    out.segment(first, count).noalias() = k.topRows(count) * known_.weights;
  });
  return out;
}

ResidualGp::Posterior ResidualGp::posterior(const Places& places) const {
  const auto all = static_cast<Eigen::Index>(places.size());
  Posterior out{VectorXd(all), VectorXd(all)};
  loops::AlignedArray left(loops::kBlock);
  for_blocks(places, [&](Eigen::Index first, Eigen::Index count, Eigen::Map<MatrixXd> k) {
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

MatrixXd ResidualGp::prior_covariance(const Places& places) const {
  std::vector<Row> rows;
  for (const Place& place : places) rows.push_back({place, Vector3d::Zero(), 0.0, 0.0, false});
  const Table table = table_of(rows);
  return covariances(table, table);
}

double ResidualGp::mean(const Place& place) const {
  return covariances(known_.table, table_of({{place, Vector3d::Zero(), 0.0, 0.0, false}})).col(0).dot(known_.weights);
}

double ResidualGp::variance(const Place& place) const {
  const Eigen::Index n = known_.lower.rows();
  VectorXd k = covariances(known_.table, table_of({{place, Vector3d::Zero(), 0.0, 0.0, false}})).col(0).head(n);
  known_.lower.triangularView<Eigen::Lower>().solveInPlace(k);
  return std::max(0.0, deviation() * deviation() - k.squaredNorm());
}

}  // namespace palpate
