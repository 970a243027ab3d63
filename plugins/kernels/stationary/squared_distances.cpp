// SPDX-License-Identifier: MIT
#include "kernels/stationary/squared_distances.hpp"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kernels/stationary/squared_distances.cpp"
#include "math/highway.hpp"

HWY_BEFORE_NAMESPACE();
namespace palpate::kernels::HWY_NAMESPACE {
namespace {

namespace hn = math::HWY_NAMESPACE::hn;

/// Computes squared_distances() for the pairs of the positions [from, to) with the position `other`, in vectors of type
/// `reals`. Returns the first position that was not computed, because fewer positions were left than a vector has
/// elements.
template <class Reals>
HWY_INLINE std::ptrdiff_t squared_distances_by_lanes(Reals reals, const Pairs& pairs, std::ptrdiff_t other,
                                                     std::ptrdiff_t from, std::ptrdiff_t to, double most, double scale,
                                                     double* out) {
  constexpr auto lanes = static_cast<std::ptrdiff_t>(hn::MaxLanes(reals));
  const auto farthest = hn::Set(reals, most);
  for (; from + lanes <= to; from += lanes, out += lanes) {
    auto sum = hn::Zero(reals);
    for (int axis = 0; axis < pairs.axes; ++axis) {
      const auto apart =
          hn::Sub(hn::LoadU(reals, pairs.places[axis] + from), hn::Set(reals, pairs.others[axis][other]));
      const auto scaled = hn::Mul(apart, hn::Set(reals, pairs.per_length[axis]));
      const auto square = hn::Mul(scaled, scaled);
      sum = hn::Add(sum, hn::IfThenElse(hn::Lt(farthest, square), farthest, square));
    }
    hn::StoreU(hn::Mul(sum, hn::Set(reals, scale)), reals, out);
  }
  return from;
}

void squared_distances(const Pairs& pairs, std::ptrdiff_t first, std::ptrdiff_t count, double most, double scale,
                       double* out) {
  std::ptrdiff_t other = first / pairs.n;
  for (std::ptrdiff_t begin = first % pairs.n; count > 0; begin = 0, ++other) {
    const std::ptrdiff_t end = std::min(pairs.n, begin + count);
    const std::ptrdiff_t rest =
        squared_distances_by_lanes(math::HWY_NAMESPACE::kReals, pairs, other, begin, end, most, scale, out);
    squared_distances_by_lanes(hn::CappedTag<double, 1>(), pairs, other, rest, end, most, scale, out + (rest - begin));
    out += end - begin;
    count -= end - begin;
  }
}

}  // namespace
}  // namespace palpate::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::kernels {

void squared_distances(const Pairs& pairs, std::ptrdiff_t first, std::ptrdiff_t count, double most, double scale,
                       double* out) {
  PALPATE_DISPATCH(squared_distances)(pairs, first, count, most, scale, out);
}

}  // namespace palpate::kernels
#endif
