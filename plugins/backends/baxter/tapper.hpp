// SPDX-License-Identifier: MIT
// One tap of the arm: plan, travel, tare, come down until it touches, stop there, go up again; and what is done when a
// rule is broken on the way.
#pragma once

#include "baxter/path.hpp"
#include "baxter/reaction.hpp"
#include "baxter/watch.hpp"
#include "tapping/guarded_tap.hpp"

#include <palpate/backend.hpp>
#include <palpate/scene.hpp>

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::baxter {

/// Moves the arm, and is the only one to do so. A tap begins and ends at the height of travel; the first begins
/// wherever above the area the arm is.
class Tapper {
 public:
  /// `robot` must outlive it; `interrupted` may be null; `note` gets what happens, one line each, for the diary of the
  /// run.
  Tapper(const BaxterOptions& options, const Scene& scene, Robot& robot, const std::atomic<bool>* interrupted,
         std::function<void(const std::string&)> note);

  Tapper(const Tapper&) = delete;
  Tapper& operator=(const Tapper&) = delete;

  /// Taps. What goes wrong is an outcome: `unreachable` before anything moved; `aborted` by a fault, whose reason ends
  /// with where the arm was left, and which `ends_run` if the robot needs a person.
  Contact tap(const TapRequest& request);

  /// tap() in words: from where the arm is now, which may not be where it was left.
  std::vector<std::string> describe(const TapRequest& request);

  /// What the taps have shown of the robot's force that the config left open: `positive` or `negative`; empty for
  /// nothing.
  std::string learnt_sign() const;

  /// Looks at everything that must be right before anything moves. Throws Error (kind `run`) that names the cause and
  /// the remedy: a calibration tap beside the area, a state in which it must not move, a second sender, stale or
  /// unsound data, a joint beyond its limit, left_gripper not where the config has it, an arm that is not above the
  /// area with its tool down, settings that others left, places that cannot be reached.
  void check();

 private:
  static constexpr double kPeriod = tapping::GuardedTap::kPeriod;
  static constexpr double kNearTravel = 0.01;  ///< m that the tip may be below the height of travel
  static constexpr double kGently = 0.01;      ///< m that an arm which may press goes up gently; and
  static constexpr double kMostGentle = 0.02;  ///< m, at most, since nothing that is touched gives way by more
  static constexpr const char* kSilent = "no more commands are sent, the arm stays where it is";
  /// m above `hover` that the arm travels: from there it comes down to where it rests and feels its zero.
  static constexpr double kFromAbove = tapping::GuardedTap::kFromAbove;
  static constexpr double kTurned = 0.01;  ///< m of a way over which most_pull() looks

  Contact attempt(const TapRequest& request);
  Contact descend(const TapRequest& request, const tapping::MotionOptions& motion, const Path& column);
  struct WayDown;
  void lead(WayDown& way);
  void expect_descent(const WayDown& way) const;
  void slow_down(WayDown& way);
  void tare(WayDown& way);
  void feel_free(WayDown& way, double felt, double beside, bool coming_down);
  Contact judge(const WayDown& way, const Contact& contact);
  void calibrate(const Contact& contact);
  void check_robot() const;
  std::optional<Fault> listen();
  void await_fit(bool moving);
  void expect_fit();
  void go_to(const Joints& hover);
  void follow(const Path& path, double speed, double end);
  void settle(const Joints& goal);
  void rest_from_above(const Path& column);
  void retreat(const Path& up, double sign, double zero, const Contact& contact);
  void rise(const Path& up, double gently, double sign, const std::optional<double>& zero);
  void learn_rubbing(const Path& column);
  double most_pull(const Path& way, double along) const;
  static double turned(const Path& way, double along);
  double stiffness_at(const Target& place) const;
  double greatest_speed(double threshold, double stiffness, Fault::Then then) const;
  void measure_time();
  tapping::MotionOptions bounded(tapping::MotionOptions motion, double stiffness) const;
  void learn_moving(double difference);
  double greatest_rise() const;
  Eigen::Vector3d force_at_rest(const Joints& joints);
  std::string recover(const Fault& fault);
  static Contact failed(Outcome outcome, const std::string& reason, bool ends_run = false);
  void outlast_reflex();
  Path way_up() const;
  void climb(const Path& up, double sign, const std::optional<double>& zero);
  void await_height(const Joints& top);
  Path column(const Target& place) const;
  Target bare() const { return {options_.calibration->at[0], options_.calibration->at[1]}; }
  std::optional<Joints> inverse(const Pose& tip, const Joints& seed);

  void step(const Joints& command);
  std::optional<Fault> stay(const Fault& fault);
  std::optional<Fault> hold(Joints joints);
  bool pass();
  void take(Snapshot seen);
  bool interrupted() const { return interrupted_ != nullptr && interrupted_->load(); }
  double height() const { return tip_.z(); }
  double travel_height() const { return scene_.desk() + motion_.hover; }
  void learn_sign();

  BaxterOptions options_;
  tapping::MotionOptions motion_;  ///< of this tap
  const Scene& scene_;
  Robot& robot_;
  const std::atomic<bool>* interrupted_;
  std::function<void(const std::string&)> note_;
  Arm arm_;
  Planner planner_;
  Workspace workspace_;
  Watch watch_;
  Snapshot seen_;
  Eigen::Vector3d tip_ = Eigen::Vector3d::Zero();  ///< of what was seen, in the frame of the scene
  double next_ = 0.0;                              ///< when the next period begins
  bool recovering_ = false;
  bool calibrated_ = false;
  double sign_;  ///< of the force along z when something presses the tool upwards; 0 until it is known
  Eigen::Vector3d zero_ = Eigen::Vector3d::Zero();  ///< the force of the latest tare
  double moving_ = 0.0;  ///< N along z that it reads beside while the arm comes down in the air
  /// Of this descent as soon as it shows it, of earlier ones before: how much it read beside, N, and how fast it was,
  /// m/s.
  struct {
    double beside = 0.0;
    double speed = 0.0;
  } lately_;
  std::optional<double> rubbing_;  ///< Nm with which every joint rubs, once it is known
  double shown_sign_ = 0.0;        ///< by the latest contact that was believed; 0 if nothing showed it
  Reaction reaction_;
  std::optional<std::vector<Reaction::Step>> motion_log_;  ///< gets every period while it is there
  int told_ = 0;                                           ///< of how many taps moving_ was noted
  std::optional<double> peak_;  ///< N, the most that was felt of this tap against the tool; none before its descent
};

}  // namespace palpate::baxter
