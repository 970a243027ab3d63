// SPDX-License-Identifier: MIT
#include "gp/factor.hpp"

#include "regular/regular_factor.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {

void Factor::reserve(int rows) {
  if (rows <= capacity_) return;
  const int padded = loops::round_up(rows, loops::kLine);
  const loops::AlignedArray old = std::move(rows_);
  rows_ = loops::AlignedArray(loops::packed_row(padded));
  std::copy_n(old.data(), loops::packed_row(size_), rows_.data());
  scratch_ = loops::AlignedArray(static_cast<std::size_t>(padded));
  largest_.vector.conservativeResize(rows);
  smallest_.vector.conservativeResize(rows);
  capacity_ = rows;
}

bool Factor::append(const VectorView& covariance, double diagonal) {
  const int n = size_;
  if (n == capacity_) reserve(std::max(16, 2 * n));
  double* const row = rows_.data() + loops::packed_row(n);
  Eigen::Map<Eigen::VectorXd> l(row, n);
  l = covariance;
  std::fill(row + n, rows_.data() + loops::packed_row(n + 1), 0.0);
  loops::solve_lower(rows_.data(), n, row);
  const double square = diagonal - l.squaredNorm();
  if (!is_regular(square, n, diagonal)) return false;
  row[n] = std::sqrt(square);
  log_determinant_ += math::log(square);
  ++size_;
  update(largest_, true);
  update(smallest_, false);
  return true;
}

void Factor::inverse_row(int i, VectorOut out) {
  // Row c of L^-1 satisfies c^T L = e_i^T, so L^T c = e_i. The last entry of c is 1 / L_ii, and the leading block of
  // L^T gives the other entries.
  const double last = 1.0 / pivot(i);
  double* const c = scratch_.data();
  Eigen::Map<Eigen::VectorXd>(c, i) = -last * row(i);
  std::fill(c + i, c + loops::round_up(i, loops::kLine), 0.0);
  loops::solve_lower_transposed(rows_.data(), i, c);
  out.head(i) = Eigen::Map<const Eigen::VectorXd>(c, i);
  out(i) = last;
}

void Factor::update(SingularPair& extreme, bool largest) const {
  const int n = size_ - 1;
  const double pivot = this->pivot(n);
  if (n == 0) {
    extreme.vector(0) = 1.0;
    extreme.value = pivot * pivot;
    return;
  }
  // The new singular vector has the form (s x, c) with s^2 + c^2 = 1, and |L (s x, c)|^2 = [s c] [[v + a^2, a d], [a d,
  // d^2]] [s c]^T. Here l is the new row of L without its pivot d, a = l.x, and v is the value |L x|^2 before this row.
  const double a = row(n).dot(extreme.vector.head(n));
  const double angle = 0.5 * math::atan2(2.0 * a * pivot, extreme.value + a * a - pivot * pivot);
  double s = math::cos(angle);
  double c = math::sin(angle);
  const double image = s * a + c * pivot;
  const double largest_value = s * s * extreme.value + image * image;
  if (largest) {
    extreme.value = largest_value;
  } else {
    // The smaller eigenvalue is the determinant v d^2 divided by the larger eigenvalue. This avoids a difference of
    // nearly equal numbers.
    extreme.value = extreme.value * pivot * pivot / largest_value;
    std::swap(s, c);
    s = -s;
  }
  extreme.vector.head(n) *= s;
  extreme.vector(n) = c;
}

void Factor::clear() {
  size_ = 0;
  log_determinant_ = 0.0;
}

}  // namespace palpate
