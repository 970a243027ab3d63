// SPDX-License-Identifier: MIT
#include "belief/height_map_models.hpp"

#include "config/tree.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate {

// Standard deviation of the unknown constant level of object heights, as a multiple of the signal. The multiple 1000
// makes the prior of the level practically flat, unless the surface varies by less than a thousandth of its height.
constexpr double kFreeLevel = 1000.0;
// The same multiple for a GP with an outlier model. With a practically flat prior of the level, the first object tap
// would count as an outlier.
constexpr double kLevelWithOutliers = 1.0;

namespace {

EngineSettings posterior_settings(const EngineOptions& options, const RunSettings& run, int prior_points) {
  EngineSettings out;
  out.engine = static_cast<EngineSettings::Kind>(options.type);
  out.accuracy = std::min(options.accuracy, 0.1 * run.tie_tolerance);
  out.tolerance = options.tolerance;
  out.taps = static_cast<int>(run.taps) + prior_points;
  out.workers = std::make_shared<Workers>(static_cast<int>(options.threads));
  return out;
}

bool same(const PluginChoice& a, const PluginChoice& b) {
  return a.type == b.type && a.options->canonical() == b.options->canonical();
}

GpDescription height_gp_of(const HeightGpOptions& height, const EngineSettings& engine, const Context& context,
                           bool only_objects) {
  GpSettings settings{height.signal, height.noise, 0.0};
  if (only_objects) settings.mean_ratio = height.outlier_probability ? kLevelWithOutliers : kFreeLevel;
  const PluginChoice kernel = height.kernel.value_or(context.run.kernel);
  const PluginChoice fitting = height.fitting.value_or(context.run.fitting);
  const char* const stream = only_objects ? "fitting/surface" : "fitting/height";
  return {stream, kernel, fitting, {settings}, engine, false, only_objects};
}

}  // namespace

HeightModels::HeightModels(const HeightMapOptions& options, const CandidateGrid& candidates, const Context& context)
    : context_(context),
      log_(options, context.scene),
      heights_({height_gp_of(options.height, posterior_settings(options.engine, context.run, log_.prior_size()),
                             context, false),
                candidates, context},
               options.surface == HeightMapOptions::Surface::single, context.scene.desk()),
      label_map_(options.label.clip) {
  const EngineSettings& engine = heights_.gp().engine();
  const HeightGpOptions& height = options.height;
  const LabelGpOptions& label = options.label;
  GpSettings settings{label.signal, label.noise, label.prior_mean};
  if (label.hyperparameters != LabelGpOptions::HyperparameterSource::shared) {
    const PluginChoice kernel = label.kernel.value_or(context.run.kernel);
    const PluginChoice fitting = label.fitting.value_or(context.run.fitting);
    labels_.emplace(GpDescription{"fitting/weight", kernel, fitting, {settings}, engine, true}, candidates, context);
    // If both GPs have the same covariance, and no fit changes it, they become two outputs of one GP.
    const auto taps = static_cast<int>(context.run.taps);
    if (same(height.kernel.value_or(context.run.kernel), kernel) &&
        height.noise / height.signal == label.noise / label.signal && !heights_.gp().is_fitted_within(taps) &&
        !labels_->is_fitted_within(taps))
      labels_.reset();
  }
  if (is_joined()) {
    // Both outputs have the same ratio of noise to signal, so the noise of the labels follows from the noise of the
    // heights.
    settings.noise = height.noise / height.signal * settings.signal;
    heights_.gp().add_labels(settings);
  }
  footprint_.emplace(options.footprint, candidates, context);
  if (footprint_->is_label_gp()) footprint_.reset();
  if (options.surface == HeightMapOptions::Surface::two_part)
    surface_.emplace(GpModel(height_gp_of(height, engine, context, true), candidates, context),
                     height.outlier_probability, candidates, context.scene.desk());
}

void HeightModels::add(const TapRequest& request, const TapResult& result) {
  log_.add(request, result, height_noise());
  if (result.is_contact()) is_updated_ = is_inferred_ = false;
}

void HeightModels::read_again(std::vector<TapReading>& out) const {
  out.resize(log_.contacts().size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Touch& contact = log_.contacts()[i];
    TapReading& one = out[i];
    one.tap = log_.tap_numbers()[i];
    one.position = {contact.place.x, contact.place.y, context_.scene.desk() + contact.height};
    one.on_object = contact.on;
    one.is_corrected = log_.reader().has_offset();
    one.moved = footprint_ && footprint_->has_moved(log_.prior_size() + static_cast<int>(i));
    const auto index = static_cast<Eigen::Index>(i);
    const bool is_judged = outliers() != nullptr && index < outliers()->probabilities().size();
    one.outlier_probability = is_judged ? outliers()->probabilities()(index) : 0.0;
    one.wrong_label_probability =
        one.outlier_probability > 0.0 ? std::min(one.outlier_probability, outliers()->by_label()(index)) : 0.0;
  }
}

int HeightModels::failed_fits() const {
  return heights_.gp().failed_fits() + (labels_ ? labels_->failed_fits() : 0) +
         (surface_ ? surface_->gp().failed_fits() : 0);
}

