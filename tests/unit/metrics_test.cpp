// SPDX-License-Identifier: MIT
#include "experiment/metrics.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

Truth four_cells() {
  Truth truth{Eigen::Vector4d(0.0, 0.1, 0.1, 0.0), Eigen::Array<bool, Eigen::Dynamic, 1>(4)};
  truth.on << false, true, true, false;
  return truth;
}

TEST(Rmse, IsTheRootOfTheMeanSquareOverTheCellsInQuestion) {
  const Eigen::VectorXd map = Eigen::Vector4d(0.03, 0.1, 0.06, 0.0);
  EXPECT_NEAR(*rmse(map, four_cells(), false), std::sqrt((0.0009 + 0.0016) / 4), 1e-15);
  EXPECT_NEAR(*rmse(map, four_cells(), true), std::sqrt(0.0016 / 2), 1e-15);
}

TEST(Rmse, HasNoValueWhereThereIsNoCell) {
  Truth truth = four_cells();
  truth.on.setConstant(false);
  EXPECT_FALSE(rmse(Eigen::Vector4d::Zero(), truth, true).has_value());
}

TEST(FootprintIou, CountsCellsFromOneHalfOn) {
  EXPECT_DOUBLE_EQ(footprint_iou(Eigen::Vector4d(0.0, 0.5, 0.4999, 0.9), four_cells()), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(footprint_iou(Eigen::Vector4d(0.0, 2.0, 1.0, -1.0), four_cells()), 1.0);
  EXPECT_DOUBLE_EQ(footprint_iou(Eigen::Vector4d::Zero(), four_cells()), 0.0);
}

TEST(FootprintIou, IsPerfectWhenThereIsNothingAndNothingIsSeen) {
  Truth truth = four_cells();
  truth.on.setConstant(false);
  EXPECT_DOUBLE_EQ(footprint_iou(Eigen::Vector4d::Zero(), truth), 1.0);
}

TEST(Errors, OfARunAgreeWithTheirDefinitionsOverTheSurfaceItself) {
  const ResolvedConfig config = test::shipped_config("paper/object_i_right.yaml", {"seed=3"});
  Experiment experiment(config.options, test::shared_host(), nullptr);
  test::Collector collector;
  experiment.run(collector);
  const RunResult result = experiment.result();
  const Eigen::VectorXd& mean = experiment.belief().height_mean();
  const Eigen::VectorXd& variance = experiment.belief().height_variance();
  double all = 0.0;
  double on = 0.0;
  double density = 0.0;
  int cells_on = 0;
  int untapped = 0;
  int covered = 0;
  for (int i = 0; i < experiment.candidates().size(); ++i) {
    const Target at = experiment.candidates().target(i);
    // Object I by its definition: 9 + 2 cos(2 pi s / 8) cm within 6 x 16 cm around (17.5, 11.5) cm.
    const double s = (at.y - 0.115) * 100;
    const bool inside = std::abs(s) <= 8.0 && std::abs(at.x - 0.175) <= 0.03;
    const double height = inside ? 0.01 * (9 + 2 * std::cos(2 * 3.14159265358979323846 * s / 8)) : 0.0;
    const double error = mean(i) - height;
    all += error * error;
    if (!inside) continue;
    on += error * error;
    ++cells_on;
    bool tapped = false;
    for (const TapRecord& tap : collector.taps) tapped = tapped || tap.candidate == i;
    if (tapped) continue;
    const double spread = variance(i) + 1e-4 * 1e-4;
    density += 0.5 * std::log(2 * 3.14159265358979323846 * spread) + error * error / (2 * spread);
    covered += std::abs(error) < 1.959964 * std::sqrt(spread) ? 1 : 0;
    ++untapped;
  }
  EXPECT_NEAR(*result.errors.rmse, std::sqrt(all / experiment.candidates().size()), 1e-12);
  EXPECT_NEAR(*result.errors.rmse_on_surface, std::sqrt(on / cells_on), 1e-12);
  EXPECT_NEAR(*result.errors.rmse_height, std::sqrt(on / cells_on), 1e-12);
  EXPECT_NEAR(*result.calibration.nlpd, density / untapped, 1e-9);
  EXPECT_NEAR(*result.calibration.coverage_95, static_cast<double>(covered) / untapped, 1e-12);
}

TEST(Errors, AreUnknownWhereTheSceneIsNotTheTruth) {
  const ResolvedConfig config = test::shipped_config("paper/object_i.yaml");
  Experiment experiment(config.options, test::shared_host(), nullptr,
                        std::make_shared<test::ScriptedBackend>(std::vector<Contact>{}, false));
  test::Collector collector;
  experiment.run(collector);
  const RunResult result = experiment.result();
  EXPECT_FALSE(result.errors.rmse || result.errors.footprint_iou || result.calibration.nlpd);
  EXPECT_FALSE(collector.taps.front().true_on_surface.has_value());
}

}  // namespace
}  // namespace palpate
