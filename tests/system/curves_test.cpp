// SPDX-License-Identifier: MIT
// `palpate curves` as a user calls it: errors over the taps of groups, as table, CSV and figures.
#include "system/figure_blocks.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>

namespace palpate {
namespace {

class CurvesOfGroups : public Shell {
 protected:
  /// A sweep of the default, whose taps have no errors in their record.
  fs::path defaults() const {
    return swept("acquisition=footprint_then_height,weighted taps=7 candidates.count=16 seed=range(0,5)",
                 config("default.yaml"));
  }
  Ended curves(const fs::path& sweep, const Words& more = {}) const {
    Ended ended = palpate(Words{"curves", sweep} + more);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended;
  }
};

int times_in(const std::string& text, const std::string& part) {
  int out = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++out;
  return out;
}

TEST_F(CurvesOfGroups, AreAtEachTapWhatCompareSaysOfThatTap) {
  const fs::path directory = defaults();
  for (const Row& tap : rows_of(job_of(directory, 0), "tap")) EXPECT_FALSE(tap.number("rmse_m")) << "no tap costs it";
  const Ended ended = curves(directory, "-o curves.csv");
  EXPECT_THAT(ended.out, StartsWith("rmse_m [mm] against taps; less is better\n"));
  const std::vector<Cells> rows = csv_rows(text_of(here() / "curves.csv"));
  ASSERT_EQ(rows.size(), 14U) << "two groups, seven taps";
  for (const std::string tap : {"2", "5", "7"}) {
    const Words at = tap == "7" ? Words() : Words{"--at", tap};
    ASSERT_EQ(palpate(Words{"compare", directory} + "--by acquisition --metric rmse_m" + at).status, 0);
    const std::string file =
        tap == "7" ? "compare_acquisition_rmse_m.csv" : "compare_acquisition_rmse_m_at_" + tap + ".csv";
    for (const Cells& group : csv_rows(text_of(directory / file))) {
      if (group.at("kind") != "group") continue;
      int found = 0;
      for (const Cells& row : rows) {
        if (row.at("acquisition") != group.at("group") || row.at("at") != tap) continue;
        ++found;
        for (const char* cell : {"n", "units", "mean", "low_95", "high_95"})
          EXPECT_EQ(row.at(cell), group.at(cell)) << cell;
        EXPECT_NE(row.at("mean"), "");
      }
      EXPECT_EQ(found, 1);
    }
  }
}

TEST_F(CurvesOfGroups, AreComputedOnceAndAgainOnlyForAJobThatRanAgain) {
  const fs::path directory = defaults();
  curves(directory, "-o once.csv");
  const fs::path kept = job_of(directory, 3) / "summaries.jsonl";
  const auto stamp = fs::last_write_time(kept);
  const Ended again = curves(directory, "-o again.csv --metric footprint_iou");
  EXPECT_EQ(fs::last_write_time(kept), stamp);
  EXPECT_EQ(again.err, "table: again.csv\n") << "no job was replayed";
  // What belongs to another summary is not that of this run.
  std::string text = text_of(kept);
  const auto at = text.rfind("\"of_summary\": \"");
  ASSERT_NE(at, std::string::npos);
  char& digit = text[at + 15];
  digit = digit == '0' ? '1' : '0';
  write(kept, text);
  curves(directory, "-o third.csv");
  EXPECT_NE(text_of(kept), text);
  EXPECT_EQ(text_of(here() / "third.csv"), text_of(here() / "once.csv"));
  write(kept, "no JSON\n");
  curves(directory, "-o fourth.csv");
  EXPECT_EQ(text_of(here() / "fourth.csv"), text_of(here() / "once.csv"));
}

TEST_F(CurvesOfGroups, AreDrawnAsPngPdfAndSvgWithABandForEachGroup) {
  const fs::path directory =
      swept("acquisition=weighted,random scene=object_i,object_ii taps=6 candidates.count=16 seed=range(0,5)");
  curves(directory, "-o a.png -o a.pdf -o a.svg --against robot_seconds");
  EXPECT_EQ(text_of(here() / "a.png").substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_THAT(text_of(here() / "a.pdf"), StartsWith("%PDF-"));
  const std::string svg = text_of(here() / "a.svg");
  EXPECT_THAT(svg, AllOf(HasSubstr("<svg"), HasSubstr("weighted"), HasSubstr("scene: object_ii")));
  EXPECT_GE(times_in(svg, "fill-opacity"), 4) << "two groups on two scenes";
  curves(directory);
  EXPECT_TRUE(fs::exists(directory / "curves_acquisition_rmse_m_taps.png"));
  EXPECT_TRUE(fs::exists(directory / "curves_acquisition_rmse_m_taps.csv"));
  environment_ = {"PATH=/nowhere"};
  const Ended undrawn = curves(directory);
  EXPECT_THAT(undrawn.out, StartsWith("rmse_m [mm] against taps; less is better\n"));
  EXPECT_THAT(undrawn.err, ContainsRegex("no picture was drawn: .*: gnuplot is not installed"));
}

TEST_F(CurvesOfGroups, AreAFigureOfTheSweepsReportOnceTheyAreComputed) {
  const fs::path directory = defaults();
  const fs::path figure = directory / "figures/curves.png";
  EXPECT_EQ(palpate({"report", directory, "--figures"}).status, 0);
  EXPECT_FALSE(fs::exists(figure)) << "report computes none";
  curves(directory, "-o alone.png");
  const Ended ended = palpate({"report", directory, "--figures"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("/figures/curves.png\n"));
  EXPECT_EQ(text_of(figure), text_of(here() / "alone.png"));
}

/// All numbers that `pattern` finds in a text as its first group.
std::vector<double> numbers_in(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<double> out;
  for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at)
    out.push_back(std::stod((*at)[1]));
  return out;
}

/// Where a text of an SVG begins, points from the upper left corner: below it stand its letters.
struct Spot {
  double x = -1;
  double y = -1;
};

/// Of each text that begins so, in the order of the drawing.
std::vector<Spot> spots_of(const std::string& svg, const std::string& text) {
  constexpr double kPoint = 72.0 / 96.0;
  const std::string before = "translate(";
  std::vector<Spot> out;
  for (auto at = svg.find("<text>" + text); at != std::string::npos; at = svg.find("<text>" + text, at + 1)) {
    const auto place = svg.rfind(before, at) + before.size();
    out.push_back({kPoint * std::stod(svg.substr(place)), kPoint * std::stod(svg.substr(svg.find(',', place) + 1))});
  }
  return out;
}

constexpr double kSample = 22 + 5;  ///< points from where a sample in the legend begins to its name

/// A figure of a sweep on three scenes.
class FigureOfCurves : public CurvesOfGroups {
 protected:
  fs::path three_scenes() const {
    return swept("acquisition=weighted,random scene=object_i,ring,block taps=3 candidates.count=16 seed=range(0,5)",
                 config("default.yaml"));
  }
};

TEST_F(FigureOfCurves, HasOneRangeForAllPanelsThatTheDataFill) {
  const fs::path directory = three_scenes();
  for (const std::string metric : {"rmse_m", "footprint_iou"}) {
    curves(directory, Words{"-o", "a.svg", "--metric", metric});
    const std::string script = text_of(here() / "a.gnuplot");
    double least = 1e9;
    double most = -1e9;
    for (const auto& [name, lines] : blocks_of(here() / "a.gnuplot")) {
      for (const auto& line : lines) {
        least = std::min(least, line[1]);
        most = std::max(most, line[1]);
      }
    }
    std::vector<double> low = numbers_in(script, R"(set yrange \[(?!-1:1\])([-\d.e]+):)");
    const std::vector<double> high = numbers_in(script, R"(set yrange \[(?!-1:1\])[-\d.e]+:([-\d.e]+)\])");
    ASSERT_EQ(low.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(low[i], low[0]);
      EXPECT_EQ(high[i], high[0]);
    }
    EXPECT_LE(low[0], least);
    EXPECT_GE(high[0], most);
    EXPECT_GT(most - least, 0.4 * (high[0] - low[0])) << "with bands of five seeds";
    if (metric == "rmse_m") {
      EXPECT_GT(least, 0.3 * (most - least)) << "else 0 is near";
    }
    EXPECT_EQ(low[0] == 0.0, metric == "footprint_iou");
  }
}

TEST_F(FigureOfCurves, TellsGroupsApartWithoutColourAndTheirLongNamesHaveRoom) {
  const std::string one = "{type: rational_quadratic, alpha: 1.5, length_scale: 20 mm}";
  const std::string other = "{type: rational_quadratic, alpha: 1.5, length_scale: 31 mm}";
  // DejaVu Sans is so wide at eight points, by pdftotext -bbox.
  constexpr double kNameWidth = 239.7;
  const fs::path directory =
      swept(Words{"kernel=" + one + "," + other + ",rbf,matern32"} + "taps=3 candidates.count=16 seed=range(0,5)");
  for (const std::string width : {"17.8 cm", "30 cm", "8.8 cm"}) {
    curves(directory, Words{"-o", "a.svg", "--width", width});
    const std::string script = text_of(here() / "a.gnuplot");
    const std::string svg = text_of(here() / "a.svg");
    const double points = std::stod(width) / 2.54 * 72;
    std::vector<Spot> names = spots_of(svg, "{type: rat");
    ASSERT_EQ(names.size(), 2U);
    for (const char* name : {"rbf", "matern32"}) {
      ASSERT_EQ(spots_of(svg, name).size(), 1U);
      names.push_back(spots_of(svg, name)[0]);
    }
    for (std::size_t i = 0; i < 2 && width != "8.8 cm"; ++i) {
      const double next = names[i + 1].y == names[i].y ? names[i + 1].x - kSample : points;
      EXPECT_LE(names[i].x + kNameWidth, next) << width << " " << i;
    }
    std::set<std::string> dashes;
    std::set<std::string> marks;
    const std::regex style("with linespoints lw 1 dt (\\S+) lc rgb '[^']*' (pt \\d+)");
    for (std::sregex_iterator at(script.begin(), script.end(), style), end; at != end; ++at) {
      dashes.insert((*at)[1]);
      marks.insert((*at)[2]);
    }
    EXPECT_EQ(dashes.size(), 4U);
    EXPECT_EQ(marks.size(), 4U);
  }
}

TEST_F(FigureOfCurves, HasWordsOnItsAxesNoTitleAndItsScriptBesideIt) {
  const fs::path directory = three_scenes();
  const Ended ended = curves(directory, "-o a.svg --against robot_seconds");
  EXPECT_EQ(ended.err.substr(ended.err.find("picture: ")), "picture: a.svg\nscript: a.gnuplot\n");
  const std::string svg = text_of(here() / "a.svg");
  EXPECT_THAT(svg, AllOf(HasSubstr(">RMSE over the scene [mm]<"), HasSubstr(">robot time [s]<")));
  const std::string name = directory.parent_path().filename();
  EXPECT_THAT(svg, AllOf(Not(HasSubstr(">" + name)), Not(HasSubstr("rmse_m")), Not(HasSubstr("interval"))));
  EXPECT_THAT(text_of(here() / "a.gnuplot"),
              AllOf(HasSubstr("# " + name), HasSubstr("over 5 seeds. Bands: their 95 %")));
  // As it stands it draws the picture again, and with another label another one.
  fs::remove(here() / "a.svg");
  ASSERT_EQ(test::run_program({"/usr/bin/gnuplot", "a.gnuplot"}, here()).status, 0);
  EXPECT_EQ(text_of(here() / "a.svg"), svg);
  replace(here() / "a.gnuplot", "RMSE over the scene [mm]", "error in mm");
  ASSERT_EQ(test::run_program({"/usr/bin/gnuplot", "a.gnuplot"}, here()).status, 0);
  EXPECT_THAT(text_of(here() / "a.svg"), HasSubstr(">error in mm<"));
}

TEST_F(CurvesOfGroups, RefuseInOneLineWhatCannotBeDrawn) {
  const Words curves{"curves", swept("acquisition=weighted,random taps=4 candidates.count=16 seed=range(0,2)")};
  EXPECT_EQ(refused(curves + "-o a.jpg"),
            "command line: -o: 'a.jpg' has no supported file extension, use one of .csv, .png, .pdf, .svg\n");
  EXPECT_THAT(refused(curves + "-o none/a.png"), HasSubstr("does not exist, create it first"));
  EXPECT_THAT(refused(curves + "--metric rsme_m"), HasSubstr("did you mean 'rmse_m'?"));
  EXPECT_THAT(refused(curves + "--against wall_seconds"), StartsWith("--against: "));
  EXPECT_EQ(refused(curves + "--metric rmse_m,footprint_iou"),
            "command line: --metric: 'rmse_m,footprint_iou' names several columns, but a figure shows one, draw one "
            "figure per column\n");
  EXPECT_THAT(refused(curves + "--width 8.8"), HasSubstr("unit"));
  EXPECT_EQ(refused(curves + "--width 2cm"),
            "command line: --width: 2cm is not between 5 cm and 1 m, use for example 8.8 cm for a column of a paper\n");
}

}  // namespace
}  // namespace palpate
