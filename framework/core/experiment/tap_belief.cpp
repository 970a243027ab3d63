// SPDX-License-Identifier: MIT
#include "experiment/tap_belief.hpp"

#include "config/tree.hpp"
#include "experiment/policy.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace palpate {

// The level of an object is not known before it is touched: a thousand signals make it as good as free, unless the
// surface varies by less than a thousandth of its height.
constexpr double kFreeLevel = 1000.0;
// Where taps may lie the level has to be of some size: what may be anything at all makes a lie of the first tap.
constexpr double kLevelAmongLies = 1.0;

namespace {

PosteriorSettings posterior_settings(const ExperimentOptions& options) {
  PosteriorSettings out;
  out.engine = static_cast<PosteriorSettings::Kind>(options.engine.type);
  out.accuracy = std::min(options.engine.accuracy, 0.1 * options.tie_tolerance);
  out.tolerance = options.engine.tolerance;
  out.taps = static_cast<int>(options.taps);
  out.workers = std::make_shared<Workers>(static_cast<int>(options.engine.threads));
  return out;
}

bool same(const PluginChoice& a, const PluginChoice& b) {
  return a.type == b.type && a.options->canonical() == b.options->canonical();
}

}  // namespace

// The plugins are made at once, so that options which they refuse are refused before the first tap.
TapBelief::Model TapBelief::make_model(const char* name, const PluginChoice& kernel, const PluginChoice& fitting,
                                       const ProcessSettings& settings) const {
  Model model;
  model.name = name;
  model.kernel_choice = kernel;
  model.fitting_choice = fitting;
  model.kernel = context_.create<Kernel>(kernel);
  model.fitting = context_.create<Fitting>(fitting);
  model.outputs = {settings};
  const std::string refusal = model.fitting->objection(*model.kernel);
  if (!refusal.empty()) throw Error(fitting.options->place.text(), refusal);
  const std::string why = objection(posterior_, *model.kernel, candidates_);
  if (!why.empty()) {
    const char* const engine = posterior_.engine == PosteriorSettings::Kind::grid ? "grid" : "lowrank";
    throw Error("engine.type", fmt::format("{} cannot be used with the kernel {}: {}", engine, kernel.type, why),
                "engine: {type: dense} serves every kernel");
  }
  return model;
}

TapBelief::TapBelief(const ExperimentOptions& options, const Candidates& candidates, const Context& context,
                     PhaseClock& clock)
    : candidates_(candidates),
      context_(context),
      clock_(clock),
      posterior_(posterior_settings(options)),
      desk_(context.scene.desk()),
      clip_(options.label.clip),
      two_part_(options.surface == ExperimentOptions::Surface::two_part),
      sights_(sights_of(options.prior, context.scene)),
      lies_(two_part_ ? options.height.outlier_probability : std::nullopt),
      doubted_(candidates) {
  posterior_.taps += static_cast<int>(sights_.size());
  const HeightOptions& height = options.height;
  const LabelOptions& label = options.label;
  const PluginChoice height_kernel = height.kernel.value_or(options.kernel);
  const PluginChoice height_fitting = height.fitting.value_or(options.fitting);
  const PluginChoice label_kernel = label.kernel.value_or(options.kernel);
  const bool shared = label.hyperparameters == LabelOptions::Hyperparameters::shared;
  heights_ = make_model("fitting/height", height_kernel, height_fitting, {height.signal, height.noise, 0.0});
  ProcessSettings settings{label.signal, label.noise, label.prior_mean};
  if (!shared) labels_ = make_model("fitting/weight", label_kernel, label.fitting.value_or(options.fitting), settings);
  labels_.of_labels = true;
  joined_ = shared || (same(height_kernel, label_kernel) && equal_for_good(options));
  if (joined_) {
    // By the ratio of noise to signal, the labels' noise is that of the heights.
    settings.noise = height.noise / height.signal * settings.signal;
    heights_.outputs.push_back(settings);
  }
  if (height.offset) systematic_.emplace(height.offset->offset, height.offset->drift, height.offset->noise);
  footprint_choice_ = options.footprint;
  footprint_ = context.create<Footprint>(footprint_choice_);
  if (footprint_->is_weight()) footprint_.reset();
  if (two_part_) {
    object_ = make_model("fitting/surface", height_kernel, height_fitting,
                         {height.signal, height.noise, 0.0, lies_ ? kLevelAmongLies : kFreeLevel});
  }
  for (std::size_t i = 0; i < sights_.size(); ++i) {
    if (sights_[i].touch.on) hits_seen_.push_back(i);
  }
  uneven_ = !sights_.empty();
}

