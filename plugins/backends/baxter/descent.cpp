// SPDX-License-Identifier: MIT
// Descent of Tapper: rest, speed limit, descent, rise, and acceptance of the contact.
#include "baxter/error_texts.hpp"
#include "baxter/tapper.hpp"
#include "tapping/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace palpate::baxter {
namespace {

using AllowedAction = Fault::AllowedAction;

/// A pull is a fault after kPullTime seconds of consecutive new readings. These are at least kFewestPullReadings and at
/// most kMostPullReadings readings.
constexpr double kMostPullReadings = 6.0;
constexpr double kFewestPullReadings = 3.0;
constexpr double kPullTime = 0.12;
/// s, start of the average of the force: an arm that lags 0.35 s then descends at constant speed
constexpr double kEvenFrom = 0.7;
/// s after the start of the descent at which averaging of the force ends; it ends later if there are fewer than
/// kFewestEven readings
constexpr double kEvenTo = 1.0;
constexpr std::size_t kFewestEven = 10;
/// Conditions for an arm that falls behind without a contact. A blocked arm presses with at least 0.5 * stiffness *
/// lag. It is a fault if this force exceeds the threshold by kBlockedForce (N) while the measured force is small. A lag
/// below kLeastLag (m) may come from a posture that sags more.
constexpr double kBlockedForce = 2.0;
constexpr double kLeastLag = 0.003;
/// number of consecutive readings near the force zero that exclude the start of a contact
constexpr int kQuietReadings = 3;
/// N, largest difference between the mean forces of the first and the second half of the readings; noise of 1.5 N
/// causes 0.55 N
constexpr double kSteadyForce = 1.5;
/// N: smallest limit of the change of the force zero during a tap; noise causes 0.4 N
constexpr double kLeastZeroChange = 2.5;

/// Mean force along z while the arm descends at constant speed and lags behind its set-point. Gives no result if the
/// force rises meanwhile, because a contact may begin.
class ConstantSpeedForce {
 public:
  /// Takes a reading `time` seconds after the set-point began to descend. Returns the mean once it is complete.
  std::optional<double> add(double time, double force) {
    if (time < kEvenFrom) forces_.clear();
    if (time < kEvenFrom || done_) return std::nullopt;
    done_ = time >= kEvenTo && forces_.size() >= kFewestEven;
    if (!done_) forces_.push_back(force);
    if (!done_) return std::nullopt;
    const std::vector<double> forces = std::exchange(forces_, {});
    const auto count = static_cast<Eigen::Index>(forces.size());
    const Eigen::Map<const Eigen::VectorXd> all(forces.data(), count);
    const double rise = all.tail(count - count / 2).mean() - all.head(count / 2).mean();
    return std::abs(rise) < kSteadyForce ? std::optional<double>(all.mean()) : std::nullopt;
  }

 private:
  std::vector<double> forces_;
  bool done_ = false;
};

/// Control periods in which the arm descends at constant speed. `now` has all periods so far, and `at_notice` those up
/// to the last detection of a contact.
struct ConstantSpeedPeriods {
  std::vector<ReactionTime::Period> now;
  std::vector<double> lags;  ///< m by which the tip trails its set-point in each period
  double least_lag = 0.0;    ///< m, minimum of lags
  std::vector<ReactionTime::Period> at_notice;
  int noticed = 0;
  double begin = 0.0;  ///< s

