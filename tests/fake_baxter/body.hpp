// SPDX-License-Identifier: MIT
// The robot of the tests without ROS: a left arm of Baxter's over a scene, 100 times a second of its own time. It draws
// all noise from a seed: equal commands at equal times bring equal readings.
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
/// Tucked, as a real arm reads: left_s1 is beyond the limit of its description.
const Joints& tucked();

struct BodyOptions {
  baxter::ToolOptions tool;
  baxter::ScenePoseOptions scene_pose;
  double hover = 0.135;    ///< of travel, metres above the desk
  std::uint64_t seed = 1;  ///< of all noise
  /// Of the tip, straight down, in the scene's frame; else 3 cm above the height of travel, over the middle of the
  /// area.
  std::optional<Eigen::Vector3d> start_at;
  double begin = 100.0;  ///< time at the start, seconds
  MechanicsOptions mechanics;
  /// What another program has left behind: the robot keeps both until somebody sets them again.
  double speed_ratio = 0.3;
  double command_timeout = 0.2;  ///< s
};

/// What the robot says at the end of a period; a stream that is silent is absent. `received` is when it is said.
struct Said {
  std::optional<baxter::JointReading> joints;
  Joints speed = Joints::Zero();   ///< of the joints, rad/s
  Joints effort = Joints::Zero();  ///< of the joints, Nm: with which they press, without gravity
  std::optional<baxter::EndpointReading> endpoint;
  Eigen::Vector3d tip_speed = Eigen::Vector3d::Zero();  ///< of left_gripper, m/s
  std::optional<baxter::StateReading> state;
  std::optional<baxter::CollisionReading> collision;
  std::optional<baxter::AvoidanceReading> avoidance;
};

/// The arm and its firmware.
///
/// The arm itself is its mechanics' (mechanics.hpp). The published force is what they feel, turned around, with a bias
/// that depends on the pose and with noise (scene.effects.force_noise, 1.5 N if absent): it falls along z when
/// something presses the tool upwards, as five programs for Baxter by three authors have it.
class Body {
 public:
  static constexpr double kPeriod = Mechanics::kPeriod;
  static constexpr double kReflex = 16.0;  ///< N, above which the firmware holds the arm
  static constexpr double kSpike = 9.0;    ///< N, of the fault `spikes`
  static constexpr double kHeld = 2.0;     ///< s, for so long
  static constexpr double kLetGo = 0.1;    ///< s for which it then goes on at least; not known of a real one
  static constexpr double kLag = Mechanics::kLag;

  enum class Mode { following, timed_out, reflex, stopped, disabled };

  /// `scene` must outlive it. Throws Error if the arm cannot stand where it should start.
  Body(const Scene& scene, const BodyOptions& options);

  /// Takes a set-point for all joints, radians, which arrives after what the faults `delay` and `jitter` say; values
  /// that are not finite are ignored.
  void command(const Joints& target);
  /// For how long a set-point is followed, seconds; and the share of their greatest speed at which the joints go after
  /// it, clamped to 0 to 1. What is not finite is ignored.
  void set_command_timeout(double seconds);
  void set_speed_ratio(double ratio);
  void enable(bool wanted);
  void stop() { assembly_.stop(); }
  void reset() { assembly_.reset(); }

  /// Lets something go wrong from `trigger` on.
  void inject(const Fault& fault, const Trigger& trigger = {});
  /// Somebody frees a tool that is caught.
  void release();
  /// The fault of this kind if it has begun, else null.
  const Fault* active(FaultKind kind) const;
  /// Its amount, 0 if it has not begun.
  double amount(FaultKind kind) const;
  /// Whether any has begun.
  bool faulty() const;

  /// One period.
  void step();

  double now() const;
  Said said() const;

  /// What is so, whatever is said.
  Mode mode() const { return mode_; }
  Joints joints() const { return arm().position; }                     ///< with what the arm gives way
  const Joints& set_point() const { return reference_; }               ///< that the joints follow
  Eigen::Vector3d tip() const { return in_scene(joints()); }           ///< in the scene's frame, metres
  double set_point_height() const { return in_scene(reference_)(2); }  ///< of the tip, in the scene's frame, metres
  const ArmState& arm() const { return arm_; }
  double pressing() const { return arm().pressing; }    ///< N, upwards on the tool; negative where it is caught
  long commands() const { return commands_; }           ///< received so far
  double latest_command() const { return commanded_; }  ///< its time; before any, the distant past
  double command_timeout() const { return timeout_; }
  double speed_ratio() const { return speed_ratio_; }

 private:
  struct Armed {
    Fault fault;
    Trigger trigger;
    int descents;                 ///< through the trigger's height so far
    std::optional<double> since;  ///< when it began
  };

  Eigen::Vector3d in_scene(const Joints& joints) const;
  Joints start_joints(const BodyOptions& options) const;
  void begin(Armed& armed);
  void watch_faults(double height_before);
  Mode choose_mode() const;
  void obey(const Joints& target);
  void hold(bool brakes);
  void stand(const Joints& joints);
  void follow();
  void hang();
  void feel_reflex();
  void measure();
  void spoil(Eigen::Vector3d& force);

  const Scene& scene_;
  Ground ground_;
  baxter::Arm tool_;     ///< its tip is the tool's
  baxter::Arm gripper_;  ///< its tip is left_gripper
  std::uint64_t seed_;
  double begin_;
  std::unique_ptr<Mechanics> mechanics_;
  Dynamics dynamics_;
  ArmState arm_;                  ///< of the mechanics, and what hangs on to the tool
  std::optional<double> anchor_;  ///< height in the scene from which that pulls, m; none where nothing does
  double noise_;                  ///< N
  backends::Normal normal_;
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
  Joints target_;     ///< of the latest command
  Joints reference_;  ///< what the joints follow
  double held_until_ = -1e9;
  struct Sent {
    Joints target;
    double arrives;  ///< s
  };
  Network network_;  ///< from the driver
  std::deque<Sent> sent_;
  baxter::EndpointReading endpoint_;
  std::optional<Eigen::Vector3d> filtered_;  ///< N, behind the fault `wrench_filter`
  Eigen::Vector3d endpoint_speed_ = Eigen::Vector3d::Zero();
};

/// As it stands in a trace: "following", "timed_out", ...
const char* name_of(Body::Mode mode);

}  // namespace palpate::fake_baxter
