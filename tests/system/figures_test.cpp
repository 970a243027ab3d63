// SPDX-License-Identifier: MIT
// `palpate report --figures`: what is plotted is what was recorded.
#include "system/figure_blocks.hpp"

#include <algorithm>
#include <numeric>

namespace palpate {
namespace {

using testing::DoubleNear;

class Figures : public Shell {
 protected:
  Ended report(const fs::path& directory, const char* how) const { return palpate({"report", directory, how}); }

  /// A run, reported with --figures.
  fs::path drawn_run(const Words& words) const {
    const fs::path directory = ran(words);
    const Ended drawn = report(directory, "--figures");
    EXPECT_EQ(drawn.status, 0) << drawn.err;
    for (const char* name : {"surface", "maps", "curves"}) {
      EXPECT_TRUE(fs::exists(directory / "figures" / (std::string(name) + ".png"))) << name;
      EXPECT_TRUE(fs::exists(directory / "figures" / (std::string(name) + ".gnuplot"))) << name;
    }
    return directory;
  }
};

TEST_F(Figures, OfASweepWithoutTheJobsSaysInALineEachWhatIsMissing) {
  const fs::path some = swept("scene=object_i,object_i_right acquisition=weighted,random");
  const Ended two = report(some, "--paper");
  EXPECT_EQ(two.status, 0);
  EXPECT_THAT(two.err, HasSubstr("figure_3 is left out: no finished job has scene=object_ii and acquisition=weighted, "
                                 "run configs/paper/figures.yaml, which has all of them\n"));
  EXPECT_THAT(two.err, HasSubstr("figure_4 and figure_5 are left out: no finished job has scene=object_i_right and "
                                 "acquisition=uncertainty, run configs/paper/figures.yaml, which has all of them\n"));
  EXPECT_EQ(lines(two.err), 2) << two.err;
  EXPECT_TRUE(fs::exists(some / "figures/figure_2.png"));

  const Ended apart =
      report(swept({"sweep.zip={scene: [object_i, object_i_right, object_i_right], acquisition: [weighted, weighted, "
                    "uncertainty], seed: [1, 1, 2]}"}),
             "--paper");
  EXPECT_EQ(apart.status, 0);
  EXPECT_THAT(apart.err,
              HasSubstr("figure_4 and figure_5 are left out: no two finished jobs with scene=object_i_right, "
                        "one with acquisition=uncertainty and one with weighted, are equal in all else, "));
  const Ended none = report(swept("seed=1,2"), "--paper");
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("run configs/paper/figures.yaml, which has all of them\n"));
  EXPECT_EQ(lines(none.err), 1) << none.err;
}

TEST_F(Figures, OfARunHaveItsMapsAsSurfaceCsvHasThemAndCurvesThatEndWithItsSummary) {
  const fs::path directory = drawn_run("seed=3");
  const Recorded run(directory);
  const auto maps = blocks_of(directory / "figures/maps.gnuplot");
  expect_equal(block_or_none(maps, "on_last"), run.marks(17, "true"), "on");
  expect_equal(block_or_none(maps, "off_last"), run.marks(17, "false"), "off");
  const auto surface = blocks_of(directory / "figures/surface.gnuplot").at("surface");
  const std::vector<Cells> recorded = csv_rows(text_of(directory / "surface.csv"));
  ASSERT_EQ(surface.size(), recorded.size());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const double x = 100 * std::stod(recorded[i].at("x"));
    const double y = 100 * std::stod(recorded[i].at("y"));
    EXPECT_NEAR(surface[i][0], x, 1e-3);
    EXPECT_NEAR(surface[i][1], y, 1e-3);
    EXPECT_NEAR(surface[i][2], 100 * std::stod(recorded[i].at("reconstructed_height")), 1e-3);
    EXPECT_NEAR(surface[i][3], 100 * std::stod(recorded[i].at("height_standard_deviation")), 1e-3);
    const double u = value_at(maps.at("u"), x, y);
    const double w = value_at(maps.at("w"), x, y);
    EXPECT_NEAR(value_at(maps.at("e"), x, y), u * w, 1e-5) << "e = u w";
    EXPECT_NEAR(std::sqrt(u) * 100, surface[i][3], 1e-3) << "signal 1 m";
  }

  const auto curves = blocks_of(directory / "figures/curves.gnuplot");
  const std::string summary = text_of(directory / "summary.json");
  const auto field = [&](const std::string& name) {
    return std::stod(summary.substr(summary.find("\"" + name + "\": ") + name.size() + 4));
  };
  const Lines errors = curves.at("curve_1_1");
  EXPECT_THAT(errors.back(), ElementsAre(17, DoubleNear(1000 * field("rmse_m"), 1e-6)));
  EXPECT_THAT(errors.at(3), ElementsAre(3, DoubleNear(1000 * run.at(4, "rmse_m"), 1e-6)))
      << "what tap 4 was chosen from";
  EXPECT_NEAR(curves.at("curve_2_1").back()[1], field("footprint_iou"), 1e-9);
  EXPECT_NEAR(curves.at("curve_3_1").back()[1], field("object_taps") / 17, 1e-9);
  EXPECT_NEAR(curves.at("curve_6_1").back()[1], field("robot_seconds"), 1e-6);
  EXPECT_THAT(text_of(directory / "figures/curves.gnuplot"),
              AllOf(HasSubstr("Constant over all taps:"),
                    HasSubstr("Hyperparameters of the height GP: signal 1, noise 0.0001, length_scale 0.017")))
      << "what never changes is told, not drawn";
}

