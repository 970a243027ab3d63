// SPDX-License-Identifier: MIT
// What tests of the rules look at: an arm 10 cm above the middle of its area.
#pragma once

#include "baxter/bench.hpp"

namespace palpate::baxter::test {

inline const Workspace kSpace{0.23, 0.23, -0.03, 0.435};
inline const Eigen::Vector3d kInside(0.1, 0.1, 0.1);

inline Joints pose() {
  static const Joints joints = PlannerBench().at(0.1, 0.1, 0.1);
  return joints;
}

}  // namespace palpate::baxter::test
