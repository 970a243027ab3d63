// SPDX-License-Identifier: MIT
// The force that an arm reads while nothing touches its tool, as it depends on the height.
#pragma once

#include <vector>

namespace palpate::tapping {

/// One sample of a descent: the height of the tip, metres, and the force, newtons.
struct Sample {
  double height;
  double force;
};

/// A line through the force over the last centimetres of free travel. The zero of an estimated force depends on the
/// pose of the arm: one tare at the height of travel is wrong by several newtons further down.
class FreeForce {
 public:
  /// `gap`: metres above the tip whose samples do not count, because a contact with something soft may lie in them.
  /// `top`: the height of the tare, metres.
  FreeForce(double gap, double top) : gap_(gap), top_(top) {}

  /// Forgets all samples and starts with the force of a tare, newtons.
  void tare(double zero);

  /// Takes a sample of a tip that comes down evenly.
  void add(const Sample& sample) { samples_.push_back(sample); }

  /// The force without a contact, newtons, as a function of the height, metres.
  struct Line {
    double force;   ///< N, at `height`
    double height;  ///< m
    double slope;   ///< N/m
    double at(double other) const { return force + slope * (other - height); }
  };

  /// Returns the line that holds at this height (m): by least squares through the samples between `gap` and `gap` +
  /// kLength above it, with a normal prior about 0 for the slope. Where there are none, the tare. Its slope is at most
  /// kMostDrift, and at this height it is off the tare by at most kMostOffset + kMostDrift per metre below the top:
  /// what changes by more is something soft and not a zero.
  Line line(double height) const;

  static constexpr double kLength = 0.03;     ///< m
  static constexpr double kMostDrift = 60.0;  ///< N/m
  static constexpr double kMostOffset = 4.0;  ///< N

 private:
  double gap_;
  double top_;
  double tare_ = 0.0;
  std::vector<Sample> samples_;
};

}  // namespace palpate::tapping
