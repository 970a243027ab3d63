// SPDX-License-Identifier: MIT
#pragma once

#include "analysis/statistics.hpp"

namespace palpate::test {

/// Each value as a cluster of its own.
inline Clusters each_alone(const std::vector<double>& values) {
  Clusters out;
  for (const double value : values) out.push_back({value});
  return out;
}

}  // namespace palpate::test
