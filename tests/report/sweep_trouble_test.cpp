// SPDX-License-Identifier: MIT
// The page of a sweep with failures, with hostile texts, and with a thousand jobs.
#include "report/page/sweep_page.hpp"
#include "report/sweep_pages.hpp"
#include "support/large_sweep.hpp"
#include "support/parts.hpp"
#include "support/programs.hpp"

#include <set>

namespace palpate {
namespace {

using ::testing::ElementsAre;
using ::testing::StartsWith;

class SweepTrouble : public test::SweepPages {};

TEST_P(SweepTrouble, OffersWhatParetoTakesAndShowsFailedAndMissingJobs) {
  // Jobs that succeed, jobs that fail with a cost but no error, and jobs that crash without either.
  const std::string plugins = "PALPATE_PLUGIN_PATH=" + test::bad_plugin_folder("throws_in_score").string() + ":" +
                              test::bad_plugin_folder("dies").string();
  const fs::path directory = swept({paper_, "backend=simulator,dies", "backend.way=crash",
                                    "acquisition=weighted,throws_in_score", "seed=range(0,4)", "candidates.count=12"},
                                   {plugins});
  std::vector<Cells> rows = csv_rows(text_of(directory / "results.csv"));
  ASSERT_EQ(rows.size(), 16U);
  test::forget_end(directory / "jobs" / rows[0].at("id"));
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
  EXPECT_THAT(seen.values.at(5).get<std::string>(), HasSubstr("4 failed runs have no cost either"));
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

  // The page offers exactly the columns that `palpate pareto` accepts.
  const auto takes = [&](const std::string& cost, const std::string& error) {
    return test::palpate({"pareto", directory.string(), "--cost", cost, "--error", error}, folder_.path()).status == 0;
  };
  const auto offered = [&](std::size_t at) { return seen.values.at(at).get<std::set<std::string>>(); };
  for (const char* name : {"coverage_95", "footprint_iou", "height_gp.jitter"}) {
    EXPECT_EQ(takes("robot_seconds", name), offered(7).count(name) == 1) << name;
  }
  for (const char* name : {"footprint_iou", "object_taps", "taps"}) {
    EXPECT_EQ(takes(name, "rmse_m"), offered(8).count(name) == 1) << name;
  }

  fs::remove_all(directory / "jobs");
  report(directory);
  const Browsed empty = browse(directory, {drawn(1), "return document.getElementById('nothing').textContent",
                                           "return document.querySelectorAll('tr.missing').length"});
  EXPECT_THAT(empty.values, ElementsAre("No job has a result yet: there is nothing to draw.", 16));
}

TEST_P(SweepTrouble, TakesTextOfNamesValuesAndReasonsForTextAndNothingElse) {
  const std::string name =
      "<script>alert(1)</script> \"quoted\" 'too' </bdi>&amp; %{x} $1$\nsecond line \u202Egnitset\u202C <img src=x "
      "onerror=alert(2)>";
  const std::string good = "<b onmouseover=alert(3)>good\u202E.py";
  const std::string bad = "</script><script>alert(4)</script>.py";
  folder_.write(good, test::python("for ask in asks(): contact(ask)"));
  // Its contacts are on the desk: with equal results of all jobs, the page would have no panels.
  folder_.write(bad, test::python("for ask in asks(): tell(ask, outcome='contact', height=0.0, force=1, seconds=5.5)"));
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
  test::set_end(directory / "jobs" / rows.at(5).at("id"), json({{"status", "failed"}, {"stop_reason", reason}}).dump());
  report(directory);
  EXPECT_EQ(text_of(directory / "report.html").find("alert("), std::string::npos);
  const std::string foreign_elements = "return document.querySelectorAll('img, i, u, b[onmouseover]').length";
  const auto hover = [](const std::string& id, const std::string& where) {
    return fmt::format("Plotly.Fx.hover('{}', {})", id, where);
  };
  const auto hovered = [](const std::string& id) {  // hovers appear with a delay
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
       ("return [...document.querySelectorAll('#cells_mean .xtick text, #cells_mean .ytick text, #groups .ytick "
        "text')].map((t) => t.textContent)"),
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
  // Shortened names still differ.
  for (const char* part : {"\"python3 '<b onmouse", "good.py'\"", "%{y}</i>\\\"\"", "</script><script>"})
    EXPECT_THAT(ticks, HasSubstr(part));
  EXPECT_THAT(seen.values.at(9).get<std::string>(),
              AllOf(HasSubstr("</script><script>alert(4)</script>.py"), HasSubstr(reason)));
  EXPECT_EQ(seen.values.at(10), "isolate");
  if (GetParam()) {
    EXPECT_THAT(seen.values.at(11).dump(), HasSubstr("</i>")) << "on an axis of all keys, too";
  }
  EXPECT_THAT(seen.values.at(13).get<std::string>(), HasSubstr("backend.command=python3 '<b onmouseover=alert(3)>"));
  EXPECT_THAT(seen.values.at(15).get<std::string>(), HasSubstr("backend.command: python3 '<b onmouseover=alert(3)>"));
  EXPECT_EQ(seen.values.at(16), 0);
}

TEST_P(SweepTrouble, StaysSmallAndDrawnWithAThousandJobs) {
  const fs::path directory =
      swept({paper_, "acquisition=weighted,uncertainty", "seed=range(0,500)", "taps=4", "candidates.count=8"});
  report(directory);
  EXPECT_LT(fs::file_size(directory / "report.html"), 5'000'000U);
  const std::string rows = "return document.querySelectorAll('#jobs tbody tr').length";
  const Browsed seen =
      browse(directory, {drawn(1), rows, "document.getElementById('more').click()", rows,
                         "return document.getElementById('jobs_note').textContent",
                         data_of("groups", "d.map((box) => box.x.length)"),
                         GetParam() ? data_of("parallel", "d[0].line.color.length")
                                    : "return document.getElementById('parallel').hidden ? 1000 : 0",
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

INSTANTIATE_TEST_SUITE_P(InABrowser, SweepTrouble, ::testing::Bool(), test::webgl_name);

}  // namespace
}  // namespace palpate
