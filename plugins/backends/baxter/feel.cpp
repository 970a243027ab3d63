// SPDX-License-Identifier: MIT
// What Tapper makes of the force that the robot tells: its rest, its bound, the way up, and what it learns.
#include "baxter/tapper.hpp"
#include "baxter/words.hpp"
#include "tapping/motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace palpate::baxter {
namespace {

using tapping::newtons;
using Then = Fault::Then;

constexpr std::size_t kForceSamples = 25;        ///< new ones, for the force at rest
constexpr std::size_t kFewestForceSamples = 12;  ///< after kForcePatience, of a force that is renewed seldom
constexpr double kForcePatience = 1.0;           ///< s
constexpr double kMostForcePatience = 3.0;       ///< s
constexpr int kTold = 3;                         ///< taps of a run for which that is noted
constexpr double kMostMoving = 0.8;              ///< of the threshold: more may be a contact that begins

/// m above what it touched to where an arm goes up gently: there it is clear, and its joints rub the other way.
constexpr double kClear = 0.005;
constexpr double kFarther = 0.01;  ///< m that it goes on gently where it still presses: an onset is as inexact
constexpr double kRubs = 1.4;      ///< times as much as at rest, while the joints turn around and move
constexpr double kGentle = 0.01;   ///< m/s: an arm of 6.4 kN/m that is held feels 2 N more in three readings
constexpr double kSpeedUp = 0.15;  ///< m/s^2, afterwards
/// N that an arm reads less when it goes up faster, by its speed, and behind a zero that changes by 50 N/m.
constexpr double kFaster = 2.0;
constexpr double kMovingNoise = 0.5;     ///< N of it that may be noise: two deviations of 30 readings
constexpr double kLatest = 0.2;          ///< of a force that is followed, the part of the latest reading
constexpr double kToRest = 0.015;        ///< m/s, of the centimetre before a rest, where nothing should be
constexpr double kFirstThreshold = 5.0;  ///< N, until a contact was measured
constexpr double kMostRubbing = 0.5;     ///< Nm of a joint: more is something that touches the arm
constexpr double kStiffest = 8000.0;     ///< N/m of the arm where its posture is not known

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

}  // namespace

/// How far the joints turn for each metre of a way, `along` it: rad/m, all of them together.
double Tapper::turned(const Path& way, double along) {
  const double end = std::min(way.length(), along + kTurned);
  return (way.at(end) - way.at(along)).lpNorm<1>() / std::max(end - along, 1e-3);
}

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

/// The greatest speed (m/s) at which no contact is expected to exceed Reaction::kGreatestForce. Throws Fault, after
/// which `then` may be done, where that speed is too low to tap with.
double Tapper::greatest_speed(double threshold, double stiffness, Then then) const {
  const double greatest = reaction_.greatest_speed(threshold, stiffness);
  if (greatest >= reaction_.slowest()) return greatest;
  const char* const assumed = reaction_.measured() ? "" : "before the first measured contact it is assumed that ";
  throw Fault{fmt::format("{}a contact would be detected after {:.0f} ms and stopped {:.0f} ms later, messages are up "
                          "to {:.0f} ms late: at {:.1f} N this allows {:.2f} mm/s, but {:.0f} mm/s are needed. Connect "
                          "by cable, end other load, or choose a motion.threshold below {:.1f} N",
                          assumed, 1e3 * reaction_.noticing(), 1e3 * reaction_.stopping(), 1e3 * reaction_.lateness(),
                          threshold, 1e3 * greatest, 1e3 * reaction_.slowest(), threshold),
              then};
}

/// Takes how late messages are now, and how often the force is renewed.
void Tapper::measure_time() {
  reaction_.late(watch_.lateness(), seen_.now);
  reaction_.renewed_every(watch_.renewals().seconds());
}

/// The motion at speeds at which no contact is expected to exceed Reaction::kGreatestForce. Throws Fault where such a
/// speed is not worth having.
tapping::MotionOptions Tapper::bounded(tapping::MotionOptions motion, double stiffness) const {
  // Nobody knows yet how late this robot is: it is taken for the slowest that is driven.
  if (!reaction_.measured()) {
    motion.threshold = std::min(motion.threshold, kFirstThreshold);
    motion.fine_threshold = std::min(motion.fine_threshold, motion.threshold);
  }
  const double greatest = greatest_speed(motion.threshold, stiffness, Then::hold);
  const double configured = motion.speed;
  motion.speed = std::min(motion.speed, greatest);
  if (motion.type == tapping::MotionOptions::Type::two_stage)
    motion.fine_speed = std::min(motion.fine_speed, greatest_speed(motion.fine_threshold, stiffness, Then::hold));
  if (motion.adaptive_hover) motion.adaptive_hover->speed = std::min(motion.adaptive_hover->speed, greatest);
  const double way = motion.hover + motion.overrun;
  motion.timeout += way / motion.speed - way / configured;
  return motion;
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

/// N of a pull, against its zero at rest, that an arm may feel which goes up `along` this way and is not held: what its
/// joints rub, and what it was seen to read beside while it moves.
double Tapper::most_pull(const Path& way, double along) const {
  if (!rubbing_) return options_.force_stop;
  const double beside =
      std::max(std::abs(moving_), lately_.beside < kMostMoving * motion_.threshold ? lately_.beside : 0);
  return motion_.threshold + beside + kRubs * 2 * *rubbing_ * turned(way, along);
}

/// m/s at which an arm that goes up freely reads at most kFaster less than it is known to: that grows with its speed.
double Tapper::greatest_rise() const {
  const double surely = lately_.beside - kMovingNoise;
  if (surely <= 0.0) return motion_.retreat_speed;
  return std::min(motion_.retreat_speed, lately_.speed * (1.0 + kFaster / surely));
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
  // A pull is noticed as late as a contact.
  const double stiffness = arm_.vertical_stiffness(seen_.joints->position);
  double speed = std::min(
      {motion_.speed, kGentle, std::max(reaction_.slowest(), reaction_.greatest_speed(motion_.threshold, stiffness))});
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
    speed = std::min(greatest_rise(), speed + kSpeedUp * kPeriod);
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
  note_("force_sign: when an object presses the tool upwards, the force along z " +
        std::string(sign_ > 0.0 ? "rises: positive" : "falls: negative"));
}

/// What the force reads beside while the arm comes down in the air is no contact: from now on it counts as zero then.
void Tapper::learn_moving(double difference) {
  const bool much = std::abs(difference) >= kMostMoving * motion_.threshold;
  moving_ = much ? 0.0 : difference;
  if (told_ >= kTold) return;
  ++told_;
  note_("during the descent in air the force along z differs by " + newtons(difference) + " from its value at rest" +
        (much ? ", too much for a zero: calibrate the robot (rosrun baxter_tools tare.py) or lower motion.speed"
              : ": this is its zero during descents from the next tap on"));
}

/// The median of a few new readings, while the arm is where it is sent: one of them may be far off.
Eigen::Vector3d Tapper::force_at_rest(const Joints& joints) {
  std::vector<Eigen::Vector3d> readings;
  const double begin = seen_.now;
  const auto enough = [&] {
    return readings.size() >= (seen_.now < begin + kForcePatience ? kForceSamples : kFewestForceSamples);
  };
  while (!enough() && seen_.now < begin + kMostForcePatience) {
    step(joints);
    if (watch_.fresh()) readings.push_back(seen_.endpoint->force);
  }
  if (!enough()) {
    throw Fault{"endpoint_state is published too rarely to measure the force at rest", Fault::Then::hold};
  }
  return median(std::move(readings));
}

}  // namespace palpate::baxter