const Touch& TapBelief::datum(const Model& model, int number) const {
  const auto at = static_cast<std::size_t>(number);
  const auto before = static_cast<std::size_t>(seen(model));
  if (at >= before) return (of_hits(model) ? hits_ : touches_)[at - before];
  return sights_[of_hits(model) ? hits_seen_[at] : at].touch;
}

bool TapBelief::equal_for_good(const ExperimentOptions& options) const {
  const HeightOptions& height = options.height;
  const LabelOptions& label = options.label;
  if (height.noise / height.signal != label.noise / label.signal) return false;
  for (int taps = 1; taps <= options.taps; ++taps) {
    if (heights_.fitting->due(taps) || labels_.fitting->due(taps)) return false;
  }
  return true;
}

void TapBelief::observe(const Target& place, const Contact& contact, const Manner& manner) {
  targets_.push_back(place);
  initial_taps_ += manner.initial ? 1 : 0;
  const double began = seconds_;
  const Reading reading = read(contact, manner.motion);
  seconds_ += contact.seconds;
  if (contact.outcome != Outcome::contact) return;
  touches_.push_back({place, reading.height - desk_, reading.on});
  numbers_.push_back(taps());
  const double noise = height_noise();
  const double share =
      manner.roughness > 0.0 ? noise * noise / (noise * noise + manner.roughness * manner.roughness) : 1.0;
  share_.push_back(std::round(share * kSteps) / kSteps);
  uneven_ = uneven_ || share_.back() < 1.0;
  motions_.push_back(manner.motion);
  if (reading.on) hits_.push_back(touches_.back());
  current_ = false;
  if (!systematic_) return;
  first_labels_.push_back(reading.on);
  excess_.push_back(contact.height - desk_);
  times_.push_back(began);
  systematic_->add(place, began, excess_.back(), manner.motion);
  read_again();
}

std::optional<int> TapBelief::first_hit_tap() const {
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    if (touches_[i].on) return numbers_[i];
  }
  return std::nullopt;
}

std::vector<Relabelled> TapBelief::relabelled() const {
  std::vector<Relabelled> out;
  for (std::size_t i = 0; i < first_labels_.size(); ++i) {
    if (touches_[i].on != first_labels_[i]) out.push_back({numbers_[i], touches_[i].on});
  }
  return out;
}

TapBelief::Reading TapBelief::read(const Contact& contact, int motion) const {
  if (!systematic_) return {contact.height, context_.scene.on_object(contact.height)};
  // Until the desk is known, what is hardly higher than it may be is more probably the desk than so low an object.
  const Systematic::Estimate estimate = systematic_->at(seconds_, motion);
  const double height = contact.height - estimate.value;
  const double unsure =
      Systematic::kClearly * std::sqrt(estimate.variance + systematic_->noise() * systematic_->noise());
  return {height, context_.scene.on_object(height) && height - desk_ > unsure};
}

std::vector<TapBelief::SuspectedOutlier> TapBelief::suspected_outliers() const {
  std::vector<SuspectedOutlier> out;
  for (std::size_t i = 0; i < static_cast<std::size_t>(doubt_.size()); ++i) {
    const double doubt = doubt_of(i);
    if (doubt >= kWorthALook)
      out.push_back({numbers_[i], doubt, std::min(doubt, by_label_(static_cast<Eigen::Index>(i)))});
  }
  return out;
}

std::optional<Systematic::Estimate> TapBelief::systematic(int motion) const {
  return systematic_ ? std::optional(systematic_->at(seconds_, motion)) : std::nullopt;
}

Quantities TapBelief::known(Quantities asked) const {
  const bool of_weight = asked.has(Quantity::weight) || (asked.has(Quantity::probability) && !footprint_);
  const bool of_heights = asked.has(Quantity::uncertainty) || (asked.has(Quantity::height) && !two_part_) ||
                          (of_weight && joined_);  // two outputs of one process
  Quantities out = asked;
  if (asked.has(Quantity::outlines)) out = out | Quantity::probability;
  if (of_weight) out = out | Quantity::weight;
  if (of_weight && !footprint_) out = out | Quantity::probability;
  if (of_heights) out = out | Quantity::uncertainty;
  if (of_heights && !two_part_) out = out | Quantity::height;
  return out;
}

