// SPDX-License-Identifier: MIT
// What stands around the loop of experiment.cpp: building it, taking over a broken one, and who reads what.
#include "experiment/experiment.hpp"

namespace palpate {

Experiment::Experiment(const ExperimentOptions& options, const PluginFactory& factory,
                       const std::atomic<bool>* interrupted, std::shared_ptr<Backend> backend,
                       const std::string& directory)
    : options_(options),
      scene_(build_scene(options.scene, static_cast<std::uint64_t>(options.seed), factory)),
      context_{factory, *scene_, static_cast<std::uint64_t>(options.seed), interrupted, directory, lanes_of(options)},
      candidates_(options.candidates.spacing
                      ? grid_by_spacing(scene_->area(), *options.candidates.spacing)
                      : grid_by_count(scene_->area(), static_cast<int>(*options.candidates.count))),
      belief_(options_, candidates_, context_, clock_),
      chooser_(options_, candidates_, context_),
      backend_(backend ? std::move(backend) : context_.create<Backend>(options.backend)),
      watch_(options_, candidates_, context_, backend_->scene_is_truth()) {}

void Experiment::resume(const std::vector<PastTap>& past) {
  Quantities read;
  for (const PastTap& tap : past) {
    observe(tap);
    read = read | reads_for(tap.of_caller() ? Source::caller : tap.source);
    if (tap.source == Source::fallback) read = read | Chooser::kFallbackReads;
    // Who is doubted depends on who was, once there are many; a fit on what was taken off the heights at its tap.
    if (options_.height.lies || options_.height.systematic) belief_.ask(read);
  }
  belief_.ask(read);
}

Quantities Experiment::reads_for(Source source) const {
  Quantities out = belief_.predictable(backend_->expects() | chooser_.predicts());
  if (options_.height.lies) out = out | Quantity::doubt;
  if (source == Source::initial) return out;
  if (options_.stop.max_standard_deviation) out = out | Quantity::uncertainty;
  if (source == Source::caller) return out;
  out = out | chooser_.reads();
  if (source == Source::fallback) out = out | Chooser::kFallbackReads;
  return out;
}

std::vector<ModelReader> Experiment::readers() const {
  std::vector<ModelReader> out;
  const auto add = [&](Quantities reads, const std::string& who) {
    for (const std::string& model : belief_.models_of(reads)) out.push_back({model, who});
  };
  add(chooser_.reads(), "acquisition " + options_.acquisition.type);
  if (chooser_.may_fall_back()) add(Chooser::kFallbackReads, "fallback uncertainty, from its first use on");
  if (options_.height.lies) add(Quantity::doubt, "height.lies");
  if (options_.stop.max_standard_deviation) add(Quantity::uncertainty, "stop.max_standard_deviation");
  if (options_.stop.expected_rmse) add(belief_.surface_reads(), "stop.expected_rmse");
  add(backend_->reads() | belief_.predictable(backend_->expects()), "backend " + options_.backend.type);
  return out;
}

Eigen::VectorXd Experiment::scores() {
  belief_.ask(reads_for(Source::acquisition));
  return chooser_.scores(belief_);
}

Preview Experiment::preview(const TapRecord& tap) const {
  Preview out{tap.predicted, backend_->describe(request_of(tap))};
  if (!out.expected && belief_.recorded().has(Quantity::height))
    out.expected = belief_.predict(tap.candidate, Quantity::height);
  return out;
}

}  // namespace palpate
