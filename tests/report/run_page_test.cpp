// SPDX-License-Identifier: MIT
// The page of a run in a browser: drawing, slider, numbers of the record, and texts.
#include "report/browser.hpp"
#include "support/parts.hpp"

#include <fmt/format.h>

#include <cmath>

namespace palpate {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Makes a run of the paper's experiment with `words`. Returns the run directory.
fs::path made(const test::TemporaryFolder& folder, std::vector<std::string> words) {
  words.insert(words.begin(), {"run", (test::source_folder() / "configs/paper/object_i.yaml").string(), "--quiet"});
  const test::Ended ran = test::palpate(words, folder.path());
  EXPECT_EQ(ran.status, 0) << ran.err;
  const auto runs = std::find(words.begin(), words.end(), "--runs");
  return test::only_run(folder.path() / (runs == words.end() ? "runs" : *std::next(runs)));
}

class ReportedRun : public test::Reports {};
class RunPage : public test::ReportsInBoth {};

/// Returns pictures of a map and of the surface as the browser paints them.
const std::string kPainted =
    "return Promise.all(['map_e', 'surface'].map((id) => Plotly.toImage(id, {format: 'png', width: 400, height: "
    "300})))";

TEST_P(RunPage, DrawsEveryTapAndMovesByKeyAndSliderWithoutAComplaint) {
  const fs::path directory = made(folder_, {"seed=4"});
  report(directory);
  const Browsed seen = browse(
      directory, {drawn(17), kPainted, "key ARROW_LEFT", "key ARROW_LEFT", drawn(15), kPainted,
                  "return document.getElementById('at').textContent", "key ARROW_RIGHT", drawn(16),
                  "const s = document.getElementById('slider'); s.value = 0; s.dispatchEvent(new Event('input'));",
                  drawn(0), "return document.getElementById('story').textContent",
                  "return document.getElementById('surface').data.map((trace) => trace.type)",
                  ("window.before = JSON.stringify(document.getElementById('surface').data[0].z); "
                   "document.getElementById('truth').click()"),
                  GetParam() ? "await document.getElementById('surface').data.length === 6"
                             : "await JSON.stringify(document.getElementById('surface').data[0].z) !== window.before",
                  "document.getElementById('truth').focus()", "key ARROW_RIGHT", drawn(1),
                  "return document.getElementById('map_deviation') !== null"});
  const json& last = seen.values.at(0);
  const json& before = seen.values.at(1);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto picture = last.at(i).get<std::string>();
    EXPECT_EQ(picture.compare(0, 22, "data:image/png;base64,"), 0);
    EXPECT_GT(picture.size(), 5000U);
    EXPECT_TRUE(picture != before.at(i)) << "picture " << i << " is the same after tap 15 and after tap 17";
  }
  EXPECT_EQ(seen.values.at(2), "after tap 15 of 17");
  EXPECT_THAT(seen.values.at(4).get<std::string>(), HasSubstr("Before the first tap."));
  EXPECT_EQ(seen.values.at(5).at(0), GetParam() ? "surface" : "heatmap");
  EXPECT_EQ(seen.values.back(), !GetParam()) << "what the colours of the surface say is a map where there is none";
}

TEST_F(ReportedRun, MarksTapsAsTheyAreReadAtTheMomentThatIsShown) {
  // Tap 1, at a height of 1.5 cm, counts as on the desk until other taps reveal the height of the desk.
  const test::Ended ran = test::palpate(
      {"run", (test::source_folder() / "configs/default.yaml").string(), "--quiet", "scene=mug", "taps=9"},
      folder_.path());
  ASSERT_EQ(ran.status, 0) << ran.err;
  const fs::path directory = test::only_run(folder_.path() / "runs");
  report(directory);
  const std::string count =
      "const of = (name) => document.getElementById('map_u').data.find((t) => t.name === name)?.x.length ?? 0; "
      "return [of('on the object'), of('on the desk')]";
  const Browsed seen =
      test::browse(directory / "report.html",
                   {drawn(9), count, "return document.getElementById('story').textContent",
                    "const s = document.getElementById('slider'); s.value = 1; s.dispatchEvent(new Event('input'));",
                    drawn(1), count},
                   false);
  ASSERT_EQ(seen.trouble, "");
  const json summary = json::parse(text_of(directory / "summary.json"));
  ASSERT_EQ(summary.at("relabelled"), "1 object");
  EXPECT_EQ(seen.values.at(0), json({summary.at("object_taps"), summary.at("desk_taps")}));
  EXPECT_THAT(seen.values.at(1).get<std::string>(), HasSubstr("Tap 1 is now read as on the object"));
  EXPECT_EQ(seen.values.at(3), json({0, 1}));
}