TEST_F(Figures, OfAFootprintHaveItsProbabilityAndTheScoreInPlaceOfTheWeight) {
  const fs::path directory =
      drawn_run("seed=3 belief.footprint=primitives acquisition=footprint_then_height belief.surface=two_part");
  const auto maps = blocks_of(directory / "figures/maps.gnuplot");
  EXPECT_EQ(maps.count("w") + maps.count("e"), 0U);
  EXPECT_EQ(maps.count("score"), 1U);
  EXPECT_THAT(text_of(directory / "figures/maps.gnuplot"), HasSubstr("by footprint/primitives"));
  for (const Cells& cell : csv_rows(text_of(directory / "surface.csv"))) {
    EXPECT_NEAR(value_at(maps.at("p"), 100 * std::stod(cell.at("x")), 100 * std::stod(cell.at("y"))),
                std::stod(cell.at("object_probability")), 1e-5);
  }
}

TEST_F(Figures, OfARunGiveFailedTapsAMarkOfTheirOwn) {
  const fs::path directory = drawn_run(
      {"scene.effects.missed_contacts.probability=0.5", "scene.area.width=40cm", "candidates={spacing: 5mm}"});
  std::vector<double> numbers;
  for (const auto& line : block_or_none(blocks_of(directory / "figures/maps.gnuplot"), "failed_last"))
    numbers.push_back(line.at(3));
  std::vector<double> recorded;
  for (const Cells& tap : csv_rows(text_of(directory / "taps.csv"))) {
    if (tap.at("outcome") != "contact") recorded.push_back(std::stod(tap.at("tap")));
  }
  EXPECT_THAT(recorded, Not(IsEmpty()));
  EXPECT_EQ(numbers, recorded);
}

TEST_F(Figures, AreDrawnOfTheSmallestRunsAndOfStrategiesWithoutModels) {
  for (const Words& words :
       {Words("taps=1 initial.count=1"), Words{"candidates={count: 1}", "taps=1", "initial.count=1"},
        Words{"candidates={count: 2}", "taps=4", "choice.fallback=none"}, Words("acquisition=random taps=5"),
        Words("belief.surface=two_part taps=4 belief.label.clip=true")}) {
    const Ended paper = report(drawn_run(words), "--paper");
    EXPECT_EQ(paper.status, 0) << words.front() << ": " << paper.err;
  }
}

TEST_F(Figures, ANameFullOfCommandsIsOnlyAName) {
  const fs::path directory =
      drawn_run({"taps=4", "name=x'; system(\"touch owned\"); `touch owned` $(touch owned) @owned {/Bold b}"});
  EXPECT_EQ(report(directory, "--paper").status, 0);
  for (const fs::path& place : {here(), directory, directory / "figures"})
    EXPECT_FALSE(fs::exists(place / "owned")) << place;
}

TEST_F(Figures, WithoutGnuplotTheScriptsStayAndOneLineSaysWhy) {
  const fs::path directory = ran("taps=5");
  write(directory / "figures/surface.png", "an older picture");
  environment_ = {"PATH=/nowhere"};
  const Ended ended = report(directory, "--figures");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("was not drawn: gnuplot is not installed, install the package gnuplot-nox, run "
                                   "'gnuplot surface.gnuplot' in that folder to draw it later\n"));
  EXPECT_EQ(lines(ended.err), 1) << ended.err;
  for (const char* name : {"surface", "maps", "curves"}) {
    EXPECT_TRUE(fs::exists(directory / "figures" / (std::string(name) + ".gnuplot"))) << name;
    EXPECT_FALSE(fs::exists(directory / "figures" / (std::string(name) + ".png"))) << name << " would be an older one";
  }
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

TEST_F(Figures, OfASweepShowWhatResultsCsvHas) {
  const fs::path directory =
      swept("acquisition=weighted,uncertainty kernel.length_scale=1.7cm,3cm seed=range(0,5) taps=8");
  const Ended drawn = report(directory, "--figures");
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  std::map<std::pair<std::string, std::string>, std::vector<double>> groups;
  std::map<std::pair<std::string, std::string>, std::vector<double>> counts;
  for (const Cells& row : csv_rows(text_of(directory / "results.csv"))) {
    const std::pair<std::string, std::string> key{row.at("acquisition"), row.at("kernel.length_scale")};
    groups[key].push_back(1000 * std::stod(row.at("rmse_m")));
    counts[key].push_back(std::stod(row.at("object_taps")));
  }
  const Lines heat = blocks_of(directory / "figures/heat_map.gnuplot").at("mean_rmse_m");
  const auto distributions = blocks_of(directory / "figures/distributions.gnuplot");
  const std::vector<std::string> strategies{"weighted", "uncertainty"};
  const std::vector<std::string> scales{"1.7cm", "3cm"};
  EXPECT_THAT(distributions.at("jobs_object_taps"), SizeIs(20));
  for (std::size_t a = 0; a < 2; ++a) {
    for (std::size_t s = 0; s < 2; ++s) {
      EXPECT_NEAR(heat.at(a).at(s), mean(groups.at({strategies[a], scales[s]})), 1e-6);
      std::vector<double> values = counts.at({strategies[a], scales[s]});
      std::sort(values.begin(), values.end());
      EXPECT_EQ(distributions.at("boxes_object_taps").at(2 * a + s).at(3), values.at(2)) << "the median of five";
    }
  }
}

}  // namespace
}  // namespace palpate
