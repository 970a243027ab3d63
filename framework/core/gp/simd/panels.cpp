// SPDX-License-Identifier: MIT
#include "gp/simd/panels.hpp"

#include <sys/mman.h>

#include <new>

namespace palpate::simd {

double* Lines::allocate(std::size_t size, Written written) {
  constexpr std::size_t kHuge = std::size_t{2} << 20U;
  const std::size_t bytes = size * sizeof(double);
  const bool huge = written == Written::in_order && bytes >= kHuge / 2;
  const std::size_t unit = huge ? kHuge : std::size_t{kLineBytes};
  const std::size_t rounded = (bytes + unit - 1) / unit * unit;
  void* const out = std::aligned_alloc(unit, rounded);
  if (out == nullptr && rounded > 0) throw std::bad_alloc();
  if (huge) ::madvise(out, rounded, MADV_HUGEPAGE);  // a wish: where it is not granted, small pages do
  return static_cast<double*>(out);
}

}  // namespace palpate::simd
