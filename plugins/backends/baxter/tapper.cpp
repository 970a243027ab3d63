// SPDX-License-Identifier: MIT
#include "baxter/tapper.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace palpate::baxter {
namespace {

using tapping::GuardedTap;
using Then = Fault::Then;

constexpr double kPeriod = GuardedTap::kPeriod;
constexpr double kLimitMargin = 0.03;   ///< rad that planned joints keep from their limits
constexpr double kReachSpacing = 0.02;  ///< m between the places of a dry run
constexpr double kStepClamp = 0.05;     ///< rad by which a set-point may leave both the last one and the arm
constexpr double kPoseError = 0.001;    ///< m and
constexpr double kTurnError = 0.02;     ///< rad by which an answer of the robot's may miss the pose
constexpr double kPatience = 1.0;       ///< s in which data must be fresh when a tap begins
constexpr double kBehind = 0.05;        ///< s that the loop may be late before it starts counting anew
constexpr double kAtGoal = 0.03;        ///< rad: settled errors are up to 0.008
constexpr double kStill = 0.002;        ///< rad in kStillFor
constexpr double kStillFor = 0.1;       ///< s
constexpr double kSettling = 5.0;       ///< s: after a stop the arm takes two
constexpr double kHeld = 0.5;           ///< s for which the measured joints are sent at a stop
constexpr double kReflexEnds = 4.0;     ///< s: the firmware's own stop lasts two
constexpr double kNearHover = 0.01;     ///< m
constexpr int kForceSamples = 10;       ///< for the force at rest

std::string centimetres(double length) {
  std::ostringstream out;
  out.precision(1);
  out << std::fixed << 100.0 * length << " cm";
  return out.str();
}

std::string newtons(double force) {
  std::ostringstream out;
  out.precision(1);
  out << std::fixed << force << " N";
  return out.str();
}

Eigen::Vector3d vector(const double (&values)[3]) { return {values[0], values[1], values[2]}; }

/// Of all that GuardedTap does within a column.
double fastest(const tapping::MotionOptions& motion) {
  double out = std::max(motion.speed, motion.type == tapping::MotionOptions::Type::two_stage ? motion.fine_speed : 0.0);
  if (motion.adaptive_hover) out = std::max(out, motion.adaptive_hover->speed);
  return out;
}

Contact failed(Outcome outcome, const std::string& reason, bool ends_run = false) {
  Contact out{outcome, 0.0, 0.0, 0.0, reason};
  out.ends_run = ends_run;
  return out;
}

}  // namespace

Tapper::Tapper(const BaxterOptions& options, const Scene& scene, Robot& robot, const std::atomic<bool>* interrupted,
               std::function<void(const std::string&)> note)
    : options_(options),
      scene_(scene),
      robot_(robot),
      interrupted_(interrupted),
      note_(std::move(note)),
      arm_(vector(options.tool.tip)),
      planner_(options.place, arm_,
               [this](const Pose& tip, const Joints& seed) {
                 if (options_.inverse_kinematics == BaxterOptions::InverseKinematics::robot)
                   return ask_robot(tip, seed);
                 return arm_.solve(tip, seed, kLimitMargin);
               }),
      workspace_(workspace_of(options, scene)),
      watch_(workspace_, options.force_stop) {}

void Tapper::check() {
  await_fit(!options_.dry_run);
  check_before_flight(seen_, options_, planner_, workspace_, !options_.dry_run);
  if (!options_.dry_run) return;
  const tapping::Descent descent = tapping::plan_descent(options_.motion, scene_.desk(), std::nullopt);
  const int places =
      check_reach(planner_, scene_.area(), descent.hover, descent.floor, fastest(options_.motion), kReachSpacing);
  note_("dry run: all " + std::to_string(places) + " places of the area can be reached, all the way down");
}

Contact Tapper::tap(const TapRequest& request) {
  const double begin = robot_.read().now;
  Contact contact;
  try {
    contact = attempt(request);
  } catch (const NoPath& none) {
    contact = failed(Outcome::unreachable, none.reason);
  } catch (const Fault& fault) {
    contact = failed(Outcome::aborted, fault.reason + "; " + recover(fault), fault.ends_run);
  }
  contact.seconds = std::max(0.0, robot_.read().now - begin);
  note_("tap " + std::to_string(request.number) + ": " +
        (contact.outcome == Outcome::contact
             ? "contact at " + centimetres(contact.height) + ", at most " + newtons(contact.force)
             : contact.reason));
  return contact;
}

Contact Tapper::attempt(const TapRequest& request) {
  Path down = column(request.target);
  if (options_.dry_run) return failed(Outcome::aborted, "dry run: the place can be reached, nothing moved");
  start();
  if (options_.calibration && !calibrated_) {
    calibrate();
    down = column(request.target);
  }
  go_to(down.front());
  return descend(request, down);
}

