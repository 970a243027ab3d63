// SPDX-License-Identifier: MIT
// The process over space against 100 digits. Of the framework the oracle takes the rows that are known, and nothing
// else: slopes are differences of its own covariance, 1e-20 metres apart.
#include "solids/residual_gp.hpp"
#include "stability/oracle.hpp"
#include "support/sanitizers.hpp"
#include "support/shape_laws.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace palpate::stability {
namespace {

using Eigen::Vector3d;
using test::random_direction;
using Point = std::array<Real, 3>;

const Real kStep("1e-20");

class ResidualGpOracle {
 public:
  ResidualGpOracle(std::string kernel, double length, double signal, std::vector<ResidualGp::ResidualDatum> rows)
      : kernel_(std::move(kernel)), length_(length), signal_(signal), rows_(std::move(rows)) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      std::vector<Real> row;
      for (std::size_t j = 0; j <= i; ++j) row.push_back(covariance(rows_[i], rows_[j]));
      lower_.push_back(std::move(row));
    }
  }

  /// False where it is not positive definite with 100 digits.
  bool factorise() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Real own = lower_[i][i];
      for (std::size_t j = 0; j <= i; ++j) {
        Real sum = lower_[i][j];
        if (i == j) sum += Real(rows_[i].noise) * rows_[i].noise;
        for (std::size_t k = 0; k < j; ++k) sum -= lower_[i][k] * lower_[j][k];
        if (i == j && !(sum > Real("1e-80") * own)) return false;
        lower_[i][j] = i == j ? Real(sqrt(sum)) : Real(sum / lower_[j][j]);
      }
    }
    weights_.clear();
    for (const ResidualGp::ResidualDatum& row : rows_) weights_.emplace_back(row.target);
    forward(weights_);
    for (std::size_t i = weights_.size(); i-- > 0;) {
      weights_[i] /= lower_[i][i];
      for (std::size_t k = 0; k < i; ++k) weights_[k] -= lower_[i][k] * weights_[i];
    }
    return true;
  }
  /// Before it is factorised: without noise.
  const Real& covariance(std::size_t i, std::size_t j) const { return lower_[std::max(i, j)][std::min(i, j)]; }

  struct Posterior {
    Real mean, variance;
  };
  Posterior at(const ResidualGp::Place& place) const {
    const ResidualGp::ResidualDatum value{place, Vector3d::Zero(), 0.0, 0.0, false};
    Posterior out{0, covariance(value, value)};
    std::vector<Real> with;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      with.push_back(covariance(rows_[i], value));
      out.mean += with[i] * weights_[i];
    }
    forward(with);
    for (const Real& one : with) out.variance -= one * one;
    return out;
  }

 private:
  Real value(const Point& a, const Vector3d& na, const Point& b, const Vector3d& nb) const {
    Real r2 = 0;
    Real normals = 1;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      r2 += (a[i] - b[i]) * (a[i] - b[i]);
      normals += Real(na(k)) * nb(k);
    }
    r2 /= length_ * length_;
    const Real s3 = sqrt(3 * r2);
    const Real s5 = sqrt(5 * r2);
    const Real k = kernel_ == "rbf"        ? Real(exp(-r2 / 2))
                   : kernel_ == "matern12" ? Real(exp(-sqrt(r2)))
                   : kernel_ == "matern32" ? Real((1 + s3) * exp(-s3))
                                           : Real((1 + s5 + s5 * s5 / 3) * exp(-s5));
    return signal_ * signal_ * k * normals / 2;
  }

  static Point moved(const ResidualGp::ResidualDatum& row, int sign) {
    Point out;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      out[i] = row.place.at(k) + sign * kStep * row.along(k);
    }
    return out;
  }

  Real covariance(const ResidualGp::ResidualDatum& a, const ResidualGp::ResidualDatum& b) const {
    const bool slope_a = !a.along.isZero(0.0);
    const bool slope_b = !b.along.isZero(0.0);
    Real sum = 0;
    for (const int i : {1, -1}) {
      if (!slope_a && i < 0) continue;
      for (const int j : {1, -1}) {
        if (!slope_b && j < 0) continue;
        sum += i * j * value(moved(a, slope_a ? i : 0), a.place.normal, moved(b, slope_b ? j : 0), b.place.normal);
      }
    }
    if (slope_a) sum /= 2 * kStep;
    if (slope_b) sum /= 2 * kStep;
    return sum;
  }

  void forward(std::vector<Real>& b) const {
    for (std::size_t i = 0; i < b.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) b[i] -= lower_[i][k] * b[k];
      b[i] /= lower_[i][i];
    }
  }

  std::string kernel_;
  Real length_, signal_;
  std::vector<ResidualGp::ResidualDatum> rows_;
  std::vector<std::vector<Real>> lower_;
  std::vector<Real> weights_;
};

