// SPDX-License-Identifier: MIT
// Read this file first: it contains the main loop. The loop follows Sun and Min 2021, section III: tap, add the point,
// update the models, choose the next tap by the exploration function.
#include "experiment/experiment.hpp"

#include "experiment/stop_rules.hpp"
#include "experiment/unreached.hpp"
#include "math/instructions.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

/// Returns whether the distance of a result is within the length of the line. The distance may be absent on lines from
/// above and after `no_contact`.
bool ends_on_line(const TapLine& line, const TapResult& result) {
  if (result.outcome != Outcome::contact && result.outcome != Outcome::no_contact) return true;
  if (!result.distance) return line.from_above || result.outcome == Outcome::no_contact;
  return *result.distance >= 0.0 && *result.distance <= line.length;
}

}  // namespace

void Experiment::run(Observer& observer, int most_taps) {
  while (std::optional<TapRecord> tap = begin(observer, most_taps)) {
    tap->result = make_tap(tap->request);
    if (is_broken_off(tap->result)) return stop(kStoppedByUser);
    end(*tap, observer);
  }
}

std::optional<TapRecord> Experiment::begin(Observer& observer, int most_taps, const TapOverride* override) {
  belief_->update();  // adds the last tap to the models, fits included
  show();
  std::optional<std::string> reason;
  std::optional<TapRecord> tap;
  try {
    reason = reason_to_stop(most_taps, override);
    if (!reason && !(tap = choose_next(override))) reason = "no candidate is left";
  } catch (const Error&) {
    // If the user interrupts, the program of an acquisition or a backend may end with an Error, which is not a failure.
    if (!is_stop_wished()) throw;
    reason = kStoppedByUser;
  }
  if (tap && !observer.permits(*tap, *this)) reason = kStoppedByUser;
  if (reason) {
    stop(*reason);
    return std::nullopt;
  }
  observer.announce(*tap);
  return tap;
}

std::optional<std::string> Experiment::reason_to_stop(int most_taps, const TapOverride* override) {
  if (is_stop_wished()) return kStoppedByUser;
  if (counts().taps >= std::min<std::int64_t>(options_.taps, most_taps)) return "tap budget";
  if (auto reason = stop_before_inference(options_.stop, counts())) return reason;
  const bool is_starting = selector_.is_starting(*belief_);
  prepare(override);
  return is_starting ? std::nullopt : stop_after_inference(options_.stop, *belief_);
}

void Experiment::prepare(const TapOverride* override) {
  begin_stages(selector_.next_source(*belief_, override));
  infer();
}

std::optional<TapRecord> Experiment::choose_next(const TapOverride* override) {
  TapRecord tap;
  complete(tap.request);
  {
    const PhaseClock::Scope acquire(&clock_, Phase::acquire);
    prepare(override);
    if (!selector_.choose(*belief_, tap, override)) return std::nullopt;
    if (motions_) motions_->choose(*belief_, tap);
  }
  complete(tap.request);
  tap.unreached = unreached_;
  if (const QuantitySet reads = backend_->predicts(); !reads.empty())
    tap.request.predicted = belief_->predict(tap.candidate, reads.count(quantity::kObjectProbability) != 0);
  const PhaseClock::Scope log(&clock_, Phase::log);
  monitor_.describe(tap, *belief_);
  return tap;
}

void Experiment::end(TapRecord& tap, Observer& observer) {
  tap.reading = belief_->read(tap.request, tap.result);
  // The tap is recorded before any model receives it. So the record of the tap is not lost if a plugin fails.
  observer.record(tap, clock_.take());
  take_in(tap);
  check_backend(tap);
}

void Experiment::take_in(const TapRecord& tap) {
  belief_->add(tap.request, tap.result);
  selector_.take_in(tap, *belief_);
  if (motions_) motions_->take_in(tap, *belief_);
  monitor_.take_in(tap, *belief_);
  previous_ = tap.request.line;
}

void Experiment::resume(const std::vector<TapRecord>& taps) {
  for (TapRecord tap : taps) {
    complete(tap.request);
    belief_->update();
    begin_stages(tap.is_of_caller() ? Source::caller : tap.request.source);
    if (tap.request.source == Source::fallback) belief_->begin(Stage::first_fallback);
    belief_->update();
    take_in(tap);
  }
}

