// SPDX-License-Identifier: MIT
// One descent of Tapper: it rests, bounds its speed, comes down, goes up and judges.
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

/// New readings of a force that pulls, in kPulledFor seconds: what moving takes away from it is noisy.
constexpr double kPulled = 6.0;
constexpr double kFewestPulled = 3.0;
constexpr double kPulledFor = 0.12;
constexpr double kEvenFrom = 0.7;  ///< s after which an arm that trails by 0.35 s comes down evenly
constexpr double kEvenTo = 1.0;    ///< s until which its force is averaged, longer if there are fewer readings than
constexpr std::size_t kFewestEven = 10;
/// An arm that its springs hold presses with at least half of its stiffness times the way by which it stays behind; so
/// much more than the threshold, N, must be felt of it. Less than kLeastBehind, m, may be a posture that sags more.
constexpr double kPressed = 2.0;
constexpr double kLeastBehind = 0.003;
constexpr int kQuiet = 3;  ///< readings within half the threshold, one after the other: no contact has fewer above it
constexpr double kSteady = 1.5;      ///< N from the first half of it to the second: noise of 1.5 N makes 0.55
constexpr double kLeastMoved = 2.5;  ///< N that the zero may move, whatever the threshold: noise makes 0.4

/// The mean force along z of a descent from when the arm, which trails its set-point, comes down evenly until shortly
/// after. Where it rises meanwhile a contact begins: that is no force of a moving arm.
class EvenDescent {
 public:
  /// Takes a reading `time` seconds after the set-point began to come down; the mean when it is there.
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
    return std::abs(rise) < kSteady ? std::optional<double>(all.mean()) : std::nullopt;
  }

 private:
  std::vector<double> forces_;
  bool done_ = false;
};

/// The periods in which the set-point comes down evenly, those up to now and those up to the latest notice.
struct EvenPeriods {
  std::vector<Reaction::Period> now;
  std::vector<double> lags;  ///< m by which the tip trails its set-point in each of them
  double least_lag = 0.0;    ///< m, of them all
  std::vector<Reaction::Period> at_notice;
  int noticed = 0;
  double begin = 0.0;  ///< s

  /// `even_for`: since when it comes down so, seconds; 0 if it does not.
  void add(const Reaction::Period& period, double set_point, double even_for) {
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
  /// Begins anew once an arm that is slowed down at `time` comes down evenly again.
  void restart(double time) {
    clear();
    begin = time + kEvenFrom;
  }
  /// How much farther than at its nearest the tip trailed its set-point `ago` (s), metres; 0 while it did not come
  /// down.
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

}  // namespace

/// A way down: what it goes by, where it is, and what it has felt.
struct Tapper::WayDown {
  const Path& column;
  tapping::MotionOptions motion;  ///< bounded
  double stiffness;               ///< N/m, of the arm
  tapping::Descent plan;
  SignedTap tap;
  Eigen::Vector3d at_hover;  ///< N, the force of the first tare
  Joints command;
  double set_point = plan.hover;
  double speed = motion.speed;
  bool tared = false;
  bool goes_up = false;
  std::vector<Eigen::Vector3d> tare = {};  ///< readings of one that goes on
  EvenDescent even = {};
  std::optional<double> moving = {};  ///< N along z that an arm which comes down reads beside that at rest
  EvenPeriods periods = {};
  int pulled = 0;  ///< readings, one after the other
  int quiet = 0;   ///< readings, one after the other

