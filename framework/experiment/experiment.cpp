// SPDX-License-Identifier: MIT
// Read this file first: it is the program. After the paper (Sun and Min 2021, section III): tap, add the point, update
// both processes, choose the next tap by the exploration function.
#include "experiment/experiment.hpp"

#include <palpate/error.hpp>

#include <cmath>

namespace palpate {

void Experiment::run(Journal& journal) {
  for (;;) {
    if (std::optional<std::string> reason = stop_reason()) {
      result_.stop_reason = *reason;
      return;
    }
    std::optional<TapRecord> tap = choose_next();
    if (!tap) {
      result_.stop_reason = "no candidate is left";
      return;
    }
    journal.announce(*tap);
    perform(*tap);
    journal.record(*tap, clock_.take());
  }
}

std::optional<TapRecord> Experiment::choose_next() {
  TapRecord tap;
  tap.number = result_.taps + 1;
  if (result_.taps < static_cast<int>(initial_.size())) {
    tap.candidate = initial_[static_cast<std::size_t>(result_.taps)];
  } else {
    choose_by_score(tap);
    if (tap.candidate < 0) return std::nullopt;
  }
  tap.target = candidates_.target(tap.candidate);
  describe_state(tap);
  return tap;
}

void Experiment::choose_by_score(TapRecord& tap) {
  const PhaseClock::Scope acquire(clock_, Phase::acquire);
  Pick picked = pick_best();
  tap.source = Source::acquisition;
  if (picked.flat && options_.fallback == ExperimentOptions::Fallback::uncertainty) {
    tap.source = Source::fallback;
    tap.why = *picked.flat;
    picked = chooser_.pick(VectorScores(belief_.uncertainty()), allowed_, 1.0, options_.tie_tolerance);
  }
  tap.candidate = picked.candidate;
  if (picked.candidate < 0) return;
  tap.score = picked.score;
  tap.ties = picked.ties;
  if (picked.runner_up >= 0) {
    tap.runner_up = candidates_.target(picked.runner_up);
    tap.runner_up_score = picked.runner_up_score;
  }
}

Pick Experiment::pick_best() {
  const double scale = acquisition_->prior_scale();
  if (const Scores* formed = belief_.formed()) return chooser_.pick(*formed, allowed_, scale, options_.tie_tolerance);
  scores_.resize(candidates_.size());
  acquisition_->score(belief_, scores_);
  if (!scores_.allFinite()) {
    throw Error("acquisition/" + options_.acquisition.type, "gave a score that is not a finite number", {},
                Error::Kind::run);
  }
  return chooser_.pick(VectorScores(scores_), allowed_, scale, options_.tie_tolerance);
}

void Experiment::perform(TapRecord& tap) {
  tap.contact = touch(tap.number, tap.target);
  if (tap.contact.outcome == Outcome::contact) tap.on_surface = scene_->on_surface(tap.contact.height);
  absorb(tap.target, tap.contact, tap.source);
}

void Experiment::absorb(const Target& target, const Contact& contact, Source source) {
  belief_.observe(target, contact);
  count(contact, source);
  previous_ = target;
  const auto candidate = static_cast<std::size_t>(candidates_.nearest(target.x, target.y, scene_->area()));
  const bool touched = contact.outcome == Outcome::contact;
  if (touched) tapped_[candidate] = true;
  if (!touched || options_.repeat == ExperimentOptions::Repeat::forbid) allowed_[candidate] = false;
}

std::optional<std::string> Experiment::stop_reason() const {
  if (context_.interrupted != nullptr && context_.interrupted->load()) return "interrupted";
  if (result_.taps >= options_.taps) return "tap budget";
  const StopOptions& stop = options_.stop;
  if (stop.robot_time && result_.robot_seconds >= *stop.robot_time) return "robot_time";
  if (stop.max_standard_deviation && result_.taps >= options_.initial.count &&
      std::sqrt(belief_.all_taps_variance().maxCoeff()) <= *stop.max_standard_deviation) {
    return "max_standard_deviation";
  }
  return std::nullopt;
}

}  // namespace palpate
