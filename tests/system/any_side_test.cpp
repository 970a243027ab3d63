// SPDX-License-Identifier: MIT
// Runs from any side as their users see them: what they leave, that they go on and are played again as they were, and
// what is refused.
#include "record/json.hpp"
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

class AnySide : public Shell {
 protected:
  /// The meshes of the scenes are in the folder that they name.
  void SetUp() override { fs::create_directory_symlink(test::source_folder() / "configs", here() / "configs"); }
  static std::string config() { return (test::source_folder() / "configs/any_side.yaml").string(); }
  fs::path touched(const Words& more) const {
    return ran(Words{"scene=any_bowl", "space.approaches=200", "space.moves=100"} + more, config());
  }
};

TEST_F(AnySide, ARunTellsOfEachTapWhereItBeganInWhichDirectionAndHowFarItWent) {
  const fs::path run = touched("taps=12");
  const std::vector<Row> rows = rows_of(run, "taps.jsonl");
  ASSERT_EQ(rows.size(), 12U);
  int on = 0;
  for (const Row& row : rows) {
    const auto number = [&](const char* name) { return row.number(name).value(); };
    const Eigen::Vector3d direction(number("direction.x"), number("direction.y"), number("direction.z"));
    EXPECT_NEAR(direction.norm(), 1.0, 1e-12);
    EXPECT_GT(number("z"), 0.0);
    EXPECT_LE(number("along"), number("length"));
    if (row.text("outcome") != "contact") continue;
    EXPECT_NEAR(number("height"), number("z") + number("along") * direction.z(), 1e-12);
    on += row.flag("on_surface").value() ? 1 : 0;
    EXPECT_EQ(row.flag("on_surface"), row.flag("true_on_surface"));
  }
  EXPECT_GT(on, 4);
  const Row summary = parse_json_row(text_of(run / "summary.json")).value();
  EXPECT_LT(summary.number("nearest_m").value(), 0.05);
  EXPECT_GE(summary.number("rmse_m").value(), summary.number("nearest_m").value());
  EXPECT_GT(summary.number("f_score").value(), 0.0);
  EXPECT_EQ(text_of(run / "surface.ply").rfind("ply\nformat ascii 1.0\n", 0), 0U);
}

TEST_F(AnySide, ARunThatWasBrokenOffEndsAsTheUnbrokenOneDoes) {
  const fs::path whole = touched("taps=9 name=whole");
  const fs::path broken = touched("taps=9 name=broken");
  break_off(broken);
  ASSERT_EQ(resume(broken).status, 0);
  EXPECT_EQ(text_of(broken / "taps.csv"), text_of(whole / "taps.csv"));
  EXPECT_EQ(text_of(broken / "surface.ply"), text_of(whole / "surface.ply"));
}

TEST_F(AnySide, ARunIsPlayedAgainToTheLastBit) {
  const Ended ended = palpate({"replay", touched("taps=9")});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, testing::HasSubstr("all equal"));
}

TEST_F(AnySide, EachRuleTakesApproachesOfItsOwnAfterTheSameFirstOnes) {
  std::vector<std::vector<Row>> runs;
  for (const Words& rule : {Words("acquisition=random"), Words("acquisition=uncertainty"),
                            Words("acquisition=contrast acquisition.skin=0m")}) {
    runs.push_back(rows_of(touched(rule + "taps=12"), "taps.jsonl"));
  }
  // The first ones go on until an object is hit, which happens to all of them at the same tap.
  const auto start = [&](std::size_t run, std::size_t tap) { return runs[run][tap].number("x").value(); };
  std::size_t first = 0;
  while (first < runs[0].size() && runs[0][first].text("source") == "initial") ++first;
  ASSERT_GE(first, 3U);
  ASSERT_LT(first, runs[0].size());
  for (std::size_t tap = 0; tap < first; ++tap) {
    EXPECT_EQ(start(0, tap), start(1, tap));
    EXPECT_EQ(start(0, tap), start(2, tap));
  }
  EXPECT_NE(start(0, first), start(1, first));
  EXPECT_NE(start(0, first), start(2, first));
  EXPECT_NE(start(1, first), start(2, first));
}

TEST_F(AnySide, ASweepIsComparedAfterFewerTapsAsIfItsRunsHadEndedThere) {
  const fs::path sweep = swept(
      {"acquisition=random,contrast", "scene=any_bowl", "space.approaches=200", "space.moves=50", "taps=8"}, config());
  const Ended ended =
      palpate({"compare", sweep, "--by", "acquisition", "--metric", "nearest_m", "--at", "5", "--table"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  const Row alone =
      parse_json_row(
          text_of(ran({"scene=any_bowl", "space.approaches=200", "space.moves=50", "taps=5", "acquisition=random"},
                      config()) /
                  "summary.json"))
          .value();
  const std::string shown = std::to_string(1e3 * alone.number("nearest_m").value());
  EXPECT_THAT(ended.out, testing::HasSubstr("| random | 5 | " + shown.substr(0, shown.find('.'))));
}

TEST_F(AnySide, WhatOnlyKnowsTapsFromAboveIsRefusedInOneLine) {
  EXPECT_THAT(refused({"run", config(), "acquisition=weighted"}),
              testing::HasSubstr("weighted scores taps from above alone, choose one that scores approaches"));
  EXPECT_THAT(refused({"run", config(), "scene.touch=top"}),
              testing::HasSubstr("surface: implicit is for a scene with touch: any"));
  EXPECT_THAT(refused({"run", config(), "strategy=default"}), testing::HasSubstr("strategy=any_side has it"));
  EXPECT_THAT(refused({"run", paper(), "acquisition=contrast"}),
              testing::HasSubstr("contrast scores approaches from any side alone"));
  const fs::path run = touched("taps=4");
  EXPECT_THAT(refused({"export", run}), testing::HasSubstr("is a run from any side"));
  EXPECT_THAT(refused({"report", run}), testing::HasSubstr("is a run from any side"));
}

}  // namespace
}  // namespace palpate
