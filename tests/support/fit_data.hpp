// SPDX-License-Identifier: MIT
// The reference data of hyperparameter fits: tests/data/fit_N.csv, N noisy heights of a smooth wave (places in cm,
// heights in dm). Their log marginal likelihoods at the optimum were reached by several independent optimisers.
#pragma once

#include "support/plugins.hpp"

#include <palpate/fitting.hpp>

#include <memory>
#include <string>
#include <vector>

namespace palpate::test {

struct FitData {
  Points points;            ///< metres
  Eigen::VectorXd targets;  ///< decimetres, so that likelihoods are those of the reference
};

/// N is 50, 200 or 1000.
FitData fit_data(int count);

/// A process with a squared-exponential kernel, at the numbers from which the reference fits start unless others are
/// given: length scale 1 cm, signal variance 1, noise variance 1e-2.
struct FitState {
  explicit FitState(double length_scale = 0.01, double signal_variance = 1.0, double noise_variance = 1e-2);

  FitSummary fit(const Fitting& fitting, const FitData& data, std::uint64_t seed = 1,
                 std::vector<double>* memory = nullptr);

  double length_scale() const { return kernel->parameters().front().value; }

  std::shared_ptr<Kernel> kernel;
  double signal;
  double noise_ratio;
  double mean = 0.0;
};

}  // namespace palpate::test