  /// Adds a period. `even_for`: seconds for which the set-point has descended at constant speed; 0 if it does not.
  void add(const ReactionTime::Period& period, double set_point, double even_for) {
    if (even_for < kEvenFrom) clear();
    if (even_for < kEvenFrom || period.time < begin) return;
    const double lag = period.height - set_point;
    least_lag = now.empty() ? lag : std::min(least_lag, lag);
    now.push_back(period);
    lags.push_back(lag);
  }
  void clear() {
    now.clear();
    lags.clear();
  }
  /// Discards all periods after a change of speed at `time`. Adds new periods once the arm descends at constant speed.
  void restart(double time) {
    clear();
    begin = time + kEvenFrom;
  }
  /// Returns the lag of the tip `ago` seconds before the last period, minus the least lag, metres; 0 if there was no
  /// such period.
  double behind(double ago) const {
    for (std::size_t i = now.size(); i > 0; --i) {
      if (now[i - 1].time <= now.back().time - ago) return lags[i - 1] - least_lag;
    }
    return 0.0;
  }
  void notice(int count) {
    noticed = count;
    at_notice = now;
  }
};

/// Guarded tap for an unknown sign of the force. Two taps, one per sign, run in parallel until one of them detects a
/// contact. That tap continues. If its contact is accepted, its sign is adopted as that of the robot.
class SignedTap {
  struct SignTrial {
    double sign;
    tapping::GuardedTap tap;
    double set_point = 0.0;
  };

 public:
  /// `sign`: sign of the force when an object presses the tool upwards, 1 or -1; 0 if unknown.
  SignedTap(const tapping::MotionOptions& motion, const tapping::Descent& descent, double sign) {
    const tapping::GuardedTap tap(motion, descent, tapping::GuardedTap::ArmKind::real);
    taps_ = sign != 0.0 ? std::vector<SignTrial>{{sign, tap}} : std::vector<SignTrial>{{-1.0, tap}, {1.0, tap}};
  }

  /// Calls GuardedTap::next() for each sign. `force`: force along z as the robot reports it, N.
  double next(double height, double force, bool fresh) {
    for (SignTrial& one : taps_) one.set_point = one.tap.next(height, one.sign * force, fresh);
    if (taps_.size() == 2 && taps_.front().set_point != taps_.back().set_point) {
      // The tap that detects the contact sets its set-point to the height of the arm.
      const bool second = taps_.back().set_point == height;
      taps_.erase(second ? taps_.begin() : taps_.begin() + 1);
    }
    return taps_.front().set_point;
  }

  void slow_to(double speed) {
    for (SignTrial& one : taps_) one.tap.slow_to(speed);
  }
  const tapping::GuardedTap& tap() const { return taps_.front().tap; }
  /// Returns the zero of the force along z, with the robot's sign.
  double zero() const { return taps_.front().sign * tap().zero(); }
  /// Returns the sign of the force; 0 while it is unknown.
  double sign() const { return taps_.size() == 1 ? taps_.front().sign : 0.0; }

 private:
  std::vector<SignTrial> taps_;
};

}  // namespace

/// State of a descent: plan, position, and measured forces.
struct Tapper::DescentState {
  const Path& column;
  tapping::MotionOptions motion;  ///< limited to the allowed speed
  double stiffness;               ///< N/m, stiffness of the arm
  tapping::Descent plan;
  SignedTap tap;
  Eigen::Vector3d at_hover;  ///< N, force at the first tare
  Joints command;
  double set_point = plan.hover;
  double speed = motion.speed;
  bool tared = false;
  bool goes_up = false;
  std::vector<Eigen::Vector3d> tare = {};  ///< readings of the current tare
  ConstantSpeedForce even = {};
  std::optional<double> moving = {};  ///< N along z: force of a free descent minus force at rest
  ConstantSpeedPeriods periods = {};
  int pulled = 0;  ///< number of consecutive readings with a pull
  int quiet = 0;   ///< number of consecutive readings that differ from the zero by less than half the threshold

  Joints at(double height) const { return column.at(plan.hover + kFromAbove - height); }
};

