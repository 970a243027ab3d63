// SPDX-License-Identifier: MIT
#include "experiment/tap_belief.hpp"

#include "config/tree.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

namespace palpate {

// The level of an object is not known before it is touched: a thousand signals make it as good as free, unless the
// surface varies by less than a thousandth of its height.
constexpr double kFreeLevel = 1000.0;

namespace {

constexpr std::array<const char*, 4> kEngineNames{"auto", "dense", "grid", "lowrank"};

PosteriorSettings posterior_settings(const ExperimentOptions& options) {
  PosteriorSettings out;
  out.engine = static_cast<PosteriorSettings::Kind>(options.posterior);
  out.accuracy = std::min(options.accuracy, 0.1 * options.tie_tolerance);
  out.tolerance = options.lowrank.tolerance;
  out.single = options.lowrank.precision == LowrankOptions::Precision::single;
  out.taps = static_cast<int>(options.taps);
  out.machine.loops = &loops_of(options);
  out.machine.workers = std::make_shared<Workers>(static_cast<int>(options.threads));
  return out;
}

bool same(const PluginChoice& a, const PluginChoice& b) {
  return a.type == b.type && a.options->canonical() == b.options->canonical();
}

}  // namespace

const simd::Table& loops_of(const ExperimentOptions& options) {
  const bool baseline = options.instruction_set == ExperimentOptions::InstructionSet::baseline;
  return baseline ? simd::baseline() : simd::fastest();
}

// The plugins are made at once, so that options which they refuse are refused before the first tap.
TapBelief::Model TapBelief::make_model(const char* name, const PluginChoice& kernel, const PluginChoice& fitting,
                                       const ProcessSettings& settings) const {
  Model model;
  model.name = name;
  model.kernel = context_.create<Kernel>(kernel);
  model.fitting = context_.create<Fitting>(fitting);
  model.outputs = {settings};
  const std::string refusal = model.fitting->objection(*model.kernel);
  if (!refusal.empty()) throw Error(fitting.options->place.text(), refusal);
  const std::string why = objection(posterior_, *model.kernel, candidates_);
  if (!why.empty()) {
    throw Error("posterior",
                fmt::format("{} cannot be used with the kernel {}, {}",
                            kEngineNames[static_cast<std::size_t>(posterior_.engine)], kernel.type, why),
                "posterior: dense serves every kernel");
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
      clip_(options.weight.clip),
      two_part_(options.surface == ExperimentOptions::Surface::two_part) {
  const HeightOptions& height = options.height;
  const WeightOptions& weight = options.weight;
  const PluginChoice height_kernel = height.kernel.value_or(options.kernel);
  const PluginChoice height_fitting = height.fitting.value_or(options.fitting);
  const PluginChoice weight_kernel = weight.kernel.value_or(options.kernel);
  const bool shared = weight.hyperparameters == WeightOptions::Hyperparameters::shared;
  heights_ = make_model("fitting/height", height_kernel, height_fitting, {height.signal, height.noise, 0.0});
  ProcessSettings label{weight.signal, weight.noise, weight.prior_mean};
  if (!shared) labels_ = make_model("fitting/weight", weight_kernel, weight.fitting.value_or(options.fitting), label);
  labels_.of_labels = true;
  joined_ = shared || (same(height_kernel, weight_kernel) && equal_for_good(options));
  if (joined_) {
    // By the ratio of noise to signal, the labels' noise is that of the heights.
    label.noise = height.noise / height.signal * label.signal;
    heights_.outputs.push_back(label);
  }
  footprint_ = context.create<Footprint>(options.footprint);
  if (footprint_->is_weight()) footprint_.reset();
  if (two_part_) {
    object_ =
        make_model("fitting/surface", height_kernel, height_fitting, {height.signal, height.noise, 0.0, kFreeLevel});
  }
}

bool TapBelief::equal_for_good(const ExperimentOptions& options) const {
  const HeightOptions& height = options.height;
  const WeightOptions& weight = options.weight;
  if (height.noise / height.signal != weight.noise / weight.signal) return false;
  for (int taps = 1; taps <= options.taps; ++taps) {
    if (heights_.fitting->due(taps) || labels_.fitting->due(taps)) return false;
  }
  return true;
}

void TapBelief::observe(const Target& place, const Contact& contact, bool initial) {
  ++taps_;
  initial_taps_ += initial ? 1 : 0;
  if (contact.outcome != Outcome::contact) return;
  const bool on = context_.scene.on_surface(contact.height);
  const Datum datum{place, contact.height - desk_, on ? 1.0 : 0.0};
  if (footprint_) touches_.push_back({place, datum.height, on});
  heights_.data.push_back(datum);
  if (!joined_) labels_.data.push_back(datum);
  if (on) object_.data.push_back(datum);
}

Process& TapBelief::ready(Model& model, int output) const {
  const PhaseClock::Scope infer(clock_, Phase::infer);
  if (!model.process) {
    PosteriorSettings posterior = posterior_;
    if (&model != &heights_) posterior.score = simd::Score::none;
    model.process = std::make_unique<Process>(model.kernel, model.outputs, candidates_, posterior);
  }
  Process& process = *model.process;
  process.show(output + 1);
  // One by one, fits included: a process that is read late, or after a resume, goes through the very states that one
  // read at every tap went through.
  while (process.size() < static_cast<int>(model.data.size())) {
    const Datum& datum = model.data[static_cast<std::size_t>(process.size())];
    const std::array<double, 2> values{model.of_labels ? datum.label : datum.height, datum.label};
    process.add(datum.place,
                Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(model.outputs.size())));
    if (model.fitting->due(process.size())) fit(model);
  }
  return process;
}

void TapBelief::fit(Model& model) const {
  const PhaseClock::Scope fit(clock_, Phase::fit);
  const int taps = model.process->size();
  Random random = context_.random(model.name, static_cast<std::uint64_t>(taps));
  model.fit = model.process->fit(*model.fitting, random);
  model.fit_at = taps;
  if (model.fit.failed) ++failed_fits_;
}

TapBelief::Quantity TapBelief::quantity(Model& model, int output) const {
  if (!model.process || model.process->shown() <= output) return {};
  const Process& process = ready(model, output);
  const bool fitted = model.fit_at > 0 && model.fit_at == process.size();
  return {&process, output, fitted ? &model.fit : nullptr};
}

void TapBelief::form(Product product) {
  if (product == Product::uncertainty) posterior_.score = simd::Score::variance;
  if (product == Product::weighted && joined_) {
    posterior_.score = clip_ ? simd::Score::weighted_clipped : simd::Score::weighted;
  }
}

const Scores* TapBelief::formed() const {
  if (posterior_.score == simd::Score::none) return nullptr;
  return &ready(heights_, posterior_.score == simd::Score::variance ? 0 : 1);
}

template <class Read>
const Eigen::VectorXd& TapBelief::read(Map& map, Model& model, int output, Read read) const {
  const int known = static_cast<int>(model.data.size());
  if (map.taps != known) {
    const Process& process = ready(model, output);
    const PhaseClock::Scope infer(clock_, Phase::infer);
    map.values.resize(candidates_.size());
    read(process, map.values);
    map.taps = known;
  }
  return map.values;
}

const Eigen::VectorXd& TapBelief::uncertainty() const {
  return read(uncertainty_map_, heights_, 0,
              [](const Process& process, Eigen::VectorXd& out) { process.read_relative_variance(out); });
}

const Eigen::VectorXd& TapBelief::weight_mean() const {
  return read(weight_mean_map_, labels(), label_output(),
              [this](const Process& process, Eigen::VectorXd& out) { process.read_mean(label_output(), out); });
}

const Eigen::VectorXd& TapBelief::weight() const {
  if (!clip_) return weight_mean();
  return read(weight_map_, labels(), label_output(), [this](const Process& process, Eigen::VectorXd& out) {
    process.read_mean(label_output(), out);
    out = out.cwiseMax(0.0).cwiseMin(1.0);
  });
}

Footprint& TapBelief::ready_footprint() const {
  for (; touches_taken_ < touches_.size(); ++touches_taken_) footprint_->add(touches_[touches_taken_]);
  return *footprint_;
}

const Footprint* TapBelief::footprint() const {
  if (!footprint_read_) return nullptr;
  const PhaseClock::Scope infer(clock_, Phase::infer);
  return &ready_footprint();
}

const Eigen::VectorXd& TapBelief::probability() const {
  if (!footprint_) {
    return read(probability_map_, labels(), label_output(), [this](const Process& process, Eigen::VectorXd& out) {
      process.read_mean(label_output(), out);
      out = out.cwiseMax(0.0).cwiseMin(1.0);
    });
  }
  const int known = static_cast<int>(touches_.size());
  if (probability_map_.taps != known) {
    const PhaseClock::Scope infer(clock_, Phase::infer);
    probability_map_.values.resize(candidates_.size());
    ready_footprint().probability(candidates_.points, probability_map_.values);
    probability_map_.taps = known;
    footprint_read_ = true;
  }
  return probability_map_.values;
}

const Eigen::VectorXd& TapBelief::height_mean() const {
  return read(mean_map_, surface(), 0, [this](const Process& process, Eigen::VectorXd& out) {
    process.read_mean(0, out);
    out.array() += desk_;
  });
}

const Eigen::VectorXd& TapBelief::all_taps_variance() const {
  return read(all_taps_map_, heights_, 0,
              [](const Process& process, Eigen::VectorXd& out) { process.read_variance(0, out); });
}

const Eigen::VectorXd& TapBelief::height_variance() const {
  if (!two_part_) return all_taps_variance();
  return read(variance_map_, surface(), 0,
              [](const Process& process, Eigen::VectorXd& out) { process.read_variance(0, out); });
}

double TapBelief::height_noise() const {
  const Model& model = surface();
  return model.process ? model.process->settings().noise : model.outputs.front().noise;
}

}  // namespace palpate
