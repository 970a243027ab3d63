// SPDX-License-Identifier: MIT
#include "model.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::fitting {
namespace {

/// Deviations of targets below this share of their size are rounding.
constexpr double kRounding = 1e-9;

}  // namespace

double Model::total(double value) const {
  const auto n = static_cast<double>(size());
  return value * n * static_cast<double>(outputs()) - n * scales.array().log().sum();
}

Model model_of(const FitProblem& problem, bool fit_means) {
  Model model{problem.points, {}, {}, {}, problem.kernel, problem.mean_ratio, {}, fit_means, {}};
  std::vector<double> centres;
  std::vector<double> scales;
  for (std::size_t i = 0; i < problem.outputs.size(); ++i) {
    const FitOutput& output = problem.outputs[i];
    const bool open = fit_means || problem.mean_ratio > 0.0;
    const double centre = open ? output.targets.mean() : output.mean;
    const double scale = (output.targets.array() - centre).abs().maxCoeff();
    if (!std::isfinite(scale) || !(scale > kRounding * output.targets.cwiseAbs().maxCoeff())) continue;
    model.used.push_back(i);
    centres.push_back(centre);
    scales.push_back(scale);
  }
  const auto outputs = static_cast<Eigen::Index>(model.used.size());
  model.centres = Eigen::Map<const Eigen::VectorXd>(centres.data(), outputs);
  model.scales = Eigen::Map<const Eigen::VectorXd>(scales.data(), outputs);
  model.targets.resize(problem.points.rows(), outputs);
  model.means.resize(outputs);
  for (Eigen::Index i = 0; i < outputs; ++i) {
    const FitOutput& output = problem.outputs[model.used[static_cast<std::size_t>(i)]];
    model.targets.col(i) = (output.targets.array() - model.centres(i)) / model.scales(i);
    model.means(i) = (output.mean - model.centres(i)) / model.scales(i);
  }
  return model;
}

Model part_of(const Model& all, Eigen::Index least) {
  Model part = all;
  const Eigen::Index count = std::max(least, all.size() / 2);
  part.points.resize(count, 2);
  part.targets.resize(count, all.outputs());
  for (Eigen::Index i = 0; i < count; ++i) {
    part.points.row(i) = all.points.row(i * all.size() / count);
    part.targets.row(i) = all.targets.row(i * all.size() / count);
  }
  return part;
}

Eigen::VectorXd present(const FitProblem& problem, const Model& model) {
  const std::vector<KernelParameter> parameters = problem.kernel.parameters();
  const auto count = static_cast<Eigen::Index>(parameters.size());
  const Eigen::Index outputs = model.outputs();
  Eigen::VectorXd x(count + 1 + outputs * (model.fit_means ? 2 : 1));
  for (Eigen::Index p = 0; p < count; ++p) x(p) = std::log(parameters[static_cast<std::size_t>(p)].value);
  x(count) = 2.0 * std::log(problem.noise_ratio);
  for (Eigen::Index i = 0; i < outputs; ++i) {
    const FitOutput& output = problem.outputs[model.used[static_cast<std::size_t>(i)]];
    x(count + 1 + i) = 2.0 * std::log(output.signal / model.scales(i));
  }
  if (model.fit_means) x.tail(outputs) = model.means;
  return x;
}

void take(const Eigen::VectorXd& x, const Model& model, FitProblem& problem) {
  const Eigen::Index outputs = model.outputs();
  const Eigen::Index count = x.size() - 1 - outputs * (model.fit_means ? 2 : 1);
  problem.kernel.set_parameters(x.head(count).array().exp().matrix());
  problem.noise_ratio = std::exp(0.5 * x(count));
  for (Eigen::Index i = 0; i < outputs; ++i) {
    FitOutput& output = problem.outputs[model.used[static_cast<std::size_t>(i)]];
    output.signal = model.scales(i) * std::exp(0.5 * x(count + 1 + i));
    if (model.fit_means) output.mean = model.centres(i) + model.scales(i) * x(count + 1 + outputs + i);
  }
}

}  // namespace palpate::fitting
