// SPDX-License-Identifier: MIT
#include "experiment/watch.hpp"

#include "experiment/policy.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr Quantities kErrorsRead = Quantity::height | Quantity::probability;

GpState state_of(const TapBelief::Output& one) {
  const GaussianProcess& process = *one.process;
  const int output = one.output;
  GpState out;
  out.kernel = process.kernel().parameters();
  out.settings = process.settings(output);
  const GpDiagnostics diagnostics = process.diagnostics(output);
  out.log_marginal_likelihood = diagnostics.log_marginal_likelihood;
  out.jitter = diagnostics.factors.jitter;
  out.condition = diagnostics.condition;
  const EngineState engine = process.engine();
  out.engine = engine.name;
  out.engine_reason = engine.reason;
  out.error_bound = engine.error_bound;
  if (one.last_fit != nullptr) out.fit = *one.last_fit;
  return out;
}

/// `belief` has what the surface is made of.
Forecast forecast_by(const TapBelief& belief) {
  Forecaster forecaster;
  for (const Touch& hit : belief.log().object_contacts()) forecaster.hit(hit.height);
  return forecaster.forecast(belief);
}

FootprintState state_of(const Footprint& footprint) { return {footprint.numbers(), footprint.remark()}; }

}  // namespace

Watch::Watch(const ExperimentOptions& options, const Candidates& candidates, const Context& context, bool truth_known)
    : options_(options),
      candidates_(candidates),
      context_(context),
      truth_known_(truth_known),
      touched_(static_cast<std::size_t>(candidates.size()), false) {
  constexpr std::int64_t kRoom = 1024;  // within it no tap of the loop has to make any
  taps_.reserve(static_cast<std::size_t>(std::min(options.taps, kRoom)));
}

void Watch::observe(const PastTap& tap, const Manner& manner, int candidate, const TapBelief& belief) {
  const Contact& contact = tap.contact;
  taps_.emplace_back(tap, manner);
  if (contact.outcome == Outcome::contact) note_object(candidate);
  if (beside_) beside_->observe(tap.target, tap.contact, manner);
  result_.count(tap);
  if (contact.outcome != Outcome::contact) return;
  touched_[static_cast<std::size_t>(candidate)] = true;
  result_.object_taps = static_cast<int>(belief.log().object_contacts().size());
  result_.desk_taps = static_cast<int>(belief.log().contacts().size() - belief.log().object_contacts().size());
  result_.first_hit_tap = belief.log().first_hit_tap();
  result_.relabelled = belief.log().relabelled();
}

void Watch::note_object(int candidate) {
  const Truth* const real = truth();  // as it was tapped: what is pushed by this tap is pushed after it
  if (real == nullptr) return;
  touches_.resize(static_cast<std::size_t>(real->objects));
  const int object = real->object(candidate);
  if (object == Scene::kNoObject) return;
  ObjectTouches& touches = touches_[static_cast<std::size_t>(object)];
  ++touches.taps;
  if (!touches.first_tap) touches.first_tap = result_.taps + 1;
}

std::optional<Forecast> Watch::forecast(TapBelief& belief) const {
  if (!options_.stop.expected_rmse) return std::nullopt;
  if (!belief.log().object_contacts().empty()) belief.ask(belief.surface_reads());
  return forecast_by(belief);
}

std::optional<double> Watch::expected_rmse(TapBelief& belief) const {
  const Quantities reads = belief.surface_reads();
  for (TapBelief* one : {&belief, beside_.get()}) {
    if (one == nullptr || one->log().object_contacts().empty() || !one->has_models_of(reads)) continue;
    one->build(reads);
    return forecast_by(*one).rmse;
  }
  return std::nullopt;
}

void Watch::describe(TapRecord& tap, TapBelief& belief) {
  tap.forecast = forecast(belief);
  const Quantities known = belief.recorded();
  if (known.has(Quantity::uncertainty)) {
    tap.uncertainty = belief.uncertainty()(tap.candidate);
    const Eigen::VectorXd& variance = belief.all_taps_variance();
    tap.max_standard_deviation = std::sqrt(variance.maxCoeff<Eigen::PropagateNaN>());
    tap.mean_standard_deviation = variance.cwiseSqrt().mean();
    tap.height_gp = state_of(belief.height_gp());
  }
  if (belief.two_part() && known.has(Quantity::height)) tap.surface_gp = state_of(belief.surface_gp());
  if (known.has(Quantity::weight)) {
    tap.weight = belief.weight()(tap.candidate);
    tap.min_weight = belief.weight_mean().minCoeff();
    tap.max_weight = belief.weight_mean().maxCoeff();
    tap.label_gp = state_of(belief.label_gp());
  }
  if (known.has(Quantity::probability) && !belief.footprint_is_weight()) {
    tap.probability = belief.probability()(tap.candidate);
    tap.footprint = state_of(*belief.footprint());
  }
  if (options_.height.outlier_probability) tap.suspected_outliers = belief.suspected_outliers();
  if (tap.uncertainty && tap.weight) tap.exploration = *tap.uncertainty * *tap.weight;
  if (const Truth* real = truth()) {
    tap.true_on_object = real->on(tap.candidate);
    tap.errors = errors_of(maps_of(belief, known), *real);
  }
}

