// SPDX-License-Identifier: MIT
#include "experiment/tap_belief.hpp"

#include "config/tree.hpp"

#include <palpate/error.hpp>

#include <string>

namespace palpate {

// The level of an object is not known before it is touched: a thousand signals make it as good as free, unless the
// surface varies by less than a thousandth of its height.
constexpr double kFreeLevel = 1000.0;

TapBelief::Model TapBelief::make_model(const char* name, const PluginChoice& kernel, const PluginChoice& fitting,
                                       const ProcessSettings& settings, const Context& context) {
  Model model;
  model.name = name;
  model.kernel = context.create<Kernel>(kernel);
  model.fitting = context.create<Fitting>(fitting);
  model.settings = settings;
  const std::string objection = model.fitting->objection(*model.kernel);
  if (!objection.empty()) throw Error(fitting.options->place.text(), objection);
  return model;
}

// The plugins are made at once, so that options which they refuse are refused before the first tap.
TapBelief::TapBelief(const ExperimentOptions& options, const Candidates& candidates, const Context& context,
                     PhaseClock& clock)
    : candidates_(candidates),
      context_(context),
      clock_(clock),
      desk_(context.scene.desk()),
      clip_(options.weight.clip),
      two_part_(options.surface == ExperimentOptions::Surface::two_part),
      shared_(options.weight.hyperparameters == WeightOptions::Hyperparameters::shared),
      initial_taps_(static_cast<int>(options.initial.count)) {
  const HeightOptions& height = options.height;
  const WeightOptions& weight = options.weight;
  const PluginChoice height_kernel = height.kernel.value_or(options.kernel);
  const PluginChoice height_fitting = height.fitting.value_or(options.fitting);
  height_ = make_model("fitting/height", height_kernel, height_fitting, {height.signal, height.noise, 0.0}, context);
  // Labels that share have the heights' kernel and are fitted by the heights' fitting, whatever the shared ones are.
  weight_ = make_model("fitting/weight", shared_ ? height_kernel : weight.kernel.value_or(options.kernel),
                       shared_ ? height_fitting : weight.fitting.value_or(options.fitting),
                       {weight.signal, weight.noise, weight.prior_mean}, context);
  if (shared_) {
    weight_.kernel = height_.kernel;
    for (int taps = 1; taps <= options.taps; ++taps) fitted_together_ |= height_.fitting->due(taps);
  }
  if (two_part_) {
    object_ = make_model("fitting/surface", height_kernel, height_fitting,
                         {height.signal, height.noise, 0.0, kFreeLevel}, context);
  }
}

void TapBelief::observe(const Target& place, const Contact& contact) {
  ++taps_;
  if (contact.outcome != Outcome::contact) return;
  const bool on = context_.scene.on_surface(contact.height);
  height_.data.push_back({place, contact.height - desk_});
  weight_.data.push_back({place, on ? 1.0 : 0.0});
  if (on) object_.data.push_back(height_.data.back());
}

Process& TapBelief::ready(Model& model) const {
  const PhaseClock::Scope infer(clock_, Phase::infer);
  const bool joint = fitted_together_ && &model != &object_;
  const std::vector<Model*> models = joint ? std::vector<Model*>{&height_, &weight_} : std::vector<Model*>{&model};
  for (Model* one : models) {
    if (!one->process) one->process = std::make_unique<Process>(one->kernel, one->settings, candidates_.points);
  }
  // One by one, fits included: a process that is read late, or after a resume, goes through the very states that one
  // read at every tap went through.
  while (model.process->size() < static_cast<int>(model.data.size())) {
    for (Model* one : models) {
      const Datum& datum = one->data[static_cast<std::size_t>(one->process->size())];
      one->process->add(datum.place, datum.value);
    }
    if (models.front()->fitting->due(model.process->size())) fit(models);
  }
  return *model.process;
}

void TapBelief::fit(const std::vector<Model*>& models) const {
  const PhaseClock::Scope fit(clock_, Phase::fit);
  std::vector<Process*> processes;
  for (Model* one : models) processes.push_back(one->process.get());
  Model& first = *models.front();
  const int taps = first.process->size();
  Random random = context_.random(first.name, static_cast<std::uint64_t>(taps));
  const FitSummary summary = Process::fit(processes, *first.fitting, random);
  if (summary.failed) ++failed_fits_;
  for (Model* one : models) {
    one->fit = summary;
    one->fit_at = taps;
  }
}

const FitSummary* TapBelief::last_fit(const Process& process) const {
  for (const Model* one : {&height_, &weight_, &object_}) {
    if (one->process.get() == &process && one->fit_at > 0 && one->fit_at == process.size()) return &one->fit;
  }
  return nullptr;
}

template <class Compute>
const Eigen::VectorXd& TapBelief::read(Map& map, Model& model, Compute compute) const {
  const int known = static_cast<int>(model.data.size());
  if (map.taps != known) {
    const Process& process = ready(model);
    const PhaseClock::Scope infer(clock_, Phase::infer);
    map.values = compute(process);
    map.taps = known;
  }
  return map.values;
}

const Eigen::VectorXd& TapBelief::uncertainty() const {
  return read(uncertainty_map_, height_, [](const Process& process) { return process.relative_variance(); });
}

const Eigen::VectorXd& TapBelief::weight_mean() const {
  return read(weight_mean_map_, weight_, [](const Process& process) { return process.mean(); });
}

const Eigen::VectorXd& TapBelief::weight() const {
  if (!clip_) return weight_mean();
  return read(weight_map_, weight_,
              [](const Process& process) -> Eigen::VectorXd { return process.mean().cwiseMax(0.0).cwiseMin(1.0); });
}

const Eigen::VectorXd& TapBelief::height_mean() const {
  return read(mean_map_, surface(),
              [this](const Process& process) -> Eigen::VectorXd { return process.mean().array() + desk_; });
}

const Eigen::VectorXd& TapBelief::all_taps_variance() const {
  return read(all_taps_map_, height_, [](const Process& process) { return process.variance(); });
}

const Eigen::VectorXd& TapBelief::height_variance() const {
  if (!two_part_) return all_taps_variance();
  return read(variance_map_, surface(), [](const Process& process) { return process.variance(); });
}

double TapBelief::height_noise() const {
  const Model& model = surface();
  return model.process ? model.process->settings().noise : model.settings.noise;
}

}  // namespace palpate
