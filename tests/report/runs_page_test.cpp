// SPDX-License-Identifier: MIT
// The page of several runs: its numbers are those of the records.
#include "report/browser.hpp"

#include <cmath>

namespace palpate {
namespace {

using ::testing::IsEmpty;

class RunsPage : public test::Reports {
 protected:
  /// Makes a run of the paper's experiment with `words`. Returns the run directory.
  fs::path made(const std::string& runs, std::vector<std::string> words) const {
    words.insert(words.begin(), {"run", paper_, "--quiet", "--runs", runs});
    const test::Ended ran = test::palpate(words, folder_.path());
    EXPECT_EQ(ran.status, 0) << ran.err;
    return test::only_run(folder_.path() / runs);
  }
  Browsed opened(const std::vector<fs::path>& runs, const std::vector<std::string>& steps) const {
    std::vector<std::string> words{"report", "--to", "pages"};
    for (const fs::path& run : runs) words.push_back(run.string());
    const test::Ended ended = test::palpate(words, folder_.path());
    EXPECT_EQ(ended.status, 0) << ended.err;
    Browsed seen = test::browse(folder_.path() / ended.out.substr(0, ended.out.find('\n')), steps, false);
    EXPECT_EQ(seen.trouble, "");
    EXPECT_THAT(seen.severe, IsEmpty());
    return seen;
  }
};

/// Returns the names and last points of the curves in a plot.
std::string ends_of(const std::string& plot) {
  return "return document.getElementById('" + plot +
         "').data.map((curve) => [curve.name, curve.x.at(-1), curve.y.at(-1)])";
}

TEST_F(RunsPage, ShowsTheErrorsOfAllOfThemOverTapsAndOverRobotTime) {
  const fs::path first = made("a", {"seed=4"});
  const fs::path second = made("b", {"seed=5", "taps=12", "acquisition=uncertainty"});
  const Browsed seen = opened({first, second}, {drawn(17), ends_of("over_taps"), ends_of("over_seconds")});
  const std::vector<fs::path> runs{first, second};
  for (std::size_t i = 0; i < 2; ++i) {
    const json summary = json::parse(text_of(runs[i] / "summary.json"));
    const json& over_taps = seen.values.at(0).at(i);
    const json& over_seconds = seen.values.at(1).at(i);
    EXPECT_EQ(over_taps.at(0), i == 0 ? "A" : "B");
    EXPECT_EQ(over_taps.at(1), summary.at("taps"));
    EXPECT_NEAR(over_taps.at(2).get<double>(), 1000.0 * summary.at("rmse_m").get<double>(), 1e-9);
    EXPECT_NEAR(over_seconds.at(1).get<double>(), summary.at("robot_seconds").get<double>(), 1e-9);
    EXPECT_EQ(over_seconds.at(2), over_taps.at(2));
  }
}

TEST_F(RunsPage, SubtractsTheFirstSurfaceAndFollowsTheSlider) {
  const fs::path first = made("a", {"seed=4"});
  const fs::path second = made("b", {"seed=5", "taps=12"});
  const std::string compare =
      "const z = (id) => document.getElementById(id).data[0].z; const [a, b, d] = ['surface_0', 'surface_1', "
      "'difference_1'].map(z); return Math.max(...d.flatMap((line, i) => line.map((v, k) => Math.abs(v - (b[i][k] - "
      "a[i][k])))))";
  const std::string back =
      "const s = document.getElementById('slider'); s.value = 0; s.dispatchEvent(new Event('input'));";
  const std::string marks =
      "const [, on, off] = document.getElementById('surface_1').data; return on.x.length + off.x.length";
  const std::string rows = "return document.getElementById('surface_1').data[0].z";
  const Browsed seen = opened({first, second}, {drawn(17), compare, rows, back, drawn(0), compare, marks});
  EXPECT_LT(seen.values.at(0).get<double>(), 1e-9);
  EXPECT_LT(seen.values.at(3).get<double>(), 1e-9);
  EXPECT_EQ(seen.values.at(4), 0) << "before the first tap there is none to mark";
  // The second run's record has the surface after its last tap.
  const std::vector<Cells> recorded = csv_rows(text_of(second / "surface.csv"));
  const json& shown = seen.values.at(1);
  ASSERT_EQ(recorded.size(), shown.size() * shown.at(0).size());
  double most = 0.0;
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    const double there = shown.at(i / shown.at(0).size()).at(i % shown.at(0).size()).get<double>();
    most = std::max(most, std::abs(there - 100.0 * std::stod(recorded[i].at("reconstructed_height"))));
  }
  EXPECT_LT(most, 1e-2) << "centimetres; maps are packed in 65536 steps";
}

TEST_F(RunsPage, SaysWhatDiffersInTheirConfigsAndNothingElse) {
  const fs::path first = made("a", {"seed=4"});
  const fs::path second = made("b", {"seed=5", "kernel.length_scale=2 cm"});
  const Browsed seen = opened(
      {first, second}, {drawn(17),
                        "return [...document.querySelectorAll('table')].at(-1).innerText.split('\\n').map((line) => "
                        "line.split('\\t').map((cell) => cell.trim()))"});
  EXPECT_EQ(seen.values.at(0), json::parse(R"([["key", "A", "B"], ["seed", "4", "5"],
                                              ["kernel.length_scale", "0.017 m", "0.02 m"]])"));
}

}  // namespace
}  // namespace palpate
