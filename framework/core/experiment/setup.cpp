// SPDX-License-Identifier: MIT
// What stands around the loop of experiment.cpp: building it, taking over a broken one, and telling its result.
#include "experiment/experiment.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

Candidates make_candidates(const CandidateOptions& options, const Area& area) {
  if (options.spacing) return grid_by_spacing(area, *options.spacing);
  return grid_by_count(area, static_cast<int>(*options.count));
}

constexpr Quantities kErrorsRead = Quantity::height | Quantity::probability;

constexpr const char* kHeightRefused = "the backend reported a height that is not a finite number";

ProcessState state_of(const TapBelief::Output& one) {
  const Process& process = *one.process;
  const int output = one.output;
  ProcessState out;
  out.kernel = process.kernel().parameters();
  out.settings = process.settings(output);
  out.log_marginal_likelihood = process.log_marginal_likelihood(output);
  out.jitter = process.jitter(output);
  out.condition = process.condition();
  out.engine = process.engine();
  out.engine_reason = process.engine_reason();
  out.error_bound = process.error_bound();
  if (one.last_fit != nullptr) out.fit = *one.last_fit;
  return out;
}

}  // namespace

Experiment::Experiment(const ExperimentOptions& options, const PluginFactory& factory,
                       const std::atomic<bool>* interrupted, std::shared_ptr<Backend> backend,
                       const std::string& directory)
    : options_(options),
      scene_(build_scene(options.scene, static_cast<std::uint64_t>(options.seed), factory)),
      context_{factory, *scene_, static_cast<std::uint64_t>(options.seed), interrupted, directory},
      candidates_(make_candidates(options.candidates, scene_->area())),
      initial_(initial_design(options.initial, candidates_, scene_->area(), context_.seed)),
      belief_(options_, candidates_, context_, clock_),
      acquisition_(context_.create<Acquisition>(options.acquisition)),
      backend_(backend ? std::move(backend) : context_.create<Backend>(options.backend)),
      allowed_(static_cast<std::size_t>(candidates_.size()), true),
      tapped_(allowed_.size(), false) {
  if (options.initial.searches())
    search_.emplace(options.initial.smallest, candidates_, scene_->area(), Random(context_.seed, "initial"));
  constexpr std::int64_t kRoom = 1024;  // within it no tap of the loop has to make any
  made_.reserve(static_cast<std::size_t>(std::min(options_.taps, kRoom)));
  check_product();
  belief_.form(acquisition_->product());
  if (options_.stop.expected_rmse) forecaster_.emplace();
  result_.interventions = {{"fallback", 0}, {"fit_failed", 0}, {"height_refused", 0},  {"jitter", 0},
                           {"pivoted", 0},  {"set_aside", 0},  {"variance_clamped", 0}};
}

void Experiment::resume(const std::vector<PastTap>& past) {
  for (const PastTap& tap : past) {
    absorb(tap.target, tap.contact, tap.source);
    // Who chose it has read for it.
    if (backend_->wants_prediction()) asked_ = asked_ | Quantity::height;
    if (tap.source != Source::initial) asked_ = asked_ | strategy_reads();
    if (tap.source == Source::fallback) asked_ = asked_ | kFallbackReads;
  }
  ask(asked_);
}

void Experiment::check_product() const {
  // Such scores come out of the models themselves; score() is not called, which would be held to reads().
  const auto needs = [&](Quantity one, const char* name) {
    if (acquisition_->reads().has(one)) return;
    throw Error("acquisition/" + options_.acquisition.type,
                fmt::format("says that its score is a product with {}, which its reads() does not name", name),
                "add it there");
  };
  if (acquisition_->product() != Product::none) needs(Quantity::uncertainty, "the uncertainty u");
  if (acquisition_->product() == Product::weighted) needs(Quantity::weight, "the weight w");
}

void Experiment::ask(Quantities quantities) {
  asked_ = asked_ | quantities;
  belief_.ask(quantities);
}

Quantities Experiment::surface_reads() const {
  return belief_.two_part() ? Quantity::height | Quantity::probability : Quantity::height;
}

