// SPDX-License-Identifier: MIT
#include "lattice_counts.hpp"

#include "clones.hpp"

namespace palpate::footprints {

// Written out for each family, so that the loops are without branches.
PALPATE_CLONES void Cuts::rows(int begin, int end, int columns, int* __restrict begins, int* __restrict ends) const {
  const Cuts by = *this;
  const double squared = by.reach_ * by.reach_;
  constexpr int kAtOnce = 64;
  double low[kAtOnce];
  double high[kAtOnce];
  for (int from = begin; from < end; from += kAtOnce) {
    const int count = std::min(kAtOnce, end - from);
    if (by.family_ == Form::Family::box) {
      for (int i = 0; i < count; ++i) {
        const double dy = from + i - by.y_;
        const double first = by.slope_[0] * dy;
        const double second = by.slope_[1] * dy;
        low[i] = by.x_ + std::max(first - by.half_[0], second - by.half_[1]);
        high[i] = std::abs(dy) > by.reach_ ? -1.0 : by.x_ + std::min(first + by.half_[0], second + by.half_[1]);
      }
    } else {
      for (int i = 0; i < count; ++i) {
        const double dy = from + i - by.y_;
        const double rest = 1.0 - dy * dy / squared;
        const double middle = by.x_ + by.slope_[0] * dy;
        const double half = by.half_[0] * std::sqrt(std::max(rest, 0.0));
        low[i] = middle - half;
        high[i] = rest < 0.0 ? -1.0 : middle + half;
      }
    }
    for (int i = 0; i < count; ++i) {
      // Rounded up, and no less than 0: without SSE4.1 std::ceil and std::floor are calls.
      const int whole = static_cast<int>(low[i]);
      begins[from + i] = std::max(whole + (low[i] > whole ? 1 : 0), 0);
    }
    for (int i = 0; i < count; ++i) {
      const int above = static_cast<int>(high[i] + 1.0);
      ends[from + i] = low[i] > high[i] ? 0 : std::min(above, columns);
    }
  }
}

}  // namespace palpate::footprints
