// SPDX-License-Identifier: MIT
// The simulated arm: how it follows its set-point, and what it feels.
#pragma once

#include "simulator/normal.hpp"

#include <palpate/effects.hpp>

#include <optional>

namespace palpate::backends {

/// One axis that follows a set-point: a second-order system, exact for a set-point that is constant over each period.
/// Without lag it is where it is told to be.
class Arm {
 public:
  /// At rest at `position` (m); `period` in seconds.
  Arm(const std::optional<JointLag>& lag, double period, double position);

  /// One period with this set-point.
  void follow(double set_point);

  double position() const { return position_; }

 private:
  bool lags_;
  double position_;
  double velocity_ = 0.0;
  /// Deviation from the set-point and velocity after one period, from those before it.
  double from_deviation_[2]{}, from_velocity_[2]{};
};

/// What the arm meets and feels during one tap: a spring at `surface`, a sensor with noise, drift, blindness and jerks.
class Touch {
 public:
  /// `surface`: height at which the tool meets something, metres; `hover`: where the arm comes from. All that is drawn
  /// comes from `random`.
  Touch(const Effects& effects, double surface, double hover, double threshold, Random random);

  /// Takes the place at which the joints would have the tip (m), and tells where it is then and the force (N).
  struct Felt {
    double height;
    double force;
  };
  Felt feel(double position);

 private:
  double surface_;
  double hover_;
  double stiffness_;  ///< of object and arm in series, N/m
  double give_;       ///< of the object, m/N
  double noise_;      ///< N
  double drift_;      ///< N/m, of this tap
  bool blind_;
  double jerk_at_;  ///< height, below any floor if there is none
  double jerk_;     ///< N
  int jerk_left_;   ///< periods
  Normal normal_;
};

}  // namespace palpate::backends
