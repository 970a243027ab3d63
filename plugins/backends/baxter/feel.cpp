// SPDX-License-Identifier: MIT
// One descent of Tapper, and what it makes of the force that the robot tells.
#include "baxter/tapper.hpp"
#include "baxter/words.hpp"
#include "tapping/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace palpate::baxter {
namespace {

using tapping::newtons;
using Then = Fault::Then;

constexpr std::size_t kForceSamples = 25;  ///< new ones, for the force at rest
constexpr double kForcePatience = 1.0;     ///< s in which they must have come
constexpr int kTold = 3;                   ///< taps of a run for which that is noted
constexpr double kMostMoving = 0.8;        ///< of the threshold: more may be a contact that begins
constexpr double kLeastMoved = 2.5;        ///< N that the zero may move, whatever the threshold: noise makes 0.4

/// m above what it touched to where an arm goes up gently: there it is clear, and its joints rub the other way.
constexpr double kClear = 0.005;
constexpr double kFarther = 0.01;  ///< m that it goes on gently where it still presses: an onset is as inexact
constexpr double kTurned = 0.01;   ///< m of a way over which turned() looks
constexpr double kRubs = 1.4;      ///< times as much as at rest, while the joints turn around and move
constexpr double kGentle = 0.01;   ///< m/s: an arm of 6.4 kN/m that is held feels 2 N more in three readings
constexpr double kSpeedUp = 0.15;  ///< m/s^2, afterwards
/// N that an arm reads less when it goes up faster: 3 by its speed, and 2.5 behind a zero that changes by 50 N/m.
constexpr double kFaster = 3.0;
constexpr double kLatest = 0.2;    ///< of a force that is followed, the part of the latest reading
constexpr int kPulled = 6;         ///< new readings of a force that pulls: what moving takes away from it is noisy
constexpr double kEvenFrom = 0.7;  ///< s after which an arm that trails by 0.35 s comes down evenly
constexpr double kEvenTo = 1.0;    ///< s, for so long its force is looked at
constexpr std::size_t kFewestEven = 10;
constexpr double kToRest = 0.015;        ///< m/s, of the centimetre before a rest, where nothing should be
constexpr double kFirstThreshold = 5.0;  ///< N, until a contact was measured
constexpr double kMostRubbing = 0.5;     ///< Nm of a joint: more is something that touches the arm
constexpr double kStiffest = 8000.0;     ///< N/m of the arm where its posture is not known
constexpr double kSteady = 1.5;          ///< N from the first half of it to the second: noise of 1.5 N makes 0.55

/// Of each component; at least one reading.
Eigen::Vector3d median(std::vector<Eigen::Vector3d> readings) {
  Eigen::Vector3d out;
  const auto middle = readings.begin() + static_cast<std::ptrdiff_t>(readings.size() / 2);
  for (int i = 0; i < 3; ++i) {
    std::nth_element(readings.begin(), middle, readings.end(),
                     [i](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a[i] < b[i]; });
    out[i] = (*middle)[i];
  }
  return out;
}

/// The mean force along z of a descent from when the arm, which trails its set-point, comes down evenly until shortly
/// after. Where it rises meanwhile a contact begins: that is no force of a moving arm.
class EvenDescent {
 public:
  /// Takes a reading `time` seconds after the set-point began to come down; the mean when it is there.
  std::optional<double> add(double time, double force) {
    if (time < kEvenFrom) forces_.clear();
    if (time >= kEvenFrom && time < kEvenTo) forces_.push_back(force);
    if (time < kEvenTo || forces_.size() < kFewestEven) return std::nullopt;
    const std::vector<double> forces = std::exchange(forces_, {});
    const auto count = static_cast<Eigen::Index>(forces.size());
    const Eigen::Map<const Eigen::VectorXd> all(forces.data(), count);
    const double rise = all.tail(count - count / 2).mean() - all.head(count / 2).mean();
    return std::abs(rise) < kSteady ? std::optional<double>(all.mean()) : std::nullopt;
  }

