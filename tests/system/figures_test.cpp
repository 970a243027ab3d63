// SPDX-License-Identifier: MIT
// `palpate report --figures`: what is plotted is what was recorded.
#include "system/figure_blocks.hpp"

#include <algorithm>

namespace palpate {
namespace {

using ::testing::Each;

TEST(Figures, OfASweepWithoutTheJobsSaysInALineEachWhatIsMissing) {
  const TemporaryFolder folder;
  const auto report = [&](const std::string& name, const std::vector<std::string>& axes) {
    const std::vector<std::string> words =
        test::plus({"sweep", config("paper/object_i.yaml"), "--quiet", "--runs", name}, axes);
    EXPECT_EQ(test::palpate(words, folder.path()).status, 0);
    return test::palpate({"report", test::only_run(folder.path() / name).string(), "--paper"}, folder.path());
  };
  const Ended some = report("some", {"scene=object_i,object_i_right", "acquisition=weighted,random"});
  EXPECT_EQ(some.status, 0);
  EXPECT_THAT(some.err, HasSubstr("figure_3 is left out: no finished job has scene=object_ii and acquisition=weighted, "
                                  "configs/paper/figures.yaml has them all\n"));
  EXPECT_THAT(some.err, HasSubstr("figure_4 and figure_5 are left out: no finished job has scene=object_i_right and "
                                  "acquisition=uncertainty, configs/paper/figures.yaml has them all\n"));
  EXPECT_EQ(std::count(some.err.begin(), some.err.end(), '\n'), 2) << some.err;
  EXPECT_TRUE(fs::exists(test::only_run(folder.path() / "some") / "figures/figure_2.png"));

  const Ended apart = report("apart", {"sweep.zip={scene: [object_i, object_i_right, object_i_right], acquisition: "
                                       "[weighted, weighted, uncertainty], seed: [1, 1, 2]}"});
  EXPECT_EQ(apart.status, 0);
  EXPECT_THAT(apart.err,
              HasSubstr("figure_4 and figure_5 are left out: no two finished jobs with scene=object_i_right, "
                        "one with acquisition=uncertainty and one with weighted, are equal in all else, "));
  const Ended none = report("none", {"seed=1,2"});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("configs/paper/figures.yaml has them all\n"));
  EXPECT_EQ(std::count(none.err.begin(), none.err.end(), '\n'), 1) << none.err;
}

/// A run of `words` beside the shipped config, reported with --figures.
fs::path drawn_run(const TemporaryFolder& folder, const std::vector<std::string>& words) {
  const Ended run = test::palpate(test::plus({"run", config("paper/object_i.yaml"), "--quiet"}, words), folder.path());
  EXPECT_EQ(run.status, 0) << run.err;
  const fs::path directory = test::only_run(folder.path() / "runs");
  const Ended drawn = test::palpate({"report", directory.string(), "--figures"}, folder.path());
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  for (const char* name : {"surface", "maps", "curves"}) {
    EXPECT_TRUE(fs::exists(directory / "figures" / (std::string(name) + ".png"))) << name;
    EXPECT_TRUE(fs::exists(directory / "figures" / (std::string(name) + ".gnuplot"))) << name;
  }
  return directory;
}

TEST(Figures, OfARunHaveItsMapsAsSurfaceCsvHasThem) {
  const TemporaryFolder folder;
  const fs::path directory = drawn_run(folder, {"seed=3"});
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
}

TEST(Figures, OfAFootprintHaveItsProbabilityAndTheScoreInPlaceOfTheWeight) {
  const TemporaryFolder folder;
  const fs::path directory =
      drawn_run(folder, {"seed=3", "footprint=shape", "acquisition=outline_and_fill", "surface=two_part"});
  const auto maps = blocks_of(directory / "figures/maps.gnuplot");
  EXPECT_EQ(maps.count("w") + maps.count("e"), 0U);
  EXPECT_EQ(maps.count("score"), 1U);
  EXPECT_THAT(text_of(directory / "figures/maps.gnuplot"), HasSubstr("by footprint/shape"));
  for (const Cells& cell : csv_rows(text_of(directory / "surface.csv"))) {
    EXPECT_NEAR(value_at(maps.at("p"), 100 * std::stod(cell.at("x")), 100 * std::stod(cell.at("y"))),
                std::stod(cell.at("on_surface_probability")), 1e-5);
  }
}

TEST(Figures, OfARunHaveCurvesThatEndWithItsSummary) {
  const TemporaryFolder folder;
  const fs::path directory = drawn_run(folder, {"seed=3"});
  const Recorded run(directory);
  const auto curves = blocks_of(directory / "figures/curves.gnuplot");
  const std::string summary = text_of(directory / "summary.json");
  const auto field = [&](const std::string& name) {
    return std::stod(summary.substr(summary.find("\"" + name + "\": ") + name.size() + 4));
  };
  const Lines errors = curves.at("curve_1_1");
  EXPECT_THAT(errors.back(), ElementsAre(17, ::testing::DoubleNear(100 * field("rmse_m"), 1e-6)));
  EXPECT_THAT(errors.at(3), ElementsAre(3, ::testing::DoubleNear(100 * run.at(4, "rmse_m"), 1e-6)))
      << "what tap 4 was chosen from";
  EXPECT_NEAR(curves.at("curve_2_1").back()[1], field("footprint_iou"), 1e-9);
  EXPECT_NEAR(curves.at("curve_4_1").back()[1], field("on_surface_taps") / 17, 1e-9);
  EXPECT_THAT(curves.at("curve_6_3"), Each(ElementsAre(_, 0.017))) << "the length scale of the heights";
  EXPECT_NEAR(curves.at("curve_9_1").back()[1], field("robot_seconds"), 1e-6);
}

TEST(Figures, OfARunGiveFailedTapsAMarkOfTheirOwn) {
  const TemporaryFolder folder;
  const fs::path directory = drawn_run(
      folder, {"scene.effects.missed_contacts.probability=0.5", "scene.area.width=40cm", "candidates={spacing: 5mm}"});
  const Lines failed = block_or_none(blocks_of(directory / "figures/maps.gnuplot"), "failed_last");
  std::vector<double> numbers;
  for (const auto& line : failed) numbers.push_back(line.at(3));
  std::vector<double> recorded;
  for (const Cells& tap : csv_rows(text_of(directory / "taps.csv"))) {
    if (tap.at("outcome") != "contact") recorded.push_back(std::stod(tap.at("tap")));
  }
  EXPECT_THAT(recorded, Not(IsEmpty()));
  EXPECT_EQ(numbers, recorded);
}

TEST(Figures, AreDrawnOfTheSmallestRunsAndOfStrategiesWithoutModels) {
  const std::vector<std::vector<std::string>> cases{{"taps=1", "initial.count=1"},
                                                    {"candidates={count: 1}", "taps=1", "initial.count=1"},
                                                    {"candidates={count: 2}", "taps=4", "fallback=none"},
                                                    {"acquisition=random", "taps=5"},
                                                    {"surface=two_part", "taps=4", "weight.clip=true"}};
  for (const std::vector<std::string>& words : cases) {
    const TemporaryFolder folder;
    const fs::path directory = drawn_run(folder, words);
    const Ended paper = test::palpate({"report", directory.string(), "--paper"}, folder.path());
    EXPECT_EQ(paper.status, 0) << words.front() << ": " << paper.err;
  }
}

TEST(Figures, ANameFullOfCommandsIsOnlyAName) {
  const TemporaryFolder folder;
  const fs::path directory =
      drawn_run(folder, {"taps=4", "name=x'; system(\"touch owned\"); `touch owned` $(touch owned) @owned {/Bold b}"});
  EXPECT_EQ(test::palpate({"report", directory.string(), "--paper"}, folder.path()).status, 0);
  for (const fs::path& place : {folder.path(), directory, directory / "figures"})
    EXPECT_FALSE(fs::exists(place / "owned")) << place;
}

TEST(Figures, WithoutGnuplotTheScriptsStayAndOneLineSaysWhy) {
  const TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"run", config("paper/object_i.yaml"), "taps=5", "--quiet"}, folder.path()).status, 0);
  const fs::path directory = test::only_run(folder.path() / "runs");
  folder.write((directory / "figures/surface.png").string(), "an older picture");
  const Ended ended = test::palpate({"report", directory.string(), "--figures"}, folder.path(), {"PATH=/nowhere"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("was not drawn: gnuplot is not installed, the package gnuplot-nox has it, 'gnuplot "
                                   "surface.gnuplot' in that folder draws it later\n"));
  EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
  for (const char* name : {"surface", "maps", "curves"}) {
    EXPECT_TRUE(fs::exists(directory / "figures" / (std::string(name) + ".gnuplot"))) << name;
    EXPECT_FALSE(fs::exists(directory / "figures" / (std::string(name) + ".png"))) << name << " would be an older one";
  }
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double one : values) sum += one;
  return sum / static_cast<double>(values.size());
}

