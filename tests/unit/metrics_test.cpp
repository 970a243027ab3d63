// SPDX-License-Identifier: MIT
#include "belief/metrics.hpp"

#include "support/runs.hpp"
#include "support/testing.hpp"

namespace palpate::test {
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

TEST(FootprintIou, CountsCellsFromOneHalfOn) {
  EXPECT_DOUBLE_EQ(footprint_iou(Eigen::Vector4d(0.0, 0.5, 0.4999, 0.9), four_cells()), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(footprint_iou(Eigen::Vector4d(0.0, 2.0, 1.0, -1.0), four_cells()), 1.0);
  EXPECT_DOUBLE_EQ(footprint_iou(Eigen::Vector4d::Zero(), four_cells()), 0.0);
}

TEST(FootprintIou, IsPerfectWhenThereIsNothingAndNothingIsSeenButTheErrorHasNoValueThere) {
  Truth truth = four_cells();
  truth.on.setConstant(false);
  EXPECT_FALSE(rmse(Eigen::Vector4d::Zero(), truth, true).has_value());
  EXPECT_DOUBLE_EQ(footprint_iou(Eigen::Vector4d::Zero(), truth), 1.0);
}

/// Errors and calibration of a whole run, by their definitions; with two parts, of the surface that the weight gates.
void expect_errors_by_definition(bool gated) {
  Finished run("paper/object_i_right.yaml", {"seed=3", gated ? "belief.surface=two_part" : "belief.surface=single"});
  const RunResult result = run.experiment.result();
  const HeightModels& models = run.models();
  constexpr double kTwoPi = 2 * 3.14159265358979323846;
  double all = 0.0;
  double on = 0.0;
  double bare = 0.0;
  double density = 0.0;
  int cells_on = 0;
  int seen = 0;
  int untapped = 0;
  int covered = 0;
  for (int i = 0; i < run.grid().size(); ++i) {
    const Target at = run.grid().target(i);
    // Object I by its definition: 9 + 2 cos(2 pi s / 8) cm within 6 x 16 cm around (17.5, 11.5) cm.
    const double s = (at.y - 0.115) * 100;
    const bool inside = std::abs(s) <= 8.0 && std::abs(at.x - 0.175) <= 0.03;
    const double height = inside ? 0.01 * (9 + 2 * std::cos(kTwoPi * s / 8)) : 0.0;
    const bool object = !gated || models.label_map().mean()(i) >= 0.5;
    seen += object ? 1 : 0;
    const double square = std::pow((object ? models.height_mean()(i) : 0.0) - height, 2);
    all += square;
    if (!inside) continue;
    const double error = models.height_mean()(i) - height;
    on += square;
    bare += error * error;
    ++cells_on;
    if (std::any_of(run.taps.begin(), run.taps.end(), [&](const TapRecord& tap) { return tap.candidate == i; })) {
      continue;
    }
    const double spread = models.height_variance()(i) + 1e-4 * 1e-4;
    density += 0.5 * std::log(kTwoPi * spread) + error * error / (2 * spread);
    covered += std::abs(error) < 1.959964 * std::sqrt(spread) ? 1 : 0;
    ++untapped;
  }
  EXPECT_NEAR(*result.errors.rmse, std::sqrt(all / run.grid().size()), 1e-12);
  EXPECT_NEAR(*result.errors.rmse_object, std::sqrt(on / cells_on), 1e-12);
  EXPECT_NEAR(*result.errors.rmse_height, std::sqrt(bare / cells_on), 1e-12);
  EXPECT_NEAR(number_of(result.state, "nlpd").value(), density / untapped, 1e-9);
  EXPECT_NEAR(number_of(result.state, "coverage_95").value(), static_cast<double>(covered) / untapped, 1e-12);
  EXPECT_GT(seen, 0);
  EXPECT_EQ(seen < run.grid().size(), gated);
  EXPECT_EQ(*result.errors.rmse_height != *result.errors.rmse_object, gated);
}

TEST(Errors, OfARunAgreeWithTheirDefinitionsOverTheSurfaceItself) { expect_errors_by_definition(false); }

TEST(TwoPart, ErrorsOfARunAreThoseOfTheGatedSurface) { expect_errors_by_definition(true); }

TEST(Errors, AreUnknownWhereTheSceneIsNotTheTruth) {
  Finished run("paper/object_i.yaml", {}, scripted());
  const RunResult result = run.experiment.result();
  EXPECT_FALSE(result.errors.rmse || result.errors.footprint_iou || number_of(result.state, "nlpd"));
  EXPECT_FALSE(run.taps.front().true_on_object.has_value());
}

}  // namespace
}  // namespace palpate::test