std::vector<std::string> TapBelief::models_of(Quantities quantities) const {
  const Quantities all = known(quantities);
  std::vector<std::string> out;
  if (all.has(Quantity::uncertainty)) out.emplace_back("height GP");
  if ((all.has(Quantity::height) || all.has(Quantity::doubt)) && two_part_) out.emplace_back("surface GP");
  if (all.has(Quantity::weight)) out.emplace_back("label GP");
  if (quantities.has(Quantity::probability) && footprint_) out.push_back("footprint " + footprint_choice_.type);
  return out;
}

Quantities TapBelief::surface_reads() const {
  return two_part_ ? Quantity::height | Quantity::probability : Quantity::height;
}

void TapBelief::ask(Quantities wanted) {
  asked_ = asked_ | wanted;
  build(wanted);
}

void TapBelief::build(Quantities wanted) {
  const Quantities all = known(wanted);
  const PhaseClock::Scope infer(clock_, Phase::infer);
  if (all.has(Quantity::uncertainty)) show(heights_, 0);
  if (all.has(Quantity::weight)) show(joined_ ? heights_ : labels_, label_output());
  if (two_part_ && (all.has(Quantity::height) || all.has(Quantity::doubt))) show(object_, 0);
  if (two_part_ && all.has(Quantity::height) && !height_asked_) {
    height_asked_ = object_.stale = true;
    current_ = false;
  }
  if (footprint_ && all.has(Quantity::probability) && !footprint_asked_) {
    footprint_asked_ = true;
    current_ = false;
  }
  if (footprint_ && all.has(Quantity::outlines) && !outlines_asked_) {
    outlines_asked_ = true;
    probability_.resize(0);
    current_ = false;
  }
  update();
}

bool TapBelief::has_models_of(Quantities quantities) const {
  const Quantities all = known(quantities);
  const bool of_hits = two_part_ && (all.has(Quantity::height) || all.has(Quantity::doubt));
  return (height_gp() || !all.has(Quantity::uncertainty)) && (label_gp() || !all.has(Quantity::weight)) &&
         (surface_gp() || !of_hits) && (footprint_asked_ || !footprint_ || !all.has(Quantity::probability));
}

void TapBelief::show(Model& model, int output) {
  if (!model.process) {
    model.process = std::make_unique<Process>(model.kernel, model.outputs, candidates_, posterior_);
  } else if (model.process->shown() > output) {
    return;
  }
  model.process->show(output + 1);
  model.stale = true;
  current_ = false;
}

void TapBelief::update() {
  if (current_) return;
  const PhaseClock::Scope infer(clock_, Phase::infer);
  if (flipped_) begin_again();
  for (Model* model : {&heights_, &labels_, &object_}) {
    if (model->process) take_in(*model);
  }
  if (systematic_) correct();
  if (footprint_asked_) {
    map_footprint();
    follow();
  }
  if (lies_ && object_.process) {
    judge();
  } else if (uneven_) {
    doubt_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(touches_.size()));
    believe();
    doubt_.resize(0);
  }
  if (heights_.stale) map_heights();
  if (labels_.stale) map_labels();
  // The judgement has a surface of its own, so that maps of the process are wanted without one, and for the record.
  if (object_.process && (height_asked_ || !is_judged())) object_.process->update_maps();
  if (object_.stale && height_asked_) map_object();
  current_ = true;
}

void TapBelief::take_in(Model& model) {
  // One by one, fits included: a process that is asked for late, or after a resume, goes through the very states that
  // one which was there from the first tap went through.
  Process& process = *model.process;
  while (process.size() < data(model)) {
    const Touch& touch = datum(model, process.size());
    const double label = touch.on ? 1.0 : 0.0;
    const std::array<double, 2> values{model.of_labels ? label : touch.height, label};
    process.add(touch.place,
                Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(model.outputs.size())));
    const int taps = process.size() - seen(model);
    if (taps > 0 && model.fitting->due(taps)) fit(model);
    model.stale = true;
  }
}

