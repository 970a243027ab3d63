// SPDX-License-Identifier: MIT
// A guarded tap of an arm whose force may have either sign.
#pragma once

#include "tapping/guarded_tap.hpp"

#include <vector>

namespace palpate::baxter {

/// While the sign is not known there are two taps, one for each. They are led alike until one of them feels a contact;
/// that one goes on, and its sign is the robot's, if the contact is one.
class SignedTap {
  struct One {
    double sign;
    tapping::GuardedTap tap;
    double set_point = 0.0;
  };

 public:
  /// `sign`: of the force when something presses the tool upwards, 1 or -1; 0 if it is not known.
  SignedTap(const tapping::MotionOptions& motion, const tapping::Descent& descent, double sign) {
    const tapping::GuardedTap tap(motion, descent, tapping::GuardedTap::Arm::real);
    taps_ = sign != 0.0 ? std::vector<One>{{sign, tap}} : std::vector<One>{{-1.0, tap}, {1.0, tap}};
  }

  /// As GuardedTap::next, with the force as the robot tells it.
  double next(double height, double force, bool fresh) {
    for (One& one : taps_) one.set_point = one.tap.next(height, one.sign * force, fresh);
    if (taps_.size() == 2 && taps_.front().set_point != taps_.back().set_point) {
      // Of a contact the set-point is put where the arm is.
      const bool second = taps_.back().set_point == height;
      taps_.erase(second ? taps_.begin() : taps_.begin() + 1);
    }
    return taps_.front().set_point;
  }

  const tapping::GuardedTap& tap() const { return taps_.front().tap; }
  /// 0 while nothing has shown it.
  double sign() const { return taps_.size() == 1 ? taps_.front().sign : 0.0; }

 private:
  std::vector<One> taps_;
};

}  // namespace palpate::baxter
