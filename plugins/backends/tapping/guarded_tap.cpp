// SPDX-License-Identifier: MIT
#include "tapping/guarded_tap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::tapping {
namespace {

/// Readings above the threshold until it counts as a contact: one alone may be noise.
constexpr int kConsecutive = 3;
/// How near to its goal the arm must come before the next stage. One that has not come nearer by as much again for so
/// many seconds is held up, and will not.
constexpr double kNear = 0.001;
constexpr double kHeldUp = 2.0;
/// s by which an arm trails its set-point: for so long it does not move yet.
constexpr double kTrail = 0.35;
/// s after which it comes down evenly.
constexpr double kEven = 0.7;

/// The means of as many samples one after the other as leave at most kMostSamples: the search for an onset takes the
/// square of their number, and the arm waits for it.
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

GuardedTap::GuardedTap(const MotionOptions& motion, const Descent& descent, Arm arm)
    : motion_(motion),
      descent_(descent),
      arm_(arm),
      set_point_(descent.hover),
      free_(motion.threshold / kSoftest, descent.hover) {}

double GuardedTap::next(double height, double force, bool fresh) {
  if (done()) return set_point_;
  ++periods_;
  if (fresh) feel(height, force);
  if (seconds() > motion_.timeout) {
    finish({Outcome::timeout, 0.0, 0.0, 0.0, kTooLong});
    return set_point_;
  }
  switch (stage_) {
    case Stage::tare:
    case Stage::settle:
      if (waited(stage_ == Stage::tare ? motion_.tare : motion_.pause) && summed_ > 0 && averaged(kFewestTared)) {
        zero_ = sum_ / summed_;
        free_.tare(zero_);
        enter(stage_ == Stage::settle ? Stage::fine : Stage::approach);
      }
      break;
    case Stage::approach:
      if (above_ >= kConsecutive) {
        set_point_ = height;
        enter(Stage::clear);
      } else if (descent_.start >= descent_.hover || ramp(descent_.start, motion_.adaptive_hover->speed)) {
        enter(Stage::descend);
      }
      break;
    case Stage::clear:
      if (ramp(goal_, motion_.adaptive_hover->speed) && arrived(height)) enter(Stage::descend);
      break;
    case Stage::descend:
      if (above_ >= kConsecutive) {
        touched(height);
      } else if (ramp(goal_, motion_.speed)) {
        enter(motion_.type == MotionOptions::Type::paper ? Stage::pause : Stage::bottom);
      }
      break;
    case Stage::pause:
      if (arm_ == Arm::real && waited(motion_.pause) && summed_ > 0) {
        // The mean of the end of the pause, when the arm stands still. Half of the threshold may be a contact, which
        // must not be tared away.
        const double mean = sum_ / summed_;
        if (std::abs(mean - zero_) < 0.5 * motion_.threshold) {
          zero_ = mean;
          free_.tare(zero_);
        }
      }
      if (above_ >= kConsecutive) {
        touched(height);
      } else if (waited(motion_.pause)) {
        enter(set_point_ <= descent_.floor ? Stage::bottom : Stage::descend);
      }
      break;
    case Stage::rest:
      if (waited(motion_.pause) && (arm_ == Arm::simulated || averaged(kFewestWatched))) {
        Rise found = arm_ == Arm::simulated ? Rise{height, true, 0.0} : rise();
        found.height = height;
        conclude(found);
      }
      break;
    case Stage::back_off:
      if (ramp(goal_, motion_.speed) && arrived(height)) enter(arm_ == Arm::real ? Stage::unwind : Stage::settle);
      break;
    case Stage::unwind:
      if (above_ >= kConsecutive) {
        set_point_ = height;
        enter(Stage::back_off);
      } else if (ramp(goal_, motion_.fine_speed) && arrived(height)) {
        enter(Stage::settle);
      }
      break;
    case Stage::fine:
      if (above_ >= kConsecutive) {
        finish({Outcome::contact, height, peak_, 0.0, {}});
      } else if (ramp(goal_, motion_.fine_speed)) {
        enter(Stage::descend);
      }
      break;
    case Stage::stop:
      if (waited(kWatched) && averaged(kFewestWatched)) conclude_at_onset();
      break;
    case Stage::bottom:
      if (above_ >= kConsecutive) {
        touched(height);
      } else if (arrived(height)) {
        finish({Outcome::no_contact, 0.0, 0.0, 0.0, "the descent ended without a contact"});
      }
      break;
    case Stage::done:
      break;
  }
  return set_point_;
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

/// What a new reading counts for.
void GuardedTap::feel(double height, double force) {
  const bool in_pause = arm_ == Arm::real && stage_ == Stage::pause && waited(motion_.pause - motion_.tare);
  const bool stopped =
      (stage_ == Stage::stop || stage_ == Stage::rest) && (!waited(kWatched + kPeriod) || !averaged(kFewestWatched));
  if (taring() || in_pause || stopped) {
    sum_ += force;
    ++summed_;
  }
  if (taring()) return;
  const bool descending = stage_ == Stage::descend || stage_ == Stage::bottom;
  if (arm_ == Arm::real && descending) {
    zero_ = free_.line(height).at(height);
    if (even_for() >= kEven) free_.add({height, force});
  }
  const double felt = force - zero_;
  peak_ = std::max(peak_, felt);
  above_ = felt > threshold() ? above_ + 1 : 0;
  const bool paused = arm_ == Arm::real && (stage_ == Stage::pause || stage_ == Stage::rest);
  if (descending || stage_ == Stage::stop || paused) trace_.push_back({height, force});
}

/// The contact is one, or the descent goes on where it is. If something is touched, the mean of the force that followed
/// the three loud readings is high; if they were noise it is about zero. It is not above the threshold everywhere: a
/// set-point that is put where the arm is lets its springs relax, on something soft to less than the threshold.
void GuardedTap::conclude(const Rise& found) {
  // An arm that brakes presses less meanwhile.
  const bool relaxes = motion_.brake > 0.0 || arm_ == Arm::real;
  const double least = relaxes ? 0.5 * motion_.threshold : motion_.threshold;
  const bool presses = summed_ == 0 || sum_ / summed_ - zero_ > least;
  const bool lasts = found.is_contact && presses;
  const bool asks = arm_ == Arm::real || motion_.confirm;
  if (given_up_ && !lasts) return finish({Outcome::aborted, 0.0, 0.0, 0.0, kStoppedByItself});
  const bool again = arm_ == Arm::real && found.is_contact && refused_ && std::abs(*refused_ - first_) < kSamePlace;
  if (!asks || lasts || again) return finish({Outcome::contact, found.height, peak_, 0.0, {}});
  if (found.is_contact) refused_ = first_;
  if (presses && !found.is_contact && too_soft()) {
    return finish({Outcome::aborted, 0.0, 0.0, 0.0,
                   fmt::format("a contact is too soft: its force rises by {:.0f} N/m, but an object needs {:.0f} N/m "
                               "from at most {:.0f} cm above, to differ from a zero that changes with the pose",
                               found.slope, kSoftestRise, 100.0 * kFarthestOnset)});
  }
  enter(Stage::descend);
}

/// Counts a contact that lasts and does not rise as on an object; returns whether they are too many in one place.
bool GuardedTap::too_soft() {
  if (softs_ == 0 || std::abs(soft_ - first_) > kFarthestOnset) {
    soft_ = first_;
    softs_ = 0;
  }
  return ++softs_ >= kMostSoft;
}

/// Of `continuous`: the height is that of the onset.
void GuardedTap::conclude_at_onset() {
  if (arm_ == Arm::simulated) return conclude({onset_of_descent(trace_).value_or(first_), true, 0.0});
  conclude(rise());
}

/// How the force of a real arm rose above the line that it had in free travel.
GuardedTap::Rise GuardedTap::rise() const {
  const FreeForce::Line free = free_.line(first_);
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

bool GuardedTap::coming_down() const { return stage_ == Stage::stop || even_for() >= kTrail; }

double GuardedTap::even_for() const {
  const bool even = stage_ == Stage::descend || stage_ == Stage::fine;
  return even ? static_cast<double>(periods_ - entered_) * kPeriod : 0.0;
}

void GuardedTap::enter(Stage stage) {
  // A real arm of `paper` may touch in a pause, or between two of its steps.
  const bool resumed =
      stage_ == Stage::stop || (arm_ == Arm::real && (stage_ == Stage::pause || stage_ == Stage::rest));
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
      // From where the contact began: a soft object may have given way by more than that, and would be tared.
      const double more = arm_ == Arm::real ? kFromAbove : 0.0;
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

void GuardedTap::touched(double height) {
  first_ = height;
  ++noticed_;
  // Wherever the arm trails its set-point, holding that would press on.
  if (motion_.type != MotionOptions::Type::paper || arm_ == Arm::real) set_point_ = height;
  if (motion_.type == MotionOptions::Type::continuous) set_point_ = std::min(descent_.hover, height + motion_.brake);
  switch (motion_.type) {
    case MotionOptions::Type::paper:
      return enter(Stage::rest);
    case MotionOptions::Type::two_stage:
      return enter(Stage::back_off);
    case MotionOptions::Type::continuous:
    case MotionOptions::Type::per_tap:  // no motion of its own
      return enter(Stage::stop);
  }
}

/// Moves the set-point towards `goal` by what one period allows; whether it is there.
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

/// Whether the arm is where it was sent, or will not come any nearer. One that trails its set-point may still press on
/// what it should be clear of.
bool GuardedTap::arrived(double height) {
  const double gap = std::abs(height - set_point_);
  if (gap < gap_ - kNear) {
    gap_ = gap;
    nearer_ = periods_;
  }
  return gap < kNear || static_cast<double>(periods_ - nearer_) * kPeriod >= kHeldUp;
}

/// Half a period of grace: 0.5 s are 50 periods, whatever their sum rounds to.
bool GuardedTap::waited(double seconds) const {
  return (static_cast<double>(periods_ - entered_) + 0.5) * kPeriod >= seconds;
}

void GuardedTap::finish(const Contact& result) {
  result_ = result;
  stage_ = Stage::done;
}

}  // namespace palpate::tapping
