// SPDX-License-Identifier: MIT
// Common input for tests of the safety rules: an arm 10 cm above the middle of its area.
#pragma once

#include "baxter/bench.hpp"

#include <functional>
#include <optional>
#include <ostream>
#include <string>

#include <gmock/gmock.h>

namespace palpate::baxter {

inline void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.reason; }

namespace test {

using Spoil = std::function<void(Snapshot&)>;

inline const Workspace kSpace{0.23, 0.23, -0.03, 0.435};
inline const Eigen::Vector3d kInside(0.1, 0.1, 0.1);
inline const Eigen::Vector3d kZero(0.3, -0.2, 1.0);  ///< approximate force of sound()

inline Joints pose() {
  static const Joints joints = PlannerBench().at(0.1, 0.1, 0.1);
  return joints;
}

/// The rules, applied to a sound robot that `spoil` changes.
class Rules : public MotionGuard {
 public:
  Rules() : MotionGuard(kSpace, 14.0) {}
  Eigen::Vector3d tip = kInside;
  std::optional<Fault> at(double now, const Spoil& spoil = nullptr, const Joints& joints = pose()) {
    Snapshot seen = sound(now, joints);
    if (spoil) spoil(seen);
    return check(seen, tip);
  }
};

MATCHER(IsNothing, "") { return !arg.has_value(); }
/// Matches a fault whose reason contains these words and that allows this action.
MATCHER_P2(IsFault, words, then, "") {
  return arg && arg->then == then &&
         testing::ExplainMatchResult(testing::HasSubstr(words), arg->reason, result_listener);
}

}  // namespace test
}  // namespace palpate::baxter
