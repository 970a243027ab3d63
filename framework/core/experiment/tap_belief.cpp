// SPDX-License-Identifier: MIT
#include "experiment/tap_belief.hpp"

#include "config/tree.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace palpate {

// The level of an object is not known before it is touched: a thousand signals make it as good as free, unless the
// surface varies by less than a thousandth of its height.
constexpr double kFreeLevel = 1000.0;
// With outliers the level has a size: a level that may have any value makes an outlier of the first tap.
constexpr double kLevelWithOutliers = 1.0;

namespace {

EngineSettings posterior_settings(const ExperimentOptions& options, int prior_points) {
  EngineSettings out;
  out.engine = static_cast<EngineSettings::Kind>(options.engine.type);
  out.accuracy = std::min(options.engine.accuracy, 0.1 * options.tie_tolerance);
  out.tolerance = options.engine.tolerance;
  out.taps = static_cast<int>(options.taps) + prior_points;
  out.workers = std::make_shared<Workers>(static_cast<int>(options.engine.threads));
  return out;
}

bool same(const PluginChoice& a, const PluginChoice& b) {
  return a.type == b.type && a.options->canonical() == b.options->canonical();
}

GpModel make_height_gp(const ExperimentOptions& options, const EngineSettings& posterior, const Candidates& candidates,
                       const Context& context, bool only_objects) {
  const HeightOptions& height = options.height;
  GpSettings settings{height.signal, height.noise, 0.0};
  if (only_objects) settings.mean_ratio = height.outlier_probability ? kLevelWithOutliers : kFreeLevel;
  const GpModel::Data data{only_objects ? "fitting/surface" : "fitting/height", false, only_objects};
  return {data,
          height.kernel.value_or(options.kernel),
          height.fitting.value_or(options.fitting),
          settings,
          posterior,
          candidates,
          context};
}

}  // namespace

// The plugins are created at once, so that options which they reject are rejected before the first tap.
TapBelief::TapBelief(const ExperimentOptions& options, const Candidates& candidates, const Context& context,
                     PhaseClock& clock)
    : candidates_(candidates),
      context_(context),
      clock_(clock),
      log_(options, context.scene),
      posterior_(posterior_settings(options, log_.prior_size())),
      heights_(make_height_gp(options, posterior_, candidates, context, false),
               options.surface == ExperimentOptions::Surface::single, context.scene.desk()),
      label_map_(options.label.clip) {
  const HeightOptions& height = options.height;
  const LabelOptions& label = options.label;
  GpSettings settings{label.signal, label.noise, label.prior_mean};
  if (label.hyperparameters != LabelOptions::Hyperparameters::shared) {
    const PluginChoice kernel = label.kernel.value_or(options.kernel);
    labels_.emplace(GpModel::Data{"fitting/weight", true}, kernel, label.fitting.value_or(options.fitting), settings,
                    posterior_, candidates, context);
    // Models that are equal and stay so are two outputs of one process.
    const auto taps = static_cast<int>(options.taps);
    if (same(height.kernel.value_or(options.kernel), kernel) &&
        height.noise / height.signal == label.noise / label.signal && !heights_.gp().is_fitted_within(taps) &&
        !labels_->is_fitted_within(taps))
      labels_.reset();
  }
  if (joined()) {
    // By the ratio of noise to signal, the labels' noise is that of the heights.
    settings.noise = height.noise / height.signal * settings.signal;
    heights_.gp().add_labels(settings);
  }
  footprint_.emplace(options.footprint, candidates, context);
  if (footprint_->is_label_gp()) footprint_.reset();
  if (options.surface == ExperimentOptions::Surface::two_part)
    surface_.emplace(make_height_gp(options, posterior_, candidates, context, true), height.outlier_probability,
                     candidates, desk());
}

void TapBelief::observe(const Target& place, const Contact& contact, const Manner& manner) {
  log_.add(place, contact, manner, height_noise());
  if (contact.outcome == Outcome::contact) current_ = false;
}

std::vector<SuspectedOutlier> TapBelief::suspected_outliers() const {
  return outliers() != nullptr ? outliers()->suspected(log_) : std::vector<SuspectedOutlier>{};
}

double TapBelief::outlier_probability(std::size_t contact) const {
  const auto index = static_cast<Eigen::Index>(contact);
  return outliers() != nullptr && index < outliers()->probabilities().size() ? outliers()->probabilities()(index) : 0.0;
}

int TapBelief::failed_fits() const {
  return heights_.gp().failed_fits() + (labels_ ? labels_->failed_fits() : 0) +
         (surface_ ? surface_->gp().failed_fits() : 0);
}

const OutlineSample& TapBelief::outlines() const {
  static const OutlineSample none;
  return footprint_ ? footprint_->hypotheses() : none;
}

Quantities TapBelief::known(Quantities asked) const {
  const bool of_weight = asked.has(Quantity::weight) || (asked.has(Quantity::probability) && !footprint_);
  const bool of_heights = asked.has(Quantity::uncertainty) || (asked.has(Quantity::height) && !two_part()) ||
                          (of_weight && joined());  // two outputs of one process
  Quantities out = asked;
  if (asked.has(Quantity::outlines)) out = out | Quantity::probability;
  if (of_weight) out = out | Quantity::weight;
  if (of_weight && !footprint_) out = out | Quantity::probability;
  if (of_heights) out = out | Quantity::uncertainty;
  if (of_heights && !two_part()) out = out | Quantity::height;
  return out;
}

