// SPDX-License-Identifier: MIT
// Between connect(), which knows what to wait for and what to say when it does not come, and roscpp's side.
#pragma once

#include "baxter/ros/bag.hpp"
#include "baxter/ros/connect.hpp"
#include "baxter/ros/graph.hpp"
#include "baxter/ros/node.hpp"

#include <array>
#include <memory>
#include <optional>

namespace palpate::baxter {

/// A topic of the robot.
struct Topic {
  const char* name;
  const char* type;
  const char* md5;
};

constexpr const char* kJointTopic = "/robot/joint_states";
constexpr const char* kEndpointTopic = "/robot/limb/left/endpoint_state";
constexpr const char* kStateTopic = "/robot/state";
constexpr const char* kCollisionTopic = "/robot/limb/left/collision_detection_state";
constexpr const char* kAvoidanceTopic = "/robot/limb/left/collision_avoidance_state";
constexpr const char* kEndEffectorTopic = "/robot/end_effector/left_gripper/properties";
constexpr const char* kSpeedRatioTopic = "/robot/limb/left/set_speed_ratio";
constexpr const char* kCommandTimeoutTopic = "/robot/limb/left/joint_command_timeout";
constexpr const char* kCommandTopic = "/robot/limb/left/joint_command";
constexpr const char* kClockTopic = "/clock";
constexpr const char* kSolverService = "/ExternalTools/left/PositionKinematicsNode/IKService";

/// The robot, perhaps not yet heard in full.
class Link : public Robot {
 public:
  /// The streams without which nothing goes: joints, endpoint, state.
  static const std::array<Topic, 3>& needed();
  /// What is written of them, and of what is shown.
  virtual std::shared_ptr<Bag> bag() = 0;
  virtual bool listened_to() = 0;  ///< somebody receives the set-points
};

/// Subscribes and advertises. `tool_mass` is what the robot's description has beyond the flange, kg. The node must have
/// been started.
std::unique_ptr<Link> make_link(const Network& network, bool commands, std::optional<double> tool_mass);

}  // namespace palpate::baxter