tapping::HeightResult Tapper::descend(const TapRequest& request, const tapping::MotionOptions& wanted,
                                      const Path& column) {
  if (!friction_) measure_friction(column);
  rest_from_above(column);
  const double stiffness = stiffness_at(request.line.target());
  update_timing();
  const tapping::MotionOptions motion = bounded(wanted, stiffness);
  note_(fmt::format(
      "tap {}: {:.1f} mm/s on springs of {:.1f} kN/m; a contact is detected after {:.0f} ms and stopped {:.0f} ms "
      "later, messages are up to {:.0f} ms late; at most {} are expected",
      request.number, 1e3 * motion.speed, 1e-3 * stiffness, 1e3 * reaction_.noticing(), 1e3 * reaction_.stopping(),
      1e3 * reaction_.lateness(),
      tapping::newtons(reaction_.expected_force(motion.threshold, motion.speed, stiffness))));
  last_moving_ = {std::abs(moving_), motion.speed};
  const tapping::Descent plan = tapping::plan_descent(motion, scene_.desk(), request.predicted);
  DescentState way{column, motion, stiffness, plan, SignedTap(motion, plan, sign_), seen_.endpoint->force, {}};
  way.command = way.at(plan.hover);
  while (!way.tap.tap().done()) {
    update(way);
    step(way.command);
  }
  const tapping::HeightResult contact = way.tap.tap().result();
  retreat(column.back(plan.hover + kFromAbove - height()), way.tap.sign(), way.tap.zero(), contact);
  return contact.outcome == Outcome::contact ? accept(way, contact) : contact;
}

/// Executes one period of a descent: evaluates the force and sets the next command.
void Tapper::update(DescentState& way) {
  const bool taring = way.tap.tap().taring();
  const bool coming_down = way.tap.tap().coming_down();
  const double beside = coming_down ? moving_ : 0.0;
  const double felt = seen_.endpoint->force.z() - beside;
  update_timing();
  way.periods.add({seen_.now, height()}, way.set_point, way.tap.tap().even_for());
  const double before = std::exchange(way.set_point, way.tap.next(height(), felt, guard_.fresh()));
  if (way.tap.tap().noticed() > way.periods.noticed) way.periods.notice(way.tap.tap().noticed());
  if (!taring && !way.tap.tap().presses_no_further()) slow_down(way);
  const double sign = way.tap.sign();
  // Called once per rise, because a new call resets the count of readings with a pull.
  if (way.set_point > before && !way.goes_up && sign != 0.0) {
    const double along = std::clamp(way.plan.hover + kFromAbove - height(), 0.0, way.column.length() - kRotationWindow);
    guard_.expect_rise(MotionGuard::RiseLimits{way.tap.zero(), sign, largest_pull(way.column, along)});
  }
  if (way.set_point < before) guard_.expect_rise(std::nullopt);
  if (way.set_point != before) way.goes_up = way.set_point > before;
  // A set-point at the height of the arm is a request to stop. The command is then the measured joints, which stops
  // every joint and not only the tip.
  if (way.set_point == height() && way.set_point != before) {
    way.command = seen_.joints->position;
  } else if (way.set_point != before) {
    way.command = way.at(way.set_point);
  }
  if (taring) return tare(way);
  if (guard_.fresh()) evaluate_force(way, felt, beside, coming_down);
  expect_following(way);
}

/// Throws Fault if the arm falls behind its set-point without a contact force. Something then blocks the arm, and it
/// would jump down to its set-point once it comes free.
void Tapper::expect_following(const DescentState& way) const {
  if (way.quiet < kQuietReadings || way.tap.tap().done()) return;
  const double behind = way.periods.behind(reaction_.noticing() + reaction_.lateness());
  if (behind < std::max(kLeastLag, 2.0 * (way.motion.threshold + kBlockedForce) / way.stiffness)) return;
  throw Fault{fmt::format("the arm does not follow: it stays {:.1f} mm behind its set-point without a contact force. "
                          "Check what blocks it, and whether other programs command it",
                          1e3 * behind),
              AllowedAction::hold};
}

/// Reduces the speed if messages become later or the force is renewed less often, because less time is then left to
/// stop.
void Tapper::slow_down(DescentState& way) {
  const double greatest = greatest_speed(way.motion.threshold, way.stiffness, AllowedAction::retreat);
  if (greatest >= way.speed) return;
  way.speed = greatest;
  way.tap.slow_to(greatest);
  way.periods.restart(seen_.now);
}

