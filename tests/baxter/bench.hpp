// SPDX-License-Identifier: MIT
// Common input of the driver's tests: scene pose and tool of configs/backend/fake_baxter.yaml, and a sound robot.
#pragma once

#include "baxter/motion_guard.hpp"
#include "baxter/path.hpp"
#include "support/plugins.hpp"

#include <cmath>

namespace palpate::baxter::test {

/// Returns the options of configs/backend/fake_baxter.yaml.
inline BaxterOptions fake_options() {
  BaxterOptions out;
  out.motion.type = tapping::MotionOptions::Type::continuous;
  out.motion.speed = 0.015;
  out.motion.threshold = 5.0;
  out.motion.travel_speed = 0.15;
  out.motion.retreat_speed = 0.1;
  out.motion.tare = 0.5;
  out.motion.overrun = 0.02;
  out.tool.tip[2] = 0.15;
  out.scene_pose.corner[0] = 0.507;
  out.scene_pose.corner[1] = 0.067;
  out.scene_pose.height = -0.17;
  out.scene_pose.rotation = 10.0 * 3.14159265358979323846 / 180.0;
  return out;
}

constexpr Target kMiddle{0.115, 0.115};  ///< of the area

/// A planner for these options with palpate's own inverse kinematics.
class PlannerBench {
 public:
  explicit PlannerBench(const BaxterOptions& options = fake_options())
      : arm(Eigen::Map<const Eigen::Vector3d>(options.tool.tip)),
        planner(options.scene_pose, arm,
                [this](const Pose& tip, const Joints& seed) { return arm.solve(tip, seed, 0.03); }) {}
  PlannerBench(const PlannerBench&) = delete;
  PlannerBench& operator=(const PlannerBench&) = delete;

  /// Returns joints with the tool upright and its tip at this position of the scene.
  Joints at(double x, double y, double z) const { return arm.solve(planner.pose({x, y}, z), untucked()).value(); }

  /// Returns the path straight down at `place` from the height of travel.
  Path down(const Target& place) const { return planner.column(place, kMiddle, 0.135, -0.02, 0.03); }

  ArmKinematics arm;
  Planner planner;
};

/// Returns a snapshot without any fault, at protocol time `now`, with the arm at `joints`.
inline Snapshot sound(double now, const Joints& joints) {
  Snapshot out;
  out.now = now;
  out.joints = JointReading{{now, now + 5.0}, joints};  // the robot's clock differs
  const Pose gripper = ArmKinematics({0.0, 0.0, 0.025}).tip(joints);
  // A real sensor never repeats a value exactly.
  const long period = std::lround(100.0 * now);
  out.endpoint =
      EndpointReading{{now, now + 5.0, period}, gripper, {0.3, -0.2, 1.0 + 0.1 * std::sin(1000.0 * now)}, period};
  out.state =
      StateReading{now, true, true, false, false, StateReading::Button::unpressed, StateReading::EstopSource::none};
  out.collision = CollisionReading{{now, now + 5.0}, false};
  for (auto* nodes : {&out.senders.joints, &out.senders.endpoint, &out.senders.state, &out.senders.collision}) {
    *nodes = {"/realtime_loop"};
  }
  return out;
}

}  // namespace palpate::baxter::test
