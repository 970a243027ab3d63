// SPDX-License-Identifier: MIT
#include "gp/axis_basis.hpp"

#include "regular/regular_factor.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate {
namespace {

/// Covariance matrix of the positions along one axis, computed column by column.
class AxisCovariances {
 public:
  AxisCovariances(const Kernel& kernel, int axis, const Eigen::VectorXd& positions)
      : kernel_(kernel), axis_(axis), positions_(positions) {}

  Eigen::Index size() const { return positions_.size(); }
  Eigen::VectorXd column(Eigen::Index i) const {
    Eigen::VectorXd out(size());
    kernel_.axis_covariance(axis_, positions_, positions_.segment(i, 1), out);
    return out;
  }
  double at(Eigen::Index i, Eigen::Index j) const {
    Eigen::Matrix<double, 1, 1> out;
    kernel_.axis_covariance(axis_, positions_.segment(i, 1), positions_.segment(j, 1), out);
    return out(0);
  }
  Eigen::Index mirror_image(Eigen::Index i) const { return size() - 1 - i; }

  /// Returns whether positions and kernel are symmetric, up to rounding of the positions. Compares only three columns
  /// with their mirror images.
  bool is_mirrored() const {
    if (size() < 2) return false;
    for (const Eigen::Index i : {Eigen::Index{0}, size() / 3, size() / 2}) {
      const Eigen::VectorXd there = column(mirror_image(i)).reverse();
      const Eigen::VectorXd here = column(i);
      if ((here - there).cwiseAbs().maxCoeff() > 64.0 * kEpsilon * here.cwiseAbs().maxCoeff()) return false;
    }
    // The positions between the compared columns must be symmetric, too.
    const Eigen::VectorXd middle = positions_ + positions_.reverse();
    return (middle.array() - middle(0)).abs().maxCoeff() <= 16.0 * kEpsilon * positions_.cwiseAbs().maxCoeff();
  }

 private:
  const Kernel& kernel_;
  int axis_;
  const Eigen::VectorXd& positions_;
};

/// Part of the covariance matrix K along an axis: k(h, h') + sign * k(h, mirror image of h') for h and h' among the
/// first `count` positions. If `sign` is 1, this is the even part of K; if -1, the odd part. If `sign` is 0 and `count`
/// includes all positions, it is K itself.
struct SymmetryPart {
  const AxisCovariances& covariances;
  Eigen::Index count;
  double sign;

  /// Returns whether the last position is its own mirror image.
  bool has_middle() const { return sign != 0.0 && covariances.mirror_image(count - 1) == count - 1; }

  /// Computes columns of the Cholesky factor with diagonal pivoting, until the residual variance at each position is at
  /// most `enough`, or until there are `most` columns.
  Eigen::MatrixXd pivoted(double enough, Eigen::Index most) const {
    Eigen::VectorXd residual(count);
    for (Eigen::Index i = 0; i < count; ++i)
      residual(i) = covariances.at(i, i) + (sign == 0.0 ? 0.0 : sign * covariances.at(i, covariances.mirror_image(i)));
    most = std::min(most, count);
    Eigen::MatrixXd columns(count, std::min<Eigen::Index>(most, 32));
    Eigen::Index rank = 0;
    while (rank < most) {
      Eigen::Index pivot = 0;
      if (!(residual.maxCoeff(&pivot) > enough)) break;
      if (rank == columns.cols()) columns.conservativeResize(Eigen::NoChange, std::min(most, 2 * rank));
      auto column = columns.col(rank);
      column = covariances.column(pivot).head(count);
      if (sign != 0.0) column += sign * covariances.column(covariances.mirror_image(pivot)).head(count);
      // An odd function is 0 in the middle. Without this assignment, the rounding error in the middle would be as large
      // as the smallest columns.
      if (sign < 0.0 && has_middle()) column(count - 1) = 0.0;
      column.noalias() -= columns.leftCols(rank) * columns.row(pivot).head(rank).transpose();
      column /= std::sqrt(residual(pivot));
      residual -= column.cwiseAbs2();
      residual(pivot) = 0.0;
      ++rank;
    }
    return columns.leftCols(rank);
  }

  /// Computes an orthonormal basis of the span of `columns`, extended to all positions by symmetry.
  Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns) const {
    // Each position of the half axis stands for itself and for its mirror image, so its weight is sqrt(2). If the
    // weighted half directions are orthonormal, the directions over all positions are orthonormal, too.
    Eigen::VectorXd weights = Eigen::VectorXd::Constant(count, sign == 0.0 ? 1.0 : std::sqrt(2.0));
    if (has_middle()) weights(count - 1) = 1.0;
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(weights.asDiagonal() * columns);
    const Eigen::MatrixXd half =
        weights.cwiseInverse().asDiagonal() * (qr.householderQ() * Eigen::MatrixXd::Identity(count, columns.cols()));
    Eigen::MatrixXd whole(covariances.size(), columns.cols());
    whole.bottomRows(count) = sign * half.colwise().reverse();
    whole.topRows(count) = half;
    return whole;
  }
};

/// Returns the even and the odd part if there is symmetry, else the whole matrix as one part.
std::vector<SymmetryPart> parts_of(const AxisCovariances& covariances) {
  if (!covariances.is_mirrored()) return {{covariances, covariances.size(), 0.0}};
  const Eigen::Index half = (covariances.size() + 1) / 2;
  return {{covariances, half, 1.0}, {covariances, half, -1.0}};
}

double largest_variance(const AxisCovariances& covariances) {
  double out = 0.0;
  for (Eigen::Index i = 0; i < covariances.size(); ++i) out = std::max(out, covariances.at(i, i));
  return out;
}

}  // namespace

AxisBasis axis_basis(const Kernel& kernel, int axis, const Eigen::VectorXd& positions, double tolerance) {
  const AxisCovariances covariances(kernel, axis, positions);
  const double enough = tolerance * largest_variance(covariances);
  const std::vector<SymmetryPart> parts = parts_of(covariances);
  AxisBasis out;
  out.mirrored = parts.size() > 1;
  for (const SymmetryPart& part : parts) {
    const Eigen::MatrixXd own = part.orthonormal(part.pivoted(enough, part.count));
    out.directions.conservativeResize(covariances.size(), out.directions.cols() + own.cols());
    out.directions.rightCols(own.cols()) = own;
    if (part.sign >= 0.0) out.even = out.rank();
  }
  return out;
}

int axis_rank(const Kernel& kernel, int axis, const Eigen::VectorXd& positions, double tolerance, int most) {
  const AxisCovariances covariances(kernel, axis, positions);
  const double enough = tolerance * largest_variance(covariances);
  int rank = 0;
  for (const SymmetryPart& part : parts_of(covariances))
    rank += static_cast<int>(part.pivoted(enough, most - rank).cols());
  return rank;
}

}  // namespace palpate