Quantities Experiment::strategy_reads() const {
  Quantities out = acquisition_->reads();
  if (options_.stop.max_standard_deviation) out = out | Quantity::uncertainty;
  return out;
}

std::vector<ModelReader> Experiment::readers() const {
  std::vector<ModelReader> out;
  const auto add = [&](Quantities reads, const std::string& who) {
    for (const std::string& model : belief_.models_of(reads)) out.push_back({model, who});
  };
  add(acquisition_->reads(), "acquisition " + options_.acquisition.type);
  if (options_.fallback == ExperimentOptions::Fallback::uncertainty) {
    add(kFallbackReads, "fallback uncertainty, from its first use on");
  }
  if (options_.stop.max_standard_deviation) add(Quantity::uncertainty, "stop.max_standard_deviation");
  if (options_.stop.expected_rmse) add(surface_reads(), "stop.expected_rmse");
  Quantities backend = backend_->reads();
  if (backend_->wants_prediction()) backend = backend | Quantity::height;
  add(backend, "backend " + options_.backend.type);
  return out;
}

std::optional<Forecast> Experiment::forecast() {
  if (!forecaster_) return std::nullopt;
  if (forecaster_->hits() > 0) ask(surface_reads());
  return forecaster_->forecast(belief_);
}

Errors Experiment::errors() {
  const Truth* real = truth();
  if (real == nullptr) return {};
  SurfaceMaps maps = maps_of(belief_, recorded());
  Quantities lacking;
  if (maps.height == nullptr) lacking = lacking | Quantity::height;
  if (maps.probability == nullptr) lacking = lacking | Quantity::probability;
  if (lacking == Quantities()) return errors_of(maps, *real);
  if (!watched_) {
    watched_ = std::make_unique<TapBelief>(options_, candidates_, context_, unrecorded_);
    for (const PastTap& tap : made_) watched_->observe(tap.target, tap.contact, tap.source == Source::initial);
  }
  watched_->ask(lacking);
  const SurfaceMaps beside = maps_of(*watched_, lacking);
  if (maps.height == nullptr) maps.height = beside.height;
  if (maps.probability == nullptr) maps.probability = beside.probability;
  return errors_of(maps, *real);
}

void Experiment::absorb(const Target& target, const Contact& contact, Source source) {
  belief_.observe(target, contact, source == Source::initial);
  if (watched_) watched_->observe(target, contact, source == Source::initial);
  made_.push_back({target, contact, source});
  count(contact, source);
  if (search_) search_->look(target);
  previous_ = target;
  const auto candidate = static_cast<std::size_t>(candidates_.nearest(target.x, target.y, scene_->area()));
  const bool touched = contact.outcome == Outcome::contact;
  if (touched) tapped_[candidate] = true;
  if (touched && forecaster_ && scene_->on_surface(contact.height)) forecaster_->hit(contact.height - belief_.desk());
  if (!touched || options_.repeat == ExperimentOptions::Repeat::forbid) allowed_[candidate] = false;
}

Eigen::VectorXd Experiment::scores() {
  ask_for_strategy();
  Eigen::VectorXd out(candidates_.size());
  acquisition_->score(belief_, out);
  return out;
}

