// SPDX-License-Identifier: MIT
#include "experiment/from_above.hpp"

#include "config/relation.hpp"
#include "experiment/policy.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace palpate {

FromAbove::FromAbove(const ExperimentOptions& options, const PluginFactory& factory,
                     const std::atomic<bool>* interrupted, std::shared_ptr<Backend> backend,
                     const std::string& directory)
    : Experiment(options, factory, interrupted, std::move(backend), directory),
      candidates_(options.candidates.spacing
                      ? grid_by_spacing(scene_->area(), *options.candidates.spacing)
                      : grid_by_count(scene_->area(), static_cast<int>(*options.candidates.count))),
      belief_(options_, candidates_, context_, clock_),
      chooser_(options_, candidates_, context_),
      plan_(make_plan()),
      watch_(options_, candidates_, context_, backend_->scene_is_truth()) {}

void FromAbove::update() {
  belief_.update();
  const PhaseClock::Scope log(clock_, Phase::log);
  if (watch_.counts().taps == 0) return;
  belief_.ask(plan_.reads(Stage::second_tap));
  backend_->show(belief_);
}

std::optional<TapRecord> FromAbove::choose_next(const Wish* wish) {
  TapRecord tap;
  {
    const PhaseClock::Scope acquire(clock_, Phase::acquire);
    const bool starting = chooser_.starting(belief_);
    belief_.ask(plan_.reads(wish != nullptr ? Source::caller : starting ? Source::initial : Source::acquisition));
    const Wish recalled{{}, recalled_};
    if (!has_scores() && wish == nullptr && !starting) {
      if (!recalled_) return std::nullopt;
      wish = &recalled;
    }
    if (!chooser_.choose(belief_, tap, previous_, wish)) return std::nullopt;
  }
  tap.number = watch_.counts().taps + 1;
  tap.target = candidates_.target(tap.candidate);
  if (const Quantities expected = backend_->expects(); expected != Quantities())
    tap.predicted = belief_.predict(tap.candidate, expected);
  const PhaseClock::Scope log(clock_, Phase::log);
  watch_.describe(tap, belief_);
  return tap;
}

void FromAbove::observe(const PastTap& tap) {
  const int candidate = candidates_.nearest(tap.target.x, tap.target.y, scene_->area());
  const Manner manner = manner_of(tap);
  belief_.observe(tap.target, tap.contact, manner);
  chooser_.observe(tap, candidate, previous_, belief_);
  watch_.observe(tap, manner, candidate, belief_);
  previous_ = tap.target;
}

void FromAbove::read(TapRecord& tap) {
  const ContactLog::Reading reading = belief_.log().read(tap.contact, tap.motion);
  tap.on_object = reading.on;
  if (belief_.log().has_offset()) tap.corrected = reading.height;
}

std::optional<std::string> FromAbove::stop_rule(Source source) {
  if (chooser_.starting(belief_)) return std::nullopt;
  belief_.ask(plan_.reads(source));
  const StopOptions& stop = options_.stop;
  const auto deviation = [&] { return std::sqrt(belief_.all_taps_variance().maxCoeff<Eigen::PropagateNaN>()); };
  if (stop.max_standard_deviation && satisfies(deviation(), Relation::at_most, *stop.max_standard_deviation))
    return "max_standard_deviation";
  if (stop.expected_rmse && good_enough(*watch_.forecast(belief_), *stop.expected_rmse)) return "expected_rmse";
  return std::nullopt;
}

void FromAbove::resume(const std::vector<PastTap>& past) {
  Quantities read;
  for (const PastTap& tap : past) {
    read = read | plan_.reads(tap.of_caller() ? Source::caller : tap.source);
    if (tap.source == Source::fallback) read = read | plan_.reads(Stage::first_fallback);
    // Who is doubted depends on who was, once there are many; a fit on what was taken off the heights at its tap.
    if (options_.height.outlier_probability || options_.height.offset) belief_.ask(read);
    observe(tap);
  }
  belief_.ask(read);
}

ReadPlan FromAbove::make_plan() const {
  ReadPlan plan;
  plan.add("acquisition " + options_.acquisition.type, chooser_.reads(), Stage::first_acquisition_tap);
  if (chooser_.may_fall_back())
    plan.add("fallback uncertainty, from its first use on", Chooser::kFallbackReads, Stage::first_fallback);
  if (options_.height.outlier_probability) plan.add("height.outlier_probability", Quantity::doubt, Stage::first_tap);
  if (options_.stop.max_standard_deviation)
    plan.add("stop.max_standard_deviation", Quantity::uncertainty, Stage::first_scored_tap);
  if (options_.stop.expected_rmse) plan.add("stop.expected_rmse", belief_.surface_reads(), Stage::first_object_contact);
  // The choice of a motion is an option of the backend.
  const std::string backend = "backend " + options_.backend.type;
  plan.add(backend, belief_.predictable(backend_->expects() | chooser_.predicts()), Stage::first_tap);
  plan.add(backend, backend_->reads(), Stage::second_tap);
  return plan;
}

std::vector<ModelReader> FromAbove::readers() const {
  std::vector<ModelReader> out;
  for (const ReadPlan::Reader& one : plan_.readers()) {
    for (const std::string& model : belief_.models_of(one.reads)) {
      const bool is_known = std::any_of(out.begin(), out.end(), [&](const ModelReader& known) {
        return known.who == one.name && known.model == model;
      });
      if (!is_known) out.push_back({model, one.name});
    }
  }
  return out;
}

Eigen::VectorXd FromAbove::scores() {
  if (!has_scores()) return Eigen::VectorXd::Zero(candidates_.size());
  belief_.ask(plan_.reads(Source::acquisition));
  return chooser_.scores(belief_);
}

Preview FromAbove::preview(const TapRecord& tap) const {
  Preview out{tap.predicted, backend_->describe(request_of(tap))};
  if (!out.expected && belief_.recorded().has(Quantity::height))
    out.expected = belief_.predict(tap.candidate, Quantity::height);
  return out;
}

}  // namespace palpate
