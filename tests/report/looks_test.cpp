// SPDX-License-Identifier: MIT
// Appearance of pages: themes, a phone, the wheel, and panels that are left out.
#include "report/sweep_pages.hpp"

#include <algorithm>

namespace palpate {
namespace {

using ::testing::Not;

class Looks : public test::SweepPages {
 protected:
  /// Makes a run of the paper's experiment with its page. Returns its directory.
  fs::path run_with_page(std::vector<std::string> words) const {
    words.insert(words.begin(), {"run", paper_, "--quiet", "--runs", "runs"});
    const test::Ended ran = test::palpate(words, folder_.path());
    EXPECT_EQ(ran.status, 0) << ran.err;
    fs::path directory = test::only_run(folder_.path() / "runs");
    report(directory);
    return directory;
  }
};

/// Returns the lightness, 0 to 255, of the page, its text, a plot, the plot's text, and its grid lines.
const std::string kLightness =
    "const light = (c) => { const [r, g, b] = c.match(/[\\d.]+/g).map(Number); return (r + g + b) / 3; };"
    "const e = document.getElementById(document.getElementById('map_u') ? 'map_u' : 'front'); const l = e.layout;"
    "const seen = [...e.querySelectorAll('.xtick text')].map((t) => light(getComputedStyle(t).fill));"
    "const style = getComputedStyle(document.body);"
    "return [light(style.backgroundColor), light(style.color), light(l.plot_bgcolor), Math.max(...seen), "
    "light(l.xaxis.gridcolor)]";

std::string system_is(const std::string& theme) {
  return R"(devtools Emulation.setEmulatedMedia {"features": [{"name": "prefers-color-scheme", "value": ")" + theme +
         "\"}]}";
}
const std::string kClickTheme = "document.getElementById('theme').click()";
std::string plots_are(const std::string& theme) {
  return "await light_of_plots() " + std::string(theme == "dark" ? "< 80" : "> 200");
}
/// Defines a function of the page that returns the lightness of its plots, so that steps can wait for a change.
const std::string kWatchPlots =
    "window.light_of_plots = () => document.getElementById(document.getElementById('map_u') ? 'map_u' : 'front')"
    ".layout.plot_bgcolor.match(/[\\d.]+/g).map(Number)[0]";

void expect_light(const json& seen) {
  EXPECT_GT(seen.at(0), 230) << "page";
  EXPECT_LT(seen.at(1), 80) << "its text";
  EXPECT_GT(seen.at(2), 230) << "plot";
  EXPECT_LT(seen.at(3), 80) << "its text";
  EXPECT_GT(seen.at(4), 200) << "its grid";
}

void expect_dark(const json& seen) {
  EXPECT_LT(seen.at(0), 50) << "page";
  EXPECT_GT(seen.at(1), 200) << "its text";
  EXPECT_LT(seen.at(2), 50) << "plot";
  EXPECT_GT(seen.at(3), 200) << "its text";
  EXPECT_LT(seen.at(4), 90) << "its grid";
}

TEST_P(Looks, OfARunAreDarkWithTheSystemUntilSomebodySwitchesAndThePageRemembersIt) {
  const fs::path directory = run_with_page({"taps=4", "candidates.count=12"});
  const Browsed seen = browse(directory, {drawn(4), kWatchPlots, kLightness,                 // light at first
                                          system_is("dark"), plots_are("dark"), kLightness,  // follows the system
                                          kClickTheme, plots_are("light"), kLightness,       // the reader switches
                                          "reload", drawn(4), kWatchPlots, kLightness,  // the page remembers the choice
                                          kClickTheme, plots_are("dark"), kLightness,   // the reader switches back
                                          // follows the system again
                                          system_is("light"), plots_are("light"), kLightness});
  std::vector<json> shown;
  std::copy_if(seen.values.begin(), seen.values.end(), std::back_inserter(shown),
               [](const json& one) { return one.is_array(); });
  ASSERT_EQ(shown.size(), 6U);
  expect_light(shown.at(0));
  expect_dark(shown.at(1));
  expect_light(shown.at(2));
  expect_light(shown.at(3));
  expect_dark(shown.at(4));
  expect_light(shown.at(5));
}

const char* const kPhone =
    R"(devtools Emulation.setDeviceMetricsOverride {"width": 360, "height": 740, "deviceScaleFactor": 2, "mobile": true})";
/// Returns the widths of the window and of the page, and the right edge of plots that do not scroll on their own.
const std::string kWidths =
    "return [innerWidth, document.documentElement.scrollWidth, Math.max(...[...document.querySelectorAll('.plot')]"
    ".filter((p) => getComputedStyle(p.closest('figure')).overflowX !== 'auto' && p.offsetParent)"
    ".map((p) => p.getBoundingClientRect().right))]";

/// Returns the rightmost begin of the tables' second column, plus the width of a word.
const std::string kTables =
    "return Math.max(...[...document.querySelectorAll('tr td:nth-child(2) .foreign')]"
    ".map((cell) => cell.getBoundingClientRect().left + 20))";

TEST_P(Looks, OfARunOnAPhoneAreOneColumnWithTheSurfaceFirst) {
  const fs::path directory = run_with_page({"taps=6", "candidates.count=16", "name=" + std::string(90, 'x')});
  const std::string ask_tops =
      "const top = (s) => document.querySelector(s).getBoundingClientRect().top; return {surface: "
      "top('#surface'), bottom: document.querySelector('#surface').getBoundingClientRect().bottom, slider: "
      "top('#slider'), facts: top('.facts'), maps: top('#map_u')}";
  const std::string ask_lefts =
      "return [...document.querySelectorAll('#maps_row figure')].map((f) => "
      "Math.round(f.getBoundingClientRect().left))";
  const Browsed seen = browse(directory, {kPhone, "reload", drawn(6), kWidths, ask_tops, ask_lefts, kTables});
  EXPECT_LE(seen.values.at(3), 360) << "the values of the config are beside their keys";
  const json& widths = seen.values.at(0);
  EXPECT_EQ(widths.at(0), 360);
  EXPECT_LE(widths.at(1), 360) << "nothing to scroll sideways";
  EXPECT_LE(widths.at(2), 360);
  const json& tops = seen.values.at(1);
  EXPECT_LT(tops.at("surface"), tops.at("slider"));
  EXPECT_LT(tops.at("slider"), tops.at("facts"));
  EXPECT_LT(tops.at("facts"), tops.at("maps"));
  EXPECT_LT(tops.at("bottom"), 740) << "on the first screen";
  for (const json& left : seen.values.at(2)) EXPECT_EQ(left, seen.values.at(2).at(0)) << "one column";
}

TEST_P(Looks, OfASweepAreDarkAndItsJobsLinkToNothingButPagesThatAreThere) {
  const fs::path directory =
      swept({paper_, "acquisition=weighted,uncertainty", "seed=range(0,3)", "taps=5", "candidates.count=12"});
  const std::vector<Cells> rows = csv_rows(text_of(directory / "results.csv"));
  report(directory / "jobs" / rows.at(4).at("id"));
  fs::remove_all(directory / "jobs" / rows.at(5).at("id"));
  report(directory);
  const std::string links = "return [...document.querySelectorAll('a')].map((a) => a.getAttribute('href'))";
  const std::string how = "return document.getElementById('how_to_report')?.textContent ?? ''";
  // A slow page may have drawn twice, in light and in dark.
  const std::string drawn_at_all = "await Number(document.body.dataset.drawn) >= 1";
  const Browsed seen =
      browse(directory, {system_is("dark"), drawn_at_all, kWatchPlots, plots_are("dark"), kLightness, links, how});
  const std::size_t at = seen.values.size() - 3;
  expect_dark(seen.values.at(at));
  EXPECT_EQ(seen.values.at(at + 1), json({"jobs/" + rows.at(4).at("id") + "/report.html"}));
  // The command on the page works; with it done for all jobs, the page has no more commands.
  const auto told = seen.values.at(at + 2).get<std::string>();
  const auto begin = told.find("palpate report ") + 15;
  const std::string place = told.substr(begin, told.find(" makes it") - begin);
  EXPECT_EQ(place, (directory / "jobs" / rows.at(0).at("id")).string()) << told;
  report(place);
  for (std::size_t job = 1; job < 4; ++job) report(directory / "jobs" / rows.at(job).at("id"));
  report(directory);
  const Browsed again = browse(directory, {drawn(1), links, how});
  EXPECT_EQ(again.values.at(0).size(), 5U);
  for (const json& link : again.values.at(0)) EXPECT_TRUE(fs::exists(directory / link.get<std::string>())) << link;
  EXPECT_EQ(again.values.at(1), "") << "the job without a folder has nothing to be reported";
}

/// Returns a step that turns the wheel in the middle of the surface; `keys` is 0, or 2 for Ctrl.
std::string wheel(int keys) {
  return fmt::format(
      R"(devtools Input.dispatchMouseEvent {{"type": "mouseWheel", "x": 600, "y": 300, "deltaX": 0, "deltaY": 240, "modifiers": {}}})",
      keys);
}

TEST_P(Looks, TheWheelScrollsThePageOverEveryPlotAndWithCtrlItZoomsTheSurface) {
  const fs::path directory = run_with_page({"seed=4", "taps=6", "candidates.count=16"});
  const auto under = [](const std::string& id) {
    return "document.getElementById('" + id +
           "').scrollIntoView({block: 'start'}); window.scrollBy(0, -100); window.before = scrollY; const e = "
           "document.elementFromPoint(600, 300); return e.closest('.plot')?.id ?? e.tagName";
  };
  std::vector<std::string> steps{drawn(6), under("surface"), wheel(0), "await scrollY > window.before + 100"};
  if (GetParam()) {
    const std::string eye = "document.getElementById('surface')._fullLayout.scene._scene.getCamera().eye";
    steps.insert(steps.end(), {under("surface"), "window.eye = Math.hypot(...Object.values(" + eye + "))", wheel(2),
                               "await Math.abs(Math.hypot(...Object.values(" + eye + ")) - window.eye) > 1e-3",
                               "return scrollY - window.before"});
  }
  steps.insert(steps.end(), {under("map_u"), wheel(0), "await scrollY > window.before + 100"});
  const Browsed seen = browse(directory, steps);
  EXPECT_EQ(seen.values.at(0), "surface");
  if (GetParam()) {
    EXPECT_EQ(seen.values.at(3), 0) << "with Ctrl the page stays";
  }
  EXPECT_THAT(seen.values.back().get<std::string>(), testing::StartsWith("map_"));
}

/// Returns the titles of all panels, and the lines about constants.
const std::string kPanels =
    "const text = (s) => [...document.querySelectorAll(s)].map((e) => e.textContent); return [text('figcaption'), "
    "text('.constants').join(' ')]";

TEST_P(Looks, MapsThatAreTheSameEverywhereAndErrorsThatNobodyKnowsAreNoPanels) {
  const fs::path missed = run_with_page({"taps=3", "candidates.count=12"});  // no tap hits the object
  const Browsed seen = browse(missed, {drawn(3), kPanels, "return document.getElementById('map_w') === null"});
  EXPECT_THAT(seen.values.at(0).at(1).get<std::string>(),
              HasSubstr("Weight w: 1 on an object, 0 on the desk: 0 everywhere"));
  EXPECT_EQ(seen.values.at(1), true);

  const std::string process = (test::source_folder() / "configs/process.yaml").string();
  const test::Ended ran = test::palpate({"run", process, "--quiet", "--runs", "others", "taps=4"}, folder_.path());
  ASSERT_EQ(ran.status, 0) << ran.err;
  const fs::path robot = test::only_run(folder_.path() / "others");
  report(robot);
  const Browsed other = browse(robot, {drawn(4), kPanels});
  for (const json& title : other.values.at(0).at(0)) {
    EXPECT_THAT(title.get<std::string>(), Not(HasSubstr("Error")));
    EXPECT_THAT(title.get<std::string>(), Not(HasSubstr("IoU")));
  }
}

// run_page_test.cpp tests pages without WebGL, which lack the surface alone.
INSTANTIATE_TEST_SUITE_P(InABrowser, Looks, ::testing::Values(true), test::webgl_name);

}  // namespace
}  // namespace palpate