void Experiment::infer() {
  belief_->update();
  draw_candidates();
  belief_->infer();
}

void Experiment::begin_stages(Source source) {
  belief_->begin(Stage::first_tap);
  if (source != Source::initial) belief_->begin(Stage::first_scored_tap);
  if (source == Source::acquisition || source == Source::fallback) belief_->begin(Stage::first_acquisition_tap);
  if (source == Source::fallback) belief_->begin(Stage::first_fallback);
  const std::vector<TapReading>& readings = belief_->taps().readings;
  if (std::any_of(readings.begin(), readings.end(), [](const TapReading& one) { return one.on_object; }))
    belief_->begin(Stage::first_object_contact);
}

void Experiment::show() {
  if (counts().taps == 0) return;
  belief_->begin(Stage::first_tap);
  if (!backend_->reads().empty()) infer();
  const PhaseClock::Scope log(&clock_, Phase::log);
  backend_->show(*belief_);
}

void Experiment::draw_candidates() {
  std::size_t tries = 0;
  std::string rejected;
  belief_->draw_candidates([&](const Candidates& lines, BoolOut out) {
    backend_->reaches(lines, out);
    for (Eigen::Index i = 0; i < out.size(); ++i, ++tries) {
      if (!out(i)) mark_unreached(rejected, tries);
    }
  });
  if (tries > 0) unreached_ = rejected;
}

void Experiment::complete(TapRequest& request) const {
  request.number = monitor_.counts().taps + 1;
  request.previous = previous_;
  request.elapsed = monitor_.counts().robot_seconds;
  request.height_noise = motions_ ? motions_->height_noise(request.motion) : 0.0;
}

void Experiment::look() {
  belief_->begin(Stage::first_tap);
  infer();
  truth();
}

RunResult Experiment::result() {
  belief_->update();
  belief_->begin(Stage::summary);
  belief_->update();
  // After the last tap, all lines are accepted without calling the backend, whose program may have ended.
  belief_->draw_candidates([](const Candidates&, BoolOut out) { out.setConstant(true); });
  belief_->infer();
  return monitor_.result(*belief_);
}

Eigen::VectorXd Experiment::scores() {
  begin_stages(Source::acquisition);
  infer();
  return selector_.scores(*belief_);
}

Preview Experiment::preview(const TapRecord& tap) const {
  Preview out{tap.request.predicted, backend_->describe(tap.request)};
  const bool is_built = belief_->available().count(quantity::kHeightMean) != 0;
  if (!out.expected && is_built) out.expected = belief_->predict(tap.candidate, false);
  return out;
}

ReadPlan Experiment::make_plan(const ReadPlan& more) const {
  ReadPlan plan;
  selector_.add_readers(plan);
  palpate::add_readers(options_.stop, plan);
  const std::string backend = "backend " + options_.backend.type;
  const QuantitySet predicts = backend_->predicts();
  const std::string motion = motion_name(options_).empty() ? backend : "motion " + motion_name(options_);
  if (!predicts.empty()) plan.readers.push_back({motion, predicts, Stage::first_tap, true});
  if (motions_) plan.readers.push_back({motion, MotionSelector::reads(), Stage::first_tap, true});
  plan.readers.push_back({backend, backend_->reads(), Stage::first_tap});
  if (options_.log.maps) plan.readers.push_back({"log.maps", {quantity::kDeskPosition}, Stage::first_tap});
  if (options_.candidates.spacing)
    plan.readers.push_back({"candidates.spacing", {quantity::kDeskPosition}, Stage::first_tap});
  for (ReadPlan::Reader reader : more.readers) {
    if (reader.is_optional) leave_out_unoffered(reader, *belief_);
    plan.readers.push_back(std::move(reader));
  }
  plan.surface_from = more.surface_from;
  const bool is_needed = backend_->scene_is_truth() || options_.log.surface;
  if (!plan.surface_from && is_needed) plan.surface_from = Stage::summary;
  return plan;
}

