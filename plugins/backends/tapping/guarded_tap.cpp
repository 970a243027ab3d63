// SPDX-License-Identifier: MIT
#include "tapping/guarded_tap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::tapping {
namespace {

/// Number of consecutive readings above the threshold that count as a contact; fewer may be noise.
constexpr int kConsecutive = 3;
/// Distance in m at which the arm counts as arrived at its goal. An arm also counts as arrived if its distance to the
/// goal has not decreased by kArrivalTolerance for kBlockedTime seconds, because something blocks it.
constexpr double kArrivalTolerance = 0.001;
constexpr double kBlockedTime = 2.0;
/// Lag in s of the arm behind its set-point. After a change of the set-point, the arm does not move during this time.
constexpr double kArmLag = 0.35;
/// Time in s after which the arm descends at constant speed.
constexpr double kConstantSpeedTime = 0.7;

/// Averages groups of consecutive samples, so that at most kMostSamples remain. The search for an onset takes quadratic
/// time, and the arm waits for it.
std::vector<Sample> thinned(const std::vector<Sample>& samples) {
  constexpr std::size_t kMostSamples = 400;
  const std::size_t size = samples.size() / kMostSamples + 1;
  if (size == 1) return samples;
  std::vector<Sample> out;
  for (std::size_t begin = 0; begin < samples.size(); begin += size) {
    const std::size_t end = std::min(samples.size(), begin + size);
    const auto count = static_cast<double>(end - begin);
    Sample mean{0.0, 0.0};
    for (std::size_t i = begin; i < end; ++i) {
      mean.height += samples[i].height / count;
      mean.force += samples[i].force / count;
    }
    out.push_back(mean);
  }
  return out;
}

}  // namespace

GuardedTap::GuardedTap(const MotionOptions& motion, const Descent& descent, ArmKind arm)
    : motion_(motion),
      descent_(descent),
      arm_(arm),
      set_point_(descent.hover),
      free_(motion.threshold / kSoftest, descent.hover) {}

double GuardedTap::next(double height, double force, bool fresh) {
  if (done()) return set_point_;
  ++periods_;
  if (fresh) evaluate(height, force);
  if (seconds() > motion_.timeout) {
    finish({Outcome::timeout, 0.0, 0.0, 0.0, kTooLong});
    return set_point_;
  }
  if (stage_ == Stage::pause) tare_in_pause();
  if (above_ < kConsecutive || !react(height)) advance(height);
  return set_point_;
}

/// Reacts to a detected contact. Returns false in stages that ignore contacts.
bool GuardedTap::react(double height) {
  switch (stage_) {
    case Stage::approach:
    case Stage::unwind:
      set_point_ = height;
      enter(stage_ == Stage::approach ? Stage::clear : Stage::back_off);
      return true;
    case Stage::descend:
    case Stage::pause:
    case Stage::bottom:
      start_reaction(height);
      return true;
    case Stage::fine:
      finish({Outcome::contact, height, peak_, 0.0, {}});
      return true;
    default:
      return false;
  }
}

/// Continues the stage by one period without a contact.
void GuardedTap::advance(double height) {
  switch (stage_) {
    case Stage::tare:
    case Stage::settle:
      return finish_tare();
    case Stage::approach:
      if (descent_.start >= descent_.hover || ramp(descent_.start, motion_.adaptive_hover->speed))
        enter(Stage::descend);
      break;
    case Stage::clear:
      if (ramp(goal_, motion_.adaptive_hover->speed) && arrived(height)) enter(Stage::descend);
      break;
    case Stage::descend:
      if (ramp(goal_, motion_.speed)) enter(motion_.type == MotionOptions::Type::paper ? Stage::pause : Stage::bottom);
      break;
    case Stage::pause:
      if (waited(motion_.pause)) enter(set_point_ <= descent_.floor ? Stage::bottom : Stage::descend);
      break;
    case Stage::rest:
      if (waited(motion_.pause) && averaged(kFewestWatched)) conclude_at_rest(height);
      break;
    case Stage::back_off:
      if (ramp(goal_, motion_.speed) && arrived(height)) enter(arm_ == ArmKind::real ? Stage::unwind : Stage::settle);
      break;
    case Stage::unwind:
      if (ramp(goal_, motion_.fine_speed) && arrived(height)) enter(Stage::settle);
      break;
    case Stage::fine:
      if (ramp(goal_, motion_.fine_speed)) enter(Stage::descend);
      break;
    case Stage::stop:
      if (waited(kWatched) && averaged(kFewestWatched)) conclude_at_onset();
      break;
    case Stage::bottom:
      if (arrived(height)) finish({Outcome::no_contact, 0.0, 0.0, 0.0, "the descent ended without a contact"});
      break;
    case Stage::done:
      break;
  }
}