constexpr double kLength = 0.04;

std::shared_ptr<Kernel> kernel_of(const std::string& type) {
  return test::make<Kernel>(test::shared_host(), type, "{length_scale: 4 cm}");
}

/// A vessel with a rim and an edge below, 10 cm wide.
Assembly vessel() {
  Assembly out;
  out.parts.push_back(
      {{Primitive::Form::cylinder, {0, 0, 0.06}, Eigen::Matrix3d::Identity(), {0.05, 0.05, 0.06}, 0.004}, {}, {}, 0.0});
  return out;
}

/// From anywhere around, some with the normal, and ways that pass beside or through.
std::vector<SurfaceTouch> touches_of(const Assembly& solids, int count, Random& random) {
  std::vector<SurfaceTouch> out;
  while (static_cast<int>(out.size()) < count) {
    Vector3d direction = random_direction(random);
    const Vector3d through = Vector3d(0, 0, 0.06) + 0.055 * random_direction(random);
    const Line line{through - 0.3 * direction, direction};
    const double hit = solids.first_intersection(line);
    if (hit == kNoHit) {
      out.push_back({line, 0.6, false, false});
      continue;
    }
    SurfaceTouch touch{line, hit + 0.006 * (random.uniform() - 0.5), true, false};
    if (out.size() % 3 == 0) {
      touch.normal = (solids.normal(touch.end()) + 0.1 * random_direction(random)).normalized();
    }
    out.push_back(touch);
  }
  return out;
}

class ResidualGpExactly : public ::testing::TestWithParam<const char*> {};

TEST_P(ResidualGpExactly, HasMeanAndVarianceWithContactsFreePointsAndNormals) {
  const Assembly solids = vessel();
  int slopes = 0;
  int free = 0;
  for (int seed = 0; seed < 4; ++seed) {
    Random random(seed, "test/skin");
    const std::vector<SurfaceTouch> touches = touches_of(solids, 25, random);
    ResidualGp residual_gp(kernel_of(GetParam()), {0.006, 0.0005});
    residual_gp.fit(solids, touches);
    ResidualGpOracle oracle(GetParam(), kLength, residual_gp.signal(), residual_gp.rows());
    ASSERT_TRUE(oracle.factorise());
    std::vector<ResidualGp::ResidualDatum> certain = residual_gp.rows();
    certain.erase(
        std::remove_if(certain.begin(), certain.end(), [](const ResidualGp::ResidualDatum& row) { return row.free; }),
        certain.end());
    ResidualGpOracle without(GetParam(), kLength, residual_gp.signal(), certain);
    ASSERT_TRUE(without.factorise());
    for (const ResidualGp::ResidualDatum& row : residual_gp.rows()) {
      slopes += row.along.isZero(0.0) ? 0 : 1;
      free += row.free ? 1 : 0;
    }
    EXPECT_EQ(residual_gp.report().raised, 0);
    double mean_error = 0.0;
    double variance_error = 0.0;
    for (int i = 0; i < 30; ++i) {
      const Vector3d at = Vector3d(0, 0, 0.06) + 0.06 * random_direction(random);
      // Also at the data, where distances are 0.
      const ResidualGp::Place place =
          i < 10 ? residual_gp.rows()[static_cast<std::size_t>(i)].place : ResidualGp::Place{at, solids.normal(at)};
      const ResidualGpOracle::Posterior exact{oracle.at(place).mean, without.at(place).variance};
      const double size = residual_gp.signal();
      mean_error = std::max(mean_error, std::abs(static_cast<double>(residual_gp.mean(place) - exact.mean)) / size);
      variance_error = std::max(
          variance_error,
          std::abs(static_cast<double>(residual_gp.posterior({place}).variance(0) - exact.variance)) / (size * size));
    }
    // A Cholesky solution is that of a matrix n roundings off (Higham 2002, theorem 10.4), times the condition number:
    // the largest eigenvalue is n times the signal squared at most, the least no less than the noise squared.
    const auto n = static_cast<double>(residual_gp.rows().size());
    const double ratio = residual_gp.signal() / 0.0005;
    const double rounding = n * 0x1p-52 * n * ratio * ratio;
    EXPECT_LE(mean_error, rounding);
    EXPECT_LE(variance_error, rounding);
    RecordProperty("errors_" + std::to_string(seed),
                   std::to_string(1e15 * mean_error) + "e-15, " + std::to_string(1e15 * variance_error) + "e-15");
  }
  EXPECT_GT(slopes, 10);
  EXPECT_GT(free, 3);
}