 private:
  std::vector<double> forces_;
};

/// The periods in which the set-point comes down evenly, those up to now and those up to the latest notice.
struct EvenPeriods {
  std::vector<Reaction::Period> now;
  std::vector<Reaction::Period> at_notice;
  int noticed = 0;
  double begin = 0.0;  ///< s

  /// `even_for`: since when it comes down so, seconds; 0 if it does not.
  void add(const Reaction::Period& period, double even_for) {
    if (even_for < kEvenFrom) now.clear();
    if (even_for >= kEvenFrom && period.time >= begin) now.push_back(period);
  }
  /// Begins anew once an arm that is slowed down at `time` comes down evenly again.
  void restart(double time) {
    now.clear();
    begin = time + kEvenFrom;
  }
  void notice(int count) {
    noticed = count;
    at_notice = now;
  }
};

/// While the sign is not known there are two taps, one for each. They are led alike until one of them feels a contact;
/// that one goes on, and its sign is the robot's, if the contact is one.
class SignedTap {
  struct One {
    double sign;
    tapping::GuardedTap tap;
    double set_point = 0.0;
  };

 public:
  /// `sign`: of the force when something presses the tool upwards, 1 or -1; 0 if it is not known.
  SignedTap(const tapping::MotionOptions& motion, const tapping::Descent& descent, double sign) {
    const tapping::GuardedTap tap(motion, descent, tapping::GuardedTap::Arm::real);
    taps_ = sign != 0.0 ? std::vector<One>{{sign, tap}} : std::vector<One>{{-1.0, tap}, {1.0, tap}};
  }

  /// As GuardedTap::next, with the force as the robot tells it.
  double next(double height, double force, bool fresh) {
    for (One& one : taps_) one.set_point = one.tap.next(height, one.sign * force, fresh);
    if (taps_.size() == 2 && taps_.front().set_point != taps_.back().set_point) {
      // Of a contact the set-point is put where the arm is.
      const bool second = taps_.back().set_point == height;
      taps_.erase(second ? taps_.begin() : taps_.begin() + 1);
    }
    return taps_.front().set_point;
  }

  void slow_to(double speed) {
    for (One& one : taps_) one.tap.slow_to(speed);
  }
  const tapping::GuardedTap& tap() const { return taps_.front().tap; }
  /// The force along z that it compares with, as the robot tells it.
  double zero() const { return taps_.front().sign * tap().zero(); }
  /// 0 while nothing has shown it.
  double sign() const { return taps_.size() == 1 ? taps_.front().sign : 0.0; }

 private:
  std::vector<One> taps_;
};

/// How far the joints turn for each metre of a way, `along` it: rad/m, all of them together.
double turned(const Path& way, double along) {
  const double end = std::min(way.length(), along + kTurned);
  return (way.at(end) - way.at(along)).lpNorm<1>() / std::max(end - along, 1e-3);
}

}  // namespace

/// Comes down to `hover` from just above and waits until the arm rests. Its joints rub: at 0.4 Nm the force of an arm
/// at rest reads 9 N less after it has come up than after it has come down. So it rests as it will go on, and what is
/// felt at rest before a tap and after it can be compared.
void Tapper::rest_from_above(const Path& column) {
  settle(column.front());
  follow(column, std::min(motion_.speed, kToRest), kFromAbove);
  settle(column.at(kFromAbove));
}

/// The greatest vertical stiffness of the arm on its way down there, N/m.
double Tapper::stiffness_at(const Target& place) const {
  double out = 0.0;
  std::optional<Joints> joints = untucked();
  for (const double height : {travel_height(), scene_.desk() + 0.5 * motion_.hover, scene_.desk()}) {
    joints = arm_.solve(planner_.pose(place, height), joints.value_or(untucked()));
    if (joints) out = std::max(out, arm_.vertical_stiffness(*joints));
  }
  return out > 0.0 ? out : kStiffest;
}