/// Ends a tare once its time has passed. The mean force becomes the zero.
void GuardedTap::finish_tare() {
  if (!waited(stage_ == Stage::tare ? motion_.tare : motion_.pause) || summed_ == 0 || !averaged(kFewestTared)) return;
  zero_ = sum_ / summed_;
  free_.tare(zero_);
  enter(stage_ == Stage::settle ? Stage::fine : Stage::approach);
}

/// Tares a real arm at the end of a pause, when it rests. A force change of half the threshold may be a contact, so the
/// tare does not remove it.
void GuardedTap::tare_in_pause() {
  if (arm_ != ArmKind::real || !waited(motion_.pause) || summed_ == 0) return;
  const double mean = sum_ / summed_;
  if (std::abs(mean - zero_) < 0.5 * motion_.threshold) {
    zero_ = mean;
    free_.tare(zero_);
  }
}

void GuardedTap::slow_to(double speed) {
  if (motion_.adaptive_hover) motion_.adaptive_hover->speed = std::min(motion_.adaptive_hover->speed, speed);
  motion_.fine_speed = std::min(motion_.fine_speed, speed);
  if (speed >= motion_.speed) return;
  const double left = std::max(0.0, set_point_ - descent_.floor);
  motion_.timeout += left / speed - left / motion_.speed;
  motion_.speed = speed;
}

void GuardedTap::give_up(double height) {
  if (done() || given_up_) return;
  given_up_ = true;
  first_ = height;
  set_point_ = std::min(descent_.hover, height + std::max(motion_.brake, kFromAbove));
  enter(Stage::stop);
}

/// Evaluates a new reading according to the stage.
void GuardedTap::evaluate(double height, double force) {
  const bool in_pause = arm_ == ArmKind::real && stage_ == Stage::pause && waited(motion_.pause - motion_.tare);
  const bool stopped =
      (stage_ == Stage::stop || stage_ == Stage::rest) && (!waited(kWatched + kPeriod) || !averaged(kFewestWatched));
  if (taring() || in_pause || stopped) {
    sum_ += force;
    ++summed_;
  }
  if (taring()) return;
  const bool descending = stage_ == Stage::descend || stage_ == Stage::bottom;
  if (arm_ == ArmKind::real && descending) {
    zero_ = free_.line(height).at(height);
    if (even_for() >= kConstantSpeedTime) free_.add({height, force});
  }
  const double felt = force - zero_;
  peak_ = std::max(peak_, felt);
  above_ = felt > threshold() ? above_ + 1 : 0;
  const bool paused = arm_ == ArmKind::real && (stage_ == Stage::pause || stage_ == Stage::rest);
  if (descending || stage_ == Stage::stop || paused) trace_.push_back({height, force});
}

/// Accepts the contact, or continues the descent. After a true contact, the mean of the following readings stays high;
/// after noise, it does not. Even the mean of a true contact may be below the threshold, because an arm that stops
/// relaxes its springs, especially on soft objects.
void GuardedTap::conclude(const Rise& found) {
  // While an arm brakes, it presses less, so the mean is lower.
  const bool relaxes = motion_.brake > 0.0 || arm_ == ArmKind::real;
  const double least = relaxes ? 0.5 * motion_.threshold : motion_.threshold;
  const bool presses = summed_ == 0 || sum_ / summed_ - zero_ > least;
  const bool lasts = found.is_contact && presses;
  const bool asks = arm_ == ArmKind::real || motion_.confirm;
  if (given_up_ && !lasts) return finish({Outcome::aborted, 0.0, 0.0, 0.0, kStoppedByItself});
  const bool again = arm_ == ArmKind::real && found.is_contact && refused_ && std::abs(*refused_ - first_) < kSamePlace;
  if (!asks || lasts || again) return finish({Outcome::contact, found.height, peak_, 0.0, {}});
  if (found.is_contact) refused_ = first_;
  if (presses && !found.is_contact && too_soft())
    return finish({Outcome::aborted, 0.0, 0.0, 0.0,
                   fmt::format("a contact is too soft: its force rises by {:.0f} N/m, but an object needs {:.0f} N/m "
                               "from at most {:.0f} cm above, to differ from a zero that changes with the pose",
                               found.slope, kSoftestRise, 100.0 * kFarthestOnset)});
  enter(Stage::descend);
}

/// Counts contacts whose force lasts but rises too slowly. Returns whether kMostSoft of them occurred at one height.
bool GuardedTap::too_soft() {
  if (softs_ == 0 || std::abs(soft_ - first_) > kFarthestOnset) {
    soft_ = first_;
    softs_ = 0;
  }
  return ++softs_ >= kMostSoft;
}

/// Ends the standstill of the motion `paper`. The result is the height of the resting arm.
void GuardedTap::conclude_at_rest(double height) {
  Rise found = arm_ == ArmKind::simulated ? Rise{height, true, 0.0} : rise();
  found.height = height;
  conclude(found);
}

