// SPDX-License-Identifier: MIT
#include "analysis/importance.hpp"

#include "analysis/compare.hpp"
#include "analysis/groups.hpp"
#include "analysis/mean_output.hpp"
#include "config/quantity.hpp"

#include <palpate/error.hpp>
#include <palpate/random.hpp>

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Texts = std::vector<std::string>;

constexpr Index kDraws = 2000;

/// Returns -1/2 of the squared distances between the values of a key in all settings. Quantities are scaled to 0 to 1,
/// on a log scale if the largest is more than ten times the smallest. If some values are not quantities, two different
/// values have distance 1.
MatrixXd exponents_of(const Texts& values) {
  const auto count = static_cast<Index>(values.size());
  Eigen::ArrayXXd numbers(count, 1);
  MatrixXd choices(count, count);
  for (Index i = 0; i < count; ++i) {
    const auto quantity = any_quantity(values[i]);
    numbers(i) = quantity ? quantity->value : HUGE_VAL;
    for (Index k = 0; k < count; ++k) choices(i, k) = values[i] != values[k] ? -0.5 : 0.0;
  }
  if (!numbers.allFinite()) return choices;
  if (numbers.minCoeff() > 0.0 && numbers.maxCoeff() > 10.0 * numbers.minCoeff()) numbers = numbers.log().eval();
  numbers /= std::max(numbers.maxCoeff() - numbers.minCoeff(), 1e-300);
  return -0.5 * (numbers.replicate(1, count) - numbers.transpose().replicate(count, 1)).square();
}

MatrixXd kernel_of(const MatrixXd& exponents, double scale) { return (exponents / (scale * scale)).array().exp(); }

/// Fits a Gaussian process of mean 0, with a product of one kernel per key, to values of the settings with noise of
/// variance `noise`. Returns the weights of the settings in its posterior mean. Stores in `scales` the length scales of
/// the keys and the variance of the process. They maximise the likelihood over a grid, one at a time.
MatrixXd fit_process(const std::vector<MatrixXd>& exponents, const MatrixXd& values, double noise,
                     std::vector<double>& scales) {
  std::vector<double> centre(exponents.size(), 0.4);
  centre.push_back(values.squaredNorm() / static_cast<double>(values.size()));
  scales = centre;
  MatrixXd weights;
  double best = -HUGE_VAL;
  for (std::size_t step = 0; step < 21 * centre.size(); ++step) {  // three rounds with seven values of each scale
    std::vector<double> trial = scales;
    const std::size_t changed = step / 7 % centre.size();
    trial[changed] = centre[changed] * std::exp2(static_cast<double>(step % 7) - 2.0);
    MatrixXd covariance = MatrixXd::Constant(values.size(), values.size(), trial.back());
    for (std::size_t i = 0; i < exponents.size(); ++i)
      covariance = covariance.cwiseProduct(kernel_of(exponents[i], trial[i]));
    covariance.diagonal().array() += noise;
    const Eigen::LLT<MatrixXd> factor(covariance);
    const MatrixXd solved = factor.solve(values);
    const double fit = -0.5 * solved.cwiseProduct(values).sum() - factor.matrixLLT().diagonal().array().log().sum();
    if (fit > best) std::tie(best, scales, weights) = std::make_tuple(fit, trial, solved * trial.back());
  }
  return weights;
}

/// Parts of a variance, in the sample, then in each resample. They are sorted by the number of keys (0 for the whole
/// variance, 3 for three or more), the negative variance in the sample, and the names of the keys.
using VarianceParts = std::map<std::tuple<int, double, std::string>, MatrixXd>;