TEST_P(ResidualGpExactly, IsTheOptimumOverAllFreePoints) {
  const Assembly solids = vessel();
  int points = 0;
  int slack = 0;
  int ways = 0;
  double deepest_left = 0.0;
  for (int seed = 10; seed < 15; ++seed) {
    Random random(seed, "test/skin");
    std::vector<SurfaceTouch> touches = touches_of(solids, 40, random);
    for (int i = 0; i < 30; ++i) {  // ways close by the side: some say what others say already
      const double angle = 2 * kHalfTurn * random.uniform();
      const Vector3d out(std::cos(angle), std::sin(angle), 0.0);
      const Vector3d up = (Vector3d::UnitZ() + random.uniform() * out.cross(Vector3d::UnitZ())).normalized();
      touches.push_back({{Vector3d((0.0495 + 0.001 * random.uniform()) * out) + 0.3 * up, -up}, 0.6, false, false});
    }
    ResidualGp residual_gp(kernel_of(GetParam()), {0.006, 0.0005});
    residual_gp.fit(solids, touches);
    ResidualGpOracle oracle(GetParam(), kLength, residual_gp.signal(), residual_gp.rows());
    ASSERT_TRUE(oracle.factorise());
    ASSERT_EQ(residual_gp.free_paths().violated, 0);
    for (const SurfaceTouch& way : touches) {
      double deepest = 0.0;
      double most = 0.0;
      // Every 1.5 mm one point is asked for, so that the surface is not in front of all of so long a stretch by more
      // than a point may be inside; between it and the next place looked at, 0.125 mm, f changes by little more.
      constexpr double kApart = 0.00025;
      constexpr std::size_t kStretch = 7;
      std::vector<double> stretch;
      for (double along = 0.0; along < way.length; along += kApart) {
        const Vector3d at = way.line.origin + along * way.line.direction;
        const double distance = solids.distance(at);
        deepest = std::min(deepest, distance);
        if (distance > residual_gp.reach()) {
          stretch.clear();
          along += distance - residual_gp.reach();
          continue;
        }
        // One that is inside though it holds has a contact against it.
        if (std::any_of(residual_gp.rows().begin(), residual_gp.rows().end(),
                        [&](const ResidualGp::ResidualDatum& row) {
                          return row.free && (row.place.at - at).norm() < 0.0015;
                        })) {
          stretch.clear();
          continue;
        }
        stretch.push_back(residual_gp.mean({at, solids.normal(at)}) - distance);
        if (stretch.size() >= kStretch)
          most = std::max(most, *std::min_element(stretch.end() - kStretch, stretch.end()));
      }
      if (deepest < -3.0 * residual_gp.deviation()) continue;  // for the solids to explain
      ++ways;
      deepest_left = std::max(deepest_left, most);
    }
    for (const ResidualGp::ResidualDatum& point : residual_gp.free_paths().points) {
      const bool holds =
          std::any_of(residual_gp.rows().begin(), residual_gp.rows().end(), [&](const ResidualGp::ResidualDatum& row) {
            return row.free && row.place.at == point.place.at && row.place.normal == point.place.normal;
          });
      const auto inside = static_cast<double>(Real(oracle.at(point.place).mean - point.target));
      // The gradient of the cost: one that holds pulls outwards, of the others none is inside.
      if (holds) {
        EXPECT_GE(inside, -1e-12);
      } else {
        EXPECT_LE(inside, 1e-12);
      }
      ++points;
      slack += holds ? 0 : 1;
    }
  }
  EXPECT_LT(deepest_left, 0.0005 + 0.0002);  // the noise, and what f changes by
  EXPECT_GT(ways, 200);
  RecordProperty("left", std::to_string(1e3 * deepest_left) + " mm");
  EXPECT_GT(points, 40);
  EXPECT_GT(slack, 5);
  RecordProperty("points", std::to_string(points) + ", of which " + std::to_string(slack) + " do not hold");
}

