// SPDX-License-Identifier: MIT
// Additional nodes beside the robot's own. A process has only one node, so each runs in another process of this
// program. It publishes when the robot's process requests it, and ends with the robot's process.
#pragma once

#include <string>

namespace palpate::fake_baxter {

/// A process with its own node. Must be created before ROS starts and before any thread.
class ExtraNode {
 public:
  /// `role` is one of:
  /// - "end_effector": publishes the gripper's joint on /robot/joint_states;
  /// - "second_sender=state": publishes /robot/state of a healthy robot; likewise endpoint, joints, collision and
  ///   avoidance, of a robot at rest without forces;
  /// - "set_speed_ratio=0.03" or "joint_command_timeout=0.02": a program that has set this of the left arm, latched.
  /// The node starts with the first tell(). Throws Error.
  explicit ExtraNode(const std::string& role);
  ~ExtraNode();
  ExtraNode(const ExtraNode&) = delete;
  ExtraNode& operator=(const ExtraNode&) = delete;

  /// Requests a message with this stamp (s). Never waits; requests that a busy process has not read are dropped.
  void tell(double stamp);
  /// Waits until the node has started. Throws Error after ten seconds.
  void wait_until_up();

 private:
  int socket_ = -1;
  int pid_ = -1;
};

/// Main function of the other process, for `--companion ROLE`. Returns the exit status.
int serve_extra_node(const std::string& role);

}  // namespace palpate::fake_baxter
