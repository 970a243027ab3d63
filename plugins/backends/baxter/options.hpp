// SPDX-License-Identifier: MIT
// What a config says of a Baxter: where its tool and the scene are, how it taps, when it must stop.
#pragma once

#include "tapping/motion.hpp"

#include <palpate/options.hpp>

#include <Eigen/Geometry>

#include <optional>

namespace palpate::baxter {

/// What is fixed to the flange of the arm.
struct ToolOptions : Options {
  double tip[3] = {0.0, 0.0, 0.0};  ///< the point that touches, in the frame left_hand, metres
  double gripper = 0.025;           ///< left_gripper as the robot has it, from left_hand along z, metres
  void list(Fields& fields) override;
};

/// Where the frame of the scene lies in the robot's frame `base`.
struct PlaceOptions : Options {
  double corner[2] = {0.0, 0.0};  ///< metres
  double height = 0.0;            ///< of the scene's zero, metres
  double rotation = 0.0;          ///< about the vertical, radians
  /// Brings a point (x, y, z) of the scene to corner + R(rotation) (x, y), height + z.
  Eigen::Isometry3d frame() const;
  void list(Fields& fields) override;
};

/// A tap on the bare desk before the first of the run, whose height then counts instead of the config's.
struct CalibrationOptions : Options {
  double at[2] = {0.0, 0.0};  ///< in the area, metres
  double tolerance = 0.01;    ///< how far the desk may be from where the config has it, metres
  void list(Fields& fields) override;
};

struct BaxterOptions : Options {
  enum class InverseKinematics { own, robot };
  /// The sign of the force along z when something presses the tool upwards; `learn`: the first contact shows it.
  enum class ForceSign { negative, positive, learn };

  tapping::MotionOptions motion;
  ToolOptions tool;
  PlaceOptions place;
  std::optional<CalibrationOptions> calibration;
  std::optional<ForceSign> force_sign;  ///< `learn` with a calibration and else `negative`, if the config says nothing
  double force_stop = 14.0;             ///< N
  InverseKinematics inverse_kinematics = InverseKinematics::own;
  bool dry_run = false;
  bool view = true;
  bool bag = false;

  ForceSign sign() const { return force_sign.value_or(calibration ? ForceSign::learn : ForceSign::negative); }
  void list(Fields& fields) override;
};

}  // namespace palpate::baxter