TapResult Experiment::make_tap(const TapRequest& request) {
  const PhaseClock::Scope robot(&clock_, Phase::robot);
  TapResult result = backend_->tap(request);
  const double seconds = std::isfinite(result.seconds) ? result.seconds : 0.0;
  const auto refused = [&](const char* why) {
    return tap_without_contact(Outcome::aborted, seconds, why, result.ends_run);
  };
  const bool is_contact = result.is_contact();
  if (is_contact && (!result.contact || !result.contact->allFinite())) return refused(kHeightRefused);
  if (!ends_on_line(request.line, result)) return refused(kAlongRefused);
  if ((is_contact && !std::isfinite(result.force)) || !std::isfinite(result.seconds) ||
      !std::isfinite(result.peak_force.value_or(0.0)))
    return refused(kNumberRefused);
  return result;
}

bool Experiment::is_broken_off(const TapResult& result) const {
  return is_stop_wished() && result.outcome == Outcome::aborted && backend_->repeatable();
}

void Experiment::check_backend(const TapRecord& tap) {
  const TapResult& last = tap.result;
  const auto fail = [&](const std::string& reason, const std::string& hint = {}) {
    throw Error("backend/" + options_.backend.type, reason, hint, Error::Kind::run);
  };
  if (last.ends_run) fail(last.reason.empty() ? "cannot continue and gives no reason" : last.reason);
  // One impossible result may be a glitch. This many impossible results in a row mean that the backend is faulty.
  constexpr int kMostRefused = 10;
  refused_in_a_row_ = is_refused(last) ? refused_in_a_row_ + 1 : 0;
  if (refused_in_a_row_ == kMostRefused)
    fail(fmt::format("{} taps in a row failed, the last with: {}", kMostRefused, last.reason), "correct the backend");
  const bool is_well = tap.is_contact() || tap.is_free_line();
  if (is_well) failed_in_a_row_ = 0;
  if (is_well || last.outcome == Outcome::unreachable || is_stop_wished()) return;
  constexpr std::int64_t kOfARobot = 3;
  const std::optional<std::int64_t> most =
      options_.stop.failed_in_a_row || backend_->repeatable() ? options_.stop.failed_in_a_row : kOfARobot;
  if (!most || ++failed_in_a_row_ < *most) return;
  fail(fmt::format("{} failed, the last with: {}", *most == 1 ? "a tap" : fmt::format("{} taps in a row", *most),
                   last.reason.empty() ? "no reason given" : last.reason),
       "correct the cause, then run 'palpate resume --retry-failed'; stop.failed_in_a_row sets the limit");
}

std::shared_ptr<Backend> Experiment::make_backend(const ExperimentSetup& setup) {
  context_.from_above = belief_->candidates().from_above;
  std::shared_ptr<Backend> backend = setup.backend ? setup.backend : context_.create<Backend>(options_.backend);
  if (!context_.from_above && !backend->taps_any_line())
    throw Error("backend",
                fmt::format("{} only taps from above, which the belief {} does not", options_.backend.type,
                            options_.belief.type),
                "choose another backend, with backend process protocol: 2, or belief=height_map");
  if (belief_->reads_scene() && !backend->scene_is_truth())
    throw Error("belief.view",
                fmt::format("uses the scene of the config, but backend {} taps another scene", options_.backend.type),
                "remove it, or choose backend=simulator");
  return backend;
}

Experiment::Experiment(const ExperimentOptions& options, const ExperimentSetup& setup)
    : options_(options),
      scene_(build_scene(options.scene, static_cast<std::uint64_t>(options.seed), setup.factory)),
      context_{setup.factory,
               *scene_,
               static_cast<std::uint64_t>(options.seed),
               setup.interrupted,
               setup.directory,
               math::choose_instructions(),
               &clock_,
               run_settings(options)},
      belief_(context_.create<Belief>(options.belief)),
      backend_(make_backend(setup)),
      selector_(options_, *belief_, context_),
      monitor_(*scene_, backend_->scene_is_truth()) {
  if (auto motions = setup.factory.motions(options_.backend, *scene_))
    motions_.emplace(std::move(motions), scene_->desk());
  plan_.read = make_plan(setup.readers);
  require_offered(plan_.read, *belief_, options_.belief.type);
  plan_.models = belief_->plan(plan_.read);
  belief_->update();
}

}  // namespace palpate