TEST_F(ReportedRun, ShowsTheExpectedErrorAndQuantitiesInTheirUnitsWithTheDigitsThatTheyDeserve) {
  const std::string quantities =
      "return [quantity('rmse_m', 3.24e-6), quantity('rmse_m', 1.5650845800732873e-2), "
      "quantity('robot_seconds', 65.5), quantity('rmse_m', null), shown(1.23456e-9, 3)]";
  const fs::path directory = made(folder_, {"seed=4"});
  report(directory);
  const Browsed seen = test::browse(
      directory / "report.html",
      {drawn(17), "return [...document.querySelectorAll('.facts li')].map((one) => one.children[0].textContent)",
       "return document.getElementById('curve_0').data.map((curve) => [curve.name, curve.y.at(-1)])",
       "return document.getElementById('curve_0').layout.yaxis.title.text", quantities},
      false);
  ASSERT_EQ(seen.trouble, "");
  const json summary = json::parse(text_of(directory / "summary.json"));
  const auto millimetres = [&](const char* field) { return 1e3 * summary.at(field).get<double>(); };
  const json& facts = seen.values.at(0);
  const auto shows = [&](const char* field) {
    return std::any_of(facts.begin(), facts.end(), [&](const json& fact) {
      const auto text = fact.get<std::string>();
      const bool is_length = text.size() > 3 && text.compare(text.size() - 3, 3, " mm") == 0;
      return is_length && std::abs(std::stod(text) - millimetres(field)) < 0.006 * millimetres(field);
    });
  };
  EXPECT_TRUE(shows("rmse_m")) << facts;
  EXPECT_TRUE(shows("expected_rmse_m")) << facts;
  double drawn_error = 0.0;
  for (const json& curve : seen.values.at(1))
    if (curve.at(0) == "over the scene, expected") drawn_error = curve.at(1);
  EXPECT_NEAR(drawn_error, millimetres("expected_rmse_m"), 1e-9);
  EXPECT_EQ(seen.values.at(2), "[mm]");
  EXPECT_EQ(seen.values.at(3), json({"0.00324 mm", "15.7 mm", "65.5 s", "–", "1.23e-9"}));
}