const Truth* Watch::truth() {
  if (!truth_known_) return nullptr;
  if (truth_ && (!context_.scene.effects().push || truth_taps_ == result_.taps)) return &*truth_;
  const auto taps = static_cast<int>(result_.taps);
  const std::unique_ptr<const Scene> now = context_.scene.after(taps);
  truth_ = truth_at(candidates_, now ? *now : context_.scene);
  truth_taps_ = taps;
  return &*truth_;
}

Errors Watch::errors(TapBelief& belief) {
  const Truth* real = truth();
  if (real == nullptr) return {};
  if (belief.has_models_of(kErrorsRead)) {
    belief.build(kErrorsRead);
    return errors_of(maps_of(belief, kErrorsRead), *real);
  }
  SurfaceMaps maps = maps_of(belief, belief.recorded());
  Quantities lacking;
  if (maps.height == nullptr) lacking = lacking | Quantity::height;
  if (maps.probability == nullptr) lacking = lacking | Quantity::probability;
  if (!beside_) {
    beside_ = std::make_unique<TapBelief>(options_, candidates_, context_, unrecorded_);
    for (const auto& [tap, manner] : taps_) beside_->observe(tap.target, tap.contact, manner);
  }
  // The outlines have a word in who is believed.
  beside_->ask(options_.height.outlier_probability ? lacking | Quantity::probability : lacking);
  const SurfaceMaps others = maps_of(*beside_, lacking);
  if (maps.height == nullptr) maps.height = others.height;
  if (maps.probability == nullptr) maps.probability = others.probability;
  return errors_of(maps, *real);
}

RunResult Watch::result(TapBelief& belief) {
  RunResult out = result_;
  belief.update();
  out.forecast = forecast(belief);
  out.interrupted = out.stop_reason == kStoppedByUser;
  if (const Truth* real = truth()) {
    belief.build(kErrorsRead);
    const SurfaceMaps maps = maps_of(belief, kErrorsRead);
    out.errors = errors_of(maps, *real);
    require_finite(out.errors, result_.taps);
    touches_.resize(static_cast<std::size_t>(real->objects));
    out.objects.emplace();
    for (const ObjectErrors& errors : object_errors(maps, *real, candidates_))
      out.objects->push_back({errors, touches_[out.objects->size()]});
    out.calibration = calibration(belief, *real, touched_);
  } else if (belief.surface_gp()) {
    belief.build(Quantity::height);  // what is told of a process is of its maps, too
  }
  std::vector<const GaussianProcess*> counted;  // one process may have several outputs
  const auto take = [&](const TapBelief::Output& one, std::optional<GpState>& state) {
    if (!one) return;
    const GaussianProcess& process = *one.process;
    state = state_of(one);
    FactorReport factors = process.diagnostics(one.output).factors;
    if (std::find(counted.begin(), counted.end(), &process) != counted.end()) {
      factors.raised = factors.pivoted = 0;
    } else {
      counted.push_back(&process);
      out.diagnostics["variance_clamped"] += process.variances_clamped();
    }
    out.count(factors);
  };
  take(belief.height_gp(), out.height_gp);
  take(belief.label_gp(), out.label_gp);
  if (belief.two_part()) take(belief.surface_gp(), out.surface_gp);
  if (options_.height.outlier_probability) {
    out.suspected_outliers = belief.suspected_outliers();
    if (belief.outliers() != nullptr) {
      out.count(belief.outliers()->surface().report());
      out.diagnostics["variance_clamped"] += belief.variances_clamped();
    }
  }
  if (const Footprint* footprint = belief.footprint()) {
    out.footprint = state_of(*footprint);
    // What a footprint factorises counts as what the processes do, by the names of its numbers.
    FactorReport factors;
    for (const FootprintNumber& one : out.footprint->numbers) {
      if (one.name == "jitter") factors.jitter = one.value;
      if (one.name == "jitter_raised") factors.raised = static_cast<int>(one.value);
      if (one.name == "pivoted") factors.pivoted = static_cast<int>(one.value);
      if (one.name == "redundant_taps") factors.redundant_taps = static_cast<int>(one.value);
    }
    out.count(factors);
  }
  out.diagnostics["fit_failed"] = belief.failed_fits();
  // Last, so that its maps change nothing that is counted above; not by the models beside, which only observers ask
  // for.
  if (out.forecast) {
    out.expected_rmse = out.forecast->rmse;
  } else if (belief.has_models_of(belief.surface_reads())) {
    out.expected_rmse = expected_rmse(belief);
  }
  return out;
}

}  // namespace palpate