/// Averages the readings of a tare and passes the zero to the safety rules, because the bias of the force depends on
/// the pose.
void Tapper::tare(DescentState& way) {
  if (guard_.fresh()) way.tare.push_back(seen_.endpoint->force);
  way.pulled = 0;
  if (way.tap.tap().taring() || way.tap.tap().done()) return;
  const Eigen::Vector3d sum = std::accumulate(way.tare.begin(), way.tare.end(), Eigen::Vector3d(0, 0, 0));
  zero_ = sum / static_cast<double>(std::exchange(way.tare, {}).size());
  if (!std::exchange(way.tared, true)) way.at_hover = zero_;
  guard_.set_tare(zero_);
}

/// Evaluates a new reading during the descent. `beside`: force of the motion in N, the difference between a free
/// descent and rest. `felt`: measured force along z minus the force of the motion (N).
void Tapper::evaluate_force(DescentState& way, double felt, double beside, bool coming_down) {
  const double zero = way.tap.zero();
  const double against = sign_ == 0.0 ? std::abs(felt - zero) : sign_ * (felt - zero);
  peak_ = std::max(peak_.value_or(0.0), against);
  const bool two_stage = way.motion.type == tapping::MotionOptions::Type::two_stage;
  const double least = two_stage ? std::min(way.motion.threshold, way.motion.fine_threshold) : way.motion.threshold;
  way.quiet = std::abs(felt - zero) < 0.5 * least ? way.quiet + 1 : 0;
  // force_stop does not apply while the arm stops at a contact: noise may raise the force of the contact above it.
  if (way.tap.tap().presses_no_further()) {
    guard_.forget_tare();
  } else {
    guard_.set_tare({zero_.x(), zero_.y(), zero + beside});
  }
  // The force of motion is measured once, high above the desk. Lower down, the bias of another pose would be counted as
  // force of motion. Near the expected surface, a soft contact would be counted, too.
  if (!way.moving && way.plan.start >= way.plan.hover) {
    const auto mean = way.even.add(way.tap.tap().even_for(), seen_.endpoint->force.z());
    if (mean) way.moving = *mean - zero_.z();
    if (mean) last_moving_ = {std::abs(*way.moving), way.speed};
  }
  // Friction of a rising arm has the opposite sign, so only readings during a descent count.
  way.pulled = coming_down && sign_ * (felt - zero) < -way.motion.threshold ? way.pulled + 1 : 0;
  if (way.pulled < std::clamp(kPullTime / guard_.renewals().seconds(), kFewestPullReadings, kMostPullReadings)) return;
  throw Fault{
      "the force fell by more than the threshold although nothing can pull: its zero moved, or force_sign is wrong",
      AllowedAction::retreat};
}

/// Accepts the contact if the force at rest is the same as before the tap. The limit is larger for sideways forces,
/// where the robot's estimate is worst. An accepted contact updates the estimates of the reaction time and of the force
/// of motion.
tapping::HeightResult Tapper::accept(const DescentState& way, const tapping::HeightResult& contact) {
  rest_from_above(way.column);
  const Eigen::Vector3d moved = force_at_rest(way.at(way.plan.hover)) - way.at_hover;
  const double most = std::max(kLeastZeroChange, 0.5 * way.motion.threshold);
  if (!(std::abs(moved.z()) < most && moved.head<2>().norm() < options_.force_stop))
    return failed(Outcome::aborted,
                  "the force did not return to its zero after the tool was clear: its zero moved during the tap, and "
                  "the contact may be false");
  if (way.moving) learn_moving(*way.moving);
  // Other motions do not measure the height of the onset.
  const bool at_onset = way.motion.type == tapping::MotionOptions::Type::continuous;
  reaction_.learn_noticing(way.periods.at_notice, at_onset ? std::optional<double>(contact.height) : std::nullopt,
                           way.motion.threshold, way.stiffness);
  shown_sign_ = way.tap.sign();
  return contact;
}

}  // namespace palpate::baxter