/// Splits the variance over the settings of a function: the sum over settings of weight times product of the keys'
/// kernels. `weights`: one row per setting, one column per seed.
VarianceParts split_variance(const Texts& keys, const std::vector<MatrixXd>& kernels, const MatrixXd& weights) {
  const auto seeds = static_cast<double>(weights.cols());
  MatrixXd draws = MatrixXd::Zero(weights.cols(), 1 + kDraws);  // how often each resample contains each seed
  draws.col(0).setOnes();
  Random random(0, "importance");
  for (Index i = 0; i < weights.cols() * kDraws; ++i)
    draws(static_cast<Index>(random.index(static_cast<std::uint64_t>(weights.cols()))), 1 + i % kDraws) += 1.0;
  VarianceParts parts;
  const auto add = [&](int count, const std::string& name, const MatrixXd& effect) {
    if (effect.isZero(0.0)) return;  // a key with one value among these settings
    const MatrixXd by_seed = effect * weights;
    const MatrixXd squares = (by_seed * draws).colwise().squaredNorm() / (seeds * seeds);
    const MatrixXd same_seed = by_seed.colwise().squaredNorm() * draws / (seeds * seeds);
    MatrixXd part = (squares - same_seed) / (1.0 - 1.0 / seeds);
    // The sample contains noise. The resamples, which are drawn from it, contain it again.
    part.rightCols(kDraws).array() -= squares(0) - part(0);
    parts.emplace(std::make_tuple(count, -part(0), name), part);
  };
  // Returns the matrix that maps weights to the effect of key `a`, to the interaction of keys `a` and `b`, or to the
  // whole function.
  const auto effect_of = [&](std::size_t a, std::size_t b, bool whole) {
    MatrixXd out = MatrixXd::Ones(weights.rows(), weights.rows());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const MatrixXd mean = kernels[i].colwise().mean().replicate(weights.rows(), 1);
      out = out.cwiseProduct(whole ? kernels[i] : i == a || i == b ? kernels[i] - mean : mean);
    }
    return out;
  };
  MatrixXd rest = effect_of(0, 0, true) - effect_of(keys.size(), keys.size(), false);
  add(0, "", rest);
  for (std::size_t a = 0; a < keys.size(); ++a) {
    for (std::size_t b = a; b < keys.size(); ++b) {
      const MatrixXd effect = effect_of(a, b, false);
      a == b ? add(1, keys[a], effect) : add(2, keys[a] + "," + keys[b], effect);
      rest -= effect;
    }
  }
  if (keys.size() > 2) add(3, "", rest);
  return parts;
}

}  // namespace

