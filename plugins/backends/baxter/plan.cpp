// SPDX-License-Identifier: MIT
// Checks and planning of Tapper while the arm does not move.
#include "baxter/tapper.hpp"

#include "baxter/error_texts.hpp"
#include "tapping/motion.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::baxter {
namespace {

constexpr double kLimitMargin = 0.03;      ///< rad: margin of planned joints to their limits
constexpr double kReachSpacing = 0.02;     ///< m between the positions of a dry run
constexpr double kPoseError = 0.001;       ///< m: largest position error of the robot's inverse kinematics
constexpr double kTurnError = 0.02;        ///< rad: largest rotation error of the robot's inverse kinematics
constexpr double kReadinessTimeout = 1.0;  ///< s in which the data must become fresh when a tap begins
/// Time in s to detect other programs that command the arm, and message rates that are too low.
constexpr double kRateWindow = ReadingCounter::kWindow + 0.05;

constexpr double kAgreement = 0.005;   ///< m: allowed difference between own kinematics and endpoint_state
constexpr double kAgreedTurn = 0.035;  ///< rad: allowed difference of the rotations
constexpr double kUpright = 0.35;  ///< rad: largest tilt of the tool before the first motion, which makes it upright

/// Formats a length with more digits than in messages about taps.
std::string fine_centimetres(double length) { return fmt::format("{:.2f} cm", 100.0 * length); }

/// Compares the driver's own kinematics with the robot's pose of left_gripper. Throws Error if they disagree, or if
/// left_gripper is not at the configured distance.
void check_gripper(const JointReading& joints, const EndpointReading& endpoint, double gripper) {
  const Pose hand = ArmKinematics(Eigen::Vector3d::Zero()).tip(joints.position);
  const Eigen::Vector3d seen = hand.rotation.inverse() * (endpoint.pose.position - hand.position);
  const double aside = std::hypot(seen.x(), seen.y());
  const double turned = hand.rotation.angularDistance(endpoint.pose.rotation);
  if (aside <= kAgreement && std::abs(seen.z() - gripper) <= kAgreement && turned <= kAgreedTurn) return;
  if (aside <= kAgreement && turned <= kAgreedTurn)
    throw robot_error("tool.gripper",
                      fmt::format("the robot has left_gripper {} from left_hand, the config has it at {}",
                                  fine_centimetres(seen.z()), fine_centimetres(gripper)),
                      "check what is mounted on the robot, then correct tool.gripper and tool.tip");
  throw robot_error("tool.gripper",
                    fmt::format("joints and endpoint_state disagree by {} about the position of left_gripper",
                                fine_centimetres((seen - Eigen::Vector3d(0, 0, gripper)).norm())),
                    "check that the arm is a Baxter's and that its gripper is mounted straight");
}

/// Returns lines for the run's log: settings that other programs left on the robot, and the mounted tool. Throws Error
/// if the robot's collision avoidance pushes the arm.
std::vector<std::string> check_settings(const Snapshot& seen) {
  const struct {
    const char* topic;
    const std::optional<ReceivedSetting>& setting;
    const char* own;
  } settings[] = {{"set_speed_ratio", seen.speed_ratio, "0.3"},
                  {"joint_command_timeout", seen.command_timeout, "0.2 s"}};
  std::vector<std::string> out;
  for (const auto& [topic, setting, own] : settings)
    out.push_back(setting ? fmt::format("{}: {:g} from {}", topic, setting->value, setting->sender)
                          : fmt::format("{}: not published, the robot's default of {} is assumed", topic, own));
  if (seen.avoidance && (seen.avoidance->other_arm || !seen.avoidance->objects.empty())) {
    std::vector<std::string> from = seen.avoidance->objects;
    if (seen.avoidance->other_arm) from.insert(from.begin(), "the other arm");
    throw robot_error("collision_avoidance_state", "the robot pushes the arm away from " + join_words(from),
                      "move the other arm away, or the area forward");
  }
  const EndEffector& mounted = seen.end_effector;
  out.push_back(fmt::format(
      "mounted according to the robot: {}, {}; a tool of another mass shifts the zero of the force with the posture",
      mounted.product.empty() ? "no known gripper" : mounted.product,
      mounted.mass ? fmt::format("{:g} kg beyond the flange", *mounted.mass) : "of unknown mass"));
  return out;
}

/// Returns the largest speed with which a GuardedTap moves in a column, m/s.
double fastest(const BaxterOptions& options) {
  double out = 0.0;
  for (int i = 0; i < options.motion.count(); ++i) {
    const tapping::MotionOptions& motion = options.motion.at(i);
    const bool two_stage = motion.type == tapping::MotionOptions::Type::two_stage;
    out = std::max({out, motion.speed, two_stage ? motion.fine_speed : 0.0,
                    motion.adaptive_hover ? motion.adaptive_hover->speed : 0.0});
  }
  return out;
}

}  // namespace

void Tapper::check() {
  const Area area = scene_.area();
  if (options_.calibration && (desk_target().x < 0.0 || desk_target().y < 0.0 || desk_target().x > area.width ||
                               desk_target().y > area.depth)) {
    throw robot_error("calibration.at", "is outside the area", "choose a bare position inside the area");
  }
  const std::optional<Fault> slow = check_rates();
  await_readiness(!options_.dry_run);
  check_robot();
  if (slow && !options_.dry_run) throw robot_error("", slow->reason);
  if (!options_.dry_run) {
    for (const std::string& line : check_settings(seen_)) note_(line);
  }
  try {
    if (options_.calibration) column(desk_target());
    if (options_.dry_run) {
      const int places = check_reach(area, kReachSpacing, [this](const Target& place) { column(place); });
      note_(fmt::format("dry run: all {} places of the area can be reached, all the way down", places));
    }
  } catch (const NoPath& none) {
    throw robot_error("calibration.at", none.reason,
                      "choose another position, or move the middle of the area near x = 60 cm, y = 20 cm of base");
  } catch (const Fault& fault) {
    throw robot_error("", fault.reason);
  }
}

