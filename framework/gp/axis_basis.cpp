// SPDX-License-Identifier: MIT
#include "gp/axis_basis.hpp"

#include <Eigen/QR>

#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Covariances along one axis between some places.
class Line {
 public:
  Line(const Kernel& kernel, int axis, const Eigen::VectorXd& places) : kernel_(kernel), axis_(axis), places_(places) {}

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

/// Orthonormal columns that span those of the pivoted Cholesky factor of k(h, h') + sign k(h, image of h'), h and h'
/// the first `places`; continued to all places by the mirror. For sign 0 and all places, of k itself.
Eigen::MatrixXd span(const Line& line, Eigen::Index places, double sign, double enough) {
  const bool own_image = line.image(places - 1) == places - 1;
  Eigen::VectorXd left(places);
  for (Eigen::Index i = 0; i < places; ++i) {
    left(i) = line.at(i, i) + (sign == 0.0 ? 0.0 : sign * line.at(i, line.image(i)));
  }
  Eigen::MatrixXd columns(places, std::min<Eigen::Index>(places, 32));
  Eigen::Index rank = 0;
  while (rank < places) {
    Eigen::Index pivot = 0;
    if (!(left.maxCoeff(&pivot) > enough)) break;
    if (rank == columns.cols()) columns.conservativeResize(Eigen::NoChange, std::min(places, 2 * rank));
    auto column = columns.col(rank);
    column = line.column(pivot).head(places);
    if (sign != 0.0) column += sign * line.column(line.image(pivot)).head(places);
    // An odd function is 0 in the middle: rounding there would count as much as the least directions.
    if (sign < 0.0 && own_image) column(places - 1) = 0.0;
    column.noalias() -= columns.leftCols(rank) * columns.row(pivot).head(rank).transpose();
    column /= std::sqrt(left(pivot));
    left -= column.cwiseAbs2();
    left(pivot) = 0.0;
    ++rank;
  }
  // A place that is not its own image stands for two. Orthonormal by these weights, the halves are so as a whole.
  Eigen::VectorXd weights = Eigen::VectorXd::Constant(places, sign == 0.0 ? 1.0 : std::sqrt(2.0));
  if (own_image) weights(places - 1) = 1.0;
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(weights.asDiagonal() * columns.leftCols(rank));
  const Eigen::MatrixXd half =
      weights.cwiseInverse().asDiagonal() * (qr.householderQ() * Eigen::MatrixXd::Identity(places, rank));
  Eigen::MatrixXd whole(line.size(), rank);
  whole.bottomRows(places) = sign * half.colwise().reverse();
  whole.topRows(places) = half;
  return whole;
}

}  // namespace

AxisBasis axis_basis(const Kernel& kernel, int axis, const Eigen::VectorXd& places, double tolerance) {
  const Line line(kernel, axis, places);
  double largest = 0.0;
  for (Eigen::Index i = 0; i < line.size(); ++i) largest = std::max(largest, line.at(i, i));
  const double enough = tolerance * largest;
  AxisBasis out;
  out.mirrored = line.is_mirrored();
  if (out.mirrored) {
    const Eigen::Index half = (line.size() + 1) / 2;
    const Eigen::MatrixXd even = span(line, half, 1.0, enough);
    const Eigen::MatrixXd odd = span(line, half, -1.0, enough);
    out.directions.resize(line.size(), even.cols() + odd.cols());
    out.directions << even, odd;
    out.even = static_cast<int>(even.cols());
  } else {
    out.directions = span(line, line.size(), 0.0, enough);
    out.even = out.rank();
  }
  return out;
}

}  // namespace palpate