using Matrix = std::vector<std::vector<Real>>;

/// Whether a symmetric matrix, less `shift` on its diagonal, has no negative eigenvalue: by the signs of D in L D L'
/// (Sylvester's law of inertia). Reads the lower triangle.
bool exceeds(Matrix a, const Real& shift) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i][i] -= shift;
    for (std::size_t j = 0; j < i; ++j) {
      for (std::size_t k = 0; k < j; ++k) a[i][j] -= a[i][k] * a[j][k] * a[k][k];
      a[i][j] /= a[j][j];
      a[i][i] -= a[i][j] * a[i][j] * a[j][j];
    }
    if (!(a[i][i] > 0)) return false;
  }
  return true;
}

/// The least eigenvalue is at least 2 to this power, and less than to the next; -300 where it is less than that.
int least_power(const Matrix& a) {
  int low = -300, high = 10;
  while (high - low > 1) {
    const int middle = (low + high) / 2;
    (exceeds(a, pow(Real(2), middle)) ? low : high) = middle;
  }
  return low;
}

/// Values all over space with any normals and, where `slopes`, slopes at every other place: 25 places, some close by.
std::vector<ResidualGp::ResidualDatum> any_design(bool slopes, Random& random) {
  std::vector<ResidualGp::ResidualDatum> rows;
  for (int i = 0; i < 25; ++i) {
    const ResidualGp::Place place{0.08 * random.uniform() * random_direction(random), random_direction(random)};
    rows.push_back({place, Vector3d::Zero(), 0.0, 0.0, false});
    if (!slopes || i % 2 == 0) continue;
    for (Eigen::Index k = 0; k < 3; ++k) rows.push_back({place, Vector3d::Unit(k), 0.0, 0.0, false});
  }
  return rows;
}

class ResidualGpCovariance : public ::testing::TestWithParam<const char*> {};

TEST_P(ResidualGpCovariance, IsItsFormulaAndHasNoNegativeEigenvalueOverRandomValuesAndSlopes) {
  const std::string kernel = GetParam();
  ResidualGp residual_gp(kernel_of(kernel), {0.006, 0.0005});
  residual_gp.fit({}, {});
  for (int seed = 0; seed < (test::brief() ? 2 : 5); ++seed) {
    Random random(seed, "test/skin/designs");
    const std::vector<ResidualGp::ResidualDatum> rows = any_design(kernel != "matern12", random);
    const ResidualGpOracle oracle(kernel, kLength, residual_gp.signal(), rows);
    const Eigen::MatrixXd found = residual_gp.covariance(rows);
    // Both with a diagonal of 1, so that values and slopes count alike.
    Matrix exact(rows.size()), framework(rows.size());
    double off = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const Real size = sqrt(oracle.covariance(i, i) * oracle.covariance(j, j));
        exact[i].push_back(oracle.covariance(i, j) / size);
        framework[i].push_back(Real(found(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j))) / size);
        off = std::max(off, std::abs(static_cast<double>(Real(framework[i][j] - exact[i][j]))));
      }
    }
    // A handful of roundings in the distance, the kernel and the normals; normals are of length 1 but for one, too.
    constexpr double kRounding = 20 * 0x1p-52;
    EXPECT_LT(off, kRounding);
    const int exactly = least_power(exact);
    EXPECT_GT(exactly, -300);
    // Entries so far off move an eigenvalue by n times that at most (Weyl).
    const double moved = static_cast<double>(rows.size()) * kRounding;
    EXPECT_TRUE(exceeds(framework, Real(-moved)));
    EXPECT_TRUE(exceeds(framework, Real(0)) || std::ldexp(1.0, exactly) <= moved);
    RecordProperty("least_" + std::to_string(seed), "2^" + std::to_string(exactly));
  }
}

INSTANTIATE_TEST_SUITE_P(Kernels, ResidualGpCovariance, ::testing::Values("matern12", "matern32", "matern52", "rbf"),
                         [](const auto& one) { return std::string(one.param); });

INSTANTIATE_TEST_SUITE_P(Kernels, ResidualGpExactly, ::testing::Values("matern32", "matern52", "rbf"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace palpate::stability