std::vector<std::string> TapBelief::models_of(Quantities quantities) const {
  const Quantities all = known(quantities);
  std::vector<std::string> out;
  if (all.has(Quantity::uncertainty)) out.emplace_back("height GP");
  if ((all.has(Quantity::height) || all.has(Quantity::doubt)) && two_part()) out.emplace_back("surface GP");
  if (all.has(Quantity::weight)) out.emplace_back("label GP");
  if (quantities.has(Quantity::probability) && footprint_) out.push_back("footprint " + footprint_->name());
  return out;
}

Quantities TapBelief::surface_reads() const {
  return two_part() ? Quantity::height | Quantity::probability : Quantity::height;
}

void TapBelief::ask(Quantities wanted) {
  asked_ = asked_ | wanted;
  build(wanted);
}

void TapBelief::build(Quantities wanted) {
  const Quantities all = known(wanted);
  const PhaseClock::Scope infer(clock_, Phase::infer);
  bool more = false;
  if (all.has(Quantity::uncertainty)) more = heights_.gp().show(0) || more;
  if (all.has(Quantity::weight)) more = (labels_ ? *labels_ : heights_.gp()).show(label_output()) || more;
  if (surface_ && (all.has(Quantity::height) || all.has(Quantity::doubt)))
    more = surface_->show(all.has(Quantity::height)) || more;
  if (footprint_ && all.has(Quantity::probability)) more = footprint_->show(all.has(Quantity::outlines)) || more;
  if (more) current_ = false;
  update();
}

bool TapBelief::has_models_of(Quantities quantities) const {
  const Quantities all = known(quantities);
  const bool of_objects = two_part() && (all.has(Quantity::height) || all.has(Quantity::doubt));
  return (height_gp() || !all.has(Quantity::uncertainty)) && (label_gp() || !all.has(Quantity::weight)) &&
         (surface_gp() || !of_objects) && (footprint() != nullptr || !footprint_ || !all.has(Quantity::probability));
}

void TapBelief::update() {
  if (current_) return;
  const PhaseClock::Scope infer(clock_, Phase::infer);
  add_data();
  find_outliers();
  update_maps();
  current_ = true;
}

template <class Visit>
void TapBelief::for_each_gp(const Visit& visit) {
  visit(heights_.gp());
  if (labels_) visit(*labels_);
  if (surface_) visit(surface_->gp());
}

/// Has all models take in the contacts since, as they are read now.
void TapBelief::add_data() {
  if (log_.has_changed_labels()) {
    log_.reset_changed_labels();
    // A GP of heights alone stays: only their values change.
    if (joined()) heights_.gp().reset();
    if (labels_) labels_->reset();
    if (surface_) surface_->reset();
    if (footprint_) footprint_->reset();
  }
  for_each_gp([&](GpModel& gp) { gp.add_data(log_, clock_); });
  if (log_.has_offset()) {
    heights_.gp().set_heights(log_);
    if (surface_) surface_->gp().set_heights(log_);
  }
  if (footprint() == nullptr) return;
  footprint_->update(log_);
  for_each_gp([&](GpModel& gp) { gp.set_positions(log_, footprint_->positions()); });
}

/// Has the models of heights trust each contact as far as it is no outlier.
void TapBelief::find_outliers() {
  Eigen::VectorXd probabilities;
  if (outliers() != nullptr) {
    surface_->find_outliers(log_, footprint());
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

void TapBelief::update_maps() {
  if (heights_.gp().is_stale()) {
    heights_.update_maps(taps());
    if (joined() && label_gp()) label_map_.update(heights_.gp().process(), label_output(), taps());
    heights_.gp().set_stale(false);
  }
  if (labels_ && labels_->is_stale()) {
    labels_->update_maps();
    label_map_.update(labels_->process(), label_output(), taps());
    labels_->set_stale(false);
  }
  if (surface_) surface_->update_maps(log_);
}

TapBelief::Output TapBelief::output(const GpModel& model, int output) {
  if (!model.shows(output)) return {};
  return {&model.process(), output, model.last_fit()};
}

const Eigen::VectorXd& TapBelief::kept(const Eigen::VectorXd& map) const {
  if (map.size() == 0) throw std::logic_error("a map of the belief is read that no reads() names");
  if (!current_) throw std::logic_error("a map of the belief is read that is older than the last tap");
  return map;
}

Quantities TapBelief::predictable(Quantities wanted) const {
  if (!surface_ || !surface_->has_outliers()) return wanted;
  Quantities out;
  if (wanted.has(Quantity::height)) out = out | Quantity::doubt;
  if (wanted.has(Quantity::probability)) out = out | Quantity::probability;
  return out;
}

Prediction TapBelief::predict(int candidate, Quantities wanted) const {
  if (!current_) throw std::logic_error("a height is predicted by a belief that is older than the last tap");
  Prediction out = surface_ && surface_->has_outliers()
                       ? surface_->predict(candidate, log_)
                       : Prediction{height_mean()(candidate), std::sqrt(height_variance()(candidate)), {}};
  if (wanted.has(Quantity::probability)) out.probability = probability()(candidate);
  return out;
}

}  // namespace palpate