bool Experiment::starting() const {
  if (search_) return !result_.first_hit_tap && result_.taps < candidates_.size();
  return result_.taps < static_cast<int>(initial_.size());
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

Prediction Experiment::predict(int candidate) const {
  return {belief_.height_mean()(candidate), std::sqrt(belief_.height_variance()(candidate))};
}

TapRequest Experiment::request_of(const TapRecord& tap) const {
  return {tap.number, tap.target, previous_, tap.predicted};
}

Preview Experiment::preview(const TapRecord& tap) const {
  Preview out{tap.predicted, backend_->describe(request_of(tap))};
  if (!out.expected && recorded().has(Quantity::height)) out.expected = predict(tap.candidate);
  return out;
}

Contact Experiment::touch(const TapRecord& tap) {
  const PhaseClock::Scope in_tap(clock_, Phase::robot);
  Contact contact = backend_->tap(request_of(tap));
  if (contact.outcome != Outcome::contact || std::isfinite(contact.height)) return contact;
  return {Outcome::aborted, 0.0, 0.0, contact.seconds, kHeightRefused, contact.ends_run};
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
  if (result_.taps == 0) return;
  ask(backend_->reads());
  backend_->show(belief_);
}

void Experiment::count(const Contact& contact, Source source) {
  ++result_.taps;
  result_.robot_seconds += contact.seconds;
  if (source == Source::fallback) ++result_.interventions["fallback"];
  if (contact.reason == kHeightRefused) ++result_.interventions["height_refused"];
  if (contact.outcome != Outcome::contact) {
    ++result_.failed_taps;
    return;
  }
  const bool on = scene_->on_surface(contact.height);
  ++(on ? result_.on_surface_taps : result_.off_surface_taps);
  if (on && !result_.first_hit_tap) result_.first_hit_tap = result_.taps;
}

const Truth* Experiment::truth() {
  if (!backend_->scene_is_truth()) return nullptr;
  if (!truth_) truth_ = truth_at(candidates_, *scene_);
  return &*truth_;
}

void Experiment::describe_state(TapRecord& tap) {
  const PhaseClock::Scope log(clock_, Phase::log);
  tap.forecast = forecast();
  const Quantities known = recorded();
  if (known.has(Quantity::uncertainty)) {
    tap.uncertainty = belief_.uncertainty()(tap.candidate);
    const Eigen::VectorXd& variance = belief_.all_taps_variance();
    tap.max_standard_deviation = std::sqrt(variance.maxCoeff());
    tap.mean_standard_deviation = variance.cwiseSqrt().mean();
    tap.height_process = state_of(belief_.height_process());
  }
  if (belief_.two_part() && known.has(Quantity::height)) tap.surface_process = state_of(belief_.surface_process());
  if (known.has(Quantity::weight)) {
    tap.weight = belief_.weight()(tap.candidate);
    tap.min_weight = belief_.weight_mean().minCoeff();
    tap.max_weight = belief_.weight_mean().maxCoeff();
    tap.weight_process = state_of(belief_.weight_process());
  }
  if (known.has(Quantity::probability) && !belief_.footprint_is_weight()) {
    const Footprint* footprint = belief_.footprint();
    tap.probability = belief_.probability()(tap.candidate);
    tap.footprint = FootprintState{footprint->numbers(), footprint->remark()};
  }
  if (tap.uncertainty && tap.weight) tap.exploration = *tap.uncertainty * *tap.weight;
  if (const Truth* real = truth()) {
    tap.true_on_surface = real->on(tap.candidate);
    tap.errors = errors_of(maps_of(belief_, known), *real);
  }
}

RunResult Experiment::result() {
  RunResult out = result_;
  belief_.update();
  out.forecast = forecast();
  out.interrupted = out.stop_reason == kStoppedByUser;
  if (const Truth* known = truth()) {
    belief_.ask(kErrorsRead);
    out.errors = errors_of(maps_of(belief_, kErrorsRead), *known);
    out.calibration = calibration(belief_, *known, tapped_);
  }
  const auto take = [&](const TapBelief::Output& one, std::optional<ProcessState>& state) {
    if (!one) return;
    const Process& process = *one.process;
    state = state_of(one);
    out.jitter_max = std::max(out.jitter_max, state->jitter);
    out.interventions["jitter"] += process.jitter_raised();
    out.interventions["pivoted"] += process.pivoted();
    out.interventions["set_aside"] += process.set_aside();
    out.interventions["variance_clamped"] += process.variances_clamped();
  };
  take(belief_.height_process(), out.height_process);
  take(belief_.weight_process(), out.weight_process);
  if (belief_.two_part()) take(belief_.surface_process(), out.surface_process);
  if (const Footprint* footprint = belief_.footprint())
    out.footprint = FootprintState{footprint->numbers(), footprint->remark()};
  out.interventions["fit_failed"] = belief_.failed_fits();
  return out;
}

}  // namespace palpate
