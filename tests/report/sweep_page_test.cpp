// SPDX-License-Identifier: MIT
// The page of a sweep in a browser: what it plots are the numbers of results.csv, it follows its controls, shows what
// failed, takes text for text, and stays small.
#include "report/browser.hpp"
#include "support/programs.hpp"
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>

namespace palpate {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using test::Browsed;
using test::Cells;
using test::csv_rows;
using test::TemporaryFolder;
using test::text_of;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

/// The sorted numbers of a column, times `factor`, over the rows of which `wanted` holds.
std::vector<double> column(const std::vector<Cells>& rows, const std::string& name, double factor,
                           const std::function<bool(const Cells&)>& wanted) {
  std::vector<double> out;
  for (const Cells& row : rows) {
    if (wanted(row) && !row.at(name).empty()) out.push_back(std::stod(row.at(name)) * factor);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<double> sorted(const json& numbers) {
  auto out = numbers.get<std::vector<double>>();
  std::sort(out.begin(), out.end());
  return out;
}

void expect_near(const std::vector<double>& seen, const std::vector<double>& expected) {
  ASSERT_EQ(seen.size(), expected.size());
  for (std::size_t i = 0; i < seen.size(); ++i)
    EXPECT_NEAR(seen[i], expected[i], 1e-12 * (1.0 + std::abs(expected[i])));
}

/// Chooses a value of a control.
std::string choose(const std::string& id, const std::string& value) {
  return fmt::format(
      "const s = document.getElementById('{}'); s.value = '{}'; s.dispatchEvent(new Event('change')); return s.value;",
      id, value);
}

std::string drawn(int times) { return fmt::format("await document.body.dataset.drawn == '{}'", times); }

std::string data_of(const std::string& id, const std::string& expression) {
  return fmt::format("const e = document.getElementById('{}'); const d = e.data; const l = e.layout; return {};", id,
                     expression);
}

const std::string kCells =
    "const c = (id) => document.getElementById(id); const m = c('cells_mean'); return {x: m.layout.xaxis.ticktext, y: "
    "m.layout.yaxis.ticktext, mean: m.data[0].z, spread: c('cells_spread').data[0].z, hover: m.data[0].customdata, "
    "title: m.data[0].colorbar.title.text}";

class SweepPage : public ::testing::TestWithParam<bool> {
 protected:
  void SetUp() override {
    if (const std::string missing = test::browser_missing(); !missing.empty()) GTEST_SKIP() << missing;
  }

  /// Runs the sweep and returns its directory.
  fs::path swept(std::vector<std::string> words, const std::vector<std::string>& environment = {}) const {
    words.insert(words.begin(), "sweep");
    words.insert(words.end(), {"--quiet", "--runs", "runs", "-j", "2"});
    const test::Ended ended = test::palpate(words, folder_.path(), environment);
    EXPECT_TRUE(ended.status == 0 || ended.status == 1) << ended.err;
    return test::only_run(folder_.path() / "runs");
  }

  void report(const fs::path& directory) const {
    const test::Ended ended = test::palpate({"report", directory.string()}, folder_.path());
    ASSERT_EQ(ended.status, 0) << ended.err;
    ASSERT_EQ(ended.out, (directory / "report.html").string() + "\n");
  }

  Browsed browse(const fs::path& directory, const std::vector<std::string>& steps) const {
    Browsed seen = test::browse(directory / "report.html", steps, GetParam());
    EXPECT_EQ(seen.trouble, "");  // a dialog of the page would be one
    EXPECT_THAT(seen.severe, IsEmpty());
    return seen;
  }

  const std::string paper_ = (test::source_folder() / "configs/paper/object_i.yaml").string();
  const TemporaryFolder folder_;
};

/// Means and spreads of all cells, against the rows.
void expect_cells(const json& seen, const std::vector<Cells>& rows, const std::string& across, const std::string& up,
                  const std::string& metric, double factor) {
  ASSERT_EQ(seen.at("mean").size(), seen.at("y").size());
  for (std::size_t row = 0; row < seen.at("y").size(); ++row) {
    for (std::size_t at = 0; at < seen.at("x").size(); ++at) {
      const std::vector<double> values = column(rows, metric, factor, [&](const Cells& one) {
        return one.at(across) == seen.at("x").at(at) && one.at(up) == seen.at("y").at(row);
      });
      const std::string hover = seen.at("hover").at(row).at(at);
      if (values.empty()) {
        EXPECT_TRUE(seen.at("mean").at(row).at(at).is_null());
        EXPECT_EQ(hover, "no such job");
        continue;
      }
      EXPECT_NEAR(seen.at("mean").at(row).at(at).get<double>(), mean_of(values), 1e-12);
      EXPECT_NEAR(seen.at("spread").at(row).at(at).get<double>(), deviation_of(values), 1e-12);
      EXPECT_THAT(hover, AllOf(HasSubstr(fmt::format("of {} values", values.size())),
                               EndsWith(fmt::format("{0} of {0} done", values.size()))));
    }
  }
}

/// The front that the page joins, against the one that `palpate pareto` wrote.
void expect_front(const json& seen, const fs::path& directory, const std::string& cost, double cost_factor,
                  const std::string& error, double error_factor) {
  struct Place {
    int number;
    std::vector<double> numbers;
  };
  std::vector<Place> front;
  for (const Cells& row : csv_rows(text_of(directory / fmt::format("pareto_{}_{}.csv", cost, error)))) {
    if (row.at("front").empty()) continue;
    const auto number = [&](const std::string& name) { return std::stod(row.at(name)); };
    const auto half = [&](const std::string& name) {
      return (number(name + ".high_95") - number(name + ".low_95")) / 2;
    };
    front.push_back({std::stoi(row.at("front")),
                     {number(cost + ".mean") * cost_factor, number(error + ".mean") * error_factor,
                      half(cost) * cost_factor, half(error) * error_factor}});
  }
  std::sort(front.begin(), front.end(), [](const Place& a, const Place& b) { return a.number < b.number; });
  ASSERT_FALSE(front.empty());
  ASSERT_EQ(seen.size(), front.size());
  for (std::size_t i = 0; i < front.size(); ++i) {
    EXPECT_EQ(seen.at(i).at(0), std::to_string(front[i].number));
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(seen.at(i).at(k + 1).get<double>(), front[i].numbers[k],
                  1e-9 * (1.0 + std::abs(front[i].numbers[k])));
  }
}

const std::string kFront =
    data_of("front",
            "d[4].x.map((x, i) => [d[4].texttemplate[i], x, d[4].y[i], d[4].error_x.array[i], d[4].error_y.array[i]])");

TEST_P(SweepPage, PlotsWhatResultsCsvSaysAndFollowsItsControls) {
  const fs::path directory =
      swept({paper_, "acquisition=weighted,uncertainty", "kernel.length_scale=1.7 cm,10 mm,2.5cm", "taps=8,12",
             "seed=range(0,4)", "candidates.count=16"});
  const std::vector<Cells> rows = csv_rows(text_of(directory / "results.csv"));
  ASSERT_EQ(rows.size(), 48U);
  for (const auto& [cost, error] : {std::pair("robot_seconds", "rmse_m"), std::pair("taps", "footprint_iou")}) {
    const test::Ended ended =
        test::palpate({"pareto", directory.string(), "--cost", cost, "--error", error}, folder_.path());
    ASSERT_EQ(ended.status, 0) << ended.err;
  }
  report(directory);
  const std::string boxes = data_of("groups", "d.map((box, i) => [l.yaxis.ticktext[i], box.x])");
  const std::string table =
      "return [...document.querySelectorAll('#jobs tbody tr')].map((r) => [...r.cells].map((c) => c.textContent))";
  const Browsed seen =
      browse(directory,
             {drawn(1),
              kCells,
              boxes,
              kFront,
              data_of("parallel",
                      "d[0].type == 'parcoords' ? ['parcoords', d[0].dimensions.length, d[0].line.color] : "
                      "['lines', l.annotations.filter((a) => a.yanchor == 'bottom').length, "
                      "d.flatMap((t) => t.y.filter((y) => y === null))]"),
              choose("up", "taps"),
              drawn(2),
              choose("across", "kernel.length_scale"),
              drawn(3),
              choose("metric", "on_surface_taps"),
              drawn(4),
              kCells,
              choose("group", "acquisition"),
              drawn(5),
              choose("then", "taps"),
              drawn(6),
              boxes,
              choose("up", ""),
              drawn(7),
              data_of("cells_mean", "[d[0].type, d[0].y, d[0].error_y.array, l.xaxis.ticktext]"),
              "return getComputedStyle(document.getElementById('cells_spread').closest('figure')).display",
              choose("cost", "taps"),
              drawn(8),
              choose("error", "footprint_iou"),
              drawn(9),
              kFront,
              table,
              "[...document.querySelectorAll('button.sort')].find((b) => b.textContent == 'robot_seconds [s]').click()",
              table,
              "const f = document.getElementById('filter'); f.value = 'taps=12'; f.dispatchEvent(new Event('input'))",
              table,
              "return [...document.querySelectorAll('#jobs a')].map((a) => a.getAttribute('href'))",
              "return Promise.all(['cells_mean', 'groups', 'parallel', 'front'].map((id) => Plotly.toImage(id, "
              "{format: 'png', "
              "width: 500, height: 300})))"});
  ASSERT_EQ(seen.values.size(), 24U);

  const json& cells = seen.values.at(0);
  EXPECT_EQ(cells.at("x"), json({"weighted", "uncertainty"})) << "in the order of the sweep";
  EXPECT_EQ(cells.at("y"), json({"10 mm", "1.7 cm", "2.5cm"})) << "as numbers";
  EXPECT_EQ(cells.at("title"), "rmse_m [cm], less is better");
  expect_cells(cells, rows, "acquisition", "kernel.length_scale", "rmse_m", 100.0);
  const auto of = [&](const Cells& row) {
    return fmt::format("acquisition={}, kernel.length_scale={}, taps={}", row.at("acquisition"),
                       row.at("kernel.length_scale"), row.at("taps"));
  };
  ASSERT_EQ(seen.values.at(1).size(), 12U) << "every setting";
  for (const json& box : seen.values.at(1)) {
    expect_near(sorted(box.at(1)),
                column(rows, "rmse_m", 100.0, [&](const Cells& row) { return of(row) == box.at(0); }));
  }
  expect_front(seen.values.at(2), directory, "robot_seconds", 1.0, "rmse_m", 100.0);
  const json& parallel = seen.values.at(3);
  EXPECT_EQ(parallel.at(0), GetParam() ? "parcoords" : "lines");
  EXPECT_GT(parallel.at(1), 5);
  EXPECT_EQ(parallel.at(2).size(), 48U) << "a line a job";
  if (GetParam()) {
    expect_near(sorted(parallel.at(2)), column(rows, "rmse_m", 100.0, [](const Cells&) { return true; }));
  }

  const json& changed = seen.values.at(7);
  EXPECT_EQ(changed.at("x"), json({"10 mm", "1.7 cm", "2.5cm"}));
  EXPECT_EQ(changed.at("y"), json({"8", "12"}));
  EXPECT_EQ(changed.at("title"), "on_surface_taps, more is better");
  expect_cells(changed, rows, "kernel.length_scale", "taps", "on_surface_taps", 1.0);
  ASSERT_EQ(seen.values.at(10).size(), 4U);
  for (const json& box : seen.values.at(10)) {
    const auto wanted = [&](const Cells& row) {
      return fmt::format("acquisition={}, taps={}", row.at("acquisition"), row.at("taps")) == box.at(0);
    };
    EXPECT_EQ(box.at(1).size(), 12U);
    expect_near(sorted(box.at(1)), column(rows, "on_surface_taps", 1.0, wanted));
  }
  const json& points = seen.values.at(12);
  EXPECT_EQ(points.at(0), "scatter");
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double> values = column(rows, "on_surface_taps", 1.0, [&](const Cells& row) {
      return row.at("kernel.length_scale") == points.at(3).at(i);
    });
    EXPECT_NEAR(points.at(1).at(i).get<double>(), mean_of(values), 1e-12);
    EXPECT_NEAR(points.at(2).at(i).get<double>(), deviation_of(values), 1e-12);
  }
  EXPECT_EQ(seen.values.at(13), "none") << "one key has no second map";
  expect_front(seen.values.at(16), directory, "taps", 1.0, "footprint_iou", 1.0);

  const json& jobs = seen.values.at(17);
  ASSERT_EQ(jobs.size(), 48U);
  for (std::size_t i = 0; i < 48; ++i) {
    EXPECT_EQ(jobs.at(i).at(0), std::to_string(i));
    EXPECT_EQ(jobs.at(i).at(1), "done");
    EXPECT_EQ(jobs.at(i).at(2), rows[i].at("acquisition"));
    EXPECT_EQ(jobs.at(i).at(7), rows[i].at("on_surface_taps"));
  }
  std::vector<Cells> by_time = rows;
  std::stable_sort(by_time.begin(), by_time.end(), [](const Cells& a, const Cells& b) {
    return std::stod(a.at("robot_seconds")) < std::stod(b.at("robot_seconds"));
  });
  for (std::size_t i = 0; i < 48; ++i) EXPECT_EQ(seen.values.at(19).at(i).at(0), by_time[i].at("job"));
  EXPECT_EQ(seen.values.at(21).size(), 24U) << "twelve taps";
  for (const json& place : seen.values.at(22)) EXPECT_TRUE(fs::is_directory(directory / place.get<std::string>()));
  for (const json& picture : seen.values.at(23)) EXPECT_GT(picture.get<std::string>().size(), 5000U) << "painted";
}

TEST_P(SweepPage, OffersWhatParetoTakesAndShowsFailedAndMissingJobs) {
  // Done; failed with a cost and no error; crashed without either.
  const std::string plugins = "PALPATE_PLUGIN_PATH=" + test::bad_plugin_folder("throws_in_score").string() + ":" +
                              test::bad_plugin_folder("dies").string();
  const fs::path directory = swept({paper_, "backend=simulator,dies", "backend.way=crash",
                                    "acquisition=weighted,throws_in_score", "seed=range(0,4)", "candidates.count=12"},
                                   {plugins});
  std::vector<Cells> rows = csv_rows(text_of(directory / "results.csv"));
  ASSERT_EQ(rows.size(), 16U);
  fs::remove(directory / "jobs" / rows[0].at("id") / "summary.json");
  fs::remove_all(directory / "jobs" / rows[1].at("id"));
  ASSERT_EQ(rows[0].at("status"), "done");
  ASSERT_EQ(rows[1].at("status"), "done");
  rows.erase(rows.begin(), rows.begin() + 2);
  const auto failed = [](const Cells& row) { return row.at("status") == "failed"; };
  const std::vector<double> costs = column(rows, "robot_seconds", 1.0, failed);
  ASSERT_EQ(costs.size(), 8U);
  ASSERT_EQ(column(rows, "rmse_m", 1.0, failed).size(), 0U);
  report(directory);
  const std::string crosses =
      data_of("front", "[d[1].name, d[1].marker.color, d[1].x, d[1].y, l.yaxis.range, d[2].x, d[4].x]");
  const Browsed seen = browse(
      directory, {drawn(1), "return [...document.querySelectorAll('.facts li')].map((f) => f.textContent)",
                  "return [...document.querySelectorAll('#warnings li')].map((f) => f.textContent)", crosses,
                  choose("error", "footprint_iou"), drawn(2), crosses,
                  "return document.getElementById('front').closest('figure').querySelector('figcaption').textContent",
                  "return [...document.querySelectorAll('#jobs tr.failed')].map((r) => r.cells[1].textContent)",
                  "return [...document.querySelectorAll('#error option')].map((o) => o.value)",
                  "return [...document.querySelectorAll('#cost option')].map((o) => o.value)",
                  "return document.querySelectorAll('tr.unfinished, tr.missing').length", choose("up", "backend.way"),
                  drawn(3), kCells});
  ASSERT_EQ(seen.values.size(), 12U);
  EXPECT_EQ(seen.values.at(0), json({"16jobs", "2done", "12failed", "1unfinished", "1missing"}));
  const std::string warnings = seen.values.at(1).dump();
  EXPECT_THAT(warnings, AllOf(HasSubstr("8 jobs failed, the first is job "), HasSubstr("no score today"),
                              HasSubstr("4 jobs failed"), HasSubstr("crashed: signal 11 (Segmentation fault)"),
                              HasSubstr("2 of 16 jobs have not ended (1 unfinished, 1 missing)")));
  const json& first = seen.values.at(2);
  EXPECT_EQ(first.at(0), "failed runs");
  EXPECT_EQ(first.at(1), "#9a9a9a");
  expect_near(sorted(first.at(2)), costs);
  for (const json& y : first.at(3)) EXPECT_EQ(y, first.at(4).at(1)) << "at the upper edge";
  EXPECT_EQ(first.at(5).size(), 1U) << "the setting that is not complete is shown";
  EXPECT_EQ(first.at(6).size(), 0U) << "and not compared";
  const json& more_is_better = seen.values.at(4);
  expect_near(sorted(more_is_better.at(2)), costs);
  for (const json& y : more_is_better.at(3)) EXPECT_EQ(y, more_is_better.at(4).at(0)) << "at the lower edge";
  EXPECT_THAT(seen.values.at(5).get<std::string>(), HasSubstr("4 failed runs came to no cost either"));
  ASSERT_EQ(seen.values.at(6).size(), 12U);
  for (const json& state : seen.values.at(6)) EXPECT_THAT(state.get<std::string>(), StartsWith("failed: "));
  EXPECT_EQ(seen.values.at(9), 2);
  const json& cells = seen.values.at(11);
  ASSERT_EQ(cells.at("x"), json({"simulator", "dies"}));
  ASSERT_EQ(cells.at("mean").size(), 2U);
  EXPECT_EQ(cells.at("y").at(0), "–") << "the simulator has no such option";
  EXPECT_TRUE(cells.at("mean").at(0).at(0).is_number());
  EXPECT_TRUE(cells.at("mean").at(1).at(0).is_null()) << "no such job";
  EXPECT_TRUE(cells.at("mean").at(1).at(1).is_null()) << "all failed";
  EXPECT_THAT(cells.at("hover").at(1).at(1).get<std::string>(), HasSubstr("no value<br>0 of 8 done, 8 failed"));

  // What the page offers `palpate pareto` takes, and the other way round.
  const auto takes = [&](const std::string& cost, const std::string& error) {
    return test::palpate({"pareto", directory.string(), "--cost", cost, "--error", error}, folder_.path()).status == 0;
  };
  const auto offered = [&](std::size_t at) { return seen.values.at(at).get<std::set<std::string>>(); };
  for (const char* name : {"coverage_95", "footprint_iou", "height_process.jitter"}) {
    EXPECT_EQ(takes("robot_seconds", name), offered(7).count(name) == 1) << name;
  }
  for (const char* name : {"footprint_iou", "on_surface_taps", "taps"}) {
    EXPECT_EQ(takes(name, "rmse_m"), offered(8).count(name) == 1) << name;
  }

  fs::remove_all(directory / "jobs");
  report(directory);
  const Browsed empty = browse(directory, {drawn(1), "return document.getElementById('nothing').textContent",
                                           "return document.querySelectorAll('tr.missing').length"});
  EXPECT_THAT(empty.values, ElementsAre("No job has come to a result yet: there is nothing to draw.", 16));
}

TEST_P(SweepPage, TakesTextOfNamesValuesAndReasonsForTextAndNothingElse) {
  const std::string name =
      "<script>alert(1)</script> \"quoted\" 'too' </bdi>&amp; %{x} $1$\nsecond line \u202Egnitset\u202C <img src=x "
      "onerror=alert(2)>";
  const std::string good = "<b onmouseover=alert(3)>good\u202E.py";
  const std::string bad = "</script><script>alert(4)</script>.py";
  folder_.write(good, test::python("for ask in asks(): contact(ask)"));
  folder_.write(bad, test::python("for ask in asks(): contact(ask)"));
  const std::vector<std::string> commands{"python3 '" + good + "'", "python3 '" + good + "' \"<i>&lt;\n %{y}</i>\"",
                                          "python3 '" + bad + "'"};
  std::string text = text_of(test::source_folder() / "configs/process.yaml");
  text.replace(text.find("name: process"), 13, "name: " + json(name).dump());
  text +=
      "sweep:\n  grid:\n    backend.command: " + json(commands).dump() + "\n    acquisition: [weighted, uncertainty]\n";
  folder_.write("<u>config.yaml", text);
  const fs::path directory = swept({"<u>config.yaml", "taps=4", "candidates.count=8"});
  const std::string reason = "it said: <img src=x onerror=alert(5)> \u202E</li></script>\n";
  const std::vector<Cells> rows = csv_rows(text_of(directory / "results.csv"));
  folder_.write((directory / "jobs" / rows.at(5).at("id") / "summary.json").string(),
                json({{"status", "failed"}, {"stop_reason", reason}}).dump());
  report(directory);
  EXPECT_EQ(text_of(directory / "report.html").find("alert("), std::string::npos);
  const std::string foreign_elements = "return document.querySelectorAll('img, i, u, b[onmouseover]').length";
  const auto hover = [](const std::string& id, const std::string& where) {
    return fmt::format("Plotly.Fx.hover('{}', {})", id, where);
  };
  const auto hovered = [](const std::string& id) {  // which shows a little later
    return fmt::format("document.querySelector('#{} .hoverlayer').textContent", id);
  };
  const Browsed seen = browse(
      directory,
      {drawn(1),
       "return document.querySelector('h1').textContent",
       "return document.title",
       foreign_elements,
       "return [...document.scripts].filter((s) => s.textContent.startsWith('alert')).length",
       "return [...new Set([...document.querySelectorAll('#jobs tbody tr')].map((r) => r.cells[2].textContent))]",
       "return [...document.querySelectorAll('#across option')].map((o) => o.value)",
       choose("across", "backend.command"),
       drawn(2),
       choose("group", "backend.command"),
       drawn(3),
       "return [...document.querySelectorAll('#cells_mean .xtick text, #cells_mean .ytick text, #groups .ytick "
       "text')].map((t) => t.textContent)",
       "return document.getElementById('warnings').textContent",
       "return getComputedStyle(document.querySelector('h1 bdi')).unicodeBidi",
       "return [...document.querySelectorAll('#parallel text')].map((t) => t.textContent)",
       hover("front", "[{curveNumber: 0, pointNumber: 0}]"),
       "await " + hovered("front"),
       "return " + hovered("front"),
       hover("cells_mean", "{xval: 0, yval: 0}, 'xy'"),
       "await " + hovered("cells_mean"),
       "return " + hovered("cells_mean"),
       foreign_elements});
  ASSERT_EQ(seen.values.size(), 17U);
  EXPECT_TRUE(seen.values.at(0) == name) << seen.values.at(0);
  EXPECT_THAT(seen.values.at(1).get<std::string>(), HasSubstr("<script>alert(1)</script>"));
  EXPECT_EQ(seen.values.at(2), 0);
  EXPECT_EQ(seen.values.at(3), 0);
  EXPECT_EQ(seen.values.at(4).size(), 3U);
  EXPECT_TRUE(seen.values.at(4) == json(commands)) << seen.values.at(4);
  const std::string ticks = seen.values.at(8).dump();
  // Cut where they are too long, but so that they differ.
  for (const char* part : {"\"python3 '<b onmouse", "good.py'\"", "%{y}</i>\\\"\"", "</script><script>"})
    EXPECT_THAT(ticks, HasSubstr(part));
  EXPECT_THAT(seen.values.at(9).get<std::string>(),
              AllOf(HasSubstr("</script><script>alert(4)</script>.py"), HasSubstr(reason)));
  EXPECT_EQ(seen.values.at(10), "isolate");
  EXPECT_THAT(seen.values.at(11).dump(), HasSubstr("%{y}</i>")) << "on an axis of all keys, too";
  EXPECT_THAT(seen.values.at(13).get<std::string>(), HasSubstr("backend.command=python3 '<b onmouseover=alert(3)>"));
  EXPECT_THAT(seen.values.at(15).get<std::string>(), HasSubstr("backend.command: python3 '<b onmouseover=alert(3)>"));
  EXPECT_EQ(seen.values.at(16), 0);
}

TEST_P(SweepPage, StaysSmallAndDrawnWithAThousandJobs) {
  const fs::path directory =
      swept({paper_, "acquisition=weighted,uncertainty", "seed=range(0,500)", "taps=4", "candidates.count=8"});
  report(directory);
  EXPECT_LT(fs::file_size(directory / "report.html"), 5'000'000U);
  const std::string rows = "return document.querySelectorAll('#jobs tbody tr').length";
  const Browsed seen =
      browse(directory, {drawn(1), rows, "document.getElementById('more').click()", rows,
                         "return document.getElementById('jobs_note').textContent",
                         data_of("groups", "d.map((box) => box.x.length)"),
                         data_of("parallel",
                                 "d[0].type == 'parcoords' ? d[0].line.color.length : d.flatMap((t) => "
                                 "t.y.filter((y) => y === null)).length"),
                         data_of("front", "d[0].x.length"), choose("across", "seed"), drawn(2),
                         data_of("cells_mean", "[d[0].x.length, l.xaxis.ticktext.length]"),
                         "return [...document.querySelectorAll('.plot')].every((p) => p.querySelector('.main-svg'))"});
  ASSERT_EQ(seen.values.size(), 10U);
  EXPECT_EQ(seen.values.at(0), 200);
  EXPECT_EQ(seen.values.at(2), 700);
  EXPECT_EQ(seen.values.at(3), "the first 700 of 1000 jobs");
  EXPECT_EQ(seen.values.at(4), json({500, 500}));
  EXPECT_EQ(seen.values.at(5), 1000);
  EXPECT_EQ(seen.values.at(6), 1000);
  EXPECT_EQ(seen.values.at(8).at(0), 500);
  EXPECT_LE(seen.values.at(8).at(1), 40) << "as many names as can be read";
}

std::string webgl_name(const ::testing::TestParamInfo<bool>& info) { return info.param ? "WithWebGL" : "WithoutWebGL"; }
INSTANTIATE_TEST_SUITE_P(InABrowser, SweepPage, ::testing::Bool(), webgl_name);

}  // namespace
}  // namespace palpate