void TapBelief::fit(Model& model) {
  const PhaseClock::Scope fit(clock_, Phase::fit);
  const int taps = model.process->size() - seen(model);
  Random random = context_.random(model.name, static_cast<std::uint64_t>(taps));
  model.fit = model.process->fit(*model.fitting, random);
  model.fit_at = model.process->size();
  if (model.fit.failed) ++model.failed_fits;
}

TapBelief::Output TapBelief::output(const Model& model, int output) {
  if (!model.process || model.process->shown() <= output) return {};
  const Process& process = *model.process;
  const bool fitted = model.fit_at > 0 && model.fit_at == process.size();
  return {&process, output, fitted ? &model.fit : nullptr};
}

void TapBelief::map_heights() {
  Process& process = *heights_.process;
  process.update_maps();
  process.read_relative_variance(uncertainty_);
  process.read_variance(0, variance_);
  require_finite(variance_, "the variance of the height GP", taps());  // and with it u
  if (!two_part_) map_surface(process);
  if (joined_ && process.shown() > label_output()) map_labels();
  heights_.stale = false;
}

void TapBelief::map_labels() {
  labels().process->update_maps();
  labels().process->read_mean(label_output(), weight_mean_);
  require_finite(weight_mean_, "the weight w", taps());
  const auto clipped = weight_mean_.cwiseMax(0.0).cwiseMin(1.0);
  if (clip_) weight_ = clipped;
  if (!footprint_) probability_ = clipped;
  labels_.stale = false;
}

void TapBelief::map_object() {
  if (is_judged()) {
    doubted_.read_mean(*object_.process, height_mean_);
    height_mean_.array() += desk_;
    doubted_.read_variance(*object_.process, object_variance_);
  } else {
    map_surface(*object_.process);
    object_.process->read_variance(0, object_variance_);
  }
  object_variance_.array() += shared_variance();
  require_finite(height_mean_, "the height", taps());
  require_finite(object_variance_, "the variance of the height", taps());
  object_.stale = false;
}

void TapBelief::map_surface(const Process& process) {
  process.read_mean(0, height_mean_);
  height_mean_.array() += desk_;
  require_finite(height_mean_, "the height", taps());
}

void TapBelief::map_footprint() {
  if (probability_.size() > 0 && touches_taken_ == touches_.size()) return;
  for (std::size_t i = 0; i < sights_.size() && !sights_taken_; ++i) footprint_->add(sights_[i].touch);
  sights_taken_ = true;
  for (; touches_taken_ < touches_.size(); ++touches_taken_) footprint_->add(touches_[touches_taken_]);
  probability_.resize(candidates_.size());
  footprint_->probability(candidates_.points, probability_);
  require_finite(probability_, "the probability p", taps());
  if (outlines_asked_) footprint_->sample(candidates_.points, outlines_);
}

const Eigen::VectorXd& TapBelief::kept(const Eigen::VectorXd& map) const {
  if (map.size() == 0) throw std::logic_error("a map of the belief is read that no reads() names");
  if (!current_) throw std::logic_error("a map of the belief is read that is older than the last tap");
  return map;
}

Quantities TapBelief::predictable(Quantities wanted) const {
  if (!lies_) return wanted;
  Quantities out;
  if (wanted.has(Quantity::height)) out = out | Quantity::doubt;
  if (wanted.has(Quantity::probability)) out = out | Quantity::probability;
  return out;
}

Prediction TapBelief::predict_among_lies(int candidate) const {
  if (!current_) throw std::logic_error("a height is predicted by a belief that is older than the last tap");
  DoubtedSurface::Height height;
  if (is_judged()) {
    height = doubted_.at(*object_.process, candidate);
  } else {
    Eigen::VectorXd map;
    object_.process->read_mean(0, map);
    height.mean = map(candidate);
    object_.process->read_variance(0, map);
    height.variance = map(candidate);
  }
  return {height.mean + desk_, std::sqrt(height.variance + shared_variance()), {}};
}

Prediction TapBelief::predict(int candidate, Quantities wanted) const {
  // Whether there are maps or not, a prediction is the same to the last bit.
  Prediction out = lies_ ? predict_among_lies(candidate)
                         : Prediction{height_mean()(candidate), std::sqrt(height_variance()(candidate)), {}};
  if (wanted.has(Quantity::probability)) out.probability = probability()(candidate);
  return out;
}

double TapBelief::height_noise() const {
  const Model& model = surface();
  return model.process ? model.process->settings().noise : model.outputs.front().noise;
}

}  // namespace palpate
