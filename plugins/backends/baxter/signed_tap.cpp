// SPDX-License-Identifier: MIT
#include "baxter/signed_tap.hpp"

namespace palpate::baxter {

using tapping::GuardedTap;

SignedTap::SignedTap(const tapping::MotionOptions& motion, const tapping::Descent& descent, double sign) {
  const GuardedTap tap(motion, descent, GuardedTap::Arm::real);
  if (sign != 0.0) {
    taps_.push_back({sign, tap});
  } else {
    taps_ = {{-1.0, tap}, {1.0, tap}};
  }
}

double SignedTap::next(double height, double force, bool fresh) {
  for (One& one : taps_) one.set_point = one.tap.next(height, one.sign * force, fresh);
  if (taps_.size() == 2 && taps_.front().set_point != taps_.back().set_point) {
    // Of a contact the set-point is put where the arm is.
    const bool second = taps_.back().set_point == height;
    taps_.erase(second ? taps_.begin() : taps_.begin() + 1);
  }
  return taps_.front().set_point;
}

}  // namespace palpate::baxter
