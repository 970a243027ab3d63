// SPDX-License-Identifier: MIT
// `palpate report --figures` and `--paper`: what is plotted is what was recorded. The scripts beside the pictures hold
// all data, so they are read here.
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace palpate {
namespace {

using test::Cells;
using test::csv_rows;
using test::Ended;
using test::TemporaryFolder;
using test::text_of;
using ::testing::_;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

namespace fs = std::filesystem;

std::string config(const std::string& name) { return (test::source_folder() / "configs" / name).string(); }

using Lines = std::vector<std::vector<double>>;

/// The data blocks of a script by their names; blank lines are left out.
std::map<std::string, Lines> blocks_of(const fs::path& script) {
  std::map<std::string, Lines> out;
  std::istringstream text(text_of(script));
  Lines* block = nullptr;
  for (std::string line; std::getline(text, line);) {
    if (block == nullptr && line.rfind('$', 0) == 0 && line.find(" << END") != std::string::npos) {
      block = &out[line.substr(1, line.find(' ') - 1)];
    } else if (line == "END") {
      block = nullptr;
    } else if (block != nullptr && !line.empty()) {
      std::istringstream cells(line);
      block->emplace_back();
      for (std::string cell; cells >> cell;) block->back().push_back(std::stod(cell));
    }
  }
  return out;
}

Lines block_or_none(const std::map<std::string, Lines>& blocks, const std::string& name) {
  const auto found = blocks.find(name);
  return found != blocks.end() ? found->second : Lines{};
}

/// A recorded run as its directory tells it.
struct Recorded {
  fs::path directory;
  std::vector<Cells> taps;

  explicit Recorded(const fs::path& where) : directory(where), taps(csv_rows(text_of(where / "taps.csv"))) {}

  int count() const { return static_cast<int>(taps.size()); }
  double at(int tap, const char* field) const { return std::stod(taps[static_cast<std::size_t>(tap - 1)].at(field)); }
  /// Of the taps up to `last` those whose on_surface is `on`: as a script has them.
  Lines marks(int last, const std::string& on) const {
    Lines out;
    for (int tap = 1; tap <= last; ++tap) {
      if (taps[static_cast<std::size_t>(tap - 1)].at("on_surface") == on)
        out.push_back({100 * at(tap, "x"), 100 * at(tap, "y"), 100 * at(tap, "height"), static_cast<double>(tap)});
    }
    return out;
  }
};

void expect_equal(const Lines& plotted, const Lines& recorded, const std::string& what) {
  ASSERT_EQ(plotted.size(), recorded.size()) << what;
  for (std::size_t i = 0; i < plotted.size(); ++i) {
    ASSERT_EQ(plotted[i].size(), recorded[i].size()) << what;
    for (std::size_t j = 0; j < plotted[i].size(); ++j) EXPECT_NEAR(plotted[i][j], recorded[i][j], 1e-7) << what;
  }
}

/// The value of a map at a place given in centimetres, the area being 23 by 23 of them.
double value_at(const Lines& matrix, double x, double y) {
  const auto cells = static_cast<double>(matrix.size());
  return matrix.at(static_cast<std::size_t>(y / 23 * cells)).at(static_cast<std::size_t>(x / 23 * cells));
}

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
      EXPECT_THAT(summary, HasSubstr("\"on_surface_taps\": " + std::to_string(on.size()) + ","));
      EXPECT_THAT(summary, HasSubstr("\"off_surface_taps\": " + std::to_string(off.size()) + ","));
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

TEST_F(PaperFigures, Figure3ShowsObjectIIUpToItsNineteenthTap) {
  const Recorded run = job("object_ii", "weighted");
  EXPECT_EQ(run.count(), 19);
  for (const int iteration : {1, 6, 12, 17}) {
    expect_panel("figure_3", run, "weighted", iteration, "scores_", "score");
    expect_surface("figure_3", iteration);
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

TEST_F(PaperFigures, HaveNoOtherTapsThanThoseOfTheirPanels) {
  const std::map<std::string, int> panels{{"figure_2", 4}, {"figure_3", 4}, {"figure_4", 6}, {"figure_5", 6}};
  for (const auto& [figure, count] : panels) {
    int next = 0;
    int taps = 0;
    for (const auto& [name, lines] : blocks_of(script(figure))) {
      next += name.rfind("next_", 0) == 0 ? 1 : 0;
      taps += name.rfind("on_", 0) == 0 || name.rfind("off_", 0) == 0 ? 1 : 0;
      EXPECT_NE(name.rfind("failed_", 0), 0U) << figure;
    }
    EXPECT_EQ(next, count) << figure;
    EXPECT_LE(taps, 2 * count) << figure;
  }
}

TEST_F(PaperFigures, EachScriptDrawsTheSamePictureAgainWhereverItIs) {
  const TemporaryFolder elsewhere;
  for (const std::string figure : {"figure_2", "figure_3", "figure_4", "figure_5"}) {
    const Ended drawn = test::run_program(
        {"gnuplot", elsewhere.write(figure + ".gnuplot", text_of(script(figure))).string()}, elsewhere.path());
    EXPECT_EQ(drawn.status, 0) << drawn.err;
    const std::string again = text_of(elsewhere.path() / (figure + ".png"));
    EXPECT_EQ(again.compare(0, 8, "\x89PNG\r\n\x1a\n"), 0) << figure;
    EXPECT_TRUE(again == text_of(sweep() / "figures" / (figure + ".png"))) << figure;
  }
}

TEST_F(PaperFigures, AreWrittenForARunAloneInTheLayoutOfFigure2) {
  const Recorded run = job("object_i", "weighted");
  const Ended drawn = test::palpate({"report", run.directory.string(), "--paper"}, run.directory);
  ASSERT_EQ(drawn.status, 0) << drawn.err;
  const auto alone = blocks_of(run.directory / "figures/paper_progress.gnuplot");
  for (const auto& [name, lines] : blocks_of(script("figure_2"))) EXPECT_TRUE(alone.at(name) == lines) << name;
}

TEST(Figures, OfASweepWithoutTheJobsSaysInALineEachWhatIsMissing) {
  const TemporaryFolder folder;
  const auto report = [&](const std::string& name, const std::vector<std::string>& axes) {
    std::vector<std::string> words{"sweep", config("paper/object_i.yaml"), "--quiet", "--runs", name};
    words.insert(words.end(), axes.begin(), axes.end());
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
  std::vector<std::string> all{"run", config("paper/object_i.yaml"), "--quiet"};
  all.insert(all.end(), words.begin(), words.end());
  const Ended run = test::palpate(all, folder.path());
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

TEST(Figures, OfReadmeAreSmallPicturesOfThePapers) {
  const std::string readme = text_of(test::source_folder() / "README.md");
  for (const std::string figure : {"figure_2", "figure_3", "figure_4", "figure_5"}) {
    const std::string file = "runs/reference/" + figure + ".png";
    EXPECT_NE(readme.find("](" + file + ")"), std::string::npos) << file;
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