/// Compares the state of the robot with the config. In a dry run the robot may be disabled and the arm anywhere.
void Tapper::check_robot() const {
  const bool moving = !options_.dry_run;
  if (const std::optional<Fault> fault = MotionGuard::check_readiness(seen_, moving))
    throw robot_error("", fault->reason);
  if (const int joint = beyond_limits(seen_.joints->position, 0.0); joint >= 0 && moving)
    throw robot_error("", fmt::format("{} is beyond its limit", kJointNames[static_cast<std::size_t>(joint)]),
                      "move the arm by hand");
  check_gripper(*seen_.joints, *seen_.endpoint, options_.tool.gripper);
  if (!moving) return;
  const std::string breach = workspace_.breach(tip_);
  if (!breach.empty())
    throw robot_error("", breach,
                      "move the tool by hand to a position above the area; palpate moves the arm only there");
  const Eigen::Vector3d down = arm_.tip(seen_.joints->position).rotation * Eigen::Vector3d::UnitZ();
  if (std::acos(std::clamp(-down.z(), -1.0, 1.0)) > kUpright)
    throw robot_error("", "the tool does not point down", "turn it by hand, within 20 degrees of the vertical");
}

/// Returns a fault if the robot's messages arrive too rarely.
std::optional<Fault> Tapper::check_rates() {
  store(robot_.read());
  guard_.begin();
  const double end = seen_.now + kRateWindow;
  std::optional<Fault> slow;
  for (next_ = seen_.now; next_ < end && next_period();) slow = guard_.check_rates(seen_);
  return slow;
}

std::vector<std::string> Tapper::describe(const TapRequest& request) {
  if (options_.dry_run) return {"dry run: nothing moves"};
  store(robot_.read());
  std::optional<Target> from;
  std::vector<std::string> out;
  if (seen_.joints) {
    from = Target{tip_.x(), tip_.y()};
    if (height() < travel_height() - kNearTravel)
      out.push_back("rise from " + tapping::centimetres(height() - scene_.desk()) + " above the desk");
  }
  if (options_.calibration && !calibrated_)
    out.push_back("before it, a calibration tap on the bare desk at " + tapping::place(desk_target()));
  const tapping::MotionOptions& wanted = options_.motion.of_request(request);
  const double stiffness = stiffness_at(request.line.target());
  tapping::MotionOptions motion = wanted;
  update_timing();
  try {
    motion = bounded(wanted, stiffness);
  } catch (const Fault& slow) {
    return {slow.reason};
  }
  const std::vector<std::string> words = tapping::describe(motion, scene_.desk(), request, from);
  out.insert(out.end(), words.begin(), words.end());
  out.push_back(
      fmt::format("press with at most about {} on something rigid: the arm's springs have {:.1f} kN/m there, "
                  "and {:.0f} ms pass from {} to standstill{}",
                  tapping::newtons(reaction_.expected_force(motion.threshold, motion.speed, stiffness)),
                  1e-3 * stiffness, 1e3 * reaction_.seconds(), tapping::newtons(motion.threshold),
                  motion.speed < wanted.speed ? ", so that motion.speed is not reached" : ""));
  out.push_back("stop the descent when the force changes by " + tapping::newtons(options_.force_stop) +
                " upwards or downwards, and by half as much again sideways");
  return out;
}

/// Reads until the robot passes the rules of MotionGuard::check_readiness(), for at most kReadinessTimeout seconds. The
/// last snapshot is kept.
void Tapper::await_readiness(bool moving) {
  store(robot_.read());
  next_ = seen_.now;
  const double end = next_ + kReadinessTimeout;
  while (next_ < end && MotionGuard::check_readiness(seen_, moving) && next_period()) continue;
}

Path Tapper::column(const Target& place) const {
  const Area area = scene_.area();
  return planner_.column(place, {0.5 * area.width, 0.5 * area.depth}, travel_height() + kFromAbove,
                         scene_.desk() - options_.deepest(), fastest(options_));
}

/// Plans the path from the current position to the height of travel. The path is empty if the arm is already there.
Path Tapper::way_up() const {
  const double missing = travel_height() - height();
  return planner_.up(seen_.joints->position, missing > kNearTravel ? missing : 0.0);
}

/// Solves inverse kinematics as configured. After a fault the driver's own kinematics is used, because the robot's
/// service may have failed, too.
std::optional<Joints> Tapper::inverse(const Pose& tip, const Joints& seed) {
  if (options_.inverse_kinematics == BaxterOptions::InverseKinematics::own || recovering_)
    return arm_.solve(tip, seed, kLimitMargin);
  // Planning needs many poses, and the robot's service may take a second per pose.
  if (interrupted()) throw Fault{"interrupted", Fault::AllowedAction::silence, false};
  const Eigen::Vector3d offset(0.0, 0.0, options_.tool.gripper);
  const std::optional<Joints> answer = robot_.solve(
      {tip.position + tip.rotation * (offset - Eigen::Map<const Eigen::Vector3d>(options_.tool.tip)), tip.rotation},
      seed);
  if (!answer || !answer->allFinite() || beyond_limits(*answer, kLimitMargin) >= 0) return std::nullopt;
  const Pose reached = arm_.tip(*answer);
  const bool there = (reached.position - tip.position).norm() < kPoseError &&
                     reached.rotation.angularDistance(tip.rotation) < kTurnError;
  return there ? answer : std::nullopt;
}

}  // namespace palpate::baxter
