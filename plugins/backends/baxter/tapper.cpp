// SPDX-License-Identifier: MIT
#include "baxter/tapper.hpp"

#include "baxter/readings.hpp"
#include "baxter/signed_tap.hpp"
#include "baxter/words.hpp"
#include "tapping/words.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

namespace palpate::baxter {
namespace {

using tapping::centimetres;
using tapping::GuardedTap;
using tapping::newtons;
using ForceSign = BaxterOptions::ForceSign;
using Then = Fault::Then;

constexpr double kPeriod = GuardedTap::kPeriod;
constexpr double kStepClamp = 0.05;  ///< rad by which a set-point may leave both the last one and the arm
constexpr double kAtGoal = 0.015;    ///< rad: settled errors are up to 0.008
constexpr double kStill = 0.002;     ///< rad in kStillFor
constexpr double kStillFor = 0.1;    ///< s
constexpr double kSettling = 5.0;    ///< s: after a stop the arm takes two
constexpr double kUnloading = 0.6;   ///< s after which an arm that trails by 0.35 s has turned around and is clear
constexpr int kPulled = 6;           ///< new readings of a force that pulls: what moving takes away from it is noisy

/// For the first contact with a desk of which nobody knows how hard it is: at 1 cm/s and 4 N it stays below 8 N on
/// 100 kN/m.
tapping::MotionOptions gentle(tapping::MotionOptions motion) {
  motion.speed = std::min(motion.speed, 0.01);
  motion.fine_speed = std::min(motion.fine_speed, motion.speed);
  motion.threshold = std::min(motion.threshold, 4.0);
  motion.fine_threshold = std::min(motion.fine_threshold, motion.threshold);
  return motion;
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
      arm_(Eigen::Map<const Eigen::Vector3d>(options.tool.tip)),
      planner_(options.place, arm_, [this](const Pose& tip, const Joints& seed) { return inverse(tip, seed); }),
      workspace_(workspace_of(options, scene)),
      watch_(workspace_, options.force_stop),
      sign_(options.sign() == ForceSign::learn      ? 0.0
            : options.sign() == ForceSign::positive ? 1.0
                                                    : -1.0) {}

Contact Tapper::tap(const TapRequest& request) {
  const double begin = robot_.read().now;
  Contact contact;
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
  const std::string touched =
      fmt::format("contact at {}, at most {}", centimetres(contact.height), newtons(contact.force));
  note_(fmt::format("tap {}: {}", request.number, contact.reason.empty() ? touched : contact.reason));
  return contact;
}

Contact Tapper::attempt(const TapRequest& request) {
  recovering_ = false;
  Path down = column(request.target);
  if (options_.dry_run) return failed(Outcome::aborted, "dry run: the place can be reached, nothing moved");
  if (options_.calibration && !calibrated_) {
    TapRequest desk;
    desk.target = bare();
    const Path way = column(desk.target);
    go_to(way.front());
    calibrate(descend(desk, gentle(options_.motion), way));
    learn_sign();
    down = column(request.target);
  }
  go_to(down.front());
  Contact contact = descend(request, options_.motion, down);
  if (contact.outcome == Outcome::contact) learn_sign();
  return contact;
}

/// The scene's zero moves to where a tap on the bare desk found it.
void Tapper::calibrate(const Contact& contact) {
  if (contact.outcome != Outcome::contact) {
    throw Fault{"the calibration tap met no desk: " + contact.reason, Then::hold};
  }
  const double off = contact.height - scene_.desk();
  if (std::abs(off) > options_.calibration->tolerance) {
    throw Fault{
        fmt::format("the calibration tap found the desk {} {} than place.height has it: measure again, see that "
                    "nothing lies there, or raise calibration.tolerance",
                    centimetres(std::abs(off)), off > 0.0 ? "higher" : "lower"),
        Then::hold};
  }
  planner_.raise(off);
  calibrated_ = true;
  note_("calibration: the desk lies " + centimetres(off) + " above where the config has it");
}

/// Takes over the arm where it is and brings it over a place at the height of travel: straight up first if it is below,
/// then straight there. All of it is planned before the first command, which is the measured joints.
void Tapper::go_to(const Joints& hover) {
  watch_.begin();
  expect_fit();
  const Joints start = seen_.joints->position;
  const Path up = way_up();
  const Path across = planner_.line(up.end(), hover);
  expect_fit();  // the robot's own inverse kinematics takes its time
  next_ = seen_.now;
  watch_.set_tare(force_at_rest(start), Watch::Zero::follows);
  climb(up);
  follow(across, options_.motion.travel_speed);
  settle(hover);
}

void Tapper::climb(const Path& up) {
  if (!(up.length() > 0.0)) return;
  follow(up, options_.motion.retreat_speed);
  await_height(up.end());
}

/// Waits until the arm has come up after its set-point: one that went sideways before would cut the corner, and what
/// stands there.
void Tapper::await_height(const Joints& top) {
  const double begin = seen_.now;
  while (height() < travel_height() - kNearTravel) {
    if (seen_.now > begin + kSettling) {
      throw Fault{"the arm did not come up to the height of travel: see what holds it", Then::hold};
    }
    step(top);
  }
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
  throw Fault{"the arm did not come to rest where it was sent: see what holds it", Then::hold};
}

/// Comes down to `hover` from just above and waits until the arm rests. Its joints rub: at 0.4 Nm the force of an arm
/// at rest reads 9 N less after it has come up than after it has come down. So it rests as it will go on, and what is
/// felt at rest before a tap and after it can be compared.
void Tapper::rest_from_above(const Path& column) {
  settle(column.front());
  for (double along = 0.0; along < kFromAbove;) {
    along = std::min(kFromAbove, column.advance(along, options_.motion.speed, kPeriod));
    step(column.at(along));
  }
  settle(column.at(kFromAbove));
}

Contact Tapper::descend(const TapRequest& request, const tapping::MotionOptions& motion, const Path& column) {
  const tapping::Descent plan = tapping::plan_descent(motion, scene_.desk(), request.predicted);
  const auto at = [&](double height) { return column.at(plan.hover + kFromAbove - height); };
  rest_from_above(column);
  SignedTap signed_tap(motion, plan, sign_);
  std::vector<Eigen::Vector3d> tare;
  EvenDescent even;
  std::optional<double> moving;
  int pulled = 0;
  double set_point = plan.hover;
  Joints command = at(plan.hover);
  Eigen::Vector3d at_hover = seen_.endpoint->force;
  for (bool first = true; !signed_tap.tap().done();) {
    const double before = set_point;
    const bool taring = signed_tap.tap().taring();
    const bool fresh = watch_.fresh();
    const Eigen::Vector3d reading = seen_.endpoint->force;
    const bool coming_down = signed_tap.tap().coming_down();
    const double felt = reading.z() - (coming_down ? moving_ : 0.0);
    set_point = signed_tap.next(height(), felt, fresh);
    // A set-point put where the arm is means: stop. The measured joints stop every joint, not the tip alone.
    if (set_point == height() && set_point != before) {
      command = seen_.joints->position;
    } else if (set_point != before) {
      command = at(set_point);
    }
    if (taring) {
      if (fresh) tare.push_back(reading);
      pulled = 0;
      if (!signed_tap.tap().taring() && !signed_tap.tap().done()) {
        // The bias of the force depends on the pose: every tare of the tap is one for the rules, too.
        zero_ = average(std::exchange(tare, {}));
        if (std::exchange(first, false)) at_hover = zero_;
        watch_.set_tare(zero_);
      }
    } else if (fresh) {
      // Once, high up: lower down the bias of another pose would be taken for that of the motion, and near what is
      // expected a soft contact.
      if (!moving && plan.start >= plan.hover && even.add(signed_tap.tap().even_for(), reading)) {
        moving = even.mean().z() - zero_.z();
      }
      // An arm that goes up rubs the other way, which is no pull.
      pulled = coming_down && sign_ * (felt - zero_.z()) < -motion.threshold ? pulled + 1 : 0;
      if (pulled >= kPulled) {
        throw Fault{
            "the force fell by more than the threshold where nothing can pull: its zero moved, or force_sign is "
            "wrong",
            Then::retreat};
      }
    }
    step(command);
  }
  retreat(column.back(plan.hover + kFromAbove - height()));
  const GuardedTap& tap = signed_tap.tap();
  switch (tap.outcome()) {
    case Outcome::contact:
      rest_from_above(column);
      if (!believed(at_hover, force_at_rest(at(plan.hover)), motion.threshold)) {
        return failed(Outcome::aborted,
                      "the force did not go back to its zero when the tool was clear: its zero moved "
                      "during the tap, and the contact may be none");
      }
      if (moving) learn_moving(*moving);
      shown_sign_ = signed_tap.sign();
      return {Outcome::contact, tap.height(), tap.peak_force(), 0.0, {}};
    case Outcome::timeout:
      return failed(Outcome::timeout, "the tap took longer than motion.timeout");
    default:
      return failed(tap.outcome(), "the descent ended without a contact");
  }
}

/// Goes up from where it may press. What it presses with goes, and so does what the joints rub against, which turns
/// around: only what comes after that is a force of something that holds the tool.
void Tapper::retreat(const Path& up) {
  watch_.forget_tare();
  const double free = seen_.now + kUnloading;
  bool tared = false;
  for (double along = 0.0; along < up.length();) {
    along = up.advance(along, options_.motion.retreat_speed, kPeriod);
    step(up.at(along));
    if (!tared && seen_.now >= free) {
      tared = true;
      watch_.set_tare(seen_.endpoint->force, Watch::Zero::follows);
    }
  }
  await_height(up.end());
  if (!tared) watch_.set_tare(seen_.endpoint->force, Watch::Zero::follows);
}

void Tapper::expect_fit() {
  await_fit(true);
  std::optional<Fault> fault = Watch::fit(seen_, true);
  if (!fault) return;
  fault->then = Then::silence;  // the arm stands, and has not been taken over
  throw *fault;
}

/// One period: sends the set-point, waits, reads, and looks whether every rule holds. Throws Fault.
void Tapper::step(const Joints& command) {
  if (!recovering_ && interrupted()) throw Fault{"interrupted", Then::retreat, false};
  const auto jump = [&](const Joints& from) { return (command - from).cwiseAbs().maxCoeff() > kStepClamp; };
  if (!command.allFinite() ||
      (jump(seen_.joints->position) && jump(watch_.last_sent().value_or(seen_.joints->position)))) {
    throw Fault{"a set-point would have jumped", Then::hold};
  }
  robot_.command(command);
  watch_.sent(seen_.now, command);
  // A period that was missed is not made up for: the arm would be sent several set-points at once.
  if (next_ + kPeriod <= seen_.now) next_ = seen_.now;
  if (!pass()) throw standstill();
  if (std::optional<Fault> fault = watch_.look(seen_, tip_)) throw *fault;
}

/// Waits for the next period and reads; false where time stands still.
bool Tapper::pass() {
  next_ += kPeriod;
  if (!robot_.wait_until(next_)) return false;
  take(robot_.read());
  return true;
}

void Tapper::take(Snapshot seen) {
  seen_ = std::move(seen);
  if (seen_.joints) tip_ = planner_.to_scene(arm_.tip(seen_.joints->position).position);
}

}  // namespace palpate::baxter