/// The motion at speeds at which no contact is expected to exceed Reaction::kGreatestForce. Throws Fault where such a
/// speed is not worth having.
tapping::MotionOptions Tapper::bounded(tapping::MotionOptions motion, double stiffness) const {
  // Nobody knows yet how late this robot is: it is taken for the slowest that is driven.
  if (!reaction_.measured()) {
    motion.threshold = std::min(motion.threshold, kFirstThreshold);
    motion.fine_threshold = std::min(motion.fine_threshold, motion.threshold);
  }
  double greatest = reaction_.greatest_speed(motion.threshold, stiffness);
  if (greatest < Reaction::kSlowest && reaction_.measured()) {
    throw Fault{fmt::format("a contact would be noticed after {:.0f} ms and stopped {:.0f} ms later, messages come up "
                            "to {:.0f} ms late: at {:.1f} N that allows {:.1f} mm/s, and {:.0f} mm/s are needed. "
                            "Connect by cable, end other load, or lower motion.threshold",
                            1e3 * reaction_.noticing(), 1e3 * reaction_.stopping(), 1e3 * reaction_.lateness(),
                            motion.threshold, 1e3 * greatest, 1e3 * Reaction::kSlowest),
                Then::hold};
  }
  greatest = std::max(greatest, Reaction::kSlowest);
  const double configured = motion.speed;
  motion.speed = std::min(motion.speed, greatest);
  motion.fine_speed = std::min(
      motion.fine_speed, std::max(Reaction::kSlowest, reaction_.greatest_speed(motion.fine_threshold, stiffness)));
  if (motion.adaptive_hover) motion.adaptive_hover->speed = std::min(motion.adaptive_hover->speed, greatest);
  const double way = motion.hover + motion.overrun;
  motion.timeout += way / motion.speed - way / configured;
  return motion;
}

