// SPDX-License-Identifier: MIT
// Read this file first: it is the program. After the paper (Sun and Min 2021, section III): tap, add the point, update
// both processes, choose the next tap by the exploration function.
#include "experiment/experiment.hpp"

#include "config/relation.hpp"
#include "experiment/tap_belief.hpp"
#include "math/instructions.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Whether it is said of a tap along an approach how far the tool came, and it may have come so far. Of one that met
/// nothing it may be left out: all of the way is free then. Of others nothing is learnt.
bool ends_on_its_way(const Approach& approach, const Contact& contact) {
  if (contact.outcome != Outcome::contact && contact.outcome != Outcome::no_contact) return true;
  if (!contact.along) return contact.outcome == Outcome::no_contact;
  return *contact.along >= 0.0 && *contact.along <= approach.length;
}

}  // namespace

void Experiment::run(Journal& journal, int most_taps) {
  while (std::optional<TapRecord> tap = begin(journal, most_taps)) {
    tap->contact = touch(*tap);
    if (is_broken_off(tap->contact)) return stop(kStoppedByUser);
    end(*tap, journal);
  }
}

std::optional<TapRecord> Experiment::begin(Journal& journal, int most_taps, const Wish* wish) {
  update();  // fit, infer
  const std::int64_t budget = std::min<std::int64_t>(options_.taps, most_taps);
  std::optional<std::string> reason = stop_reason(budget, wish != nullptr ? Source::caller : Source::acquisition);
  std::optional<TapRecord> tap;
  if (!reason) {
    try {
      tap = choose_next(wish);
      if (!tap) reason = "no candidate is left";
    } catch (const Error&) {
      // A program that is interrupted over its scores is no failure.
      if (!stop_wished()) throw;
      reason = kStoppedByUser;
    }
  }
  if (tap && !journal.permits(*tap)) reason = kStoppedByUser;
  if (reason) {
    stop(*reason);
    return std::nullopt;
  }
  journal.announce(*tap);
  return tap;
}

void Experiment::end(TapRecord& tap, Journal& journal) {
  if (tap.contact.outcome == Outcome::contact) read(tap);
  // Before any model takes it in: whatever a plugin does with it, a tap that was made is not lost.
  journal.record(tap, clock_.take());
  observe(tap);
  check_backend(tap);
}

std::optional<std::string> Experiment::stop_reason(std::int64_t budget, Source source) {
  if (stop_wished()) return kStoppedByUser;
  if (counts().taps >= budget) return "tap budget";
  const StopOptions& stop = options_.stop;
  if (stop.robot_time && satisfies(counts().robot_seconds, Relation::at_least, *stop.robot_time)) return "robot_time";
  return stop_rule(source);
}

Contact Experiment::touch(const TapRecord& tap) {
  const PhaseClock::Scope robot(clock_, Phase::robot);
  Contact contact = backend_->tap(request_of(tap));
  const auto refused = [&](const char* why) -> Contact {
    return {Outcome::aborted, 0.0, 0.0, std::isfinite(contact.seconds) ? contact.seconds : 0.0, why, contact.ends_run};
  };
  if (contact.outcome == Outcome::contact && !std::isfinite(contact.height)) return refused(kHeightRefused);
  if (tap.approach && !ends_on_its_way(*tap.approach, contact)) return refused(kAlongRefused);
  const bool force_known = contact.outcome != Outcome::contact || std::isfinite(contact.force);
  if (!force_known || !std::isfinite(contact.seconds) || !std::isfinite(contact.peak.value_or(0.0)))
    return refused(kNumberRefused);
  return contact;
}

bool Experiment::is_broken_off(const Contact& contact) const {
  return stop_wished() && contact.outcome == Outcome::aborted && backend_->repeatable();
}

void Experiment::check_backend(const PastTap& tap) {
  const Contact& last = tap.contact;
  const auto fail = [&](const std::string& reason, const std::string& hint = {}) {
    throw Error("backend/" + options_.backend.type, reason, hint, Error::Kind::run);
  };
  if (last.ends_run) fail(last.reason.empty() ? "cannot continue and gives no reason" : last.reason);
  // One number that is none may be a glitch. So many in a row are none, and no model is made of a run of them.
  constexpr int kMostRefused = 10;
  refused_in_a_row_ = is_refused(last) ? refused_in_a_row_ + 1 : 0;
  if (refused_in_a_row_ == kMostRefused) {
    fail(fmt::format("{} taps in a row failed, the last with: {}", kMostRefused, last.reason), "correct the backend");
  }
  const bool is_well = last.outcome == Outcome::contact || tap.is_without_contact();
  if (is_well) failed_in_a_row_ = 0;
  if (is_well || last.outcome == Outcome::unreachable || stop_wished()) return;
  constexpr std::int64_t kOfARobot = 3;
  const std::optional<std::int64_t> most =
      options_.stop.failed_in_a_row || backend_->repeatable() ? options_.stop.failed_in_a_row : kOfARobot;
  if (!most || ++failed_in_a_row_ < *most) return;
  fail(fmt::format("{} failed, the last with: {}", *most == 1 ? "a tap" : fmt::format("{} taps in a row", *most),
                   last.reason.empty() ? "no reason given" : last.reason),
       "correct the cause, then run 'palpate resume --retry-failed'; stop.failed_in_a_row sets the limit");
}

Experiment::Experiment(const ExperimentOptions& options, const PluginFactory& factory,
                       const std::atomic<bool>* interrupted, std::shared_ptr<Backend> backend,
                       const std::string& directory)
    : options_(options),
      scene_(build_scene(options.scene, static_cast<std::uint64_t>(options.seed), factory)),
      context_{factory,     *scene_,   static_cast<std::uint64_t>(options.seed),
               interrupted, directory, math::choose_instructions()},
      backend_(backend ? std::move(backend) : context_.create<Backend>(options.backend)) {}

}  // namespace palpate
