// SPDX-License-Identifier: MIT
// Speed for accuracy, tap by tap: of the backend's motions, the one with the most information per second.
//
// A tap tells whether there is an object: the entropy of the footprint there, in bits, whatever the motion. If there is
// one, it tells its height: log2(1 + v / d^2) / 2 bits (Cover and Thomas 2006, section 9.1) of a height of variance v
// by a motion of standard deviation d. It does so with the probability that the motion's taps come to a contact, and
// takes the mean of the times with an object there and without. Times, deviations and contacts are first those that the
// motion expects, then those that its taps show. So the quick motion follows an outline, and the precise one is used
// where only the height is open.
//
// The position is chosen before, by the information of a tap there and not by the information per second: near and tall
// positions are cheap, but those at the edge of an outline, which cost more, bring the scene nearer to the truth for
// each second.
#pragma once

#include "experiment/tap_record.hpp"

#include <palpate/motions.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace palpate {

class MotionSelector {
 public:
  /// `desk`: its height, metres.
  MotionSelector(std::shared_ptr<const Motions> motions, double desk);

  /// Returns what is read at the chosen candidate.
  static QuantitySet reads();

  /// Chooses the motion of a tap, whose line and predecessor are known, and notes its noise and expected time.
  void choose(const Belief& belief, TapRecord& tap) const;

  /// Returns the standard deviation that a motion adds to that of the most precise motion, metres.
  double height_noise(int motion) const;

  /// Takes in a tap, which `belief` has. Throws Error for an unknown motion, of a damaged record.
  void take_in(const TapRecord& tap, const Belief& belief);

 private:
  /// What the taps of a motion have shown.
  struct Shown {
    int taps = 0;
    int contacts = 0;
    double late = 0.0;     ///< seconds beyond those expected of what was met, over all contacts
    double squares = 0.0;  ///< of the heights of the desk, square metres
    int on_desk = 0;
  };
  double deviation(int motion) const;
  void read_desk(const Belief& belief);

  std::shared_ptr<const Motions> motions_;
  double desk_;
  std::vector<Shown> shown_;
  std::vector<int> motion_of_tap_;
};

}  // namespace palpate
