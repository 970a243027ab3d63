// SPDX-License-Identifier: MIT
// Trades speed for accuracy tap by tap: selects the motion of the backend with the most information per second.
//
// A tap reveals whether there is an object. This information is the same for all motions: the entropy of the footprint
// at the position of the tap, in bits. If there is an object, the tap also reveals its height. If the height has the
// variance v and the motion has the standard deviation d, this information is log2(1 + v / d^2) / 2 bits (Cover and
// Thomas 2006, section 9.1). The total information is multiplied by the motion's contact probability, and divided by
// its expected duration, averaged over the cases object and desk. Durations, standard deviations and contact
// probabilities begin with expected values, and are updated by the taps of the motion. So the fast motion is used along
// an outline, and the precise motion is used where only the height is unknown.
//
// The position is chosen before the motion, by the information per tap, not per second. Positions near the previous tap
// and on tall objects take less time. But taps at the edge of an outline reduce the errors by more per second, although
// they take longer.
#pragma once

#include "experiment/tap_record.hpp"

#include <palpate/motions.hpp>

#include <memory>
#include <vector>

namespace palpate {

class MotionSelector {
 public:
  /// `desk`: height of the desk, metres.
  MotionSelector(std::shared_ptr<const Motions> motions, double desk);

  /// Returns the quantities that choose() reads at the chosen candidate.
  static QuantitySet reads();

  /// Chooses the motion of `tap`, whose line and previous line are already set. Stores the motion and its expected
  /// duration in `tap`.
  void choose(const Belief& belief, TapRecord& tap) const;

  /// Returns the square root of the difference between the variance of a motion's heights and the variance of the most
  /// precise motion's heights, metres.
  double height_noise(int motion) const;

  /// Updates the statistics with a tap that `belief` already contains. Throws Error for an unknown motion, which means
  /// that the record is damaged.
  void take_in(const TapRecord& tap, const Belief& belief);

 private:
  /// Statistics of the taps of one motion.
  struct MotionStatistics {
    int taps = 0;
    int contacts = 0;
    double late = 0.0;     ///< sum over all contacts of the measured minus the expected duration, seconds
    double squares = 0.0;  ///< sum of squared heights of desk contacts relative to the desk, square metres
    int on_desk = 0;
  };
  double deviation(int motion) const;
  void read_desk(const Belief& belief);

  std::shared_ptr<const Motions> motions_;
  double desk_;
  std::vector<MotionStatistics> shown_;
  std::vector<int> motion_of_tap_;
};

}  // namespace palpate
