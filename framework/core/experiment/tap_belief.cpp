// SPDX-License-Identifier: MIT
#include "experiment/tap_belief.hpp"

#include "config/tree.hpp"
#include "experiment/policy.hpp"

#include <palpate/error.hpp>

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

PosteriorSettings posterior_settings(const ExperimentOptions& options, int prior_points) {
  PosteriorSettings out;
  out.engine = static_cast<PosteriorSettings::Kind>(options.engine.type);
  out.accuracy = std::min(options.engine.accuracy, 0.1 * options.tie_tolerance);
  out.tolerance = options.engine.tolerance;
  out.taps = static_cast<int>(options.taps) + prior_points;
  out.workers = std::make_shared<Workers>(static_cast<int>(options.engine.threads));
  return out;
}

bool same(const PluginChoice& a, const PluginChoice& b) {
  return a.type == b.type && a.options->canonical() == b.options->canonical();
}

GpModel make_height_gp(const ExperimentOptions& options, const PosteriorSettings& posterior,
                       const Candidates& candidates, const Context& context, bool only_objects) {
  const HeightOptions& height = options.height;
  ProcessSettings settings{height.signal, height.noise, 0.0};
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
      clip_(options.label.clip),
      log_(options, context.scene),
      posterior_(posterior_settings(options, log_.prior_size())),
      heights_(make_height_gp(options, posterior_, candidates, context, false)) {
  const HeightOptions& height = options.height;
  const LabelOptions& label = options.label;
  ProcessSettings settings{label.signal, label.noise, label.prior_mean};
  if (label.hyperparameters != LabelOptions::Hyperparameters::shared) {
    const PluginChoice kernel = label.kernel.value_or(options.kernel);
    labels_.emplace(GpModel::Data{"fitting/weight", true}, kernel, label.fitting.value_or(options.fitting), settings,
                    posterior_, candidates, context);
    // Models that are equal and stay so are two outputs of one process.
    const auto taps = static_cast<int>(options.taps);
    if (same(height.kernel.value_or(options.kernel), kernel) &&
        height.noise / height.signal == label.noise / label.signal && !heights_.is_fitted_within(taps) &&
        !labels_->is_fitted_within(taps))
      labels_.reset();
  }
  if (joined()) {
    // By the ratio of noise to signal, the labels' noise is that of the heights.
    settings.noise = height.noise / height.signal * settings.signal;
    heights_.add_labels(settings);
  }
  footprint_.emplace(options.footprint, candidates, context);
  if (footprint_->is_label_gp()) footprint_.reset();
  if (options.surface != ExperimentOptions::Surface::two_part) return;
  objects_.emplace(make_height_gp(options, posterior_, candidates, context, true));
  if (height.outlier_probability) outliers_.emplace(*height.outlier_probability, candidates);
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
  return heights_.failed_fits() + (labels_ ? labels_->failed_fits() : 0) + (objects_ ? objects_->failed_fits() : 0);
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
  if (all.has(Quantity::uncertainty)) more = heights_.show(0) || more;
  if (all.has(Quantity::weight)) more = (labels_ ? *labels_ : heights_).show(label_output()) || more;
  if (objects_ && (all.has(Quantity::height) || all.has(Quantity::doubt))) more = objects_->show(0) || more;
  if (objects_ && all.has(Quantity::height) && !height_asked_) {
    height_asked_ = more = true;
    objects_->set_stale(true);
  }
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

/// Has all models take in the contacts since, as they are read now.
void TapBelief::add_data() {
  if (log_.has_changed_labels()) {
    log_.reset_changed_labels();
    // Models with labels of their own begin again; of heights alone, corrections change the values.
    if (joined()) heights_.reset();
    if (labels_) labels_->reset();
    if (objects_) objects_->reset();
    if (outliers_) outliers_->reset();
    if (footprint_) footprint_->reset();
  }
  heights_.add_data(log_, clock_);
  if (labels_) labels_->add_data(log_, clock_);
  if (objects_) objects_->add_data(log_, clock_);
  if (log_.has_offset()) {
    heights_.set_heights(log_);
    if (objects_) objects_->set_heights(log_);
  }
  if (footprint() == nullptr) return;
  footprint_->update(log_);
  heights_.set_positions(log_, footprint_->positions());
  if (labels_) labels_->set_positions(log_, footprint_->positions());
  if (objects_) objects_->set_positions(log_, footprint_->positions());
}

/// Has the models of heights trust each contact as far as it is no outlier.
void TapBelief::find_outliers() {
  Eigen::VectorXd probabilities;
  if (outliers() != nullptr) {
    Eigen::VectorXd label_error = Eigen::VectorXd::Zero(log_.size());
    if (footprint() != nullptr) footprint()->doubt(label_error);
    if (outliers_->update(log_, *objects_, label_error)) objects_->set_stale(true);
    probabilities = outliers_->probabilities();
  } else if (log_.has_uneven_noise()) {
    probabilities = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(log_.contacts().size()));
  } else {
    return;
  }
  const Eigen::VectorXd trust = log_.trust(probabilities, height_noise());
  heights_.set_trust(log_, trust);
  if (objects_) objects_->set_trust(log_, trust);
}

void TapBelief::update_maps() {
  if (heights_.is_stale()) map_heights();
  if (labels_ && labels_->is_stale()) map_labels();
  if (!objects_ || !objects_->is_built()) return;
  // The surface without outliers has maps of its own, so that those of the process are for the record.
  if (height_asked_ || !outliers_are_surface()) objects_->update_maps();
  if (objects_->is_stale() && height_asked_) map_objects();
}

TapBelief::Output TapBelief::output(const GpModel& model, int output) {
  if (!model.shows(output)) return {};
  return {&model.process(), output, model.last_fit()};
}

void TapBelief::map_heights() {
  heights_.update_maps();
  const Process& process = heights_.process();
  process.read_relative_variance(uncertainty_);
  process.read_variance(0, variance_);
  require_finite(variance_, "the variance of the height GP", taps());  // and with it u
  if (!two_part()) map_surface(process);
  if (joined() && heights_.shows(label_output())) map_labels();
  heights_.set_stale(false);
}

void TapBelief::map_labels() {
  if (labels_) labels_->update_maps();
  labels().process().read_mean(label_output(), weight_mean_);
  require_finite(weight_mean_, "the weight w", taps());
  const auto clipped = weight_mean_.cwiseMax(0.0).cwiseMin(1.0);
  if (clip_) weight_ = clipped;
  if (!footprint_) probability_ = clipped;
  if (labels_) labels_->set_stale(false);
}

void TapBelief::map_objects() {
  const Process& process = objects_->process();
  if (outliers_are_surface()) {
    DoubtedSurface& surface = outliers_->surface();
    surface.read_mean(process, height_mean_);
    height_mean_.array() += desk();
    surface.read_variance(process, object_variance_);
  } else {
    map_surface(process);
    process.read_variance(0, object_variance_);
  }
  object_variance_.array() += log_.offset_variance();
  require_finite(height_mean_, "the height", taps());
  require_finite(object_variance_, "the variance of the height", taps());
  objects_->set_stale(false);
}

void TapBelief::map_surface(const Process& process) {
  process.read_mean(0, height_mean_);
  height_mean_.array() += desk();
  require_finite(height_mean_, "the height", taps());
}

const Eigen::VectorXd& TapBelief::kept(const Eigen::VectorXd& map) const {
  if (map.size() == 0) throw std::logic_error("a map of the belief is read that no reads() names");
  if (!current_) throw std::logic_error("a map of the belief is read that is older than the last tap");
  return map;
}

Quantities TapBelief::predictable(Quantities wanted) const {
  if (!outliers_) return wanted;
  Quantities out;
  if (wanted.has(Quantity::height)) out = out | Quantity::doubt;
  if (wanted.has(Quantity::probability)) out = out | Quantity::probability;
  return out;
}

Prediction TapBelief::predict_without_outliers(int candidate) const {
  if (!current_) throw std::logic_error("a height is predicted by a belief that is older than the last tap");
  DoubtedSurface::Height height;
  if (outliers_are_surface()) {
    height = outliers_->surface().at(objects_->process(), candidate);
  } else {
    Eigen::VectorXd map;
    objects_->process().read_mean(0, map);
    height.mean = map(candidate);
    objects_->process().read_variance(0, map);
    height.variance = map(candidate);
  }
  return {height.mean + desk(), std::sqrt(height.variance + log_.offset_variance()), {}};
}

Prediction TapBelief::predict(int candidate, Quantities wanted) const {
  // Whether there are maps or not, a prediction is the same to the last bit.
  Prediction out = outliers_ ? predict_without_outliers(candidate)
                             : Prediction{height_mean()(candidate), std::sqrt(height_variance()(candidate)), {}};
  if (wanted.has(Quantity::probability)) out.probability = probability()(candidate);
  return out;
}

}  // namespace palpate
