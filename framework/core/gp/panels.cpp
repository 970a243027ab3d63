// SPDX-License-Identifier: MIT
#include "gp/panels.hpp"

#include <new>

namespace palpate::loops {

double* Lines::allocate(std::size_t size) {
  const std::size_t bytes = size * sizeof(double);
  constexpr std::size_t kUnit = kLineBytes;
  const std::size_t rounded = (bytes + kUnit - 1) / kUnit * kUnit;
  void* const out = std::aligned_alloc(kUnit, rounded);
  if (out == nullptr && rounded > 0) throw std::bad_alloc();
  return static_cast<double*>(out);
}

}  // namespace palpate::loops
