// SPDX-License-Identifier: MIT
// The default over noise, length scale and taps: no run ends with what is not finite, and the model of outliers costs
// little where there are none. tests/stability_matrix.py is the long form.
#include "gp/robust_surface.hpp"
#include "support/grids.hpp"

#include "support/gaussian_process.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <fmt/format.h>

#include <cmath>

namespace palpate::test {
namespace {

/// The error of a run of the default, metres.
double error_of_run(const std::vector<std::string>& overrides) {
  Finished run("default.yaml", overrides);
  return run.experiment.result().errors.rmse.value();
}

/// The mean errors over seeds, with the model of outliers and without.
struct MeanErrors {
  double judged = 0.0, believed = 0.0;
  MeanErrors(const std::vector<std::string>& overrides, int seeds) {
    for (int seed = 1; seed <= seeds; ++seed) {
      std::vector<std::string> all = overrides;
      all.push_back(fmt::format("seed={}", seed));
      judged += error_of_run(all) / seeds;
      all.emplace_back("belief.height.outlier_probability=none");
      believed += error_of_run(all) / seeds;
    }
  }
};

void expect_cell(const std::vector<std::string>& overrides, int seeds) {
  const MeanErrors errors(overrides, seeds);
  EXPECT_TRUE(std::isfinite(errors.judged)) << ::testing::PrintToString(overrides);
  EXPECT_LE(errors.judged, 2.0 * errors.believed + 0.001) << ::testing::PrintToString(overrides);
}

// What a user reported: errors of 7e16 cm, of -nan, and of 8.9 cm instead of 0.6.
TEST(StabilityMatrix, TheDefaultAtTinyNoiseIsAsGoodAsWithoutOutliers) {
  expect_cell({"belief.height.noise=1e-5mm", "kernel.length_scale=1m", "taps=60"}, 1);
  if (brief()) return;
  expect_cell({"belief.height.noise=1e-5mm", "kernel.length_scale=50cm", "taps=200"}, 1);
  expect_cell({"belief.height.noise=5e-6mm", "kernel.length_scale=30cm", "taps=200"}, 1);
}

class StabilityMatrix : public ::testing::TestWithParam<const char*> {};

TEST_P(StabilityMatrix, HoldsAtEveryLengthScale) {
  for (const char* const length : {"1mm", "3cm", "30cm", "20m"})
    expect_cell(
        {fmt::format("belief.height.noise={}", GetParam()), fmt::format("kernel.length_scale={}", length), "taps=14"},
        brief() ? 1 : 4);
}

INSTANTIATE_TEST_SUITE_P(OfNoise, StabilityMatrix,
                         ::testing::Values("0mm", "1e-9mm", "1e-6mm", "1e-4mm", "0.1mm", "5cm"));

/// Where taps lie in the rows of the outlier model alone.
enum class Places { apart, repeated, nearly_repeated };

Points places_of(Places how, int count) {
  Random random(3, "outlier model");
  Points out = Points::NullaryExpr(count, 2, [&] { return 0.23 * random.uniform(); });
  if (how == Places::apart) return out;
  for (int i = 1; i < count; i += 2) {
    out.row(i) = out.row(i - 1);
    if (how == Places::nearly_repeated) out(i, 0) += 1e-12;
  }
  return out;
}

class OutlierModel : public ::testing::TestWithParam<Places> {};

TEST_P(OutlierModel, IsFiniteAndAsGoodAsTheProcessItself) {
  const CandidateGrid candidates =
      product_grid(Eigen::VectorXd::LinSpaced(12, 0.0, 0.23), Eigen::VectorXd::LinSpaced(12, 0.0, 0.23));
  const auto surface = [](double x, double y) { return 0.06 + 0.02 * std::sin(30.0 * x) + 0.1 * y; };
  for (const int count : brief() ? std::vector<int>{3, 25} : std::vector<int>{3, 25, 100}) {
    const Points places = places_of(GetParam(), count);
    for (const double noise : {1e-12, 1e-9, 1e-7, 1e-5, 1e-3, 0.05}) {
      for (const char* const length : {"1 mm", "3 cm", "50 cm", "20 m"}) {
        const auto kernel = make<Kernel>(shared_host(), "rbf", fmt::format("{{length_scale: {}}}", length));
        GaussianProcess process(kernel, GpSettings{0.1, noise, 0.0, 1.0}, candidates);
        for (Eigen::Index i = 0; i < count; ++i)
          process.add({places(i, 0), places(i, 1)}, surface(places(i, 0), places(i, 1)));
        RobustSurface judged(candidates);
        judged.update(process, Eigen::VectorXd::Constant(count, 0.03));
        Eigen::VectorXd mean, variance;
        judged.read_mean(process, mean);
        judged.read_variance(process, variance);
        const std::string cell = fmt::format("{} taps, noise {}, length scale {}", count, noise, length);
        ASSERT_TRUE(mean.allFinite() && variance.allFinite() && judged.outlier_probabilities().allFinite()) << cell;
        EXPECT_GE(variance.minCoeff(), 0.0) << cell;
        const auto rms_of = [&](const Eigen::VectorXd& map) {
          double squares = 0.0;
          for (int i = 0; i < candidates.size(); ++i)
            squares += std::pow(map(i) - surface(candidates.points(i, 0), candidates.points(i, 1)), 2);
          return std::sqrt(squares / candidates.size());
        };
        EXPECT_LE(rms_of(mean), 2.0 * rms_of(process.mean()) + 0.001) << cell;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfPlaces, OutlierModel,
                         ::testing::Values(Places::apart, Places::repeated, Places::nearly_repeated));

}  // namespace
}  // namespace palpate::test