/// Ends a `continuous` motion with the height of the onset.
void GuardedTap::conclude_at_onset() {
  if (arm_ == ArmKind::simulated) return conclude({onset_of_descent(trace_).value_or(first_), true, 0.0});
  conclude(rise());
}

/// Returns onset and slope of a real arm's force relative to the line of free travel.
GuardedTap::Rise GuardedTap::rise() const {
  const FreeForce::LinearForce free = free_.line(first_);
  std::vector<Sample> above;
  for (const Sample& one : trace_) {
    if (one.height < first_ + 2.0 * kFarthestOnset) above.push_back({one.height, one.force - free.at(one.height)});
  }
  above = thinned(above);
  const std::optional<double> found = onset_of_descent(above);
  const double slope = found ? slope_below(above, *found) : 0.0;
  const bool is_contact = found && *found - first_ < kFarthestOnset && slope > kSoftestRise;
  return {is_contact ? *found : first_, is_contact, slope};
}

bool GuardedTap::coming_down() const { return stage_ == Stage::stop || even_for() >= kArmLag; }

double GuardedTap::even_for() const {
  const bool even = stage_ == Stage::descend || stage_ == Stage::fine;
  return even ? static_cast<double>(periods_ - entered_) * kPeriod : 0.0;
}

void GuardedTap::enter(Stage stage) {
  // With the motion `paper`, a real arm may touch during a pause or between two steps. The earlier samples of the
  // contact are then kept.
  const bool resumed =
      stage_ == Stage::stop || (arm_ == ArmKind::real && (stage_ == Stage::pause || stage_ == Stage::rest));
  stage_ = stage;
  entered_ = periods_;
  above_ = 0;
  sum_ = 0.0;
  summed_ = 0;
  gap_ = std::numeric_limits<double>::infinity();
  switch (stage) {
    case Stage::clear:
      goal_ = std::min(descent_.hover, set_point_ + motion_.adaptive_hover->clearance);
      break;
    case Stage::descend:
      if (!resumed) trace_.clear();
      goal_ = motion_.type == MotionOptions::Type::paper ? std::max(descent_.floor, set_point_ - motion_.step)
                                                         : descent_.floor;
      break;
    case Stage::back_off: {
      // The retreat is measured from the onset, because a soft object may yield by more than back_off. The tare would
      // then include the force of the object.
      const double more = arm_ == ArmKind::real ? kFromAbove : 0.0;
      goal_ = std::min(descent_.hover + more,
                       std::max(set_point_, onset_of_descent(trace_).value_or(set_point_)) + motion_.back_off + more);
      break;
    }
    case Stage::unwind:
      goal_ = set_point_ - kFromAbove;
      break;
    case Stage::fine:
      goal_ = std::max(descent_.floor, first_ - motion_.back_off);
      break;
    default:
      break;
  }
}

void GuardedTap::start_reaction(double height) {
  first_ = height;
  ++noticed_;
  // An arm that lags behind a constant set-point would press further and increase the force.
  if (motion_.type != MotionOptions::Type::paper || arm_ == ArmKind::real) set_point_ = height;
  if (motion_.type == MotionOptions::Type::continuous) set_point_ = std::min(descent_.hover, height + motion_.brake);
  switch (motion_.type) {
    case MotionOptions::Type::paper:
      return enter(Stage::rest);
    case MotionOptions::Type::two_stage:
      return enter(Stage::back_off);
    case MotionOptions::Type::continuous:
    case MotionOptions::Type::per_tap:  // has no motion of its own
      return enter(Stage::stop);
  }
}

/// Moves the set-point towards `goal` by one period. Returns whether the set-point has reached `goal`.
bool GuardedTap::ramp(double goal, double speed) {
  const double most = speed * kPeriod;
  const double left = goal - set_point_;
  if (std::abs(left) <= most) {
    set_point_ = goal;
    return true;
  }
  set_point_ += std::copysign(most, left);
  return false;
}

/// Returns whether the arm has reached its set-point or is blocked. An arm that lags behind may still press on the
/// object that it should leave.
bool GuardedTap::arrived(double height) {
  const double gap = std::abs(height - set_point_);
  if (gap < gap_ - kArrivalTolerance) {
    gap_ = gap;
    nearer_ = periods_;
  }
  return gap < kArrivalTolerance || static_cast<double>(periods_ - nearer_) * kPeriod >= kBlockedTime;
}

/// Returns whether `seconds` have passed in this stage. Half a period is added, so that 0.5 s are 50 periods despite
/// rounding.
bool GuardedTap::waited(double seconds) const {
  return (static_cast<double>(periods_ - entered_) + 0.5) * kPeriod >= seconds;
}

void GuardedTap::finish(const HeightResult& result) {
  result_ = result;
  stage_ = Stage::done;
}

}  // namespace palpate::tapping
