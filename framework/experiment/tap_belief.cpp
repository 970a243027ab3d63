// SPDX-License-Identifier: MIT
#include "experiment/tap_belief.hpp"

#include <string>

namespace palpate {

TapBelief::TapBelief(const ExperimentOptions& options, const Candidates& candidates, const Context& context,
                     PhaseClock& clock)
    : candidates_(candidates),
      context_(context),
      clock_(clock),
      desk_(context.scene.desk()),
      clip_(options.weight.clip),
      initial_taps_(static_cast<int>(options.initial.count)) {
  height_.name = "fitting/height";
  // The plugins are made at once, so that options which they refuse are refused before the first tap.
  height_.kernel = context.create<Kernel>(options.height.kernel.value_or(options.kernel));
  height_.fitting = context.create<Fitting>(options.height.fitting.value_or(options.fitting));
  height_.settings = {options.height.signal, options.height.noise, 0.0};
  weight_.name = "fitting/weight";
  weight_.kernel = context.create<Kernel>(options.weight.kernel.value_or(options.kernel));
  weight_.fitting = context.create<Fitting>(options.weight.fitting.value_or(options.fitting));
  weight_.settings = {options.weight.signal, options.weight.noise, options.weight.prior_mean};
}

void TapBelief::observe(const Target& place, const Contact& contact) {
  ++taps_;
  if (contact.outcome != Outcome::contact) return;
  height_.data.push_back({place, contact.height - desk_});
  weight_.data.push_back({place, context_.scene.on_surface(contact.height) ? 1.0 : 0.0});
}

Process& TapBelief::ready(Model& model) const {
  const PhaseClock::Scope infer(clock_, Phase::infer);
  if (!model.process) {
    model.process = std::make_unique<Process>(model.kernel, model.settings, candidates_.points);
  }
  Process& process = *model.process;
  // One by one, fits included: a process that is read late, or after a resume, goes through the very states that one
  // read at every tap went through.
  while (process.size() < static_cast<int>(model.data.size())) {
    const Datum& datum = model.data[static_cast<std::size_t>(process.size())];
    process.add(datum.place, datum.value);
    if (model.fitting->due(process.size())) {
      const PhaseClock::Scope fit(clock_, Phase::fit);
      Random random = context_.random(model.name, static_cast<std::uint64_t>(process.size()));
      process.fit(*model.fitting, random);
    }
  }
  return process;
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
  return read(mean_map_, height_,
              [this](const Process& process) -> Eigen::VectorXd { return process.mean().array() + desk_; });
}

const Eigen::VectorXd& TapBelief::height_variance() const {
  return read(variance_map_, height_, [](const Process& process) { return process.variance(); });
}

const Process* TapBelief::height_process() const { return height_.process ? &ready(height_) : nullptr; }
const Process* TapBelief::weight_process() const { return weight_.process ? &ready(weight_) : nullptr; }

double TapBelief::height_noise() const {
  return height_.process ? height_.process->settings().noise : height_.settings.noise;
}

}  // namespace palpate
