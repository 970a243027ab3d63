// SPDX-License-Identifier: MIT
// Fits hyperparameters to the taps. The objective is the marginal likelihood or the leave-one-out predictive density,
// multiplied by priors for surfaces in an area of the scene's size (Rasmussen and Williams 2006, chapter 5). A coarse
// search finds a start, and quasi-Newton ascent finds the optimum from there. This is the only file that includes
// Ceres.
#include "options.hpp"

#include <palpate/fitting.hpp>
#include <palpate/math.hpp>
#include <palpate/plugin.hpp>
#include <palpate/random.hpp>

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace palpate::fitting {

namespace {

/// With more points than kPart, a subset of them determines the region of the optimum. All points then determine the
/// optimum within this region.
constexpr Eigen::Index kPart = 96;
/// Largest slope at the end of an ascent, per point and in coordinates in which the curvature is 1. The objective is
/// then within about 1e-8 of its maximum.
constexpr double kFine = 1e-4;

/// Factor by which the number of taps must grow before a fit searches again. Until then, each fit ascends from the last
/// optimum. Without priors, every fit searches, because a likelihood has several optima and one tap may change which of
/// them is the best.
constexpr double kGrowth = 1.1;

/// Result of an ascent.
struct AscentResult {
  Eigen::VectorXd x;
  double value = 0.0;
  bool valid = false;      ///< whether value and gradient were always finite
  bool converged = false;  ///< whether the gradient also vanished
  std::string reason;      ///< reason why the ascent ended
  Eigen::MatrixXd metric;  ///< matrix of the coordinates u of this ascent: x = start + metric * u
};

/// Data that a fit stores for the next one (FitProblem::memory): number of taps at the last search, and metric.
struct Memory {
  double searched = 0.0;
  Eigen::MatrixXd metric;

  static Memory of(const std::vector<double>& numbers, Eigen::Index size) {
    if (static_cast<Eigen::Index>(numbers.size()) != 1 + size * size)
      return {};  // No earlier fit was stored, or it had another number of outputs.
    return {numbers.front(), Eigen::Map<const Eigen::MatrixXd>(numbers.data() + 1, size, size)};
  }
  void keep(std::vector<double>& numbers) const {
    numbers.assign(1, searched);
    numbers.insert(numbers.end(), metric.data(), metric.data() + metric.size());
  }
};

/// The negative objective as a function for Ceres, in coordinates u with x = start + metric * u.
class NegativeObjective final : public ceres::FirstOrderFunction {
 public:
  NegativeObjective(Objective& objective, const Eigen::VectorXd& start, const Eigen::MatrixXd& metric)
      : objective_(objective), start_(start), metric_(metric) {}

  int NumParameters() const override { return objective_.size(); }

  bool Evaluate(const double* u, double* cost, double* gradient) const override {
    const Eigen::VectorXd x = start_ + metric_ * Eigen::Map<const Eigen::VectorXd>(u, start_.size());
    Eigen::VectorXd slope(start_.size());
    if (!objective_.evaluate(x.data(), cost, gradient != nullptr ? slope.data() : nullptr)) return false;
    *cost = -*cost;
    if (gradient != nullptr)
      Eigen::Map<Eigen::VectorXd>(gradient, start_.size()).noalias() = -metric_.transpose() * slope;
    return true;
  }

 private:
  Objective& objective_;
  const Eigen::VectorXd& start_;
  const Eigen::MatrixXd& metric_;
};

Eigen::VectorXd within_limits(Eigen::VectorXd x, const std::vector<HyperPrior>& expectations) {
  for (std::size_t i = 0; i < expectations.size(); ++i) {
    double& one = x(static_cast<Eigen::Index>(i));
    one = std::clamp(one, expectations[i].least, expectations[i].most);
  }
  return x;
}

/// Ascends from `start` by BFGS with a Wolfe line search (ceres::GradientProblem). Ends when all entries of the
/// gradient in the coordinates u are at most `tolerance`, where x = start + metric * u. A metric near the square root
/// of the inverse curvature therefore saves steps. If nothing is known about the curvature, the metric is the identity.
AscentResult ascend(Objective& objective, const Eigen::VectorXd& start, const Eigen::MatrixXd& metric,
                    double tolerance) {
  ceres::GradientProblemSolver::Options options;
  options.logging_type = ceres::SILENT;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = 200;
  options.gradient_tolerance = tolerance;
  options.function_tolerance = 1e-10;
  options.parameter_tolerance = 1e-10;
  const ceres::GradientProblem problem(new NegativeObjective(objective, start, metric));
  Eigen::VectorXd u = Eigen::VectorXd::Zero(start.size());
  ceres::GradientProblemSolver::Summary summary;
  ceres::Solve(options, problem, u.data(), &summary);
  const Eigen::VectorXd x = start + metric * u;
  // If an ascent fails on its way, its last point is still a valid result, unless the start was invalid.
  const bool valid = !summary.iterations.empty() && std::isfinite(summary.final_cost) && x.allFinite();
  const bool converged = valid && summary.termination_type == ceres::CONVERGENCE;
  return {x,     -summary.final_cost, valid, converged, summary.message.substr(0, summary.message.find_first_of(".\n")),
          metric};
}

/// Returns the metric (see ascend()) from the curvature at `result`. Differences of gradients give the curvature.
Eigen::MatrixXd metric_at(Objective& objective, const Eigen::VectorXd& result) {
  // Step in the logarithms. It is large compared with rounding errors and small compared with changes of the curvature.
  constexpr double kStep = 1e-3;
  constexpr double kFlattest = 1e-3;  // curvatures below this value are replaced by it
  const Eigen::Index size = result.size();
  Eigen::MatrixXd curvature(size, size);
  Eigen::VectorXd here(size);
  double value = 0.0;
  if (!objective.evaluate(result.data(), &value, here.data())) return Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    Eigen::VectorXd there = result;
    there(i) += kStep;
    Eigen::VectorXd slope(size);
    if (!objective.evaluate(there.data(), &value, slope.data())) return Eigen::MatrixXd::Identity(size, size);
    curvature.col(i) = (here - slope) / kStep;
  }
  const Eigen::MatrixXd symmetric = 0.5 * (curvature + curvature.transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  const Eigen::VectorXd scale = solver.eigenvalues().cwiseAbs().cwiseMax(kFlattest).cwiseSqrt().cwiseInverse();
  return solver.eigenvectors() * scale.asDiagonal() * solver.eigenvectors().transpose();
}

/// Returns a start for the ascent without random numbers: the best of `now` and a grid of length scales and noises,
/// each with its best signals. A likelihood has a wide, flat region in which all data is noise, and an ascent never
/// leaves this region.
Eigen::VectorXd look_around(Objective& objective, const FitModel& model, const Eigen::VectorXd& now,
                            const std::vector<HyperPrior>& expectations) {
  constexpr int kLengths = 4;
  // squared noise ratios of a surface with little noise and of one with much noise
  constexpr std::array<double, 2> kNoises{1e-3, 1e-1};
  const std::vector<KernelParameter> parameters = model.kernel.parameters();
  const auto count = static_cast<Eigen::Index>(parameters.size());
  const double extent = (model.points.colwise().maxCoeff() - model.points.colwise().minCoeff()).maxCoeff();
  const double spacing = 0.7 * extent / std::sqrt(static_cast<double>(model.size()));

  Eigen::VectorXd best = now;
  double best_value = -std::numeric_limits<double>::infinity();
  const auto consider = [&](Eigen::VectorXd x) {
    Eigen::VectorXd signals;
    const double value = objective.profiled(x.head(count), x(count), signals);
    if (!(value > best_value)) return;
    x.segment(count + 1, model.outputs()) = signals;
    best = x;
    best_value = value;
  };
  consider(now);
  for (int i = 0; extent > 0.0 && i < kLengths; ++i) {
    Eigen::VectorXd x = now;
    const double length = math::log(spacing) + (math::log(extent) - math::log(spacing)) * i / (kLengths - 1);
    for (Eigen::Index p = 0; p < count; ++p) {
      if (parameters[static_cast<std::size_t>(p)].unit == Unit::metre) x(p) = length;
    }
    for (const double noise : kNoises) {
      x(count) = math::log(noise);
      consider(x);
    }
  }
  return within_limits(best, expectations);
}

/// Returns a uniform random start within two standard deviations of the priors.
Eigen::VectorXd random_start(const std::vector<HyperPrior>& expectations, Random& random) {
  Eigen::VectorXd x(static_cast<Eigen::Index>(expectations.size()));
  for (std::size_t i = 0; i < expectations.size(); ++i)
    x(static_cast<Eigen::Index>(i)) = expectations[i].centre + (4.0 * random.uniform() - 2.0) * expectations[i].spread;
  return within_limits(x, expectations);
}

bool better(const AscentResult& a, const AscentResult& b) { return a.valid && (!b.valid || a.value > b.value); }

/// Returns a text about the results of all starts.
std::string describe(const std::vector<AscentResult>& results, const FitModel& model) {
  std::string values;
  for (const AscentResult& result : results) {
    values += values.empty() ? "" : " / ";
    values += result.valid ? fmt::format("{:.6g}", model.total(result.value)) : "nothing";
  }
  return fmt::format("{} {}: {}", results.size(), results.size() == 1 ? "start" : "starts", values);
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

  FitSummary fit(FitProblem& problem, Random& random) const override {
    const FitModel model = model_of(problem, options_.mean == Options::Mean::fit);
    if (model.outputs() == 0) return {false, false, 0.0, 0, "the targets equal the mean and contain no information"};
    const std::vector<HyperPrior> expected = expectations(model);
    if (options_.priors == Options::Priors::none &&
        model.size() * model.outputs() <= static_cast<Eigen::Index>(expected.size())) {
      return {false, false, 0.0, 0, "without priors there must be more taps than hyperparameters"};
    }
    FitSummary summary;
    std::vector<double> old;
    for (const KernelParameter& one : problem.kernel.parameters()) old.push_back(one.value);
    const Eigen::VectorXd now = present(problem, model);
    Objective objective = objective_of(model, expected);
    double value_now = 0.0;
    const bool known = objective.evaluate(now.data(), &value_now, nullptr);

    const AscentResult best = optimum(model, objective, expected, now, known, problem.memory, random, summary);
    summary.evaluations += objective.evaluations();
    if (model.used.size() < problem.outputs.size()) summary.reason += "; outputs without information were left out";
    if (best.valid && (!known || best.value > value_now)) {
      summary.changed = true;
      summary.objective = model.total(best.value);
      take(best.x, model, problem);
      return summary;
    }
    problem.kernel.set_parameters(Eigen::Map<const Eigen::VectorXd>(old.data(), static_cast<Eigen::Index>(old.size())));
    summary.failed = !best.valid;
    summary.objective = known ? model.total(value_now) : 0.0;
    if (best.valid) summary.reason = "no values are better than the present ones; " + summary.reason;
    return summary;
  }

 private:
  std::vector<HyperPrior> expectations(const FitModel& model) const {
    // A scene has steps at the edges of its objects, and no stationary kernel can follow these. The surface looks
    // smoother at the taps than it is elsewhere. With few taps, the likelihood alone therefore favours length scales
    // that are too long and signals that are too small, and the uncertainty becomes too small. framework/docs/runs.md
    // compares results with and without priors.
    const auto log_normal = [](double median, double spread, double factor) {
      return HyperPrior{math::log(median), spread, math::log(median / factor), math::log(median * factor)};
    };
    std::vector<HyperPrior> out;
    for (const KernelParameter& one : model.kernel.parameters())
      out.push_back(one.unit == Unit::metre ? log_normal(side_ / 12.0, 0.4, 1e4) : log_normal(1.0, 1.0, 1e3));
    // Squares of noise and signal have twice the spread of the standard deviations.
    // If the mean is unknown, there is no desk and therefore no step.
    const double noise = model.mean_ratio > 0.0 ? 0.05 : 0.3;
    out.push_back(log_normal(noise * noise, 0.8, 1e8));
    for (Eigen::Index i = 0; i < model.outputs(); ++i) out.push_back(log_normal(1.0, 0.6, 1e8));
    for (Eigen::Index i = 0; model.fit_means && i < model.outputs(); ++i) out.push_back({0.0, 1.0, -1e3, 1e3});
    return out;
  }

  Objective objective_of(const FitModel& model, const std::vector<HyperPrior>& expected) const {
    return {model, options_.objective, expected, options_.priors == Options::Priors::touch};
  }

  /// Returns the optimum. If possible, finds it by an ascent from the present values `now`, otherwise by a search.
  /// `known`: whether the objective is finite at `now`. Updates `memory`, which may be null, and the reason and the
  /// number of evaluations in `summary`.
  AscentResult optimum(const FitModel& model, Objective& objective, const std::vector<HyperPrior>& expected,
                       const Eigen::VectorXd& now, bool known, std::vector<double>* memory, Random& random,
                       FitSummary& summary) const {
    const Memory last = memory != nullptr ? Memory::of(*memory, now.size()) : Memory();
    const auto taps = static_cast<double>(model.size());
    AscentResult best;
    const bool one_optimum = options_.priors == Options::Priors::touch;
    if (known && one_optimum && taps >= last.searched && taps < kGrowth * last.searched) {
      best = ascend(objective, now, last.metric, kFine);
      if (best.converged) summary.reason = best.reason + "; from the values before";
    }
    const bool searched = !best.converged;
    if (searched) {
      const std::vector<AscentResult> results = search(model, objective, expected, now, random, summary.evaluations);
      best = results.front();
      summary.reason =
          best.valid ? best.reason + "; from " + describe(results, model) : "no ascent reached a finite value";
    }
    if (memory != nullptr && best.valid) {
      // After a search with few points, the metric is the metric of the start, which may be far from the optimum.
      if (searched && model.size() <= kPart) best.metric = metric_at(objective, best.x);
      Memory{searched ? taps : last.searched, best.metric}.keep(*memory);
    }
    return best;
  }

  /// Returns the optima of all ascents, with the best one first. `objective` must belong to `model`. Evaluations of the
  /// objectives of subsets are added to `evaluations`.
  std::vector<AscentResult> search(const FitModel& model, Objective& objective, const std::vector<HyperPrior>& expected,
                                   const Eigen::VectorXd& now, Random& random, int& evaluations) const {
    std::vector<AscentResult> results;
    if (model.size() <= kPart) {
      for (std::int64_t i = 0; i < options_.starts; ++i) {
        const Eigen::VectorXd start =
            i == 0 ? look_around(objective, model, now, expected) : random_start(expected, random);
        results.push_back(ascend(objective, start, metric_at(objective, start), kFine));
      }
    } else {
      // A subset of the points determines region and curvature. Then all points decide which optimum of the subset is
      // the best.
      const FitModel part = part_of(model, kPart / 2);
      Objective rough = objective_of(part, expected);
      results = search(part, rough, expected, now, random, evaluations);
      for (AscentResult& result : results)
        result.valid = result.valid && objective.evaluate(result.x.data(), &result.value, nullptr);
      std::sort(results.begin(), results.end(), better);
      results.front() = ascend(objective, results.front().x, metric_at(rough, results.front().x), kFine);
      evaluations += rough.evaluations();
    }
    std::sort(results.begin(), results.end(), better);
    return results;
  }

  Options options_;
  double side_;  ///< longer side of the area, metres
};

PALPATE_PLUGIN(Fitting, Ceres, "ceres",
               "fit of kernel, signal and noise to the taps, by marginal likelihood or leave-one-out")

}  // namespace palpate::fitting