  Joints at(double height) const { return column.at(plan.hover + kFromAbove - height); }
};

Contact Tapper::descend(const TapRequest& request, const tapping::MotionOptions& wanted, const Path& column) {
  if (!rubbing_) learn_rubbing(column);
  rest_from_above(column);
  const double stiffness = stiffness_at(request.target);
  measure_time();
  const tapping::MotionOptions motion = bounded(wanted, stiffness);
  note_(fmt::format(
      "tap {}: {:.1f} mm/s on springs of {:.1f} kN/m; a contact is detected after {:.0f} ms and stopped {:.0f} ms "
      "later, messages are up to {:.0f} ms late; at most {} are expected",
      request.number, 1e3 * motion.speed, 1e-3 * stiffness, 1e3 * reaction_.noticing(), 1e3 * reaction_.stopping(),
      1e3 * reaction_.lateness(), newtons(reaction_.expected_force(motion.threshold, motion.speed, stiffness))));
  lately_ = {std::abs(moving_), motion.speed};
  const tapping::Descent plan = tapping::plan_descent(motion, scene_.desk(), request.predicted);
  WayDown way{column, motion, stiffness, plan, SignedTap(motion, plan, sign_), seen_.endpoint->force, {}};
  way.command = way.at(plan.hover);
  while (!way.tap.tap().done()) {
    lead(way);
    step(way.command);
  }
  const Contact contact = way.tap.tap().result();
  retreat(column.back(plan.hover + kFromAbove - height()), way.tap.sign(), way.tap.zero(), contact);
  return contact.outcome == Outcome::contact ? judge(way, contact) : contact;
}

/// One period of a way down: takes what the arm feels and sets the next command.
void Tapper::lead(WayDown& way) {
  const bool taring = way.tap.tap().taring();
  const bool coming_down = way.tap.tap().coming_down();
  const double beside = coming_down ? moving_ : 0.0;
  const double felt = seen_.endpoint->force.z() - beside;
  measure_time();
  way.periods.add({seen_.now, height()}, way.set_point, way.tap.tap().even_for());
  const double before = std::exchange(way.set_point, way.tap.next(height(), felt, watch_.fresh()));
  if (way.tap.tap().noticed() > way.periods.noticed) way.periods.notice(way.tap.tap().noticed());
  if (!taring && !way.tap.tap().presses_no_further()) slow_down(way);
  const double sign = way.tap.sign();
  // Once for each way up: a new expectation forgets the readings that pulled.
  if (way.set_point > before && !way.goes_up && sign != 0.0) {
    const double along = std::clamp(way.plan.hover + kFromAbove - height(), 0.0, way.column.length() - kTurned);
    watch_.expect_rise(Watch::Rise{way.tap.zero(), sign, most_pull(way.column, along)});
  }
  if (way.set_point < before) watch_.expect_rise(std::nullopt);
  if (way.set_point != before) way.goes_up = way.set_point > before;
  // A set-point put where the arm is means: stop. The measured joints stop every joint, not the tip alone.
  if (way.set_point == height() && way.set_point != before) {
    way.command = seen_.joints->position;
  } else if (way.set_point != before) {
    way.command = way.at(way.set_point);
  }
  if (taring) return tare(way);
  if (watch_.fresh()) feel_free(way, felt, beside, coming_down);
  expect_descent(way);
}

/// An arm that falls behind and feels nothing stands for another reason than a contact. When it comes free it would
/// jump down to its set-point.
void Tapper::expect_descent(const WayDown& way) const {
  if (way.quiet < kQuiet || way.tap.tap().done()) return;
  const double behind = way.periods.behind(reaction_.noticing() + reaction_.lateness());
  if (behind < std::max(kLeastBehind, 2.0 * (way.motion.threshold + kPressed) / way.stiffness)) return;
  throw Fault{fmt::format("the arm does not follow: it stays {:.1f} mm behind its set-point without a contact force. "
                          "Check what blocks it, and whether other programs command it",
                          1e3 * behind),
              Then::hold};
}

/// Messages that come later than before, or a force that is renewed more seldom, leave less time to stop.
void Tapper::slow_down(WayDown& way) {
  const double greatest = greatest_speed(way.motion.threshold, way.stiffness, Then::retreat);
  if (greatest >= way.speed) return;
  way.speed = greatest;
  way.tap.slow_to(greatest);
  way.periods.restart(seen_.now);
}

/// The bias of the force depends on the pose: every tare of the tap is one for the rules, too.
void Tapper::tare(WayDown& way) {
  if (watch_.fresh()) way.tare.push_back(seen_.endpoint->force);
  way.pulled = 0;
  if (way.tap.tap().taring() || way.tap.tap().done()) return;
  const Eigen::Vector3d sum = std::accumulate(way.tare.begin(), way.tare.end(), Eigen::Vector3d(0, 0, 0));
  zero_ = sum / static_cast<double>(std::exchange(way.tare, {}).size());
  if (!std::exchange(way.tared, true)) way.at_hover = zero_;
  watch_.set_tare(zero_);
}

/// Takes a new reading of an arm that comes down: `felt` is that along z without `beside` (N), which moving makes.
void Tapper::feel_free(WayDown& way, double felt, double beside, bool coming_down) {
  const double zero = way.tap.zero();
  const double against = sign_ == 0.0 ? std::abs(felt - zero) : sign_ * (felt - zero);
  peak_ = std::max(peak_.value_or(0.0), against);
  const bool two_stage = way.motion.type == tapping::MotionOptions::Type::two_stage;
  const double least = two_stage ? std::min(way.motion.threshold, way.motion.fine_threshold) : way.motion.threshold;
  way.quiet = std::abs(felt - zero) < 0.5 * least ? way.quiet + 1 : 0;
  // Of an arm that is being stopped the force is the contact's, and noise may take that above force_stop.
  if (way.tap.tap().presses_no_further()) {
    watch_.forget_tare();
  } else {
    watch_.set_tare({zero_.x(), zero_.y(), zero + beside});
  }
  // Once, high up: lower down the bias of another pose would be taken for that of the motion, and near what is
  // expected a soft contact.
  if (!way.moving && way.plan.start >= way.plan.hover) {
    const auto mean = way.even.add(way.tap.tap().even_for(), seen_.endpoint->force.z());
    if (mean) way.moving = *mean - zero_.z();
    if (mean) lately_ = {std::abs(*way.moving), way.speed};
  }
  // An arm that goes up rubs the other way, which is no pull.
  way.pulled = coming_down && sign_ * (felt - zero) < -way.motion.threshold ? way.pulled + 1 : 0;
  if (way.pulled < std::clamp(kPulledFor / watch_.renewals().seconds(), kFewestPulled, kPulled)) return;
  throw Fault{
      "the force fell by more than the threshold although nothing can pull: its zero moved, or force_sign is wrong",
      Then::retreat};
}

/// The contact, if the force at rest is what it was before: sideways the robot's estimate is at its worst. What the tap
/// has shown of the robot is learnt.
Contact Tapper::judge(const WayDown& way, const Contact& contact) {
  rest_from_above(way.column);
  const Eigen::Vector3d moved = force_at_rest(way.at(way.plan.hover)) - way.at_hover;
  const double most = std::max(kLeastMoved, 0.5 * way.motion.threshold);
  if (!(std::abs(moved.z()) < most && moved.head<2>().norm() < options_.force_stop)) {
    return failed(Outcome::aborted,
                  "the force did not return to its zero after the tool was clear: its zero moved during the tap, and "
                  "the contact may be false");
  }
  if (way.moving) learn_moving(*way.moving);
  // The height of the other motions is not that of the beginning.
  const bool at_onset = way.motion.type == tapping::MotionOptions::Type::continuous;
  reaction_.learn_noticing(way.periods.at_notice, at_onset ? std::optional<double>(contact.height) : std::nullopt,
                           way.motion.threshold, way.stiffness);
  shown_sign_ = way.tap.sign();
  return contact;
}

}  // namespace palpate::baxter