/// Whatever a tap plans, it plans before it moves.
Path Tapper::column(const Target& place) const {
  const Area area = scene_.area();
  const tapping::Descent descent = tapping::plan_descent(options_.motion, scene_.desk(), std::nullopt);
  return planner_.column(place, {0.5 * area.width, 0.5 * area.depth}, descent.hover, descent.floor,
                         fastest(options_.motion));
}

/// A tap on the bare desk: the scene's zero moves to where it was found.
void Tapper::calibrate() {
  TapRequest request;
  request.target = {options_.calibration->at[0], options_.calibration->at[1]};
  const Path down = column(request.target);
  go_to(down.front());
  const Contact contact = descend(request, down);
  if (contact.outcome != Outcome::contact) {
    throw Fault{"the calibration tap met no desk: " + contact.reason, Then::hold, true};
  }
  const double off = contact.height - scene_.desk();
  if (std::abs(off) > options_.calibration->tolerance) {
    throw Fault{"the calibration tap found the desk " + centimetres(std::abs(off)) +
                    (off > 0.0 ? " higher" : " lower") +
                    " than place.height has it: measure again, see that nothing lies there, or raise "
                    "calibration.tolerance",
                Then::hold, true};
  }
  planner_.raise(off);
  calibrated_ = true;
  note_("calibration: the desk lies " + centimetres(off) + " above where the config has it");
}

/// Reads until the robot is fit; if it is not within a second, what was read last says why.
void Tapper::await_fit(bool moving) {
  take(robot_.read());
  const double begin = seen_.now;
  for (next_ = begin; next_ < begin + kPatience && Watch::fit(seen_, moving); take(robot_.read())) {
    next_ += kPeriod;
    if (!robot_.wait_until(next_)) return;
  }
}

/// Takes over the arm where it is: waits for fresh data, commands nothing but the measured joints, and brings the tip
/// up to the height of travel.
void Tapper::start() {
  watch_.begin();
  recovering_ = false;
  await_fit(true);
  if (std::optional<Fault> fault = Watch::fit(seen_, true)) throw *fault;
  next_ = seen_.now;
  step(seen_.joints->position);
  rise();
}

/// Straight up from where the arm is to the height of travel, if it is below.
void Tapper::rise() {
  const double hover = scene_.desk() + options_.motion.hover;
  if (height() >= hover - kNearHover) return;
  const Path up = planner_.up(seen_.joints->position, hover - height());
  follow(up, options_.motion.retreat_speed);
  await_height(up.end());
}

/// Waits until the arm has come up after its set-point: one that went sideways before would cut the corner, and what
/// stands there.
void Tapper::await_height(const Joints& top) {
  const double hover = scene_.desk() + options_.motion.hover;
  const double begin = seen_.now;
  while (height() < hover - kNearHover) {
    if (seen_.now > begin + kSettling) {
      throw Fault{"the arm did not come up to the height of travel: see what holds it", Then::hold, true};
    }
    step(top);
  }
}

void Tapper::go_to(const Joints& hover) {
  // From the set-point rather than from the measured joints: the arm trails it, and must not be called back.
  const Joints from = watch_.last_sent().value_or(seen_.joints->position);
  follow(planner_.line(from, hover), options_.motion.travel_speed);
  settle(hover);
}

void Tapper::follow(const Path& path, double speed) {
  for (double along = 0.0; along < path.length();) {
    along = path.advance(along, speed, kPeriod);
    step(path.at(along));
  }
}

/// Waits until the arm stands still where it was sent: only then does a tare mean anything.
void Tapper::settle(const Joints& goal) {
  const double begin = seen_.now;
  Joints then = seen_.joints->position;
  double since = begin;
  while (seen_.now < begin + kSettling) {
    step(goal);
    const Joints& now = seen_.joints->position;
    if ((now - then).cwiseAbs().maxCoeff() > kStill) {
      then = now;
      since = seen_.now;
    }
    if (seen_.now - since >= kStillFor && (now - goal).cwiseAbs().maxCoeff() < kAtGoal) return;
  }
  throw Fault{"the arm did not come to rest where it was sent: see what holds it", Then::hold, true};
}

Contact Tapper::descend(const TapRequest& request, const Path& column) {
  const tapping::Descent plan = tapping::plan_descent(options_.motion, scene_.desk(), request.predicted);
  GuardedTap tap(options_.motion, plan, GuardedTap::Arm::real);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const long taring = std::max(1L, std::lround(options_.motion.tare / kPeriod));
  int pulled = 0;
  double set_point = plan.hover;
  Joints command = column.front();
  for (long period = 1; !tap.done(); ++period) {
    const double before = set_point;
    set_point = tap.next(height(), force());
    // A set-point put where the arm is means: stop. The measured joints stop every joint, not the tip alone.
    if (set_point == height() && set_point != before) {
      command = seen_.joints->position;
    } else if (set_point != before) {
      command = column.at(plan.hover - set_point);
    }
    if (period <= taring) {
      sum += seen_.endpoint->force;
      zero_ = sum / static_cast<double>(period);
      if (period == taring) watch_.set_tare(zero_);
    } else {
      pulled = force() - options_.sign() * zero_.z() < -options_.motion.threshold ? pulled + 1 : 0;
      if (pulled >= 3) {
        throw Fault{
            "the force fell by more than the threshold where nothing can pull: its zero moved, or force_sign is "
            "wrong",
            Then::retreat, true};
      }
    }
    step(command);
  }
  follow(column.back(plan.hover - height()), options_.motion.retreat_speed);
  await_height(column.front());
  switch (tap.outcome()) {
    case Outcome::contact:
      if (!clear_of_force(column)) {
        return failed(Outcome::aborted,
                      "the force did not go back to its zero when the tool was clear: its zero moved "
                      "during the tap, and the contact may be none");
      }
      return {Outcome::contact, tap.height(), tap.peak_force(), 0.0, {}};
    case Outcome::timeout:
      return failed(Outcome::timeout, "the tap took longer than motion.timeout");
    default:
      return failed(tap.outcome(), "the descent ended without a contact");
  }
}