TEST_F(ReportedRun, HasTheTapsOfTheRecordAndTheMapsThatItsModelsHadOnItsPage) {
  // The run itself writes its maps, as an oracle.
  const fs::path directory =
      made(folder_, {"seed=4", "log.maps=true", "scene.effects={missed_contacts: {probability: 0.2}}"});
  report(directory);
  const std::vector<Cells> taps = csv_rows(text_of(directory / "taps.csv"));
  std::vector<std::string> steps;
  for (int tap = 17; tap >= 1; --tap) {
    steps.push_back(drawn(tap));
    steps.push_back(
        "const d = document.getElementById('map_e').data; const at = (t) => t.x.map((x, i) => [x, t.y[i]]); return "
        "d.slice(1).map(at)");
    steps.emplace_back(
        "const z = (id) => document.getElementById(id).data[0].z.flat(); return [z('map_u'), z('map_w'), z('map_e')]");
    steps.emplace_back("key ARROW_LEFT");
  }
  const Browsed seen = test::browse(directory / "report.html", steps, false);
  ASSERT_EQ(seen.trouble, "");
  EXPECT_THAT(seen.severe, IsEmpty());
  int failed_taps = 0;
  for (std::size_t made = 1; made <= 17; ++made) {
    const json& marks = seen.values.at(2 * (17 - made));
    std::vector<json> expected(3, json::array());
    for (std::size_t i = 0; i < made; ++i) {
      const std::string& on = taps[i].at("on_object");
      expected[on == "true"    ? 0
               : on == "false" ? 1
                               : 2]
          .push_back({std::stod(taps[i].at("x")) * 100.0, std::stod(taps[i].at("y")) * 100.0});
    }
    EXPECT_TRUE(marks.at(0) == expected[0]) << made;
    EXPECT_TRUE(marks.at(1) == expected[1]) << made;
    EXPECT_TRUE(marks.at(2) == expected[1]) << made;  // white edges of the crosses
    EXPECT_TRUE(marks.at(3) == expected[2]) << made;
    failed_taps = static_cast<int>(expected[2].size());
    ASSERT_EQ(marks.at(4).size(), 1U);
    if (made < 17) {
      EXPECT_EQ(marks.at(4).at(0).at(0), std::stod(taps[made].at("x")) * 100.0);
      EXPECT_EQ(marks.at(4).at(0).at(1), std::stod(taps[made].at("y")) * 100.0);
    }
  }
  EXPECT_GT(failed_taps, 0);
  const json summary = json::parse(text_of(directory / "summary.json"));
  EXPECT_EQ(summary.at("failed_taps"), failed_taps);
  EXPECT_EQ(seen.values.at(0).at(0).size(), summary.at("object_taps"));
  EXPECT_EQ(seen.values.at(0).at(1).size(), summary.at("desk_taps"));

  // The page stores maps in 65536 steps, so values are off by at most 1 / 131070 of the range.
  int maps = 0;
  for (std::size_t made = 3; made < 17; ++made) {
    const fs::path file = directory / fmt::format("maps/tap_{:03}.csv", made + 1);  // maps of the next choice
    if (!fs::exists(file)) continue;                                                // before the first model
    const std::vector<Cells> cells = csv_rows(text_of(file));
    ++maps;
    const json& shown = seen.values.at(2 * (17 - made) + 1);
    ASSERT_EQ(shown.at(0).size(), cells.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const double u = std::stod(cells[i].at("u"));
      const double w = std::stod(cells[i].at("w"));
      for (const double off : {u - shown.at(0).at(i).get<double>(), (w - shown.at(1).at(i).get<double>()) / 2.0,
                               (u * w - shown.at(2).at(i).get<double>()) / 3.0})
        worst = std::max(worst, std::abs(off));
    }
    EXPECT_LT(worst, 1.0 / 65535.0) << made;
  }
  EXPECT_GT(maps, 10);
}

