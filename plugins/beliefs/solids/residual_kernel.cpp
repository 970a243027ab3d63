// SPDX-License-Identifier: MIT
#include "solids/residual_kernel.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>
#include "solids/primitive.hpp"

#include <utility>

namespace palpate {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns whether the kernel depends on the distance alone. Compares covariances over the distances of all possible
/// length scales, in four directions, from two positions.
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

}  // namespace

ResidualKernel::ResidualKernel(std::shared_ptr<const Kernel> kernel) : kernel_(std::move(kernel)) {
  if (!knows_distances_alone(*kernel_))
    throw Error("kernel",
                "depends on more than the distance, but surface: implicit needs a kernel of the distance alone",
                "choose one with a single length scale, such as matern32");
  kernel_->variance(Points::Zero(1, 2), Eigen::Map<VectorXd>(&unit_, 1));
}

ResidualKernel::DatumTable ResidualKernel::table_of(const std::vector<ResidualDatum>& rows) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  DatumTable out{Eigen::MatrixX3d(n, 3), Eigen::MatrixX3d(n, 3), Eigen::MatrixX3d(n, 3)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const ResidualDatum& row = rows[static_cast<std::size_t>(i)];
    out.at.row(i) = row.place.at;
    out.normal.row(i) = row.place.normal;
    out.along.row(i) = row.along;
    out.slopes |= !row.along.isZero(0.0);
  }
  return out;
}

MatrixXd ResidualKernel::covariances(const DatumTable& a, const DatumTable& b) const {
  MatrixXd out(a.at.rows(), b.at.rows());
  Points apart = Points::Zero(out.size(), 2);
  covariances(a, b, apart, out);
  return out;
}

void ResidualKernel::covariances(const DatumTable& a, const DatumTable& b, Points& apart, MatrixOut out) const {
  const Eigen::Index n = a.at.rows();
  const Eigen::Index m = b.at.rows();
  for (Eigen::Index j = 0; j < m; ++j)
    apart.col(0).segment(j * n, n) =
        ((a.at.col(0).array() - b.at(j, 0)).square() + (a.at.col(1).array() - b.at(j, 1)).square() +
         (a.at.col(2).array() - b.at(j, 2)).square())
            .sqrt();
  kernel_->covariance(apart.topRows(n * m), Points::Zero(1, 2), Eigen::Map<MatrixXd>(out.data(), n * m, 1));
  if (a.slopes || b.slopes) {
    VectorXd across(n * m), along(n * m);
    kernel_->gradient_covariance(apart.col(0).head(n * m), across, along);
    for (Eigen::Index j = 0; j < m; ++j) {
      const bool slope = !b.along.row(j).isZero(0.0);
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Index pair = j * n + i;
        const auto way = a.at.row(i) - b.at.row(j);
        // Components of the difference along the directions of the two slopes. For a value, the component is 0.
        const double from = way.dot(a.along.row(i));
        const double to = way.dot(b.along.row(j));
        if (a.along.row(i).isZero(0.0)) {
          if (slope) out(i, j) = across(pair) * to;
        } else if (!slope) {
          out(i, j) = -across(pair) * from;
        } else {
          const double r = apart(pair, 0);
          const double both = r > 0.0 ? (from / r) * (to / r) : 0.0;  // at distance 0, `along` equals `across`
          out(i, j) = across(pair) * a.along.row(i).dot(b.along.row(j)) + (along(pair) - across(pair)) * both;
        }
      }
    }
  }
  const double half = 0.5 * signal_ * signal_;
  for (Eigen::Index j = 0; j < m; ++j)
    out.col(j).array() *=
        half *
        (1.0 + (a.normal.col(0) * b.normal(j, 0) + a.normal.col(1) * b.normal(j, 1) + a.normal.col(2) * b.normal(j, 2))
                   .array());
}

}  // namespace palpate
