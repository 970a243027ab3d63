// SPDX-License-Identifier: MIT
#include "baxter/tapper.hpp"

#include "baxter/error_texts.hpp"
#include "tapping/motion.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

namespace palpate::baxter {
namespace {

using tapping::centimetres;
using ForceSign = BaxterOptions::ForceSign;
using AllowedAction = Fault::AllowedAction;

constexpr double kStepClamp = 0.05;          ///< rad: a set-point must be this near to the last one or to the arm
constexpr double kArrivalTolerance = 0.015;  ///< rad: settled errors are up to 0.008
constexpr double kRestTolerance = 0.002;     ///< rad: largest change within kRestTime of an arm that rests
constexpr double kRestTime = 0.1;            ///< s
constexpr double kSettlingTimeout = 5.0;     ///< s: after a stop the arm needs two seconds

constexpr double kHoldTime = 0.5;       ///< s for which the measured joints are sent at a stop
constexpr double kReflexTimeout = 4.0;  ///< s: the firmware's own stop lasts two seconds
constexpr int kMaxReflexes = 20;        ///< reflexes of the firmware that are tolerated while a pressing arm rises
constexpr double kFrictionPull = 3.5;   ///< N of apparent pull that friction can cause while the arm presses
constexpr double kAboveTravel = 0.3;    ///< m by which the tip may be above the height of travel
constexpr double kBelowFloor = 0.01;    ///< m by which the tip may be below the end of a descent

/// Limits speed and threshold for the first contact with a desk of unknown hardness.
tapping::MotionOptions gentle(tapping::MotionOptions motion) {
  motion.speed = std::min(motion.speed, 0.01);
  motion.fine_speed = std::min(motion.fine_speed, motion.speed);
  motion.threshold = std::min(motion.threshold, 4.0);
  motion.fine_threshold = std::min(motion.fine_threshold, motion.threshold);
  return motion;
}

/// Returns the allowed space of the tip: the area with a margin, from below the deepest descent to well above the
/// height of travel.
Workspace workspace_of(const BaxterOptions& options, const Scene& scene) {
  const Area area = scene.area();
  return {area.width, area.depth, scene.desk() - options.deepest() - kBelowFloor,
          scene.desk() + options.motion.at(0).hover + kAboveTravel};
}

Fault standstill() { return {"the clock of the robot's network has stopped: its publisher has ended"}; }

}  // namespace

Tapper::Tapper(const BaxterOptions& options, const Scene& scene, Robot& robot, const std::atomic<bool>* interrupted,
               std::function<void(const std::string&)> note)
    : options_(options),
      motion_(options.motion.at(0)),
      scene_(scene),
      robot_(robot),
      interrupted_(interrupted),
      note_(std::move(note)),
      arm_(Eigen::Map<const Eigen::Vector3d>(options.tool.tip)),
      planner_(options.scene_pose, arm_, [this](const Pose& tip, const Joints& seed) { return inverse(tip, seed); }),
      workspace_(workspace_of(options, scene)),
      guard_(workspace_, options.force_stop),
      sign_(options.sign() == ForceSign::learn      ? 0.0
            : options.sign() == ForceSign::positive ? 1.0
                                                    : -1.0) {}

tapping::HeightResult Tapper::failed(Outcome outcome, const std::string& reason, bool ends_run) {
  return {outcome, 0.0, 0.0, 0.0, reason, ends_run};
}

tapping::HeightResult Tapper::tap(const TapRequest& request) {
  const double begin = robot_.read().now;
  tapping::HeightResult contact;
  peak_.reset();
  try {
    contact = attempt(request);
  } catch (const NoPath& none) {
    contact = failed(Outcome::unreachable, none.reason);
  } catch (const Fault& fault) {
    contact = failed(Outcome::aborted, fault.reason + "; " + recover(fault), fault.ends_run);
  } catch (const std::exception& trouble) {
    contact = failed(Outcome::aborted, fmt::format("{}; {}", trouble.what(), kSilent), true);
  }
  contact.seconds = std::max(0.0, robot_.read().now - begin);
  contact.peak_force = peak_;
  const std::string touched =
      fmt::format("contact at {}, at most {}", centimetres(contact.height), tapping::newtons(contact.force));
  note_(fmt::format("tap {}: {}", request.number, contact.reason.empty() ? touched : contact.reason));
  return contact;
}

tapping::HeightResult Tapper::attempt(const TapRequest& request) {
  recovering_ = false;
  motion_log_.reset();
  motion_ = options_.motion.of_request(request);
  Path down = column(request.line.target());
  if (options_.dry_run) return failed(Outcome::aborted, "dry run: the place can be reached, nothing moved");
  if (options_.calibration && !calibrated_) {
    TapRequest desk;
    desk.line = line_from_above(desk_target());
    const Path way = column(desk.line.target());
    go_to(way.front());
    calibrate(descend(desk, gentle(motion_), way));
    learn_sign();
    down = column(request.line.target());
  }
  go_to(down.front());
  tapping::HeightResult contact = descend(request, motion_, down);
  if (contact.outcome == Outcome::contact) learn_sign();
  return contact;
}

/// Moves the origin of the scene to the measured height of the bare desk.
void Tapper::calibrate(const tapping::HeightResult& contact) {
  if (contact.outcome != Outcome::contact)
    throw Fault{"the calibration tap found no desk: " + contact.reason, AllowedAction::hold};
  const double off = contact.height - scene_.desk();
  if (std::abs(off) > options_.calibration->tolerance)
    throw Fault{fmt::format("the calibration tap found the desk {} {} than scene_pose.height: measure again, check "
                            "that nothing lies there, or raise calibration.tolerance",
                            centimetres(std::abs(off)), off > 0.0 ? "higher" : "lower"),
                AllowedAction::hold};
  planner_.raise(off);
  calibrated_ = true;
  note_("calibration: the desk is " + centimetres(off) + " above its height in the config");
}

/// Moves the arm from its current position to joints `hover`: straight up to the height of travel if necessary, then
/// along a line. Everything is planned before the first set-point, which equals the measured joints.
void Tapper::go_to(const Joints& hover) {
  guard_.begin();
  expect_readiness();
  const Joints start = seen_.joints->position;
  const Path up = way_up();
  const Path across = planner_.line(up.end(), hover);
  expect_readiness();  // the robot's inverse kinematics takes time
  next_ = seen_.now;
  guard_.set_tare(force_at_rest(start), MotionGuard::ZeroMode::follows);
  climb(up, sign_, {});
  motion_log_.emplace();
  follow(across, motion_.travel_speed, across.length());
  settle(hover);
  reaction_.learn_trailing(*motion_log_);
  motion_log_.reset();
}

/// Rises along `up` from the position where an earlier run or a fault left the arm. `sign`: sign of the force when an
/// object presses the tool upwards, 0 if unknown. `zero`: see rise().
void Tapper::climb(const Path& up, double sign, const std::optional<double>& zero) {
  if (up.length() > 0.0) rise(up, kGentleRise, sign, zero);
}

/// Waits until the arm has reached the height of its set-point. A sideways motion before that would cut the corner and
/// could hit objects.
void Tapper::await_height(const Joints& top) {
  const double begin = seen_.now;
  while (height() < travel_height() - kNearTravel) {
    if (seen_.now > begin + kSettlingTimeout)
      throw Fault{"the arm did not reach the height of travel: check what holds it", AllowedAction::hold};
    step(top);
  }
}

void Tapper::follow(const Path& path, double speed, double end) {
  for (double along = 0.0; along < end;) {
    along = std::min(end, path.advance(along, speed, kPeriod));
    step(path.at(along));
  }
}

/// Waits until the arm rests at `goal`, because a tare needs an arm at rest.
void Tapper::settle(const Joints& goal) {
  const double begin = seen_.now;
  Joints then = seen_.joints->position;
  double since = begin;
  while (seen_.now < begin + kSettlingTimeout) {
    step(goal);
    const Joints& now = seen_.joints->position;
    if ((now - then).cwiseAbs().maxCoeff() > kRestTolerance) {
      then = now;
      since = seen_.now;
    }
    if (seen_.now - since >= kRestTime && (now - goal).cwiseAbs().maxCoeff() < kArrivalTolerance) return;
  }
  throw Fault{"the arm did not come to rest at its target: check what holds it", AllowedAction::hold};
}

void Tapper::expect_readiness() {
  await_readiness(true);
  std::optional<Fault> fault = MotionGuard::check_readiness(seen_, true);
  if (!fault) return;
  fault->then = AllowedAction::silence;  // the arm rests, and no set-point has been sent
  throw *fault;
}

/// Executes one period: sends the set-point, waits, reads, and checks all rules. Throws Fault.
void Tapper::step(const Joints& command) {
  if (!recovering_ && interrupted()) throw Fault{"interrupted", AllowedAction::retreat, false};
  const auto jump = [&](const Joints& from) { return (command - from).cwiseAbs().maxCoeff() > kStepClamp; };
  if (!command.allFinite() ||
      (jump(seen_.joints->position) && jump(guard_.last_sent().value_or(seen_.joints->position)))) {
    throw Fault{"a set-point would have jumped", AllowedAction::hold};
  }
  robot_.command(command);
  guard_.record_command(seen_.now, command);
  // A missed period is skipped, because catching up would send several set-points at once.
  if (next_ + kPeriod <= seen_.now) next_ = seen_.now;
  if (!next_period()) throw standstill();
  if (motion_log_) motion_log_->push_back({seen_.now, planner_.to_scene(arm_.tip(command).position), tip_});
  if (std::optional<Fault> fault = guard_.check(seen_, tip_)) throw *fault;
}

/// Waits for the next period and reads. Returns false if the clock stands still.
bool Tapper::next_period() {
  next_ += kPeriod;
  if (!robot_.wait_until(next_)) return false;
  store(robot_.read());
  return true;
}

void Tapper::store(Snapshot seen) {
  seen_ = std::move(seen);
  if (seen_.joints) tip_ = planner_.to_scene(arm_.tip(seen_.joints->position).position);
}

/// Executes the action that the fault allows. Returns a phrase with the final state of the arm.
std::string Tapper::recover(const Fault& fault) {
  if (fault.then == AllowedAction::silence) return kSilent;
  const auto silent = [](const Fault& other) { return std::string(kSilent) + ": " + other.reason; };
  const auto where = [&] { return "the arm holds " + centimetres(height() - scene_.desk()) + " above the desk"; };
  recovering_ = true;
  // If the sign is unknown, the force during the descent determines it.
  const double sign = sign_ != 0.0 ? sign_ : std::copysign(1.0, seen_.endpoint->force.z() - zero_.z());
  const auto presses = [&] { return sign * (seen_.endpoint->force.z() - zero_.z()); };
  if (const auto other = hold_through_reflex(fault)) return silent(*other);
  if (fault.then == AllowedAction::hold) return where();
  try {
    for (int attempt = 1;; ++attempt) {
      try {
        await_reflex_end();
        // If the zero has moved, an apparent pull at rest does not count.
        const double zero = zero_.z() + sign * std::min(0.0, presses());
        climb(way_up(), sign, zero);
        settle(*guard_.last_sent());
        return "the arm was raised to the height of travel";
      } catch (const Fault& again) {
        const bool pulled = again.then == AllowedAction::hold || presses() < -kFrictionPull;
        if (!again.reflex || pulled || attempt == kMaxReflexes) throw;
      }
    }
  } catch (const NoPath& none) {
    return where() + ", it could not be raised: " + none.reason;
  } catch (const Fault& other) {
    if (other.then == AllowedAction::silence) return silent(other);
    if (const auto another = hold_through_reflex(other)) return silent(*another);
    return where() + ", it was not raised: " + other.reason;
  }
}

/// Holds the arm at its position. If an object holds the tool and the reflex stopped the arm, the arm is held again
/// after the reflex, at its new position. Its springs then pull less.
std::optional<Fault> Tapper::hold_through_reflex(const Fault& fault) {
  if (const auto other = hold(seen_.joints->position)) return other;
  if (!fault.reflex || fault.then != AllowedAction::hold) return std::nullopt;
  try {
    await_reflex_end();
  } catch (const Fault& other) {
    if (other.then == AllowedAction::silence) return other;
  }
  return hold(seen_.joints->position);
}

/// Waits without motion until the firmware's reflex ends. While the arm keeps pressing, the reflex fires again
/// immediately. The arm then rises a little each time, until it presses with less than 16 N.
void Tapper::await_reflex_end() {
  guard_.begin();
  guard_.expect_collision(true);
  next_ = seen_.now;
  const double patience = seen_.now + kReflexTimeout;
  const Joints here = seen_.joints->position;
  while (seen_.now < patience && seen_.collision && seen_.collision->collision) step(here);
  guard_.expect_collision(false);
  step(seen_.joints->position);
}

/// Sends `joints` for kHoldTime seconds, or until a rule demands silence. Returns the fault of this rule, if any.
std::optional<Fault> Tapper::hold(Joints joints) {
  guard_.begin();
  next_ = seen_.now;
  for (double left = kHoldTime; left > 0.0; left -= kPeriod) {
    robot_.command(joints);
    if (!next_period()) return standstill();
    std::optional<Fault> fault = guard_.check(seen_, tip_);
    if (fault && fault->then == AllowedAction::silence) return fault;
  }
  return std::nullopt;
}

}  // namespace palpate::baxter