/// Whether the force at rest is what it was before the descent.
bool Tapper::clear_of_force(const Path& column) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < kForceSamples; ++i) {
    step(column.front());
    sum += seen_.endpoint->force;
  }
  return (sum / kForceSamples - zero_).norm() < 0.5 * options_.motion.threshold;
}

/// Does what may still be done and tells, in half a sentence, where that left the arm.
std::string Tapper::recover(const Fault& fault) {
  const std::string where = "the arm holds " + centimetres(height() - scene_.desk()) + " above the desk";
  if (fault.then == Then::silence) return "nothing more is sent, the arm stays where it is";
  recovering_ = true;
  hold(seen_.joints->position, kHeld);
  if (fault.then == Then::hold) return where;
  try {
    watch_.begin();
    watch_.expect_collision(true);
    next_ = seen_.now;
    for (double patience = kReflexEnds; patience > 0.0 && seen_.collision && seen_.collision->collision;
         patience -= kPeriod) {
      step(seen_.joints->position);
    }
    watch_.expect_collision(false);
    step(seen_.joints->position);
    rise();
    settle(*watch_.last_sent());
    return "the arm was raised to the height of travel";
  } catch (const NoPath& none) {
    return where + ", it could not be raised: " + none.reason;
  } catch (const Fault& other) {
    if (other.then != Then::silence) hold(seen_.joints->position, kHeld);
    return where + ", it was not raised: " + other.reason;
  }
}

std::optional<Joints> Tapper::ask_robot(const Pose& tip, const Joints& seed) {
  const Eigen::Vector3d offset(0.0, 0.0, options_.tool.gripper);
  const Robot::Answer answer =
      robot_.solve({tip.position + tip.rotation * (offset - vector(options_.tool.tip)), tip.rotation}, seed);
  if (!answer.trouble.empty()) throw Fault{answer.trouble, Then::silence, true};
  if (!answer.joints || !answer.joints->allFinite() || beyond_limits(*answer.joints, kLimitMargin) >= 0)
    return std::nullopt;
  const Pose reached = arm_.tip(*answer.joints);
  const bool there = (reached.position - tip.position).norm() < kPoseError &&
                     reached.rotation.angularDistance(tip.rotation) < kTurnError;
  return there ? answer.joints : std::nullopt;
}

/// One period: sends the set-point, waits, reads, and looks whether every rule holds. Throws Fault.
void Tapper::step(const Joints& command) {
  if (!recovering_ && interrupted_ != nullptr && interrupted_->load()) throw Fault{"interrupted", Then::retreat, false};
  const auto jump = [&](const Joints& from) { return (command - from).cwiseAbs().maxCoeff() > kStepClamp; };
  if (!command.allFinite() ||
      (jump(seen_.joints->position) && jump(watch_.last_sent().value_or(seen_.joints->position)))) {
    throw Fault{"a set-point would have jumped", Then::hold, true};
  }
  robot_.command(command);
  watch_.sent(seen_.now, command);
  next_ += kPeriod;
  if (next_ < seen_.now - kBehind) next_ = seen_.now + kPeriod;
  if (!robot_.wait_until(next_)) {
    throw Fault{"the clock of the robot's network stands still: its sender is gone", Then::silence, true};
  }
  take(robot_.read());
  if (std::optional<Fault> fault = watch_.look(seen_, tip_)) throw *fault;
}

/// Sends the joints for a while, whatever the rules say: they keep the arm where it is.
void Tapper::hold(const Joints& joints, double seconds) {
  next_ = seen_.now;
  for (double left = seconds; left > 0.0; left -= kPeriod) {
    robot_.command(joints);
    next_ += kPeriod;
    if (!robot_.wait_until(next_)) return;
    take(robot_.read());
  }
}

void Tapper::take(Snapshot seen) {
  seen_ = std::move(seen);
  if (seen_.joints) tip_ = planner_.to_scene(arm_.tip(seen_.joints->position).position);
}

double Tapper::height() const { return tip_.z(); }
double Tapper::force() const { return options_.sign() * seen_.endpoint->force.z(); }

}  // namespace palpate::baxter
