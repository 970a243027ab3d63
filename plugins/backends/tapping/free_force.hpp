// SPDX-License-Identifier: MIT
// Force of an arm without contact, as a function of the height.
#pragma once

#include <vector>

namespace palpate::tapping {

/// Height of the tip, metres, and force, newtons.
struct Sample {
  double height;
  double force;
};

/// Straight line fitted to the force over the last centimetres of free travel. The zero of an estimated force depends
/// on the pose of the arm, so a tare at the height of travel is wrong by several newtons at lower heights.
class FreeForce {
 public:
  /// `gap`: samples less than this distance above the tip (metres) are ignored, because they may contain a soft
  /// contact. `top`: height of the tare, metres.
  FreeForce(double gap, double top) : gap_(gap), top_(top) {}

  /// Removes all samples and sets the force of a tare, newtons.
  void tare(double zero);

  /// Adds a sample during a descent at constant speed.
  void add(const Sample& sample) { samples_.push_back(sample); }

  /// Force without contact as a linear function of the height.
  struct LinearForce {
    double force;   ///< N, at `height`
    double height;  ///< m
    double slope;   ///< N/m
    double at(double other) const { return force + slope * (other - height); }
  };

  /// Returns the line for a tip at `height` (m). It is a least-squares fit to the samples between `gap` and `gap` +
  /// kLength above `height`. The slope has a normal prior with mean 0. Without samples, the line is the constant force
  /// of the tare. The slope is at most kMostDrift in absolute value. At `height`, the line differs from the tare by at
  /// most kMostOffset + kMostDrift * (distance below `top`). Larger changes come from a soft object and not from the
  /// zero.
  LinearForce line(double height) const;

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
