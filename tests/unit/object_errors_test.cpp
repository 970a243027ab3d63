// SPDX-License-Identifier: MIT
// What is said of each of several objects, by maps that are drawn by hand, and in a run by its taps.
#include "belief/object_errors.hpp"
#include "support/grids.hpp"

#include "support/runs.hpp"
#include "support/shape_cases.hpp"
#include "support/testing.hpp"
#include "tapping_bench.hpp"

namespace palpate::test {
namespace {

using Picture = std::vector<std::string>;

/// Objects a, b, c ... as drawn in `true_ones`, cells of 1 cm; predicted where `predicted` has a #.
std::vector<ObjectErrors> errors_of_maps(const Picture& true_ones, const Picture& predicted) {
  const int rows = static_cast<int>(true_ones.size());
  const int columns = static_cast<int>(true_ones.front().size());
  const CandidateGrid candidates = grid_by_spacing({0.01 * columns, 0.01 * rows}, 0.01);
  Truth truth{Eigen::VectorXd::Zero(candidates.size()), Eigen::Array<bool, Eigen::Dynamic, 1>(candidates.size()),
              Eigen::ArrayXi(candidates.size()), 0};
  Eigen::VectorXd probability(candidates.size());
  for (int i = 0; i < candidates.size(); ++i) {
    const auto row = static_cast<std::size_t>(i / columns);
    const auto column = static_cast<std::size_t>(i % columns);
    const char object = true_ones[row][column];
    truth.on(i) = object != '.';
    truth.object(i) = object != '.' ? object - 'a' : Scene::kNoObject;
    truth.height(i) = object != '.' ? 0.05 : 0.0;
    truth.objects = std::max(truth.objects, truth.object(i) + 1);
    probability(i) = predicted[row][column] == '#' ? 0.5 : 0.4999;
  }
  SurfaceMaps maps;
  maps.probability = &probability;
  return object_errors(maps, truth, candidates);
}

/// "M" for each object that is merged, "S" for one that is split, "." for one that is neither.
std::string merged_or_split(const Picture& true_ones, const Picture& predicted) {
  std::string out;
  for (const ObjectErrors& one : errors_of_maps(true_ones, predicted))
    out += std::string(one.merged ? "M" : "") + (one.split ? "S" : "") + (!one.merged && !one.split ? "." : "");
  return out;
}

TEST(ObjectErrors, OfAPerfectFootprintAreNone) {
  const auto errors = errors_of_maps({"aa...", "aa.bb", "....b"}, {"##...", "##.##", "....#"});
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[0].cells, 4);
  EXPECT_EQ(errors[1].cells, 3);
  for (const ObjectErrors& one : errors) {
    EXPECT_FALSE(one.merged || one.split);
    EXPECT_EQ(one.iou, 1.0);
    EXPECT_FALSE(one.rmse_height) << "nobody asked for it";
  }
}

TEST(ObjectErrors, CallMergedWhatOnePieceHoldsAcrossAGap) {
  EXPECT_EQ(merged_or_split({"aaa.bbb"}, {"#######"}), "MM");
  EXPECT_EQ(merged_or_split({"aaa.bbb"}, {"###.###"}), "..");
  EXPECT_EQ(merged_or_split({"aa.bb.cc"}, {"#####.##"}), "MM.");
  EXPECT_EQ(merged_or_split({"aa..", "....", "..bb"}, {"##..", ".##.", "..##"}), "MM") << "round a corner";
  EXPECT_EQ(merged_or_split({"aa..", "....", "..bb"}, {"##..", "..#.", "..##"}), "..") << "over a corner only";
}

TEST(ObjectErrors, DoNotCallMergedWhatTouchesOrWhatIsHardlyHeld) {
  EXPECT_EQ(merged_or_split({"aaabbb"}, {"######"}), "..");
  EXPECT_EQ(merged_or_split({"aa..", "..bb"}, {"###.", ".###"}), "..") << "at a corner";
  EXPECT_EQ(merged_or_split({"aaaaa.bbbbb"}, {"#######...."}), "MM") << "a fifth";
  EXPECT_EQ(merged_or_split({"aaaaa.bbbbbb"}, {"#######....."}), "..") << "a sixth";
}

TEST(ObjectErrors, CallSplitWhatSeveralPiecesHold) {
  EXPECT_EQ(merged_or_split({"aaaaa"}, {"##.##"}), "S");
  EXPECT_EQ(merged_or_split({"aaaaaaa"}, {"####..#"}), ".") << "a seventh is no piece";
  EXPECT_EQ(merged_or_split({"aa.aa"}, {"##.##"}), ".") << "it truly is in two, as under another one";
  EXPECT_EQ(merged_or_split({"a.", ".a"}, {"#.", ".#"}), ".") << "what is right is not split";
  EXPECT_EQ(merged_or_split({"aaaaa.bb"}, {"##.#####"}), "MSM") << "split, and merged as well";
}

TEST(ObjectErrors, GiveAMissingObjectNothingInCommon) {
  const auto errors = errors_of_maps({"aa...bb"}, {"##....."});
  EXPECT_EQ(errors[0].iou, 1.0);
  EXPECT_EQ(errors[1].iou, 0.0);
  EXPECT_FALSE(errors[1].merged || errors[1].split);
}

TEST(ObjectErrors, CountWhatIsPredictedForNothingOnceAndForTheNearest) {
  //           0123456789
  const auto errors = errors_of_maps({"aa......bb"}, {"#####...##"});
  EXPECT_EQ(errors[0].iou, 2.0 / 5.0) << "cells 2, 3 and 4";
  EXPECT_EQ(errors[1].iou, 1.0);
  const auto all = errors_of_maps({"aa......bb"}, {"##########"});
  EXPECT_EQ(all[0].iou, 2.0 / 5.0);
  EXPECT_EQ(all[1].iou, 2.0 / 5.0);
  const auto other = errors_of_maps({"aabb"}, {"..##"});
  EXPECT_EQ(other[0].iou, 0.0);
  EXPECT_EQ(other[1].iou, 1.0);
  const auto shifted = errors_of_maps({"aabb"}, {"###."});
  EXPECT_EQ(shifted[0].iou, 1.0) << "a cell of another object is nothing that this one has too much";
  EXPECT_EQ(shifted[1].iou, 0.5);
}

TEST(ObjectErrors, OfAnObjectWithoutACellHaveNoNumber) {
  const auto errors = errors_of_maps({"bb.."}, {"##.."});
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_EQ(errors[0].cells, 0);
  EXPECT_FALSE(errors[0].iou);
  EXPECT_EQ(errors[1].iou, 1.0);
}

TEST(ObjectErrors, OfHeightsAreOverTheCellsOfEach) {
  const CandidateGrid candidates = grid_by_spacing({0.04, 0.01}, 0.01);
  Truth truth{Eigen::Vector4d(0.05, 0.05, 0.0, 0.02), Eigen::Array<bool, Eigen::Dynamic, 1>(4), Eigen::ArrayXi(4), 2};
  truth.on << true, true, false, true;
  truth.object << 0, 0, Scene::kNoObject, 1;
  const Eigen::VectorXd height = Eigen::Vector4d(0.05, 0.01, 0.7, 0.05);
  SurfaceMaps maps;
  maps.height = &height;
  const auto errors = object_errors(maps, truth, candidates);
  EXPECT_NEAR(*errors[0].rmse_height, std::sqrt(0.0016 / 2), 1e-15);
  EXPECT_NEAR(*errors[1].rmse_height, 0.03, 1e-15);
  EXPECT_FALSE(errors[0].iou) << "nobody asked for the probability";
}

TEST(Scene, TellsWhichObjectIsTheHighestAtAPlace) {
  const auto scene = scene_of({"{type: block, length: 20 cm, width: 20 cm, height: 2 cm, at: [20 cm, 20 cm]}",
                               "{type: cylinder, diameter: 4 cm, height: 9 cm, at: [28 cm, 20 cm]}"});
  EXPECT_EQ(scene->objects(), 2);
  EXPECT_EQ(scene->object(0.2, 0.2), 0);
  EXPECT_EQ(scene->object(0.28, 0.2), 1);
  EXPECT_EQ(scene->object(0.35, 0.2), Scene::kNoObject);
}

TEST(Push, LeavesEachObjectItsNumber) {
  const TappingBench bench(
      "[{type: block, length: 8 cm, width: 4 cm, height: 5 cm, at: [6 cm, 6 cm]}, "
      "{type: block, length: 6 cm, width: 3 cm, height: 7 cm, at: [16 cm, 15 cm]}]",
      "{push: {probability: 0.5, distance: 1 cm, turn: 20deg}}", "{type: paper}", 3);
  const auto after = bench.scene().after(60);
  ASSERT_NE(after, nullptr);
  EXPECT_EQ(after->objects(), 2);
  int cells[2] = {0, 0};
  for (double x = 0.0005; x < 0.23; x += 0.001) {
    for (double y = 0.0005; y < 0.23; y += 0.001) {
      const int object = after->object(x, y);
      if (object == Scene::kNoObject) continue;
      ++cells[object];
      EXPECT_NEAR(after->height(x, y), object == 0 ? 0.05 : 0.07, 1e-12);
    }
  }
  EXPECT_NEAR(cells[0], 3200, 60);
  EXPECT_NEAR(cells[1], 1800, 60);
}

TEST(ObjectResults, OfARunAreCountedByWhereItsTapsTrulyWent) {
  const std::vector<std::string> how{"scene=two_blocks", "strategy=random", "seed=4", "taps=40",
                                     "scene.effects={push: {probability: 0.3}}"};
  Prepared run("default.yaml", how);
  std::vector<ObjectTouches> expected(2);
  run.journal.announcing = [&](const TapRecord& tap) {
    const auto pushed = run.experiment.scene().after(tap.number() - 1);
    const Scene& now = pushed ? *pushed : run.experiment.scene();
    const int object = now.object(tap.target().x, tap.target().y);
    if (object == Scene::kNoObject) return;
    ObjectTouches& touches = expected[static_cast<std::size_t>(object)];
    if (++touches.taps == 1) touches.first_tap = tap.number();
  };
  run.run();
  const RunResult result = run.experiment.result();
  ASSERT_TRUE(result.objects);
  ASSERT_EQ(result.objects->size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*result.objects)[i].taps, expected[i].taps);
    EXPECT_EQ((*result.objects)[i].first_tap, expected[i].first_tap);
    EXPECT_GT(expected[i].taps, 0) << "else this tests nothing";
  }
  // A process that takes the taps over counts the same.
  Prepared later("default.yaml", how);
  later.experiment.resume(run.past(40));
  const RunResult again = later.experiment.result();
  EXPECT_EQ((*again.objects)[1].first_tap, expected[1].first_tap);
  EXPECT_EQ((*again.objects)[0].taps, expected[0].taps);
}

TEST(ObjectResults, AreUnknownWhereTheSceneIsNotTheTruth) {
  Finished run("paper/object_i.yaml", {}, scripted());
  EXPECT_FALSE(run.experiment.result().objects);
}

}  // namespace
}  // namespace palpate::test
