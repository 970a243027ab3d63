// SPDX-License-Identifier: MIT
// Other nodes beside the robot's own. A process has one node, so each is this program once more; it says something
// whenever the robot's process tells it to, and ends with that process however that ends.
#pragma once

#include <string>

namespace palpate::fake_baxter {

/// A process with a node of its own. Make it before ROS and before any thread.
class Companion {
 public:
  /// `role`: "end_effector", which publishes the gripper's joint on /robot/joint_states; "second_sender=state",
  /// which publishes /robot/state of a healthy robot, or likewise endpoint, joints, collision, avoidance: what one says
  /// that stands and feels nothing; "set_speed_ratio=0.03" or "joint_command_timeout=0.02", a program that
  /// has set that of the left arm, latched. Its node begins at the first tell(). Throws Error.
  explicit Companion(const std::string& role);
  ~Companion();
  Companion(const Companion&) = delete;
  Companion& operator=(const Companion&) = delete;

  /// Publish now, with this stamp (s). Never waits; what a busy companion has not taken is dropped.
  void tell(double stamp);
  /// Waits until it has its node. Throws Error after ten seconds.
  void wait_until_up();

 private:
  int socket_ = -1;
  int pid_ = -1;
};

/// The other process: what the program does with `--companion ROLE`. Returns its exit status.
int serve_companion(const std::string& role);

}  // namespace palpate::fake_baxter
