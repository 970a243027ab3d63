// SPDX-License-Identifier: MIT
#include "gp/axis_basis.hpp"

#include "regular/regular_factor.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate {
namespace {

/// Covariances along one axis between some places.
class AxisPlaces {
 public:
  AxisPlaces(const Kernel& kernel, int axis, const Eigen::VectorXd& places)
      : kernel_(kernel), axis_(axis), places_(places) {}

  Eigen::Index size() const { return places_.size(); }
  Eigen::VectorXd column(Eigen::Index place) const {
    Eigen::VectorXd out(size());
    kernel_.axis_covariance(axis_, places_, places_.segment(place, 1), out);
    return out;
  }
  double at(Eigen::Index i, Eigen::Index j) const {
    Eigen::Matrix<double, 1, 1> out;
    kernel_.axis_covariance(axis_, places_.segment(i, 1), places_.segment(j, 1), out);
    return out(0);
  }
  Eigen::Index image(Eigen::Index place) const { return size() - 1 - place; }

  /// Whether the kernel does not tell the places from their mirror image, but for the rounding of the places.
  bool is_mirrored() const {
    if (size() < 2) return false;
    for (const Eigen::Index place : {Eigen::Index{0}, size() / 3, size() / 2}) {
      const Eigen::VectorXd there = column(image(place)).reverse();
      const Eigen::VectorXd here = column(place);
      if ((here - there).cwiseAbs().maxCoeff() > 64.0 * kEpsilon * here.cwiseAbs().maxCoeff()) return false;
    }
    // The columns between those: their places are mirrored too.
    const Eigen::VectorXd middle = places_ + places_.reverse();
    return (middle.array() - middle(0)).abs().maxCoeff() <= 16.0 * kEpsilon * places_.cwiseAbs().maxCoeff();
  }

 private:
  const Kernel& kernel_;
  int axis_;
  const Eigen::VectorXd& places_;
};

/// A part of the covariances K of a line: k(h, h') + sign k(h, image of h'), h and h' the first `places`. Of sign 1 it
/// is the even part and of sign -1 the odd one; of sign 0, with all places, K itself.
struct Part {
  const AxisPlaces& line;
  Eigen::Index places;
  double sign;

  /// The last place is its own image.
  bool own_image() const { return sign != 0.0 && line.image(places - 1) == places - 1; }

  /// Columns of a Cholesky factor with diagonal pivoting, until no more than `enough` is left of the variance at any
  /// place, or there are `most` columns.
  Eigen::MatrixXd pivoted(double enough, Eigen::Index most) const {
    Eigen::VectorXd left(places);
    for (Eigen::Index i = 0; i < places; ++i) {
      left(i) = line.at(i, i) + (sign == 0.0 ? 0.0 : sign * line.at(i, line.image(i)));
    }
    most = std::min(most, places);
    Eigen::MatrixXd columns(places, std::min<Eigen::Index>(most, 32));
    Eigen::Index rank = 0;
    while (rank < most) {
      Eigen::Index pivot = 0;
      if (!(left.maxCoeff(&pivot) > enough)) break;
      if (rank == columns.cols()) columns.conservativeResize(Eigen::NoChange, std::min(most, 2 * rank));
      auto column = columns.col(rank);
      column = line.column(pivot).head(places);
      if (sign != 0.0) column += sign * line.column(line.image(pivot)).head(places);
      // An odd function is 0 in the middle: rounding there would count as much as the least directions.
      if (sign < 0.0 && own_image()) column(places - 1) = 0.0;
      column.noalias() -= columns.leftCols(rank) * columns.row(pivot).head(rank).transpose();
      column /= std::sqrt(left(pivot));
      left -= column.cwiseAbs2();
      left(pivot) = 0.0;
      ++rank;
    }
    return columns.leftCols(rank);
  }

  /// An orthonormal basis of the span of `columns`, continued to all places by the mirror.
  Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns) const {
    // A place that is not its own image stands for two. Orthonormal by these weights, the halves are so as a whole.
    Eigen::VectorXd weights = Eigen::VectorXd::Constant(places, sign == 0.0 ? 1.0 : std::sqrt(2.0));
    if (own_image()) weights(places - 1) = 1.0;
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(weights.asDiagonal() * columns);
    const Eigen::MatrixXd half =
        weights.cwiseInverse().asDiagonal() * (qr.householderQ() * Eigen::MatrixXd::Identity(places, columns.cols()));
    Eigen::MatrixXd whole(line.size(), columns.cols());
    whole.bottomRows(places) = sign * half.colwise().reverse();
    whole.topRows(places) = half;
    return whole;
  }
};

/// Even and odd part where there is a mirror, else the whole.
std::vector<Part> parts_of(const AxisPlaces& line) {
  if (!line.is_mirrored()) return {{line, line.size(), 0.0}};
  const Eigen::Index half = (line.size() + 1) / 2;
  return {{line, half, 1.0}, {line, half, -1.0}};
}

double largest_variance(const AxisPlaces& line) {
  double out = 0.0;
  for (Eigen::Index i = 0; i < line.size(); ++i) out = std::max(out, line.at(i, i));
  return out;
}

}  // namespace

AxisBasis axis_basis(const Kernel& kernel, int axis, const Eigen::VectorXd& places, double tolerance) {
  const AxisPlaces line(kernel, axis, places);
  const double enough = tolerance * largest_variance(line);
  const std::vector<Part> parts = parts_of(line);
  AxisBasis out;
  out.mirrored = parts.size() > 1;
  for (const Part& part : parts) {
    const Eigen::MatrixXd own = part.orthonormal(part.pivoted(enough, part.places));
    out.directions.conservativeResize(line.size(), out.directions.cols() + own.cols());
    out.directions.rightCols(own.cols()) = own;
    if (part.sign >= 0.0) out.even = out.rank();
  }
  return out;
}

int axis_rank(const Kernel& kernel, int axis, const Eigen::VectorXd& places, double tolerance, int most) {
  const AxisPlaces line(kernel, axis, places);
  const double enough = tolerance * largest_variance(line);
  int rank = 0;
  for (const Part& part : parts_of(line)) rank += static_cast<int>(part.pivoted(enough, most - rank).cols());
  return rank;
}

}  // namespace palpate
