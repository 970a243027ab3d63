// SPDX-License-Identifier: MIT
// Interface to a Baxter in plain numbers. The driver (tapper.*, motion_guard.*) makes all decisions without ROS; the
// files in ros/ only transport messages.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace palpate::baxter {

/// Joint positions in rad, in the order left_s0, left_s1, left_e0, left_e1, left_w0, left_w1, left_w2, from shoulder to
/// wrist.
using Joints = Eigen::Matrix<double, 7, 1>;
constexpr std::array<const char*, 7> kJointNames = {"left_s0", "left_s1", "left_e0", "left_e1",
                                                    "left_w0", "left_w1", "left_w2"};

/// Position and rotation in the robot's frame `base` (x forward, y left, z up; metres).
struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// Times of a message in seconds: reception and the sender's stamp. The two clocks may differ by seconds. So ages are
/// computed from `received`, and stamps only show that the sender is alive.
struct MessageArrival {
  double received = 0.0;
  double stamp = 0.0;
  /// Number of messages of this stream so far, including this one. An unchanged count means the same message; an
  /// increase by more than one means that messages were skipped.
  long count = 0;
};

/// Joint positions of the left arm, from any message of joint_states that has them. Values may be NaN, as received.
struct JointReading : MessageArrival {
  Joints position;
};

/// Pose of the robot's frame left_gripper in `base`, and the force that the robot estimates from the springs in its
/// joints, newtons. Rethink documents neither frame nor sign of the force.
struct EndpointReading : MessageArrival {
  Pose pose;
  Eigen::Vector3d force;
  /// Number of messages of this stream whose force differs from that of the previous message. A robot may send the same
  /// estimate several times.
  long renewals = 0;
};

/// Sets the count of `reading`, the message that follows `before`.
template <class Reading>
void count_after(const std::optional<Reading>& before, Reading& reading) {
  reading.count = (before ? before->count : 0) + 1;
}
inline void count_after(const std::optional<EndpointReading>& before, EndpointReading& reading) {
  reading.count = (before ? before->count : 0) + 1;
  const bool renewed = !before || reading.force != before->force;
  reading.renewals = (before ? before->renewals : 0) + (renewed ? 1 : 0);
}

/// State of the robot, from /robot/state, which has no stamp.
struct StateReading {
  double received = 0.0;
  bool ready = false;
  bool enabled = false;
  bool stopped = false;
  bool error = false;
  enum class Button { unpressed, pressed, unknown, released } estop_button = Button::unpressed;
  enum class EstopSource { none, user, unknown, fault, brain } estop_source = EstopSource::none;
  long count = 0;  ///< see MessageArrival::count
};

/// Collision detection of the firmware. After a collision the arm holds for two seconds, then moves on by itself.
struct CollisionReading : MessageArrival {
  bool collision = false;
};

/// Obstacles of the robot's own collision avoidance, which pushes the arm away from them.
struct AvoidanceReading : MessageArrival {
  bool other_arm = false;            ///< the right arm is an obstacle
  std::vector<std::string> objects;  ///< other obstacles by the robot's names: torso, pedestal
};

/// Setting that another program sent and that the robot keeps after that program has ended. A setting is received only
/// while its sender runs, so an absent setting may still be in force.
struct ReceivedSetting {
  double value = 0.0;
  std::string sender;  ///< node name
};

/// Tool that the robot assumes at its flange. The robot compensates the weight of this tool, which determines the zero
/// of the force.
struct EndEffector {
  std::string product;         ///< manufacturer and name of the recognised gripper, or empty
  std::optional<double> mass;  ///< kg beyond left_hand in the URDF description; absent without a description
};

/// Nodes that sent each stream so far. With two senders only the last message is visible, so one sender hides the
/// other.
struct Senders {
  std::vector<std::string> joints;  ///< joints of the left arm; other nodes may send those of a gripper
  std::vector<std::string> endpoint, state, collision, avoidance;
  std::vector<std::string> clock;  ///< simulated clock
};

/// Latest message of every stream, and all senders. A stream without a message is absent.
struct Snapshot {
  double now = 0.0;        ///< protocol time in s: the clock of the robot's network
  bool simulated = false;  ///< whether the clock is simulated: it does not wait for a late program
  std::optional<JointReading> joints;
  std::optional<EndpointReading> endpoint;
  std::optional<StateReading> state;
  std::optional<CollisionReading> collision;
  std::optional<AvoidanceReading> avoidance;
  std::optional<ReceivedSetting> speed_ratio;  ///< factor by which the robot slows set-points down, 0 to 1; default 0.3
  std::optional<ReceivedSetting> command_timeout;  ///< s for which the robot follows a set-point; default 0.2
  EndEffector end_effector;
  /// Longest time for which this program could not receive messages, s of real time. It includes the current gap and
  /// those that ended within the last second. During a gap messages may have been sent.
  double own_gap = 0.0;
  Senders senders;
  std::vector<std::string> commanders;  ///< other nodes that sent set-points of the left arm
  std::string malformed;                ///< error text for the first inconsistent message; else empty
};

/// Connection to one arm of a Baxter.
class Robot {
 public:
  virtual ~Robot() = default;

  virtual Snapshot read() = 0;

  /// Waits until protocol time reaches `time`. Returns false if the clock stands still for two seconds of real time, as
  /// a simulated clock does without its sender.
  virtual bool wait_until(double time) = 0;

  /// Sends one set-point. The robot follows it for its time-out (0.2 s) and then holds its position. So a motion needs
  /// a stream of set-points, and the arm stops when the stream ends.
  virtual void command(const Joints& target) = 0;

  /// Starts a rosbag of all messages that are received, sent and displayed. Throws Error if the file cannot be opened.
  virtual void record(const std::string& file) = 0;

  /// Solves inverse kinematics on the robot for a pose of left_gripper, started from `seed`. Returns nullopt if there
  /// is no solution. Returns within one second of real time; throws Error without an answer.
  virtual std::optional<Joints> solve(const Pose& gripper, const Joints& seed) = 0;
};

}  // namespace palpate::baxter
