// SPDX-License-Identifier: MIT
#include "gp/factor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {

bool Factor::append(const VectorView& covariance, double diagonal) {
  const int n = size_;
  if (rows_.cols() <= n) {
    const int capacity = std::max(16, 2 * n);
    rows_.conservativeResize(capacity, capacity);
  }
  auto row = rows_.col(n);
  for (int i = 0; i < n; ++i) {
    row(i) = (covariance(i) - rows_.col(i).head(i).dot(row.head(i))) / rows_(i, i);
  }
  const double square = diagonal - row.head(n).squaredNorm();
  if (!(square > (n + 1) * std::numeric_limits<double>::epsilon() * diagonal)) return false;
  const double pivot = std::sqrt(square);
  row(n) = pivot;
  largest_ = n == 0 ? pivot : std::max(largest_, pivot);
  smallest_ = n == 0 ? pivot : std::min(smallest_, pivot);
  log_determinant_ += 2.0 * std::log(pivot);
  ++size_;
  return true;
}

void Factor::clear() {
  size_ = 0;
  log_determinant_ = 0.0;
}

double Factor::condition() const { return size_ == 0 ? 1.0 : (largest_ / smallest_) * (largest_ / smallest_); }

}  // namespace palpate
