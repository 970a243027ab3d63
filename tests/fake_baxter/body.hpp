// SPDX-License-Identifier: MIT
// The simulated robot without ROS: a left arm of Baxter in a scene, 100 periods per second of its time. All noise comes
// from a seed, so equal commands at equal times give equal readings.
#pragma once

#include "baxter/kinematics.hpp"
#include "baxter/options.hpp"
#include "fake_baxter/assembly.hpp"
#include "fake_baxter/dynamics.hpp"
#include "fake_baxter/faults.hpp"
#include "fake_baxter/mechanics.hpp"
#include "fake_baxter/network.hpp"
#include "simulator/arm.hpp"

#include <palpate/scene.hpp>

#include <deque>
#include <memory>
#include <optional>
#include <vector>

namespace palpate::fake_baxter {

using baxter::untucked;
/// Returns the tucked posture of a real arm, where left_s1 exceeds the limit of the URDF.
const Joints& tucked();

struct BodyOptions {
  baxter::ToolOptions tool;
  baxter::ScenePoseOptions scene_pose;
  double hover = 0.135;    ///< height of travel above the desk, metres
  std::uint64_t seed = 1;  ///< seed of all noise
  /// Initial position of the tip, pointing down, in the scene's frame. Default: 3 cm above the height of travel, over
  /// the middle of the area.
  std::optional<Eigen::Vector3d> start_at;
  double begin = 100.0;  ///< time at the start, seconds
  MechanicsOptions mechanics;
  /// Settings that another program left on the robot; it keeps them until they are set again.
  double speed_ratio = 0.3;
  double command_timeout = 0.2;  ///< s
};

/// Messages of the robot at the end of a period; a silent stream is absent. `received` is the time of sending.
struct RobotMessages {
  std::optional<baxter::JointReading> joints;
  Joints speed = Joints::Zero();   ///< joints, rad/s
  Joints effort = Joints::Zero();  ///< joints, Nm, without gravity
  std::optional<baxter::EndpointReading> endpoint;
  Eigen::Vector3d tip_speed = Eigen::Vector3d::Zero();  ///< left_gripper, m/s
  std::optional<baxter::StateReading> state;
  std::optional<baxter::CollisionReading> collision;
  std::optional<baxter::AvoidanceReading> avoidance;
};

/// The arm and its firmware.
///
/// The motion of the arm is computed by its mechanics (mechanics.hpp). The published force is the negative of the
/// mechanics' force, plus a bias that depends on the pose, plus noise (scene.effects.force_noise, default 1.5 N). It
/// falls along z when an object presses the tool upwards, as five public programs for Baxter by three authors expect.
class Body {
 public:
  static constexpr double kPeriod = Mechanics::kPeriod;
  static constexpr double kReflex = 16.0;  ///< N, above which the firmware holds the arm
  static constexpr double kSpike = 9.0;    ///< N, of the fault `spikes`
  static constexpr double kHeld = 2.0;     ///< s of a hold
  static constexpr double kLetGo = 0.1;    ///< s of motion after a hold, at least; unknown for a real robot
  static constexpr double kLag = Mechanics::kLag;

  enum class Mode { following, timed_out, reflex, stopped, disabled };

  /// `scene` must outlive the object. Throws Error if the arm cannot reach its initial position.
  Body(const Scene& scene, const BodyOptions& options);

  /// Takes a set-point for all joints, radians. It arrives after the delays of the faults `delay` and `jitter`. Values
  /// that are not finite are ignored.
  void command(const Joints& target);
  /// Set for how many seconds a set-point is followed, and the fraction of the largest joint speeds, clamped to [0, 1].
  /// Values that are not finite are ignored.
  void set_command_timeout(double seconds);
  void set_speed_ratio(double ratio);
  void enable(bool wanted);
  void stop() { assembly_.stop(); }
  void reset() { assembly_.reset(); }

  /// Injects a fault that begins at `trigger`.
  void inject(const Fault& fault, const Trigger& trigger = {});
  /// Frees a caught tool.
  void release();
  /// Returns the fault of this kind if it has begun, else null.
  const Fault* active(FaultKind kind) const;
  /// Returns the amount of a fault, 0 if it has not begun.
  double amount(FaultKind kind) const;
  /// Returns whether any fault has begun.
  bool faulty() const;

  /// Simulates one period.
  void step();

  double now() const;
  RobotMessages messages() const;

  /// True state of the robot, independent of its messages.
  Mode mode() const { return mode_; }
  Joints joints() const { return arm().position; }                     ///< including deflection
  const Joints& set_point() const { return reference_; }               ///< followed by the joints
  Eigen::Vector3d tip() const { return in_scene(joints()); }           ///< in the scene's frame, metres
  double set_point_height() const { return in_scene(reference_)(2); }  ///< of the tip, in the scene's frame, metres
  const ArmState& arm() const { return arm_; }
  double pressing() const { return arm().pressing; }  ///< N, upwards on the tool; negative if the tool is caught
  long commands() const { return commands_; }         ///< number of received commands
  /// s, time of the last command; before the first, a time far in the past
  double latest_command() const { return commanded_; }
  double command_timeout() const { return timeout_; }
  double speed_ratio() const { return speed_ratio_; }

 private:
  struct Armed {
    Fault fault;
    Trigger trigger;
    int descents;                 ///< number of descents through the trigger's height so far
    std::optional<double> since;  ///< s, begin of the fault
  };

  Eigen::Vector3d in_scene(const Joints& joints) const;
  Joints start_joints(const BodyOptions& options) const;
  void begin(Armed& armed);
  void watch_faults(double height_before);
  Mode choose_mode() const;
  void accept(const Joints& target);
  void hold(bool brakes);
  void place(const Joints& joints);
  void follow();
  void apply_caught_tool();
  void simulate_reflex();
  void measure();
  void apply_force_faults(Eigen::Vector3d& force);

  const Scene& scene_;
  SceneFrame scene_frame_;
  baxter::ArmKinematics tool_;     ///< its tip is that of the tool
  baxter::ArmKinematics gripper_;  ///< its tip is left_gripper
  std::uint64_t seed_;
  double begin_;
  std::unique_ptr<Mechanics> mechanics_;
  Dynamics dynamics_;
  ArmState arm_;                  ///< state of the mechanics, including the effect of a caught tool
  std::optional<double> anchor_;  ///< m, height in the scene at which a caught tool is fixed
  double noise_;                  ///< N
  backends::GaussianNumbers normal_;
  Random spikes_;
  Eigen::Vector3d bias_;                        ///< N, in the untucked posture
  Eigen::Matrix<double, 3, 7> bias_by_joints_;  ///< N/rad

  Assembly assembly_{true};
  std::vector<Armed> faults_;
  long periods_ = 0;
  Mode mode_ = Mode::timed_out;
  double timeout_;
  double speed_ratio_;
  double commanded_ = -1e9;
  long commands_ = 0;
  Joints target_;     ///< last command
  Joints reference_;  ///< set-point that the joints follow
  double held_until_ = -1e9;
  struct Sent {
    Joints target;
    double arrives;  ///< s
  };
  Network network_;  ///< network from the driver
  std::deque<Sent> sent_;
  baxter::EndpointReading endpoint_;
  std::optional<Eigen::Vector3d> filtered_;  ///< N, after the fault `wrench_filter`
  Eigen::Vector3d endpoint_speed_ = Eigen::Vector3d::Zero();
};

/// Returns the mode as written in a trace: "following", "timed_out", ...
const char* name_of(Body::Mode mode);

}  // namespace palpate::fake_baxter
