// SPDX-License-Identifier: MIT
// Force sensing of Tapper: force at rest, speed limit, rise, friction, and sign.
#include "baxter/error_texts.hpp"
#include "baxter/tapper.hpp"
#include "tapping/motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace palpate::baxter {
namespace {

using AllowedAction = Fault::AllowedAction;

constexpr std::size_t kForceSamples = 25;        ///< number of new readings for the force at rest
constexpr std::size_t kFewestForceSamples = 12;  ///< minimum number of readings after kForcePatience
constexpr double kForcePatience = 1.0;           ///< s
constexpr double kMostForcePatience = 3.0;       ///< s after which the measurement has failed
constexpr int kLoggedTaps = 3;                   ///< number of taps per run whose force of motion is logged
/// Largest accepted force of the motion (difference between a free descent and rest), as a fraction of the threshold. A
/// larger difference may be the onset of a contact.
constexpr double kMostMoving = 0.8;

/// Clearance in m at which a slow rise ends: the tool is free, and the friction of the joints has changed its
/// direction.
constexpr double kClearance = 0.005;
/// m of additional slow rise while the arm still presses, because an onset is inexact
constexpr double kExtraRise = 0.01;
constexpr double kReversalFriction = 1.4;  ///< ratio of friction during a reversal to friction at rest
/// m/s: an arm of 6.4 kN/m whose tool is caught pulls 2 N more within three readings
constexpr double kGentleSpeed = 0.01;
constexpr double kAcceleration = 0.15;  ///< m/s^2, after the slow rise
/// Additional pull in N that a faster rise may show, because of its speed and of a zero that changes by 50 N per metre
/// of height.
constexpr double kSpeedPull = 2.0;
constexpr double kMovingNoise = 0.5;  ///< N: two standard deviations of the mean of 30 readings
constexpr double kSmoothing = 0.2;    ///< weight of the last reading in a moving average of the force
/// m/s, in the last centimetre before the arm rests; no object is expected there
constexpr double kSpeedToRest = 0.015;
constexpr double kFirstThreshold = 5.0;       ///< N, upper limit of the threshold until the first measured contact
constexpr double kLargestFriction = 0.5;      ///< Nm per joint; more means that something touches the arm
constexpr double kLargestStiffness = 8000.0;  ///< N/m, assumed for an unknown posture

/// Returns the median of each component; needs at least one reading.
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

/// Returns the sum of all joint rotations per metre of path at `along`, rad/m.
double Tapper::rotation_per_metre(const Path& way, double along) {
  const double end = std::min(way.length(), along + kRotationWindow);
  return (way.at(end) - way.at(along)).lpNorm<1>() / std::max(end - along, 1e-3);
}

/// Descends from the height of travel to `hover` and waits until the arm rests. Friction depends on the direction of
/// motion: at 0.4 Nm, the force at rest reads 9 N less after a rise than after a descent. So every force at rest is
/// measured after a descent.
void Tapper::rest_from_above(const Path& column) {
  settle(column.front());
  follow(column, std::min(motion_.speed, kSpeedToRest), kFromAbove);
  settle(column.at(kFromAbove));
}

/// Returns the largest vertical stiffness of the arm on its descent at `place`, N/m.
double Tapper::stiffness_at(const Target& place) const {
  double out = 0.0;
  std::optional<Joints> joints = untucked();
  for (const double height : {travel_height(), scene_.desk() + 0.5 * motion_.hover, scene_.desk()}) {
    joints = arm_.solve(planner_.pose(place, height), joints.value_or(untucked()));
    if (joints) out = std::max(out, arm_.vertical_stiffness(*joints));
  }
  return out > 0.0 ? out : kLargestStiffness;
}

/// Returns the greatest speed (m/s) at which the expected force of a contact is at most ReactionTime::kGreatestForce.
/// Throws Fault with the action `then` if this speed is too low for taps.
double Tapper::greatest_speed(double threshold, double stiffness, AllowedAction then) const {
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

/// Passes the lateness of messages and the period of the force to reaction_.
void Tapper::update_timing() {
  reaction_.late(guard_.lateness(), seen_.now);
  reaction_.renewed_every(guard_.renewals().seconds());
}

/// Returns `motion` with its speeds limited so that the expected force of a contact is at most
/// ReactionTime::kGreatestForce. Throws Fault if the limit is too low for taps.
tapping::MotionOptions Tapper::bounded(tapping::MotionOptions motion, double stiffness) const {
  // Before the first measured contact, the delays of the slowest supported robot are assumed, and the threshold is
  // lowered.
  if (!reaction_.measured()) {
    motion.threshold = std::min(motion.threshold, kFirstThreshold);
    motion.fine_threshold = std::min(motion.fine_threshold, motion.threshold);
  }
  const double greatest = greatest_speed(motion.threshold, stiffness, AllowedAction::hold);
  const double configured = motion.speed;
  motion.speed = std::min(motion.speed, greatest);
  if (motion.type == tapping::MotionOptions::Type::two_stage)
    motion.fine_speed =
        std::min(motion.fine_speed, greatest_speed(motion.fine_threshold, stiffness, AllowedAction::hold));
  if (motion.adaptive_hover) motion.adaptive_hover->speed = std::min(motion.adaptive_hover->speed, greatest);
  const double way = motion.hover + motion.overrun;
  motion.timeout += way / motion.speed - way / configured;
  return motion;
}

/// Measures the friction of the joints once per run, in the air above the first tap. The force at rest after a descent
/// differs from that after a rise. By the principle of virtual work, a friction torque of r in each joint changes the
/// force by r * rotation_per_metre().
void Tapper::measure_friction(const Path& column) {
  rest_from_above(column);
  const double down = force_at_rest(column.at(kFromAbove)).z();
  const Path up = column.back(kFromAbove);
  follow(up, std::min(motion_.speed, kSpeedToRest), up.length());
  settle(up.end());
  friction_ =
      std::min(kLargestFriction, std::abs(down - force_at_rest(up.end()).z()) / 2 / rotation_per_metre(up, 0.0));
}

/// Returns the largest pull in N, relative to the zero at rest, that a free arm can measure while it rises. `along`:
/// distance from the start of `way`, m. The causes are the friction of the joints and the motion itself.
double Tapper::largest_pull(const Path& way, double along) const {
  if (!friction_) return options_.force_stop;
  const double beside =
      std::max(std::abs(moving_), last_moving_.beside < kMostMoving * motion_.threshold ? last_moving_.beside : 0);
  return motion_.threshold + beside + kReversalFriction * 2 * *friction_ * rotation_per_metre(way, along);
}

/// Returns the greatest speed in m/s at which a free rise measures at most kSpeedPull (N) more pull than at the last
/// measured speed. The difference grows with the speed.
double Tapper::greatest_rise() const {
  const double surely = last_moving_.beside - kMovingNoise;
  if (surely <= 0.0) return motion_.retreat_speed;
  return std::min(motion_.retreat_speed, last_moving_.speed * (1.0 + kSpeedPull / surely));
}

/// Rises from a contact, or from the end of a descent without contact. During the rise, only a pull is a fault. `zero`:
/// force along z at the contact, N.
void Tapper::retreat(const Path& up, double sign, double zero, const tapping::HeightResult& contact) {
  guard_.forget_tare();
  const double touched = contact.outcome == Outcome::contact ? contact.height : height() + kGentleRise - kClearance;
  rise(up, std::clamp(touched - height(), 0.0, kMostGentleRise) + kClearance, sign, zero);
}

/// Rises slowly until the tip is `gently` metres higher, then faster. While the tool still presses, the slow part lasts
/// up to kExtraRise metres longer. During the slow part, the pressure disappears and friction changes its direction.
/// Afterwards the zero follows the force, because the bias of the force changes with the pose. `zero`: force along z of
/// a free arm, N; if absent, the force after the slow part takes its place.
void Tapper::rise(const Path& up, double gently, double sign, const std::optional<double>& zero) {
  const double limit = largest_pull(up, 0.0);
  if (sign != 0.0 && zero) guard_.expect_rise(MotionGuard::RiseLimits{*zero, sign, limit});
  const double clear = height() + gently;
  const double surely = clear + kExtraRise;
  // A pull is detected with the same delay as a contact, so the same limit of the speed applies.
  const double stiffness = arm_.vertical_stiffness(seen_.joints->position);
  double speed = std::min({motion_.speed, kGentleSpeed,
                           std::max(reaction_.slowest(), reaction_.greatest_speed(motion_.threshold, stiffness))});
  Eigen::Vector3d force = seen_.endpoint->force;
  const auto set_free = [&] {
    guard_.set_tare(force, MotionGuard::ZeroMode::follows);
    if (sign == 0.0) return;
    const double most = zero ? limit + kSpeedPull : motion_.threshold + kSpeedPull;
    guard_.expect_rise(MotionGuard::RiseLimits{zero.value_or(force.z()), sign, most, MotionGuard::ZeroMode::follows});
  };
  bool free = false;
  for (double along = 0.0; along < up.length();) {
    along = up.advance(along, speed, kPeriod);
    step(up.at(along));
    if (guard_.fresh()) force += kSmoothing * (seen_.endpoint->force - force);
    const bool presses = zero && sign * (force.z() - *zero) > motion_.threshold;
    if (height() < (presses ? surely : clear)) continue;
    if (!std::exchange(free, true)) set_free();
    speed = std::min(greatest_rise(), speed + kAcceleration * kPeriod);
  }
  await_height(up.end());
  if (!free) set_free();
}

std::string Tapper::learnt_sign() const {
  if (options_.sign() != BaxterOptions::ForceSign::learn || sign_ == 0.0) return {};
  return sign_ > 0.0 ? "positive" : "negative";
}

/// Adopts the sign of the last contact, once the contact is accepted.
void Tapper::learn_sign() {
  if (sign_ != 0.0) return;
  sign_ = shown_sign_;
  note_("force_sign: when an object presses the tool upwards, the force along z " +
        std::string(sign_ > 0.0 ? "rises: positive" : "falls: negative"));
}

/// Learns the difference of the force between free descent and rest, which is subtracted in later descents.
void Tapper::learn_moving(double difference) {
  const bool much = std::abs(difference) >= kMostMoving * motion_.threshold;
  moving_ = much ? 0.0 : difference;
  if (logged_ >= kLoggedTaps) return;
  ++logged_;
  note_("during the descent in air the force along z differs by " + tapping::newtons(difference) +
        " from its value at rest" +
        (much ? ", too much for a zero: calibrate the robot (rosrun baxter_tools tare.py) or lower motion.speed"
              : ": this is its zero during descents from the next tap on"));
}

/// Returns the median of several new readings with the arm held at `joints`. A median is robust to single outliers.
Eigen::Vector3d Tapper::force_at_rest(const Joints& joints) {
  std::vector<Eigen::Vector3d> readings;
  const double begin = seen_.now;
  const auto enough = [&] {
    return readings.size() >= (seen_.now < begin + kForcePatience ? kForceSamples : kFewestForceSamples);
  };
  while (!enough() && seen_.now < begin + kMostForcePatience) {
    step(joints);
    if (guard_.fresh()) readings.push_back(seen_.endpoint->force);
  }
  if (!enough())
    throw Fault{"endpoint_state is published too rarely to measure the force at rest", Fault::AllowedAction::hold};
  return median(std::move(readings));
}

}  // namespace palpate::baxter
