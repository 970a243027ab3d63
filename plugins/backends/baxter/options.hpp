// SPDX-License-Identifier: MIT
// Options of the backend `baxter`: poses of tool and scene, motion, and force limits.
#pragma once

#include "tapping/motion.hpp"

#include <palpate/options.hpp>

#include <Eigen/Geometry>

#include <optional>

namespace palpate::baxter {

/// Upper limits of `threshold` and `force_stop`, N. The firmware stops the arm for two seconds at 16 N ("squish"). The
/// arm keeps pressing while a contact is detected and the motion stops, so a threshold must be lower.
constexpr double kGreatestThreshold = 10.0;
constexpr double kGreatestStop = 15.0;
/// N: twice the noise of the simulated robot; the noise of a real one is not published
constexpr double kLeastThreshold = 3.0;
constexpr double kShortestTare = 0.1;  ///< s
constexpr double kSlowest = 0.01;      ///< m/s, minimum for motions without a timeout
/// m/s, maximum downwards: after a contact the arm moves on for about a third of a second
constexpr double kFastest = 0.1;
constexpr double kDeepest = 0.1;  ///< m below the desk

/// Marks `field` as mandatory, except in the stub: its error about missing packages must come before errors about
/// missing options.
inline Field mandatory(Field field) {
#ifndef PALPATE_STUB
  field.needed();
#endif
  return field;
}

/// Tool that is fixed to the flange of the arm.
struct ToolOptions : Options {
  double tip[3] = {0.0, 0.0, 0.0};  ///< contact point in the frame left_hand, metres
  double gripper = 0.025;           ///< distance from left_hand to the robot's frame left_gripper along z, metres
  void list(Fields& fields) override {
    const char* meaning =
        "x, y, z of the tool's contact point in the frame left_hand. The z axis points away from the flange";
    fields.reals(tip, 3, mandatory(Field("tip", meaning).in(Unit::metre).within(-0.6, 0.6)));
    fields.real(gripper, Field("gripper",
                               "distance from the frame left_hand to the frame left_gripper. The robot reports the "
                               "pose of left_gripper. The distance is checked at the start")
                             .in(Unit::metre)
                             .within(0, 0.6)
                             .from("baxter.urdf: 2.5 cm; 0 without a gripper, more with an electric one"));
  }
};

/// Pose of the scene's frame in the robot's frame `base`.
struct ScenePoseOptions : Options {
  double corner[2] = {0.0, 0.0};  ///< x and y of the area's corner in base, metres
  double height = 0.0;            ///< height of the scene's origin in base, metres
  double rotation = 0.0;          ///< rotation about the vertical, radians
  /// Returns the transform that maps a scene point (x, y, z) to (corner + R(rotation) * (x, y), height + z).
  Eigen::Isometry3d frame() const {
    return Eigen::Translation3d(corner[0], corner[1], height) * Eigen::AngleAxisd(rotation, Eigen::Vector3d::UnitZ());
  }
  void list(Fields& fields) override {
    const char* corner_is =
        "x, y of the area's corner (0, 0) in the robot's frame base. In this frame, x points forward and y points to "
        "the left";
    fields.reals(corner, 2, mandatory(Field("corner", corner_is).in(Unit::metre).within(-1.5, 1.5)));
    const char* height_is =
        "height of the scene's origin in the robot's frame base. All heights of the scene, including the desk, are "
        "relative to the origin";
    fields.real(height, mandatory(Field("height", height_is).in(Unit::metre).within(-1, 1)));
    fields.real(rotation, Field("rotation",
                                "rotation of the scene about the vertical axis: the angle from the x axis of the frame "
                                "base to the x axis of the scene")
                              .in(Unit::radian)
                              .within(-6.3, 6.3));
  }
};

/// Tap on the bare desk before the first tap of a run. The measured height replaces the configured height of the desk.
struct CalibrationOptions : Options {
  double at[2] = {0.0, 0.0};  ///< position in the area, metres
  double tolerance = 0.01;    ///< largest allowed difference between measured and configured height of the desk, metres
  void list(Fields& fields) override {
    fields.reals(at, 2,
                 Field("at", "position of the calibration tap in the area. The desk must be bare at this position")
                     .in(Unit::metre)
                     .needed());
    fields.real(
        tolerance,
        Field(
            "tolerance",
            "maximum difference between the measured and the configured desk height. A larger difference ends the run")
            .in(Unit::metre)
            .above(0)
            .at_most(0.05)
            .from("Baxter's absolute accuracy is 2 to 10 mm"));
  }
};

struct BaxterOptions : Options {
  enum class InverseKinematics { own, robot };
  /// Sign of the force along z when an object presses the tool upwards. With `learn`, the first contact determines the
  /// sign.
  enum class ForceSign { negative, positive, learn };

