// SPDX-License-Identifier: MIT
// `palpate report --paper`: what is plotted in the paper's figures is what was recorded. The scripts beside the
// pictures hold all data, so they are read here.
#include "system/figure_blocks.hpp"

#include <algorithm>

namespace palpate {
namespace {

/// The runs behind the paper's figures, made and drawn once.
class PaperFigures : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const Ended swept = test::palpate({"sweep", config("paper/figures.yaml"), "--quiet"}, folder_->path());
    ASSERT_EQ(swept.status, 0) << swept.err;
    const Ended drawn = test::palpate({"report", sweep().string(), "--paper"}, folder_->path());
    ASSERT_EQ(drawn.status, 0) << drawn.err;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static fs::path sweep() { return test::only_run(folder_->path() / "runs"); }
  static fs::path script(const std::string& figure) { return sweep() / "figures" / (figure + ".gnuplot"); }

  static Recorded job(const std::string& scene, const std::string& acquisition) {
    for (const Cells& row : csv_rows(text_of(sweep() / "results.csv"))) {
      if (row.at("scene") == scene && row.at("acquisition") == acquisition)
        return Recorded(sweep() / "jobs" / row.at("id"));
    }
    throw std::runtime_error("no job of " + scene + " with " + acquisition);
  }

  /// Where the strategy taps after all taps of a run: its next tap when the budget is larger by one.
  static std::vector<double> next_after_all(const Recorded& run) {
    const TemporaryFolder folder;
    const Ended ended = test::palpate(
        {"run", (run.directory / "config.yaml").string(), "taps=" + std::to_string(run.count() + 1), "--quiet"},
        folder.path());
    EXPECT_EQ(ended.status, 0) << ended.err;
    const Recorded longer(test::only_run(folder.path() / "runs"));
    return {100 * longer.at(run.count() + 1, "x"), 100 * longer.at(run.count() + 1, "y")};
  }

  /// Compares one panel with the record of its run, and its map with what taps.csv says of the next tap.
  static void expect_panel(const std::string& figure, const Recorded& run, const std::string& strategy, int iteration,
                           const std::string& map, const char* field) {
    const std::string key = strategy + "_" + std::to_string(iteration);
    const std::string what = figure + " " + key;
    const auto blocks = blocks_of(script(figure));
    const int last = std::min(iteration + 2, run.count());
    const Lines on = block_or_none(blocks, "on_" + key);
    const Lines off = block_or_none(blocks, "off_" + key);
    expect_equal(on, run.marks(last, "true"), what);
    expect_equal(off, run.marks(last, "false"), what);
    EXPECT_EQ(on.size() + off.size(), static_cast<std::size_t>(last)) << "no more taps than the iteration says";
    const std::string text = text_of(script(figure));
    EXPECT_NE(text.find("'iteration " + std::to_string(iteration) + ", after tap " + std::to_string(last) + "'"),
              std::string::npos)
        << what;
    EXPECT_NE(
        text.find("'" + std::to_string(on.size()) + " on the object, " + std::to_string(off.size()) + " on the desk'"),
        std::string::npos)
        << what;
    const Lines next = block_or_none(blocks, "next_" + key);
    ASSERT_EQ(next.size(), 1U) << what;
    if (last < run.count()) {
      expect_equal(next, {{100 * run.at(last + 1, "x"), 100 * run.at(last + 1, "y")}}, what);
      EXPECT_NEAR(value_at(blocks.at(map + key), next[0][0], next[0][1]), run.at(last + 1, field), 2e-6) << what;
    } else {
      expect_equal(next, {next_after_all(run)}, what);
      const std::string summary = text_of(run.directory / "summary.json");
      EXPECT_THAT(summary, HasSubstr("\"object_taps\": " + std::to_string(on.size()) + ","));
      EXPECT_THAT(summary, HasSubstr("\"desk_taps\": " + std::to_string(off.size()) + ","));
    }
  }

  /// A surface passes through the taps it was made from, and is sure of itself there.
  static void expect_surface(const std::string& figure, int iteration) {
    const std::string key = "weighted_" + std::to_string(iteration);
    const auto blocks = blocks_of(script(figure));
    const Lines surface = blocks.at("surface_" + key);
    ASSERT_EQ(surface.size(), 47U * 47U);
    for (const char* kind : {"on_", "off_"}) {
      for (const std::vector<double>& tap : block_or_none(blocks, kind + key)) {
        const auto cell = std::find_if(surface.begin(), surface.end(), [&](const std::vector<double>& one) {
          return std::abs(one[0] - tap[0]) < 1e-3 && std::abs(one[1] - tap[1]) < 1e-3;
        });
        ASSERT_NE(cell, surface.end());
        EXPECT_NEAR((*cell)[2], tap[2], 0.05) << "the height at tap " << tap[3];
        EXPECT_LT((*cell)[3], 0.02) << "cm: the noise of a tap is 0.01";
      }
    }
  }

  static std::unique_ptr<TemporaryFolder> folder_;
};
std::unique_ptr<TemporaryFolder> PaperFigures::folder_;

TEST_F(PaperFigures, Figure2ShowsObjectIAsItsRunWasRecorded) {
  const Recorded run = job("object_i", "weighted");
  EXPECT_EQ(run.count(), 17);
  for (const int iteration : {1, 8, 10, 14}) {
    expect_panel("figure_2", run, "weighted", iteration, "scores_", "score");
    expect_surface("figure_2", iteration);
  }
}

TEST_F(PaperFigures, Figures4And5ShowBothStrategiesFromTheSameStartWithThePapersCounts) {
  const Recorded rival = job("object_i_right", "uncertainty");
  const Recorded explorer = job("object_i_right", "weighted");
  EXPECT_THAT(rival.marks(17, "true"), SizeIs(2));
  EXPECT_THAT(explorer.marks(17, "true"), SizeIs(12));
  expect_equal(rival.marks(3, "true"), explorer.marks(3, "true"), "the same start");
  EXPECT_THAT(rival.marks(3, "true"), Not(IsEmpty())) << "a live one";
  for (const int iteration : {1, 10, 16}) {
    for (const Recorded* run : {&rival, &explorer}) {
      const std::string strategy = run == &rival ? "uncertainty" : "weighted";
      expect_panel("figure_4", *run, strategy, iteration, "scores_", "score");
      expect_panel("figure_5", *run, strategy, iteration, "u_", "u");
    }
  }
}

}  // namespace
}  // namespace palpate
