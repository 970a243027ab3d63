// SPDX-License-Identifier: MIT
// Motion of the arm in a tap: plan, travel, tare, descent until a contact, stop and rise; and the reactions to faults.
#pragma once

#include "baxter/motion_guard.hpp"
#include "baxter/path.hpp"
#include "baxter/reaction_time.hpp"
#include "tapping/guarded_tap.hpp"
#include "tapping/height_result.hpp"

#include <palpate/backend.hpp>
#include <palpate/scene.hpp>

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::baxter {

/// Moves the arm; no other class sends set-points. A tap begins and ends at the height of travel. The first tap may
/// begin anywhere above the area.
class Tapper {
 public:
  /// `robot` must outlive the object; `interrupted` may be null. `note` receives the lines of the run's log.
  Tapper(const BaxterOptions& options, const Scene& scene, Robot& robot, const std::atomic<bool>* interrupted,
         std::function<void(const std::string&)> note);

  Tapper(const Tapper&) = delete;
  Tapper& operator=(const Tapper&) = delete;

  /// Performs one tap. Failures are outcomes: `unreachable` before any motion, or `aborted` after a fault. The reason
  /// of `aborted` ends with the final position of the arm; `ends_run` is set if a person must fix the robot.
  tapping::HeightResult tap(const TapRequest& request);

  /// Returns the plan of tap() in words, starting from the current position of the arm.
  std::vector<std::string> describe(const TapRequest& request);

  /// Returns the sign of the force if taps determined it: `positive` or `negative`, else empty.
  std::string learnt_sign() const;

  /// Checks all conditions for the first motion. Throws Error (kind `run`) with cause and remedy:
  /// - forbidden state of the robot, second sender, stale or invalid data, settings of other programs;
  /// - joint beyond its limit, wrong position of left_gripper, arm not above the area with its tool down;
  /// - unreachable positions, calibration tap outside the area.
  void check();

 private:
  static constexpr double kPeriod = tapping::GuardedTap::kPeriod;
  static constexpr double kNearTravel = 0.01;  ///< m by which the tip may be below the height of travel
  static constexpr double kGentleRise = 0.01;  ///< m of a slow rise for an arm that may press
  /// m: upper limit of the slow rise. Supported objects yield by less than this.
  static constexpr double kMostGentleRise = 0.02;
  static constexpr const char* kSilent = "no more commands are sent, the arm stays where it is";
  /// Height of travel above `hover`, m. The arm descends from there to the position where it rests for the tare, so
  /// that friction always has the same direction.
  static constexpr double kFromAbove = tapping::GuardedTap::kFromAbove;
  /// m of a path over which largest_pull() measures the rotation of the joints.
  static constexpr double kRotationWindow = 0.01;

  tapping::HeightResult attempt(const TapRequest& request);
  tapping::HeightResult descend(const TapRequest& request, const tapping::MotionOptions& motion, const Path& column);
  struct DescentState;
  void update(DescentState& way);
  void expect_following(const DescentState& way) const;
  void slow_down(DescentState& way);
  void tare(DescentState& way);
  void evaluate_force(DescentState& way, double felt, double beside, bool coming_down);
  tapping::HeightResult accept(const DescentState& way, const tapping::HeightResult& contact);
  void calibrate(const tapping::HeightResult& contact);
  void check_robot() const;
  std::optional<Fault> check_rates();
  void await_readiness(bool moving);
  void expect_readiness();
  void go_to(const Joints& hover);
  void follow(const Path& path, double speed, double end);
  void settle(const Joints& goal);
  void rest_from_above(const Path& column);
  void retreat(const Path& up, double sign, double zero, const tapping::HeightResult& contact);
  void rise(const Path& up, double gently, double sign, const std::optional<double>& zero);
  void measure_friction(const Path& column);
  double largest_pull(const Path& way, double along) const;
  static double rotation_per_metre(const Path& way, double along);
  double stiffness_at(const Target& place) const;
  double greatest_speed(double threshold, double stiffness, Fault::AllowedAction then) const;
  void update_timing();
  tapping::MotionOptions bounded(tapping::MotionOptions motion, double stiffness) const;
  void learn_moving(double difference);
  double greatest_rise() const;
  Eigen::Vector3d force_at_rest(const Joints& joints);
  std::string recover(const Fault& fault);
  static tapping::HeightResult failed(Outcome outcome, const std::string& reason, bool ends_run = false);
  void await_reflex_end();
  Path way_up() const;
  void climb(const Path& up, double sign, const std::optional<double>& zero);
  void await_height(const Joints& top);
  Path column(const Target& place) const;
  Target desk_target() const { return {options_.calibration->at[0], options_.calibration->at[1]}; }
  std::optional<Joints> inverse(const Pose& tip, const Joints& seed);

  void step(const Joints& command);
  std::optional<Fault> hold_through_reflex(const Fault& fault);
  std::optional<Fault> hold(Joints joints);
  bool next_period();
  void store(Snapshot seen);
  bool interrupted() const { return interrupted_ != nullptr && interrupted_->load(); }
  double height() const { return tip_.z(); }
  double travel_height() const { return scene_.desk() + motion_.hover; }
  void learn_sign();

  BaxterOptions options_;
  tapping::MotionOptions motion_;  ///< motion of this tap
  const Scene& scene_;
  Robot& robot_;
  const std::atomic<bool>* interrupted_;
  std::function<void(const std::string&)> note_;
  ArmKinematics arm_;
  Planner planner_;
  Workspace workspace_;
  MotionGuard guard_;
  Snapshot seen_;
  Eigen::Vector3d tip_ = Eigen::Vector3d::Zero();  ///< measured tip in the scene's frame, m
  double next_ = 0.0;                              ///< s, start of the next period
  bool recovering_ = false;
  bool calibrated_ = false;
  double sign_;  ///< sign of the force along z when an object presses the tool upwards; 0 if unknown
  Eigen::Vector3d zero_ = Eigen::Vector3d::Zero();  ///< N, force at the last tare
  double moving_ = 0.0;  ///< N: difference of the force along z between a free descent and rest
  /// Latest difference of the force between a free descent and rest (N), and the speed of that descent (m/s). Measured
  /// in this descent if possible, else in an earlier one.
  struct {
    double beside = 0.0;
    double speed = 0.0;
  } last_moving_;
  std::optional<double> friction_;  ///< Nm of friction per joint, once measured
  double shown_sign_ = 0.0;         ///< sign of the force at the last accepted contact; 0 if not determined
  ReactionTime reaction_;
  std::optional<std::vector<ReactionTime::MotionSample>> motion_log_;  ///< receives every period if present
  int logged_ = 0;                                                     ///< number of taps for which moving_ was logged
  std::optional<double> peak_;  ///< N, largest force against the tool in this tap; absent before the descent
};

}  // namespace palpate::baxter