  tapping::BackendMotion motion;
  ToolOptions tool;
  ScenePoseOptions scene_pose;
  std::optional<CalibrationOptions> calibration;
  std::optional<ForceSign> force_sign;  ///< absent from the config: `learn` with a calibration, else `negative`
  double force_stop = 14.0;             ///< N
  InverseKinematics inverse_kinematics = InverseKinematics::own;
  bool dry_run = false;
  bool view = true;
  bool bag = false;

  /// Returns the largest depth below the desk at which a descent ends, metres.
  double deepest() const {
    double out = 0.0;
    for (int i = 0; i < motion.count(); ++i) out = std::max(out, motion.at(i).overrun);
    return out;
  }
  ForceSign sign() const { return force_sign.value_or(calibration ? ForceSign::learn : ForceSign::negative); }
  void list(Fields& fields) override {
    fields.section(motion, Field("motion", "motion of the arm in a tap"));
    for (std::size_t i = 0; i < motion.of.size(); ++i)
      require_gentle(fields, motion.of[i], "motion.of." + std::to_string(i) + ".");
    if (motion.of.empty()) require_gentle(fields, motion, "motion.");
    fields.section(tool, Field("tool", "tool that is fixed to the flange of the left arm"));
    fields.section(scene_pose, Field("scene_pose", "pose of the scene in the robot's frame base"));
    fields.section(
        calibration,
        Field("calibration",
              "tap on the bare desk before the run. The measured height replaces the configured desk height"));
    ForceSign chosen = sign();
    fields.choice(chosen,
                  Field("force_sign", "sign of the z force in endpoint_state when an object presses the tool upwards")
                      .from("Rethink documents no sign; five public programs for Baxter expect a falling force. With a "
                            "calibration tap the default is learn"),
                  {{"negative", "negative: the force falls", {}},
                   {"positive", "positive: the force rises", {}},
                   {"learn",
                    "learned at the first contact. Until the first contact, a rise and a fall of the force both count "
                    "as a contact",
                    {}}});
    force_sign = chosen;
    fields.real(force_stop,
                Field("force_stop",
                      "maximum change of the force since the tare while the arm is not in contact. A larger change "
                      "stops the arm. For sideways forces during vertical motion, the limit is 1.5 times as large")
                    .in(Unit::newton)
                    .above(0)
                    .at_most(kGreatestStop)
                    .from("the arm's firmware stops it at 16 N"));
    for (int i = 0; i < motion.count(); ++i)
      fields.require(force_stop > motion.at(i).threshold, "force_stop", "must lie above motion.threshold");
    fields.choice(
        inverse_kinematics,
        Field("inverse_kinematics", "solver of the inverse kinematics, from a pose to joint angles"),
        {{"own", "solver of palpate", {}}, {"robot", "IKService of the robot; palpate checks the answers", {}}});
    fields.flag(dry_run, Field("dry_run",
                               "whether to make a dry run. A dry run connects to the robot, makes all checks and "
                               "computes every pose of the area, but moves nothing"));
    fields.flag(view, Field("view", "whether to publish the surface, its standard deviation and the taps for RViz"));
    fields.flag(bag,
                Field("bag", "whether to record the messages and commands of the robot in a rosbag in the run's folder")
                    .not_identifying());
  }

 private:
  static void require_gentle(Fields& fields, const tapping::MotionOptions& motion, const std::string& at) {
    const bool two_stage = motion.type == tapping::MotionOptions::Type::two_stage;
    const bool adaptive = motion.adaptive_hover.has_value();
    const char* noise = "is within the noise of the force, choose at least 3 N";
    const char* too_fast = "is too fast for the delay of the force, choose at most 10 cm/s";
    const auto require = [&](bool holds, const char* name, const char* why) {
      fields.require(holds, (at + name).c_str(), why);
    };
    require(motion.threshold <= kGreatestThreshold, "threshold",
            "is too close to the 16 N at which the firmware stops the arm, choose at most 10 N");
    require(motion.threshold >= kLeastThreshold, "threshold", noise);
    require(motion.tare >= kShortestTare, "tare",
            "is too short to measure the zero of the force, choose at least 100 ms");
    require(motion.travel_speed >= kSlowest && motion.retreat_speed >= kSlowest, "travel_speed",
            "or motion.retreat_speed is too low for the arm to get away, choose at least 1 cm/s for both");
    require(!two_stage || motion.fine_threshold <= motion.threshold, "fine_threshold",
            "must not lie above motion.threshold");
    require(!two_stage || motion.fine_threshold >= kLeastThreshold, "fine_threshold", noise);
    require(motion.speed <= kFastest, "speed", too_fast);
    require(!two_stage || motion.fine_speed <= kFastest, "fine_speed", too_fast);
    require(!adaptive || motion.adaptive_hover->speed <= kFastest, "adaptive_hover.speed", too_fast);
    require(motion.overrun <= kDeepest, "overrun",
            "lets the arm descend too far below the desk, choose an overrun of at most 10 cm");
  }
};

}  // namespace palpate::baxter