Importance compute_importance(const Sweep& sweep, const std::vector<Row>& results, const std::string& metric,
                              const WhereCondition* where) {
  compare(sweep, results, {{}, metric, where, {}, false, CompareExtent::means});  // rejects wrong columns
  const Texts keys = varying_keys(sweep, setting_keys(sweep));
  if (keys.size() < 2)
    throw Error("command line", "--importance: fewer than two keys besides the seed vary", "sweep another key");
  const Texts names = names_of(results);
  const JobCondition condition(sweep, names, where);
  std::map<std::string, std::map<Texts, double>> by_seed;  // values of the metric by setting
  for (const JobGroup& setting : group_jobs(sweep, results, keys)) {
    for (const JobResult& one : setting.jobs) {
      const JobValue value = value_of_job(one.row, metric, "--metric");
      if (value.status == ValueStatus::counted && condition.keeps(one))
        by_seed[value_of(sweep, *one.job, "seed")][setting.values] = value.value;
    }
  }
  std::vector<std::map<Texts, double>> seeds(1);
  for (const auto& [seed, values] : by_seed) seeds.push_back(values);
  std::stable_sort(seeds.begin(), seeds.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  // At least two seeds must have the settings: those of the seed with the second largest number are used.
  const std::map<Texts, double>& settings = seeds[1];
  std::vector<double> found;
  for (const std::map<Texts, double>& values : seeds) {
    const auto has_value = [&](const auto& setting) { return values.count(setting.first) > 0; };
    if (!std::all_of(settings.begin(), settings.end(), has_value)) continue;
    for (const auto& [setting, value] : settings) found.push_back(values.at(setting));
  }
  const auto rows = static_cast<Index>(settings.size());
  const Eigen::Map<const MatrixXd> values(found.data(), rows,
                                          static_cast<Index>(found.size()) / std::max(rows, Index{1}));
  if (values.cols() < 2 || rows < 2)
    throw Error("command line", "--importance: no two seeds have values in the same two settings",
                "sweep the seed: seed=range(0,20)");
  const auto count = static_cast<double>(values.cols());
  MatrixXd weights = values.rowwise() - values.colwise().mean();
  const MatrixXd means = weights.rowwise().mean();
  const double variance = means.squaredNorm() / static_cast<double>(rows - 1);
  const double noise = (weights - means.replicate(1, values.cols())).squaredNorm() /
                       (static_cast<double>(rows - 1) * (count - 1.0) * count);
  const bool differ = variance > noise + std::pow(kRounding * values.cwiseAbs().maxCoeff(), 2);
  std::vector<MatrixXd> kernels;  // first, their exponents
  std::size_t combinations = 1;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    Texts column;
    for (const auto& [setting, value] : settings) column.push_back(setting[i]);
    combinations *= std::set<std::string>(column.begin(), column.end()).size();
    kernels.push_back(exponents_of(column));
  }
  const bool exact = combinations == settings.size();
  std::vector<double> scales(keys.size(), 1e-9);  // At this scale, two different values have a kernel of 0.
  // Without noise, the matrix of a smooth process would be singular to rounding. Two equal columns contain no noise.
  if (!exact && differ) weights = fit_process(kernels, means, noise + 1e-6 * variance, scales).replicate(1, 2);
  for (std::size_t i = 0; i < keys.size(); ++i) kernels[i] = kernel_of(kernels[i], scales[i]);
  const VarianceParts parts = split_variance(keys, kernels, weights);
  const MatrixXd& whole = parts.begin()->second;
  double positive = 0.0;
  for (const auto& [order, part] : parts) positive += std::get<0>(order) > 0 ? std::max(0.0, part(0)) : 0.0;
  const double width = student_factor(static_cast<std::size_t>(count) - 1) * std::sqrt(count / (count - 1.0));
  const auto tail = static_cast<Index>(0.5 * std::erfc(width / std::sqrt(2.0)) * static_cast<double>(kDraws));
  const auto percent = [](double share) { return fmt::format("{:.1f}", 100.0 * share); };
  Importance out;
  for (const auto& [order, part] : parts) {
    const auto& [size, minus_part, name] = order;
    if (size == 0) continue;
    const auto share = differ ? std::optional(std::max(0.0, part(0)) / positive) : std::nullopt;
    std::optional<MeanInterval> interval;
    if (differ && exact && values.cols() >= static_cast<Index>(kLeastForInterval)) {
      // If the other parts of a resample sum to less than 0, its share is 1.
      MatrixXd drawn = part.cwiseMax(0.0).cwiseQuotient(part.cwiseMax(whole).cwiseMax(1e-300)).rightCols(kDraws);
      std::sort(drawn.data(), drawn.data() + kDraws);
      interval = {std::min(*share, drawn(tail)), std::max(*share, drawn(kDraws - 1 - tail))};
    }
    out.table.add_row();
    out.table.store("metric", metric);
    out.table.store("keys", name);
    out.table.store("share", share);
    add_interval(out.table.last_row(), "", interval);
    out.table.store("exact", exact);
    out.table.store("noise", noise / variance);
    out.table.show("keys", size == 3 ? "three or more" : one_line(name), Table::Kind::text);
    if (exact) out.table.show("share in % [95 % interval]", share ? with_interval(*share, interval, percent) : "-");
    if (!exact) out.table.show("approximate share in %", share ? percent(*share) : "-");
  }
  out.text =
      fmt::format("importance for {}: share of the variance between {} settings\n{}\n{}; {} of {} seeds used\n{}\n",
                  metric, rows, out.table.text(),
                  exact ? "exact: every combination of the values has run"
                        : "approximate, by a Gaussian process: not every combination of the values has run",
                  values.cols(), by_seed.size(),
                  differ ? fmt::format("noise: {} % of the variance of the settings' means; not part of the shares",
                                       percent(noise / variance))
                         : "no shares: the means of the settings differ by no more than the noise; run more seeds");
  return out;
}

}  // namespace palpate
