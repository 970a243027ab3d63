// SPDX-License-Identifier: MIT
// Trades speed for accuracy tap by tap: selects the motion of the backend with the most information per second.
//
// A tap reveals whether there is an object. This information is the entropy of the footprint at its position, in bits,
// for any motion. If there is an object, the tap also reveals its height. With a height variance v and a motion of
// standard deviation d, this information is log2(1 + v / d^2) / 2 bits (Cover and Thomas 2006, section 9.1). The sum is
// multiplied by the motion's contact probability and divided by its mean time over both cases. Times, deviations and
// contact probabilities start at the motion's own expectations, and are updated by its taps. So the fast motion follows
// an outline, and the precise one is used where only the height is unknown.
//
// The position is chosen before, by the information of a tap, not per second. Near and tall positions are cheap to tap.
// But positions at the edge of an outline, which cost more, reduce the errors faster per second.
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

  /// Returns the quantities that are read at the chosen candidate.
  static QuantitySet reads();

  /// Chooses the motion of a tap with known line and predecessor, and stores the motion and its expected time in `tap`.
  void choose(const Belief& belief, TapRecord& tap) const;

  /// Returns the standard deviation that a motion adds to the standard deviation of the most precise motion, metres.
  double height_noise(int motion) const;

  /// Updates the statistics with a tap that `belief` already contains. Throws Error for an unknown motion, which means
  /// that the record is damaged.
  void take_in(const TapRecord& tap, const Belief& belief);

 private:
  /// Statistics of the taps of one motion.
  struct Shown {
    int taps = 0;
    int contacts = 0;
    double late = 0.0;     ///< seconds beyond the expected ones for the reported height, summed over all contacts
    double squares = 0.0;  ///< sum of squared heights of desk contacts relative to the desk, square metres
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