TEST_F(ReportedRun, KeepsToItsAxesNamesAllHyperparametersAndTakesTimesByTheirTap) {
  const fs::path directory = made(folder_, {"seed=4", "scene.desk=-50cm", "kernel=swell_and_texture", "taps=20"});
  report(directory);
  std::string record = test::text_of(directory / "record.jsonl");
  const auto line = record.find("{\"timing\": 6,");
  record.erase(line, record.find('\n', line) + 1 - line);  // as if the program had been killed during this tap
  folder_.write(fs::relative(directory / "record.jsonl", folder_.path()).string(), record);
  report(directory);
  const Browsed seen = test::browse(
      directory / "report.html",
      {drawn(20), "document.getElementById('truth').click()",
       "await document.getElementById('surface').data.length === 6",
       ("const e = document.getElementById('surface'); const z = [...e.data[0].z.flat(), ...e.data[5].z.flat()];"
        "return [e.layout.scene.zaxis.range, Math.min(...z), Math.max(...z)]"),
       "return [...document.querySelectorAll('.constants')].map((line) => line.textContent).join()",
       ("const plots = [...document.querySelectorAll('.plot')];"
        "return plots.flatMap((plot) => plot.data).filter((trace) => trace.name === 'infer').map((trace) => "
        "trace.y)[0]")},
      true);
  ASSERT_EQ(seen.trouble, "");
  EXPECT_THAT(seen.severe, IsEmpty());
  const json& axis = seen.values.at(1);
  EXPECT_LT(axis.at(0).at(0).get<double>(), axis.at(1).get<double>() + 1e-9);
  EXPECT_GT(axis.at(0).at(1).get<double>(), axis.at(2).get<double>());
  EXPECT_LT(axis.at(0).at(1).get<double>(), axis.at(2).get<double>() + 2.0) << "no empty room above";
  for (const char* name : {"kernels.0.factor", "kernels.1.kernel.length_scale"})
    EXPECT_THAT(seen.values.at(2).get<std::string>(), HasSubstr(name)) << "no fit changes it: a line, no panel";
  const json& times = seen.values.at(3);
  ASSERT_EQ(times.size(), 21U);
  EXPECT_TRUE(times.at(6).is_null());
  const Row ninth = test::rows_of(directory, "timing").at(7);
  EXPECT_EQ(ninth.number("timing"), 9.0);
  EXPECT_NEAR(times.at(9).get<double>(), 1000.0 * ninth.number("infer").value(), 1e-9);
}

TEST_P(RunPage, TakesTextOfConfigsAndPathsForTextAndNothingElse) {
  const std::string name =
      "<script>alert(1)</script> \"quoted\" 'too' </bdi>&amp;\nsecond line \u202Egnitset\u202C <img src=x "
      "onerror=alert(2)>";
  const std::string file = "<b onmouseover=alert(3)>config<\xE2\x80\xAE.yaml";
  std::string text = text_of(test::source_folder() / "configs/paper/object_i.yaml");
  text.replace(text.find("name: object_i"), 14, "name: " + json(name).dump());
  folder_.write(file, text);
  folder_.write("<u>cup.stl", text_of(test::source_folder() / "configs/scene/meshes/cup.stl"));
  const test::Ended ran =
      test::palpate({"run", file, "--quiet", "--runs", "<i>runs", "taps=5",
                     "scene.objects=[{type: mesh, file: <u>cup.stl, unit: 1 mm, at: [11.5 cm, 11.5 cm]}]"},
                    folder_.path());
  ASSERT_EQ(ran.status, 0) << ran.err;
  const fs::path directory = test::only_run(folder_.path() / "<i>runs");
  report(directory);
  EXPECT_EQ(text_of(directory / "report.html").find("alert(1)"), std::string::npos);
  const Browsed seen =
      browse(directory,
             {drawn(5), "return document.querySelector('h1').textContent", "return document.title",
              "return document.querySelectorAll('img, b[onmouseover], i, u').length",
              "return [...document.scripts].filter((s) => s.textContent.startsWith('alert')).length",
              "return [...document.querySelectorAll('td')].some((cell) => cell.textContent.includes('config<'))",
              "return [...document.querySelectorAll('td')].some((cell) => cell.textContent.includes('--runs <i>runs'))",
              "return [...document.querySelectorAll('td')].some((cell) => cell.textContent.includes('<u>cup.stl'))",
              "return getComputedStyle(document.querySelector('h1 bdi')).unicodeBidi"});
  EXPECT_EQ(seen.values.at(0), name);
  EXPECT_THAT(seen.values.at(1).get<std::string>(), HasSubstr("<script>alert(1)</script>"));
  EXPECT_EQ(seen.values.at(2), 0);
  EXPECT_EQ(seen.values.at(3), 0);
  EXPECT_EQ(seen.values.at(4), true);
  EXPECT_EQ(seen.values.at(5), true);
  EXPECT_EQ(seen.values.at(6), true);
  EXPECT_EQ(seen.values.at(7), "isolate");
}

INSTANTIATE_TEST_SUITE_P(InABrowser, RunPage, ::testing::Bool(), test::webgl_name);

}  // namespace
}  // namespace palpate