Contact Tapper::descend(const TapRequest& request, const tapping::MotionOptions& wanted, const Path& column) {
  if (!rubbing_) learn_rubbing(column);
  rest_from_above(column);
  const double stiffness = stiffness_at(request.target);
  reaction_.late(watch_.lateness(), seen_.now);
  const tapping::MotionOptions motion = bounded(wanted, stiffness);
  note_(fmt::format(
      "tap {}: {:.1f} mm/s on springs of {:.1f} kN/m; a contact is noticed after {:.0f} ms and stopped {:.0f} "
      "ms later, messages come up to {:.0f} ms late; at most {} are expected",
      request.number, 1e3 * motion.speed, 1e-3 * stiffness, 1e3 * reaction_.noticing(), 1e3 * reaction_.stopping(),
      1e3 * reaction_.lateness(), newtons(reaction_.expected_force(motion.threshold, motion.speed, stiffness))));
  const tapping::Descent plan = tapping::plan_descent(motion, scene_.desk(), request.predicted);
  const auto at = [&](double height) { return column.at(plan.hover + kFromAbove - height); };
  SignedTap signed_tap(motion, plan, sign_);
  std::vector<Eigen::Vector3d> tare;
  EvenDescent even;
  EvenPeriods periods;
  std::optional<double> moving;
  int pulled = 0;
  double set_point = plan.hover;
  double speed = motion.speed;
  Joints command = at(plan.hover);
  Eigen::Vector3d at_hover = seen_.endpoint->force;
  for (bool first = true; !signed_tap.tap().done();) {
    const double before = set_point;
    const bool taring = signed_tap.tap().taring();
    const bool fresh = watch_.fresh();
    const Eigen::Vector3d reading = seen_.endpoint->force;
    const bool coming_down = signed_tap.tap().coming_down();
    const double beside = coming_down ? moving_ : 0.0;
    const double felt = reading.z() - beside;
    reaction_.late(watch_.lateness(), seen_.now);
    periods.add({seen_.now, height()}, signed_tap.tap().even_for());
    set_point = signed_tap.next(height(), felt, fresh);
    if (signed_tap.tap().noticed() > periods.noticed) periods.notice(signed_tap.tap().noticed());
    const double greatest = std::max(Reaction::kSlowest, reaction_.greatest_speed(motion.threshold, stiffness));
    if (greatest < speed) {
      speed = greatest;
      signed_tap.slow_to(speed);
      periods.restart(seen_.now);
    }
    if (set_point > before && sign_ != 0.0) {
      const double along = std::clamp(plan.hover + kFromAbove - height(), 0.0, column.length() - kTurned);
      watch_.expect_rise(Watch::Rise{signed_tap.zero(), sign_, most_pull(column, along)});
    }
    if (set_point < before) watch_.expect_rise(std::nullopt);
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
        const Eigen::Vector3d sum = std::accumulate(tare.begin(), tare.end(), Eigen::Vector3d(0, 0, 0));
        zero_ = sum / static_cast<double>(std::exchange(tare, {}).size());
        if (std::exchange(first, false)) at_hover = zero_;
        watch_.set_tare(zero_);
      }
    } else if (fresh) {
      const double zero = signed_tap.zero();
      const double against = sign_ == 0.0 ? std::abs(felt - zero) : sign_ * (felt - zero);
      peak_ = std::max(peak_.value_or(0.0), against);
      watch_.set_tare({zero_.x(), zero_.y(), zero + beside});
      // Once, high up: lower down the bias of another pose would be taken for that of the motion, and near what is
      // expected a soft contact.
      if (!moving && plan.start >= plan.hover) {
        if (const auto mean = even.add(signed_tap.tap().even_for(), reading.z())) moving = *mean - zero_.z();
      }
      // An arm that goes up rubs the other way, which is no pull.
      pulled = coming_down && sign_ * (felt - zero) < -motion.threshold ? pulled + 1 : 0;
      if (pulled >= kPulled) {
        throw Fault{
            "the force fell by more than the threshold where nothing can pull: its zero moved, or force_sign is "
            "wrong",
            Then::retreat};
      }
    }
    step(command);
  }
  const Contact contact = signed_tap.tap().result();
  retreat(column.back(plan.hover + kFromAbove - height()), signed_tap.sign(), signed_tap.zero(), contact);
  if (contact.outcome != Outcome::contact) return contact;
  rest_from_above(column);
  // The two zeros must be the same. Sideways the robot's estimate is at its worst.
  const Eigen::Vector3d moved = force_at_rest(at(plan.hover)) - at_hover;
  const double most = std::max(kLeastMoved, 0.5 * motion.threshold);
  if (!(std::abs(moved.z()) < most && moved.head<2>().norm() < options_.force_stop)) {
    return failed(Outcome::aborted,
                  "the force did not go back to its zero when the tool was clear: its zero moved during the tap, and "
                  "the contact may be none");
  }
  if (moving) learn_moving(*moving);
  if (!periods.at_notice.empty()) {
    // Something soft may have been touched that far above.
    const double free =
        std::max(contact.height, periods.at_notice.back().height + motion.threshold / tapping::GuardedTap::kSoftest);
    reaction_.learn_noticing(periods.at_notice, free, motion.threshold, stiffness);
  }
  shown_sign_ = signed_tap.sign();
  return contact;
}

/// Once a run, in the air above the first column: what the joints rub, by the force at rest after coming down and after
/// coming up. By virtual work a torque r in each of them takes r times turned() along the way.
void Tapper::learn_rubbing(const Path& column) {
  rest_from_above(column);
  const double down = force_at_rest(column.at(kFromAbove)).z();
  const Path up = column.back(kFromAbove);
  follow(up, std::min(motion_.speed, kToRest), up.length());
  settle(up.end());
  rubbing_ = std::min(kMostRubbing, std::abs(down - force_at_rest(up.end()).z()) / 2 / turned(up, 0.0));
}

/// N of a pull, against its zero at rest, that an arm may feel which goes up `along` this way and is not held.
double Tapper::most_pull(const Path& way, double along) const {
  if (!rubbing_) return options_.force_stop;
  return motion_.threshold + kRubs * 2 * *rubbing_ * turned(way, along);
}

