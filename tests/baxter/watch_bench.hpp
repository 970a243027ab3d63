// SPDX-License-Identifier: MIT
// What tests of the rules look at: an arm 10 cm above the middle of its area.
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
inline const Eigen::Vector3d kZero(0.3, -0.2, 1.0);  ///< about the force of sound()

inline Joints pose() {
  static const Joints joints = PlannerBench().at(0.1, 0.1, 0.1);
  return joints;
}

/// The rules, and what they find of a robot that is sound but for what `spoil` does.
class Rules : public Watch {
 public:
  Rules() : Watch(kSpace, 14.0) {}
  Eigen::Vector3d tip = kInside;
  std::optional<Fault> at(double now, const Spoil& spoil = nullptr, const Joints& joints = pose()) {
    Snapshot seen = sound(now, joints);
    if (spoil) spoil(seen);
    return look(seen, tip);
  }
};

MATCHER(IsNothing, "") { return !arg.has_value(); }
/// A fault for which these words stand, after which so much may still be done.
MATCHER_P2(IsFault, words, then, "") {
  return arg && arg->then == then &&
         testing::ExplainMatchResult(testing::HasSubstr(words), arg->reason, result_listener);
}

}  // namespace test
}  // namespace palpate::baxter
