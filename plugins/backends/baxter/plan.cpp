// SPDX-License-Identifier: MIT
// What Tapper looks at and plans while nothing moves.
#include "baxter/tapper.hpp"

#include "baxter/words.hpp"
#include "tapping/words.hpp"

#include <algorithm>

namespace palpate::baxter {
namespace {

using Then = Fault::Then;

constexpr double kLimitMargin = 0.03;   ///< rad that planned joints keep from their limits
constexpr double kReachSpacing = 0.02;  ///< m between the places of a dry run
constexpr double kPoseError = 0.001;    ///< m and
constexpr double kTurnError = 0.02;     ///< rad by which an answer of the robot's may miss the pose
constexpr double kPatience = 1.0;       ///< s in which data must be fresh when a tap begins
/// s in which another program that commands the arm is heard, and streams that are too slow
constexpr double kListen = Stream::kWindow + 0.05;

/// Of all that GuardedTap does within a column.
double fastest(const tapping::MotionOptions& motion) {
  double out = std::max(motion.speed, motion.type == tapping::MotionOptions::Type::two_stage ? motion.fine_speed : 0.0);
  if (motion.adaptive_hover) out = std::max(out, motion.adaptive_hover->speed);
  return out;
}

}  // namespace

void Tapper::check() {
  check_plan(options_, scene_);
  const std::optional<Fault> slow = listen();
  await_fit(!options_.dry_run);
  if (slow && !options_.dry_run) throw trouble("", slow->reason);
  check_before_flight(seen_, options_, planner_, workspace_, !options_.dry_run);
  if (!options_.dry_run) {
    for (const std::string& line : check_settings(seen_)) note_(line);
  }
  try {
    if (options_.calibration) column(bare());
    if (options_.dry_run) try_reach();
  } catch (const NoPath& none) {
    throw trouble("calibration.at", none.reason,
                  "take another place, or move the area: its middle near x = 60 cm, y = 20 cm of base");
  } catch (const Fault& fault) {
    throw trouble("", fault.reason);
  }
}

/// What is wrong with how often the robot's data come.
std::optional<Fault> Tapper::listen() {
  take(robot_.read());
  watch_.begin();
  const double end = seen_.now + kListen;
  std::optional<Fault> slow;
  for (next_ = seen_.now; next_ < end && pass();) slow = watch_.listen(seen_);
  return slow;
}

std::vector<std::string> Tapper::describe(const TapRequest& request) {
  if (options_.dry_run) return {"dry run: nothing moves"};
  take(robot_.read());
  std::optional<Target> from;
  std::vector<std::string> out;
  if (seen_.joints) {
    from = Target{tip_.x(), tip_.y()};
    if (height() < travel_height() - kNearTravel) {
      out.push_back("rise from " + tapping::centimetres(height() - scene_.desk()) + " above the desk");
    }
  }
  if (options_.calibration && !calibrated_) {
    out.push_back("before it, a calibration tap on the bare desk at " + tapping::place(bare()));
  }
  const std::vector<std::string> motion = tapping::describe(options_.motion, scene_.desk(), request, from);
  out.insert(out.end(), motion.begin(), motion.end());
  out.push_back("stop whatever it does when the force changes by " + tapping::newtons(options_.force_stop) +
                " upwards or downwards, and by half as much again sideways");
  return out;
}

void Tapper::try_reach() {
  const tapping::Descent descent = tapping::plan_descent(options_.motion, scene_.desk(), std::nullopt);
  const int places = check_reach(planner_, scene_.area(), descent.hover + kFromAbove, descent.floor,
                                 fastest(options_.motion), kReachSpacing);
  note_(fmt::format("dry run: all {} places of the area can be reached, all the way down", places));
}

/// Reads until the robot is fit; if it is not within a second, what was read last says why.
void Tapper::await_fit(bool moving) {
  take(robot_.read());
  next_ = seen_.now;
  const double end = next_ + kPatience;
  while (next_ < end && Watch::fit(seen_, moving) && pass()) continue;
}

Path Tapper::column(const Target& place) const {
  const Area area = scene_.area();
  const tapping::Descent descent = tapping::plan_descent(options_.motion, scene_.desk(), std::nullopt);
  return planner_.column(place, {0.5 * area.width, 0.5 * area.depth}, descent.hover + kFromAbove, descent.floor,
                         fastest(options_.motion));
}

/// From where the arm is to the height of travel; no way if it is there.
Path Tapper::way_up() const {
  const double missing = travel_height() - height();
  return planner_.up(seen_.joints->position, missing > kNearTravel ? missing : 0.0);
}

/// Of a fault one goes up by own kinematics: who knows what else has failed.
std::optional<Joints> Tapper::inverse(const Pose& tip, const Joints& seed) {
  const bool asked = options_.inverse_kinematics == BaxterOptions::InverseKinematics::robot && !recovering_;
  return asked ? ask_robot(tip, seed) : arm_.solve(tip, seed, kLimitMargin);
}

std::optional<Joints> Tapper::ask_robot(const Pose& tip, const Joints& seed) {
  const Eigen::Vector3d offset(0.0, 0.0, options_.tool.gripper);
  // Many poses are asked for, and each may take a second.
  if (interrupted()) throw Fault{"interrupted", Then::silence, false};
  const Robot::Answer answer = robot_.solve(
      {tip.position + tip.rotation * (offset - Eigen::Map<const Eigen::Vector3d>(options_.tool.tip)), tip.rotation},
      seed);
  if (!answer.trouble.empty()) throw Fault{answer.trouble};
  if (!answer.joints || !answer.joints->allFinite() || beyond_limits(*answer.joints, kLimitMargin) >= 0)
    return std::nullopt;
  const Pose reached = arm_.tip(*answer.joints);
  const bool there = (reached.position - tip.position).norm() < kPoseError &&
                     reached.rotation.angularDistance(tip.rotation) < kTurnError;
  return there ? answer.joints : std::nullopt;
}

}  // namespace palpate::baxter
