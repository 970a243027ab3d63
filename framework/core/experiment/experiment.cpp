// SPDX-License-Identifier: MIT
// Read this file first: it is the program. After the paper (Sun and Min 2021, section III): tap, add the point, update
// both processes, choose the next tap by the exploration function.
#include "experiment/experiment.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {

void Experiment::run(Journal& journal, int most_taps) {
  while (std::optional<TapRecord> tap = begin(journal, most_taps)) {
    tap->contact = touch(*tap);
    if (is_broken_off(tap->contact)) return watch_.stop(kStoppedByUser);
    end(*tap, journal);
  }
}

std::optional<TapRecord> Experiment::begin(Journal& journal, int most_taps, const Wish* wish) {
  belief_.update();  // fit, infer
  show_belief();
  const std::int64_t budget = std::min<std::int64_t>(options_.taps, most_taps);
  std::optional<std::string> reason = stop_reason(budget, wish != nullptr ? Source::caller : Source::acquisition);
  std::optional<TapRecord> tap;
  if (!reason) {
    tap = choose_next(wish);
    if (!tap) reason = "no candidate is left";
  }
  if (tap && !journal.permits(*tap)) reason = kStoppedByUser;
  if (reason) {
    watch_.stop(*reason);
    return std::nullopt;
  }
  journal.announce(*tap);
  return tap;
}

void Experiment::end(TapRecord& tap, Journal& journal) {
  if (tap.contact.outcome == Outcome::contact) {
    const TapBelief::Reading reading = belief_.read(tap.contact, tap.motion);
    tap.on_surface = reading.on;
    if (belief_.systematic()) tap.corrected = reading.height;
  }
  observe(tap);
  journal.record(tap, clock_.take());
  check_backend(tap.contact);
}

std::optional<TapRecord> Experiment::choose_next(const Wish* wish) {
  TapRecord tap;
  {
    const PhaseClock::Scope acquire(clock_, Phase::acquire);
    belief_.ask(reads_for(wish != nullptr              ? Source::caller
                          : chooser_.starting(belief_) ? Source::initial
                                                       : Source::acquisition));
    if (!chooser_.choose(belief_, tap, previous_, wish)) return std::nullopt;
  }
  tap.number = watch_.counts().taps + 1;
  tap.target = candidates_.target(tap.candidate);
  if (const Quantities expected = backend_->expects(); expected != Quantities())
    tap.predicted = belief_.predict(tap.candidate, expected);
  const PhaseClock::Scope log(clock_, Phase::log);
  watch_.describe(tap, belief_);
  return tap;
}

void Experiment::observe(const PastTap& tap) {
  const int candidate = candidates_.nearest(tap.target.x, tap.target.y, scene_->area());
  const Manner manner = manner_of(tap);
  belief_.observe(tap.target, tap.contact, manner);
  chooser_.observe(tap, candidate, previous_, belief_);
  watch_.observe(tap, manner, candidate, belief_);
  previous_ = tap.target;
}

std::optional<std::string> Experiment::stop_reason(std::int64_t budget, Source source) {
  if (stop_wished()) return kStoppedByUser;
  if (watch_.counts().taps >= budget) return "tap budget";
  const StopOptions& stop = options_.stop;
  if (stop.robot_time && watch_.counts().robot_seconds >= *stop.robot_time) return "robot_time";
  if (chooser_.starting(belief_)) return std::nullopt;
  belief_.ask(reads_for(source));
  if (stop.max_standard_deviation &&
      std::sqrt(belief_.all_taps_variance().maxCoeff()) <= *stop.max_standard_deviation) {
    return "max_standard_deviation";
  }
  if (stop.expected_rmse && good_enough(*watch_.forecast(belief_), *stop.expected_rmse)) return "expected_rmse";
  return std::nullopt;
}

Contact Experiment::touch(const TapRecord& tap) {
  const PhaseClock::Scope robot(clock_, Phase::robot);
  Contact contact = backend_->tap(request_of(tap));
  if (contact.outcome != Outcome::contact || std::isfinite(contact.height)) return contact;
  return {Outcome::aborted, 0.0, 0.0, contact.seconds, kHeightRefused, contact.ends_run};
}

bool Experiment::is_broken_off(const Contact& contact) const {
  return stop_wished() && contact.outcome == Outcome::aborted && backend_->repeatable();
}

void Experiment::check_backend(const Contact& last) {
  const auto fail = [&](const std::string& reason, const std::string& hint = {}) {
    throw Error("backend/" + options_.backend.type, reason, hint, Error::Kind::run);
  };
  if (last.ends_run) fail(last.reason.empty() ? "cannot go on, and gives no reason" : last.reason);
  if (last.outcome == Outcome::contact) failed_in_a_row_ = 0;
  if (last.outcome == Outcome::contact || last.outcome == Outcome::unreachable || stop_wished()) return;
  constexpr std::int64_t kOfARobot = 3;
  const std::optional<std::int64_t> most =
      options_.stop.failed_in_a_row || backend_->repeatable() ? options_.stop.failed_in_a_row : kOfARobot;
  if (!most || ++failed_in_a_row_ < *most) return;
  fail(fmt::format("{} failed, the last so: {}", *most == 1 ? "a tap" : fmt::format("{} taps in a row", *most),
                   last.reason.empty() ? "no reason given" : last.reason),
       "see to it, then 'palpate resume --retry-failed' carries on; stop.failed_in_a_row sets how many");
}

void Experiment::show_belief() {
  const PhaseClock::Scope log(clock_, Phase::log);
  if (watch_.counts().taps == 0) return;
  belief_.ask(backend_->reads());
  backend_->show(belief_);
}

}  // namespace palpate