/// Goes up from where it may press, of which only a pull is a fault. `zero`: of the force along z down there, N.
void Tapper::retreat(const Path& up, double sign, double zero, const Contact& contact) {
  watch_.forget_tare();
  const double touched = contact.outcome == Outcome::contact ? contact.height : height() + kGently - kClear;
  rise(up, std::clamp(touched - height(), 0.0, kMostGentle) + kClear, sign, zero);
}

/// Goes up gently until the tip has come up by `gently` (m), at most kFarther more while it presses; then faster. On
/// the first part what it presses with goes, and what its joints rub against turns around; then its zero follows the
/// pose. `zero`: N of the force along z of an arm that is free; without it what it feels after the first part is taken
/// for that.
void Tapper::rise(const Path& up, double gently, double sign, const std::optional<double>& zero) {
  const double limit = most_pull(up, 0.0);
  if (sign != 0.0 && zero) watch_.expect_rise(Watch::Rise{*zero, sign, limit});
  const double clear = height() + gently;
  const double surely = clear + kFarther;
  double speed = std::min(motion_.speed, kGentle);
  Eigen::Vector3d force = seen_.endpoint->force;
  const auto set_free = [&] {
    watch_.set_tare(force, Watch::Zero::follows);
    if (sign == 0.0) return;
    const double most = zero ? limit + kFaster : motion_.threshold + kFaster;
    watch_.expect_rise(Watch::Rise{zero.value_or(force.z()), sign, most, Watch::Zero::follows});
  };
  bool free = false;
  for (double along = 0.0; along < up.length();) {
    along = up.advance(along, speed, kPeriod);
    step(up.at(along));
    if (watch_.fresh()) force += kLatest * (seen_.endpoint->force - force);
    const bool presses = zero && sign * (force.z() - *zero) > motion_.threshold;
    if (height() < (presses ? surely : clear)) continue;
    if (!std::exchange(free, true)) set_free();
    speed = std::min(motion_.retreat_speed, speed + kSpeedUp * kPeriod);
  }
  await_height(up.end());
  if (!free) set_free();
}

std::string Tapper::learnt_sign() const {
  if (options_.sign() != BaxterOptions::ForceSign::learn || sign_ == 0.0) return {};
  return sign_ > 0.0 ? "positive" : "negative";
}

/// From the latest contact, once it is believed and is where it should be.
void Tapper::learn_sign() {
  if (sign_ != 0.0) return;
  sign_ = shown_sign_;
  note_("force_sign: when something presses the tool upwards, the force along z " +
        std::string(sign_ > 0.0 ? "rises: positive" : "falls: negative"));
}

/// What the force reads beside while the arm comes down in the air is no contact: from now on it counts as zero then.
void Tapper::learn_moving(double difference) {
  const bool much = std::abs(difference) >= kMostMoving * motion_.threshold;
  moving_ = much ? 0.0 : difference;
  if (told_ >= kTold) return;
  ++told_;
  note_("coming down in the air the force along z reads " + newtons(difference) + " beside that at rest" +
        (much
             ? ", too much to be taken for its zero: calibrate the robot (rosrun baxter_tools tare.py) or take a lower "
               "motion.speed"
             : ": taken for its zero while the arm comes down, from the next tap on"));
}

/// The median of a few new readings, while the arm is where it is sent: one of them may be far off.
Eigen::Vector3d Tapper::force_at_rest(const Joints& joints) {
  std::vector<Eigen::Vector3d> readings;
  const double patience = seen_.now + kForcePatience;
  while (readings.size() < kForceSamples && seen_.now < patience) {
    step(joints);
    if (watch_.fresh()) readings.push_back(seen_.endpoint->force);
  }
  if (readings.size() < kForceSamples) {
    throw Fault{"endpoint_state comes too seldom for the force at rest", Fault::Then::hold};
  }
  return median(std::move(readings));
}

}  // namespace palpate::baxter