TEST(Figures, OfASweepShowWhatResultsCsvHas) {
  const TemporaryFolder folder;
  const Ended swept = test::palpate({"sweep", config("paper/object_i.yaml"), "acquisition=weighted,uncertainty",
                                     "kernel.length_scale=1.7cm,3cm", "seed=range(0,5)", "taps=8", "--quiet"},
                                    folder.path());
  ASSERT_EQ(swept.status, 0) << swept.err;
  const fs::path directory = test::only_run(folder.path() / "runs");
  const Ended drawn = test::palpate({"report", directory.string(), "--figures"}, folder.path());
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  std::map<std::pair<std::string, std::string>, std::vector<double>> groups;
  std::map<std::pair<std::string, std::string>, std::vector<double>> counts;
  for (const Cells& row : csv_rows(text_of(directory / "results.csv"))) {
    const std::pair<std::string, std::string> key{row.at("acquisition"), row.at("kernel.length_scale")};
    groups[key].push_back(1000 * std::stod(row.at("rmse_m")));
    counts[key].push_back(std::stod(row.at("on_surface_taps")));
  }
  const Lines heat = blocks_of(directory / "figures/heat_map.gnuplot").at("mean_rmse_m");
  const auto distributions = blocks_of(directory / "figures/distributions.gnuplot");
  const std::vector<std::string> strategies{"weighted", "uncertainty"};
  const std::vector<std::string> scales{"1.7cm", "3cm"};
  EXPECT_THAT(distributions.at("jobs_on_surface_taps"), SizeIs(20));
  for (std::size_t a = 0; a < 2; ++a) {
    for (std::size_t s = 0; s < 2; ++s) {
      EXPECT_NEAR(heat.at(a).at(s), mean(groups.at({strategies[a], scales[s]})), 1e-6);
      std::vector<double> values = counts.at({strategies[a], scales[s]});
      std::sort(values.begin(), values.end());
      EXPECT_EQ(distributions.at("boxes_on_surface_taps").at(2 * a + s).at(3), values.at(2)) << "the median of five";
    }
  }
}

