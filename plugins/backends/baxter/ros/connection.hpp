// SPDX-License-Identifier: MIT
// Interface between connect(), which waits for messages and explains why some are missing, and the code that uses
// roscpp.
#pragma once

#include "baxter/ros/bag.hpp"
#include "baxter/ros/connect.hpp"
#include "baxter/ros/graph.hpp"
#include "baxter/ros/node.hpp"

#include <array>
#include <memory>
#include <optional>

namespace palpate::baxter {

/// Topic of the robot with its message type.
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

/// Connection to a robot whose messages may not have arrived yet.
class RosConnection : public Robot {
 public:
  /// Returns the streams that every run needs: joints, endpoint, state.
  static const std::array<Topic, 3>& needed();
  /// Returns the rosbag of received, sent and displayed messages.
  virtual std::shared_ptr<Bag> bag() = 0;
  virtual bool listened_to() = 0;  ///< whether a node receives the set-points
};

/// Creates subscribers and publishers. `tool_mass`: mass in kg beyond the flange in the robot's description. The node
/// must be started.
std::unique_ptr<RosConnection> make_connection(const Network& network, bool commands, std::optional<double> tool_mass);

}  // namespace palpate::baxter
