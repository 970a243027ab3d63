// SPDX-License-Identifier: MIT
#include "stability/oracle.hpp"

#include <boost/math/constants/constants.hpp>

#include <algorithm>
#include <cmath>

namespace palpate::stability {

Oracle::Oracle(const Case& one, const Points& places, const Eigen::VectorXd& values) : case_(one), places_(places) {
  for (Eigen::Index a = 0; a < places.rows(); ++a) {
    Row row;
    for (Eigen::Index b = 0; b <= a; ++b) row.push_back(kernel(places(a, 0), places(a, 1), places(b, 0), places(b, 1)));
    covariance_.push_back(std::move(row));
    targets_.push_back((Real(values(a)) - one.mean) / one.signal);
  }
}

// Rasmussen and Williams 2006, equations 4.9 and 4.17.
Real Oracle::kernel(double ax, double ay, double bx, double by) const {
  const Real dx = (Real(ax) - bx) / case_.length_scale();
  const Real dy = (Real(ay) - by) / case_.length_scale();
  const Real r2 = dx * dx + dy * dy;
  const Real constant = Real(case_.mean_ratio) * case_.mean_ratio;
  if (case_.kernel == "rbf") return exp(-r2 / 2) + constant;
  const Real s = sqrt(5 * r2);
  return (1 + s + s * s / 3) * exp(-s) + constant;
}

bool Oracle::factorise(double jitter) {
  const std::size_t n = covariance_.size();
  const Real noise = Real(case_.noise()) / case_.signal;
  diagonal_ = noise * noise + jitter;
  factor_ = covariance_;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      Real sum = factor_[i][j];
      if (i == j) sum += diagonal_;
      for (std::size_t k = 0; k < j; ++k) sum -= factor_[i][k] * factor_[j][k];
      // 80 digits below the largest entry nothing but rounding is left.
      if (i == j && !(sum > Real("1e-80") * (covariance_[i][i] + diagonal_))) return false;
      factor_[i][j] = i == j ? Real(sqrt(sum)) : Real(sum / factor_[j][j]);
    }
  }
  alpha_ = targets_;
  forward(alpha_);
  backward(alpha_);
  return true;
}

void Oracle::forward(Row& b) const {
  for (std::size_t i = 0; i < b.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) b[i] -= factor_[i][k] * b[k];
    b[i] /= factor_[i][i];
  }
}

void Oracle::backward(Row& b) const {
  for (std::size_t i = b.size(); i-- > 0;) {
    b[i] /= factor_[i][i];
    for (std::size_t k = 0; k < i; ++k) b[k] -= factor_[i][k] * b[i];
  }
}

Oracle::Row Oracle::covariances_with(double x, double y) const {
  Row row;
  for (Eigen::Index i = 0; i < places_.rows(); ++i) row.push_back(kernel(x, y, places_(i, 0), places_(i, 1)));
  return row;
}

// The mean k_*^T A^-1 y changes by -w^T E alpha, w = A^-1 k_*, for a small change E of A.
void Oracle::nudge_covariances(double x, double y) {
  Row weights = covariances_with(x, y);
  forward(weights);
  backward(weights);
  for (std::size_t i = 0; i < covariance_.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const auto size = static_cast<double>(covariance_[i][j]);
      const double ulp = std::nextafter(size, 2.0 * size) - size;
      const bool raises = weights[i] * alpha_[j] + weights[j] * alpha_[i] < 0;
      covariance_[i][j] += raises ? ulp : -ulp;
    }
  }
}

Oracle::Posterior Oracle::at(double x, double y) const {
  Row row = covariances_with(x, y);
  Posterior out;
  out.mean = 0;
  for (std::size_t i = 0; i < row.size(); ++i) out.mean += row[i] * alpha_[i];
  out.variance = kernel(x, y, x, y);
  forward(row);
  for (const Real& v : row) out.variance -= v * v;
  backward(row);
  Real square = 0;
  for (const Real& w : row) square += w * w;
  out.weights = static_cast<double>(Real(sqrt(square)));
  return out;
}

Real Oracle::log_marginal_likelihood() const {
  Real sum = 0;
  for (std::size_t i = 0; i < alpha_.size(); ++i) {
    sum -= targets_[i] * alpha_[i] / 2 + log(factor_[i][i]) + log(Real(case_.signal)) +
           log(2 * boost::math::constants::pi<Real>()) / 2;
  }
  return sum;
}

double Oracle::least_pivot() const {
  Real least = factor_.front().front();
  for (const Row& row : factor_) least = std::min(least, row.back());
  return static_cast<double>(Real(least * least));
}

}  // namespace palpate::stability
