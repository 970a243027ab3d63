// SPDX-License-Identifier: MIT
// What a Baxter says and takes, in plain numbers. On one side of this door the driver decides (tap.*, watch.*) and
// knows no ROS; on the other side ros/ carries messages and decides nothing.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace palpate::baxter {

/// left_s0, left_s1, left_e0, left_e1, left_w0, left_w1, left_w2: from the shoulder to the wrist, radians.
using Joints = Eigen::Matrix<double, 7, 1>;
constexpr std::array<const char*, 7> kJointNames = {"left_s0", "left_s1", "left_e0", "left_e1",
                                                    "left_w0", "left_w1", "left_w2"};

/// Where something is in the robot's frame `base` (x forward, y left, z up; metres), and how it is turned.
struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// When a message came, and when its sender says it was made; seconds. The two clocks may differ by seconds, so ages
/// come from `received` and the stamp only tells whether the sender goes on.
struct Arrival {
  double received = 0.0;
  double stamp = 0.0;
  /// How many of its stream have come so far, itself included. Who reads the same count twice reads the same message
  /// twice; where it went on by more than one, the messages in between are not seen.
  long count = 0;
};

/// The joints of the left arm, from whichever of the robot's joint_states has them. Numbers are as they came: they may
/// be NaN.
struct JointReading : Arrival {
  Joints position;
};

/// The end of the arm as the robot sees it: the pose of its frame left_gripper in `base`, and the force that it
/// estimates from the springs in its joints, newtons. Frame and sign of that force are not documented.
struct EndpointReading : Arrival {
  Pose pose;
  Eigen::Vector3d force;
  /// How many of its stream so far brought another force, to the last digit, than the one before: a robot may send an
  /// estimate more often than it makes one.
  long renewals = 0;
};

/// Counts a reading as the one after `before`, the latest of its stream.
template <class Reading>
void count_after(const std::optional<Reading>& before, Reading& reading) {
  reading.count = (before ? before->count : 0) + 1;
}
inline void count_after(const std::optional<EndpointReading>& before, EndpointReading& reading) {
  reading.count = (before ? before->count : 0) + 1;
  const bool renewed = !before || reading.force != before->force;
  reading.renewals = (before ? before->renewals : 0) + (renewed ? 1 : 0);
}

/// /robot/state. It has no stamp.
struct StateReading {
  double received = 0.0;
  bool ready = false;
  bool enabled = false;
  bool stopped = false;
  bool error = false;
  enum class Button { unpressed, pressed, unknown, released } estop_button = Button::unpressed;
  enum class Source { none, user, unknown, fault, brain } estop_source = Source::none;
  long count = 0;  ///< as in Arrival
};

/// Whether the arm's firmware feels a collision: it then holds for two seconds and goes on by itself.
struct CollisionReading : Arrival {
  bool collision = false;
};

/// What the arm's own collision avoidance keeps away from at this moment. It pushes the arm aside meanwhile.
struct AvoidanceReading : Arrival {
  bool other_arm = false;            ///< the right arm
  std::vector<std::string> objects;  ///< what else, in the robot's words: its torso, its pedestal
};

/// What a program told the robot that the robot keeps when that program has gone. It can be heard only while its sender
/// is there: what is absent may be set all the same.
struct Setting {
  double value = 0.0;
  std::string sender;  ///< the node
};

/// What the robot takes to be fixed to its flange; with its mass it compensates gravity, and from that comes the zero
/// of its force.
struct EndEffector {
  std::string product;         ///< maker and name of the gripper that it has recognised; empty if it says none
  std::optional<double> mass;  ///< kg, of all that its description has beyond left_hand; absent without a description
};

/// The nodes that have sent each stream since the beginning. Of two senders of one stream only the message that came
/// last is seen: one of them hides what the other says.
struct Senders {
  std::vector<std::string> joints;  ///< of the left arm: another node may send a gripper's
  std::vector<std::string> endpoint, state, collision, avoidance;
  std::vector<std::string> clock;  ///< a simulated one
};

/// The latest of every stream, and who has been sending. A stream that has not been heard is absent.
struct Snapshot {
  double now = 0.0;        ///< protocol time: the clock of the robot's network
  bool simulated = false;  ///< that clock is a simulated one: it does not wait for whoever is late
  std::optional<JointReading> joints;
  std::optional<EndpointReading> endpoint;
  std::optional<StateReading> state;
  std::optional<CollisionReading> collision;
  std::optional<AvoidanceReading> avoidance;
  std::optional<Setting> speed_ratio;      ///< by which the robot slows set-points down, 0 to 1; its own is 0.3
  std::optional<Setting> command_timeout;  ///< s for which it follows a set-point; its own is 0.2
  EndEffector end_effector;
  /// The longest time, of those that ended within the last second and the one that is going on, for which this program
  /// did not get to receive anything, seconds of real time. A stream that is silent for no longer may have been sent.
  double own_gap = 0.0;
  Senders senders;
  std::vector<std::string> commanders;  ///< the nodes other than this one that have sent set-points of the left arm
  std::string malformed;  ///< the first message whose parts do not fit together, told in words; empty if none did
};

/// An arm of a Baxter at the end of a wire.
class Robot {
 public:
  virtual ~Robot() = default;

  virtual Snapshot read() = 0;

  /// Waits until protocol time has come to `time`. False if that clock stood still for two seconds of real time, which
  /// a simulated clock does when its sender is gone.
  virtual bool wait_until(double time) = 0;

  /// Sends one set-point of the joints. The robot forgets it after its own time-out (0.2 s) and then holds where it is:
  /// who wants to be followed sends all the time, who stops sending stops the arm.
  virtual void command(const Joints& target) = 0;

  /// From now on writes what is heard and sent, and what is shown, to a rosbag. Throws Error if it cannot be opened.
  virtual void record(const std::string& file) = 0;

  /// What the robot's own inverse kinematics says of a pose of left_gripper, starting from `seed`: joints, or none if
  /// there is no solution. Returns within a second of real time; throws Error if it does not answer.
  virtual std::optional<Joints> solve(const Pose& gripper, const Joints& seed) = 0;
};

}  // namespace palpate::baxter
