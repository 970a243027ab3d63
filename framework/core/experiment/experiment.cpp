// SPDX-License-Identifier: MIT
// Read this file first: it is the program. After the paper (Sun and Min 2021, section III): tap, add the point, update
// both processes, choose the next tap by the exploration function.
#include "experiment/experiment.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <cmath>

namespace palpate {

void Experiment::run(Journal& journal, int most_taps) {
  budget_ = std::min<std::int64_t>(options_.taps, most_taps);
  for (;;) {
    belief_.update();
    show_belief();
    if (std::optional<std::string> reason = stop_reason()) return stop(*reason);
    std::optional<TapRecord> tap = choose_next();
    if (!tap) return stop("no candidate is left");
    if (!journal.permits(*tap)) return stop(kStoppedByUser);
    journal.announce(*tap);
    if (!perform(*tap)) return stop(kStoppedByUser);
    journal.record(*tap, clock_.take());
    check_backend(tap->contact);
  }
}

std::optional<TapRecord> Experiment::choose_next() {
  TapRecord tap;
  tap.number = result_.taps + 1;
  if (starting()) {
    tap.candidate = search_ ? search_->next(allowed_) : initial_[static_cast<std::size_t>(result_.taps)];
  } else {
    choose_by_score(tap);
    if (tap.candidate < 0) return std::nullopt;
  }
  tap.target = candidates_.target(tap.candidate);
  if (backend_->wants_prediction()) {
    ask(Quantity::height);
    tap.predicted = predict(tap.candidate);
  }
  describe_state(tap);
  return tap;
}

void Experiment::choose_by_score(TapRecord& tap) {
  const PhaseClock::Scope acquire(clock_, Phase::acquire);
  ask_for_strategy();
  Pick picked = pick_best();
  tap.source = Source::acquisition;
  if (picked.flat && options_.fallback == ExperimentOptions::Fallback::uncertainty) {
    tap.source = Source::fallback;
    tap.why = *picked.flat;
    ask(kFallbackReads);
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

bool Experiment::perform(TapRecord& tap) {
  tap.contact = touch(tap);
  if (stop_wished() && tap.contact.outcome == Outcome::aborted && backend_->repeatable()) return false;
  if (tap.contact.outcome == Outcome::contact) tap.on_surface = scene_->on_surface(tap.contact.height);
  absorb(tap.target, tap.contact, tap.source);
  return true;
}

std::optional<std::string> Experiment::stop_reason() {
  if (stop_wished()) return kStoppedByUser;
  if (result_.taps >= budget_) return "tap budget";
  const StopOptions& stop = options_.stop;
  if (stop.robot_time && result_.robot_seconds >= *stop.robot_time) return "robot_time";
  if (starting()) return std::nullopt;
  ask_for_strategy();
  if (stop.max_standard_deviation &&
      std::sqrt(belief_.all_taps_variance().maxCoeff()) <= *stop.max_standard_deviation) {
    return "max_standard_deviation";
  }
  if (stop.expected_rmse && good_enough(*forecast(), *stop.expected_rmse)) return "expected_rmse";
  return std::nullopt;
}

}  // namespace palpate