ModelSet HeightModels::models_of(const QuantitySet& quantities, bool at_one_candidate) const {
  using namespace quantity;
  const auto has = [&](const char* name) { return quantities.count(name) != 0; };
  const bool rmse = has(kExpectedRmse);
  const bool height = has(kHeightMean) || has(kHeightStd) || rmse;
  const bool probability = has(kObjectProbability) || (rmse && surface_);
  ModelSet out;
  out.footprint = footprint_ && (probability || has(kHypotheses) || has(kUndiscoveredProbability));
  out.hypotheses = footprint_ && has(kHypotheses);
  out.labels = has(kLabelMean) || (probability && !footprint_);
  if (surface_) {
    // With an outlier model, the height at one candidate can be computed without a map.
    out.surface_map = height && !(at_one_candidate && surface_->has_outliers());
    out.surface = height || has(kOutliers);
  }
  out.heights = has(kUncertainty) || has(kMeasurementStd) || (height && !surface_) || (out.labels && is_joined());
  return out;
}

std::vector<std::string> HeightModels::names_of(const ModelSet& models) const {
  std::vector<std::string> out;
  if (models.heights) out.emplace_back("height GP");
  if (models.surface) out.emplace_back("surface GP");
  if (models.labels) out.emplace_back("label GP");
  if (models.footprint) out.push_back("footprint " + footprint_->name());
  return out;
}

void HeightModels::build(const ModelSet& models) {
  const PhaseClock::Scope infer(context_.clock, Phase::infer);
  bool more = false;
  if (models.heights) more = heights_.gp().show(0) || more;
  if (models.labels) more = (labels_ ? *labels_ : heights_.gp()).show(label_output()) || more;
  if (models.surface) more = surface_->show(models.surface_map) || more;
  if (models.footprint) more = footprint_->show(models.hypotheses) || more;
  if (more) is_updated_ = false;
}

void HeightModels::update() {
  if (is_updated_) return;
  const PhaseClock::Scope infer(context_.clock, Phase::infer);
  add_data();
  find_outliers();
  is_updated_ = true;
  is_inferred_ = false;
}

template <class Visit>
void HeightModels::for_each_gp(const Visit& visit) {
  visit(heights_.gp());
  if (labels_) visit(*labels_);
  if (surface_) visit(surface_->gp());
}

/// Adds the new contacts to all models, and updates earlier contacts whose readings have changed.
void HeightModels::add_data() {
  if (log_.take_label_changes()) {
    // A GP of heights alone is not reset, because set_heights() below updates its values.
    if (is_joined()) heights_.gp().reset();
    if (labels_) labels_->reset();
    if (surface_) surface_->reset();
    if (footprint_) footprint_->reset();
  }
  for_each_gp([&](GpModel& gp) { gp.add_data(log_, context_.clock); });
  if (log_.reader().has_offset()) {
    heights_.gp().set_heights(log_);
    if (surface_) surface_->gp().set_heights(log_);
  }
  if (!footprint_ || !footprint_->is_shown()) return;
  footprint_->update(log_);
  for_each_gp([&](GpModel& gp) { gp.set_positions(log_, footprint_->positions()); });
}

/// Updates the outlier probabilities. Then sets the trust in each contact accordingly, in the height GP and in the
/// surface GP.
void HeightModels::find_outliers() {
  Eigen::VectorXd probabilities;
  if (outliers() != nullptr) {
    surface_->find_outliers(log_, footprint_ && footprint_->is_shown() ? &footprint_->plugin() : nullptr);
    probabilities = outliers()->probabilities();
  } else if (log_.has_uneven_noise()) {
    probabilities = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(log_.contacts().size()));
  } else {
    return;
  }
  const Eigen::VectorXd trust = log_.trust(probabilities, height_noise());
  heights_.gp().set_trust(log_, trust);
  if (surface_) surface_->gp().set_trust(log_, trust);
}

void HeightModels::infer() {
  if (is_inferred_) return;
  const PhaseClock::Scope infer(context_.clock, Phase::infer);
  if (heights_.gp().is_stale()) {
    heights_.update_maps(log_.taps());
    if (is_joined() && label_model().shows(label_output()))
      label_map_.update(heights_.gp().process(), label_output(), log_.taps());
    heights_.gp().set_stale(false);
  }
  if (labels_ && labels_->is_stale()) {
    labels_->update_maps();
    label_map_.update(labels_->process(), label_output(), log_.taps());
    labels_->set_stale(false);
  }
  if (surface_) surface_->update_maps(log_);
  is_inferred_ = true;
}

HeightModels::Gps HeightModels::gps() const {
  const auto output = [](const GpModel& model, int index) {
    return model.shows(index) ? Output{&model.process(), index, model.last_fit()} : Output();
  };
  return {output(heights_.gp(), 0), output(label_model(), label_output()), output(surface_model(), 0)};
}

Prediction HeightModels::predict(Eigen::Index candidate, bool probability) const {
  if (!is_inferred()) throw std::logic_error("a height is predicted by a belief that is older than the last tap");
  Prediction out = surface_ && surface_->has_outliers()
                       ? surface_->predict(static_cast<int>(candidate), log_)
                       : Prediction{height_mean()(candidate), std::sqrt(height_variance()(candidate))};
  if (probability) out.probability = this->probability()(candidate);
  return out;
}

}  // namespace palpate