TEST(Figures, OfTheResultsAreSmallPicturesOfThePapers) {
  const std::string page = text_of(test::source_folder() / "framework/docs/results.md");
  for (const std::string figure : {"figure_2", "figure_3", "figure_4", "figure_5"}) {
    const std::string file = "runs/reference/" + figure + ".png";
    EXPECT_NE(page.find("](../../" + file + ")"), std::string::npos) << file;
    const std::string picture = text_of(test::source_folder() / file);
    EXPECT_EQ(picture.compare(0, 8, "\x89PNG\r\n\x1a\n"), 0) << file;
    EXPECT_LE(picture.size(), 200000U) << file;
  }
}

TEST(Figures, OfASweepWithOneKeyHaveNoHeatMap) {
  const TemporaryFolder folder;
  ASSERT_EQ(
      test::palpate({"sweep", config("paper/object_i.yaml"), "taps=4,5", "seed=1,2", "--quiet"}, folder.path()).status,
      0);
  const fs::path directory = test::only_run(folder.path() / "runs");
  EXPECT_EQ(test::palpate({"report", directory.string(), "--figures"}, folder.path()).status, 0);
  EXPECT_TRUE(fs::exists(directory / "figures/distributions.png"));
  EXPECT_FALSE(fs::exists(directory / "figures/heat_map.png"));
}

}  // namespace
}  // namespace palpate
