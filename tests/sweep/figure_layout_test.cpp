// SPDX-License-Identifier: MIT
#include "report/figures/figure_layout.hpp"
#include "support/grids.hpp"

#include "support/gaussian_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace palpate {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::vector<double>> numbers_in(const std::string& text) {
  std::vector<std::vector<double>> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    out.emplace_back();
    for (double cell = 0.0; cells >> cell;) out.back().push_back(cell);
  }
  return out;
}

TEST(MatrixTest, HasEveryCellOnceWithTheLowestRowFirst) {
  const Area area{0.3, 0.2};
  const SceneFrame frame{test::grid_by_spacing(area, 0.1), area};  // 3 x 2
  const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(6, 1, 6);
  EXPECT_EQ(matrix_of(frame, values), "1 2 3\n4 5 6\n");
  EXPECT_EQ(surface_of(frame, values / 100, values / 1000),
            "5 5 1 0.1\n15 5 2 0.2\n25 5 3 0.3\n\n5 15 4 0.4\n15 15 5 0.5\n25 15 6 0.6\n\n");
  EXPECT_EQ(matrix_columns(frame), "(10 * (column(1) + 0.5)):(10 * (column(2) + 0.5)):3");
}

TEST(MatrixTest, ThinsOutWhatNoPictureShowsAndStillCoversTheArea) {
  const Area area{1.0, 1.0};
  const SceneFrame frame{test::grid_by_count(area, 1000), area};
  const auto rows = numbers_in(matrix_of(frame, frame.candidates.points.col(0)));
  ASSERT_LT(rows.size(), 300U);
  const auto count = static_cast<double>(rows.size());
  for (std::size_t i = 0; i < rows[0].size(); ++i)
    EXPECT_NEAR(rows[0][i], (static_cast<double>(i) + 0.5) / count, 0.51 / 1000) << "the candidate nearest to the cell";
}

TEST(MatrixTest, ASingleCandidateFillsTheArea) {
  const Area area{0.1, 0.1};
  const SceneFrame frame{test::grid_by_count(area, 1), area};
  EXPECT_EQ(matrix_of(frame, Eigen::VectorXd::Constant(1, 7.0)), "7 7\n7 7\n");
}

TEST(MatrixTest, WhatIsNotFiniteIsAGapAndNoWord) {
  const Area area{0.2, 0.2};
  const SceneFrame frame{test::grid_by_count(area, 2), area};
  Eigen::VectorXd values = Eigen::VectorXd::Zero(4);
  values(1) = std::nan("");
  values(2) = HUGE_VAL;
  EXPECT_EQ(matrix_of(frame, values), "0 NaN\nNaN 0\n");
}

MapsAtTap flat_moment(double height) {
  MapsAtTap snapshot;
  snapshot.surface = Eigen::VectorXd::Constant(1, height);
  return snapshot;
}

TEST(ReliefTest, HoldsDeskSurfaceAndTaps) {
  Points middle(1, 2);
  middle << 0.1, 0.1;
  const Area area{0.2, 0.2};
  const SceneFrame frame{test::scattered(middle), area};
  const ZRange bare = z_range_of({flat_moment(0.0)}, frame);
  const ZRange hill = z_range_of({flat_moment(0.0), flat_moment(0.5)}, frame);
  EXPECT_EQ(hill.low, 0.0);
  EXPECT_EQ(hill.top, 0.5);
  EXPECT_EQ(hill.below, bare.below);
  EXPECT_NEAR(hill.above, 0.5 * std::sin(std::acos(0.5)), 1e-9) << "seen from 60 degrees off the vertical";
  const ZRange pit = z_range_of({flat_moment(-0.5)}, frame);
  EXPECT_EQ(pit.low, -0.5);
  EXPECT_EQ(pit.below, hill.above);
  MapsAtTap tapped = flat_moment(0.0);
  tapped.marks.push_back({1, TapMark::Kind::on, 0.1, 0.1, 0.7});
  EXPECT_EQ(z_range_of({tapped}, frame).top, 0.7);
}

TEST(InSightTest, LeavesOutWhatTheSurfaceHidesFromTheSide) {
  const Area area{0.2, 0.2};
  const SceneFrame frame{test::grid_by_count(area, 20), area};
  MapsAtTap snapshot;
  snapshot.surface = Eigen::VectorXd::Zero(frame.candidates.size());
  // A wall across the middle, 10 cm high: seen from 30 degrees above, it hides what lies up to 17 cm behind it.
  for (int i = 0; i < frame.candidates.size(); ++i) {
    if (std::abs(frame.candidates.points(i, 1) - 0.1) < 0.01) snapshot.surface(i) = 0.1;
  }
  snapshot.marks = {{1, TapMark::Kind::off, 0.1, 0.05, 0.0},
                    {2, TapMark::Kind::on, 0.1, 0.1, 0.1},
                    {3, TapMark::Kind::off, 0.1, 0.15, 0.0},
                    {4, TapMark::Kind::on, 0.1, 0.15, 0.12}};
  std::vector<int> seen;
  for (const TapMark& mark : without_hidden_taps(snapshot, frame).marks) seen.push_back(mark.tap);
  EXPECT_EQ(seen, (std::vector<int>{1, 2, 4}));
}

TEST(SheetTest, WritesEachKindOfTapToABlockOfItsOwnAndPlotsOnlyWhatThereIs) {
  FigureLayout layout(400, 300);
  MapsAtTap snapshot;
  snapshot.marks = {{1, TapMark::Kind::on, 0.01, 0.02, 0.03}, {2, TapMark::Kind::failed, 0.04, 0.05, 0.0}};
  snapshot.next.emplace();
  snapshot.next->request.line = line_from_above({0.06, 0.07});
  layout.taps("a", snapshot);
  const Area area{0.1, 0.1};
  const SceneFrame frame{test::grid_by_count(area, 2), area};
  layout.data("m", matrix_of(frame, Eigen::VectorXd::Zero(4)));
  layout.map({50, 50, 200, 200}, frame, "m", "a", {Palette::viridis, 0, 1, "e"});
  const std::string script = layout.script();
  EXPECT_THAT(script, HasSubstr("$on_a << END\n1 2 3 1\nEND\n"));
  EXPECT_THAT(script, HasSubstr("$failed_a << END\n4 5 0 2\nEND\n"));
  EXPECT_THAT(script, HasSubstr("$next_a << END\n6 7\nEND\n"));
  EXPECT_THAT(script, Not(HasSubstr("off_a"))) << "gnuplot has no empty blocks";
}

TEST(SheetTest, TextFromConfigsIsNeverACommand) {
  FigureLayout layout(400, 300);
  layout.text("it's `date`\nand \"more\"", 10, 10, 12);
  layout.plot({10, 10, 100, 100}, "", "plot NaN");
  EXPECT_THAT(layout.script(), HasSubstr("'it''s `date`'"));
  EXPECT_THAT(layout.script(), HasSubstr("'and \"more\"'"));
}

}  // namespace
}  // namespace palpate
