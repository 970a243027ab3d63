// SPDX-License-Identifier: MIT
// Hyperparameters from the taps: the largest marginal likelihood, or leave-one-out predictive density, weighted by what
// is reasonable to expect of a surface in an area of this size (Rasmussen and Williams 2006, chapter 5).
#include "options.hpp"
#include "search.hpp"

#include <palpate/fitting.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace palpate::fitting {

namespace {

/// Above this number of points a part of them finds the region of the optimum, and all of them only the optimum.
constexpr Eigen::Index kPart = 96;
/// Largest slope at the end, per point and in units of the curvature: the objective is then within about 1e-8 of its
/// maximum.
constexpr double kFine = 1e-4;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

bool better(const Spot& a, const Spot& b) { return a.valid && (!b.valid || a.value > b.value); }

/// What every start came to, in words.
std::string told(const std::vector<Spot>& spots, const Model& model) {
  std::string values;
  for (const Spot& spot : spots) {
    values += (values.empty() ? "" : " / ") + (spot.valid ? number(model.total(spot.value)) : "nothing");
  }
  return std::to_string(spots.size()) + (spots.size() == 1 ? " start: " : " starts: ") + values;
}

}  // namespace

class Ceres final : public Fitting {
 public:
  using Options = CeresOptions;

  Ceres(const Options& options, const Context& context)
      : options_(options), side_(std::max(context.scene.area().width, context.scene.area().depth)) {}

  bool due(int taps) const override { return taps > 0 && taps % options_.every == 0; }

  std::string objection(const Kernel& kernel) const override {
    return kernel.differentiable() ? "" : "fitting/ceres needs a kernel with derivatives, this one has none";
  }

  FitSummary fit(FitProblem& problem, Random& random) const override;

 private:
  std::vector<Expectation> expectations(const Model& model) const;
  Objective objective_of(const Model& model, const std::vector<Expectation>& expected) const {
    return {model, options_.objective, expected, options_.priors == Options::Priors::touch};
  }
  /// The optima that the ascents found, the best first. `objective` is that of `model`; `evaluations` counts those of
  /// its parts.
  std::vector<Spot> search(const Model& model, Objective& objective, const std::vector<Expectation>& expected,
                           const Eigen::VectorXd& now, Random& random, int& evaluations) const;

  Options options_;
  double side_;  ///< of the area, the longer one, metres
};

std::vector<Expectation> Ceres::expectations(const Model& model) const {
  // A scene is part desk and part object, with a step between them that no stationary kernel follows. Its taps look
  // calmer and smoother than what is still to be found: from few taps the likelihood alone takes too long a length
  // scale and too small a signal, and is sure where it should not be. framework/docs/runs.md has the figures of both.
  const auto log_normal = [](double median, double spread, double factor) {
    return Expectation{std::log(median), spread, std::log(median / factor), std::log(median * factor)};
  };
  std::vector<Expectation> out;
  for (const KernelParameter& one : model.kernel.parameters()) {
    out.push_back(one.unit == Unit::metre ? log_normal(side_ / 12.0, 0.4, 1e4) : log_normal(1.0, 1.0, 1e3));
  }
  // Squares of noise and signal: spreads twice those of the standard deviations.
  const double noise = model.mean_ratio > 0.0 ? 0.05 : 0.3;  // an open level has no desk, and so no step
  out.push_back(log_normal(noise * noise, 0.8, 1e8));
  for (Eigen::Index i = 0; i < model.outputs(); ++i) out.push_back(log_normal(1.0, 0.6, 1e8));
  for (Eigen::Index i = 0; model.fit_means && i < model.outputs(); ++i) out.push_back({0.0, 1.0, -1e3, 1e3});
  return out;
}

std::vector<Spot> Ceres::search(const Model& model, Objective& objective, const std::vector<Expectation>& expected,
                                const Eigen::VectorXd& now, Random& random, int& evaluations) const {
  std::vector<Spot> spots;
  if (model.size() <= kPart) {
    for (std::int64_t i = 0; i < options_.starts; ++i) {
      const Eigen::VectorXd start =
          i == 0 ? look_around(objective, model, now, expected) : random_start(expected, random);
      spots.push_back(ascend(objective, start, metric_at(objective, start), kFine));
    }
  } else {
    // A part of the points finds the region and its curvature; all of them decide between the optima of the part.
    const Model part = part_of(model, kPart / 2);
    Objective rough = objective_of(part, expected);
    spots = search(part, rough, expected, now, random, evaluations);
    for (Spot& spot : spots) spot.valid = spot.valid && objective.evaluate(spot.x.data(), &spot.value, nullptr);
    std::sort(spots.begin(), spots.end(), better);
    spots.front() = ascend(objective, spots.front().x, metric_at(rough, spots.front().x), kFine);
    evaluations += rough.evaluations();
  }
  std::sort(spots.begin(), spots.end(), better);
  return spots;
}

FitSummary Ceres::fit(FitProblem& problem, Random& random) const {
  FitSummary summary;
  const Model model = model_of(problem, options_.mean == Options::Mean::fit);
  if (model.outputs() == 0) {
    summary.reason = "the targets do not differ from the mean: they tell nothing";
    return summary;
  }
  const std::vector<Expectation> expected = expectations(model);
  if (options_.priors == Options::Priors::none &&
      model.size() * model.outputs() <= static_cast<Eigen::Index>(expected.size())) {
    summary.reason = "without priors there must be more taps than hyperparameters";
    return summary;
  }
  std::vector<double> old;
  for (const KernelParameter& one : problem.kernel.parameters()) old.push_back(one.value);
  const Eigen::VectorXd now = present(problem, model);
  Objective objective = objective_of(model, expected);
  double value_now = 0.0;
  const bool known = objective.evaluate(now.data(), &value_now, nullptr);

  const std::vector<Spot> spots = search(model, objective, expected, now, random, summary.evaluations);
  summary.evaluations += objective.evaluations();
  const Spot& best = spots.front();
  summary.reason = best.valid ? best.reason + "; from " + told(spots, model) : "no ascent came to a finite value";
  if (model.used.size() < problem.outputs.size()) summary.reason += "; outputs that tell nothing were left out";
  if (best.valid && (!known || best.value > value_now)) {
    summary.changed = true;
    summary.objective = model.total(best.value);
    take(best.x, model, problem);
    return summary;
  }
  problem.kernel.set_parameters(Eigen::Map<const Eigen::VectorXd>(old.data(), static_cast<Eigen::Index>(old.size())));
  summary.failed = !best.valid;
  summary.objective = known ? model.total(value_now) : 0.0;
  if (best.valid) summary.reason = "nothing is better than the present values; " + summary.reason;
  return summary;
}

PALPATE_PLUGIN(Fitting, Ceres, "ceres",
               "fit kernel, signal and noise to the taps, by marginal likelihood or leave-one-out")

}  // namespace palpate::fitting
