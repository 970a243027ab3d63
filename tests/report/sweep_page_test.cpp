// SPDX-License-Identifier: MIT
// The page of a sweep in a browser: its plots have the numbers of results.csv and follow the controls.
#include "report/sweep_pages.hpp"
#include "support/parts.hpp"

#include <numeric>
#include <tuple>

namespace palpate {
namespace {

using ::testing::EndsWith;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::StartsWith;

class SweepNumbers : public test::SweepPages {};

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

/// Compares means and spreads of all cells with the rows.
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

/// Compares the drawn front with that of `palpate pareto`.
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
      if (row.at(name + ".high_95").empty()) return 0.0;  // equal values have no interval
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

TEST_P(SweepNumbers, StandBelowASentenceAboutTheirPlan) {
  const fs::path directory =
      swept({paper_, "acquisition=weighted,uncertainty", "taps=4", "seed=range(0,2)", "candidates.count=9",
             "compare.metric=rmse_m", "compare.by=acquisition", "compare.seeds=2"});
  report(directory);
  const Browsed seen = browse(directory, {drawn(1), "return document.getElementById('planned').textContent"});
  ASSERT_EQ(seen.values.size(), 1U);
  EXPECT_THAT(seen.values.at(0).get<std::string>(),
              AllOf(StartsWith("Planned before the first run (plan "),
                    HasSubstr("): rmse_m by acquisition, 2 seeds. Other comparisons ")));
}

TEST_P(SweepNumbers, HaveTheImportanceOfTheKeysThatComparePrints) {
  const fs::path directory = swept({paper_, "acquisition=weighted,uncertainty", "kernel.length_scale=1.7cm,3cm",
                                    "taps=6", "seed=range(0,6)", "candidates.count=16"});
  report(directory);
  const Browsed seen = browse(directory, {drawn(1), "return document.getElementById('importance').textContent"});
  ASSERT_EQ(seen.values.size(), 1U);
  const test::Ended compared =
      test::palpate({"compare", directory.string(), "--importance", "--metric", "rmse_m"}, folder_.path());
  EXPECT_EQ(seen.values.at(0).get<std::string>() + "\n", compared.out);
  EXPECT_THAT(compared.out, HasSubstr("acquisition,kernel.length_scale"));
}

TEST_P(SweepNumbers, PlotsWhatResultsCsvSaysAndFollowsItsControls) {
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
              data_of("parallel", "[d[0].type, d[0].dimensions.length, d[0].line.color]"),
              choose("up", "taps"),
              drawn(2),
              choose("across", "kernel.length_scale"),
              drawn(3),
              choose("metric", "object_taps"),
              drawn(4),
              kCells,
              choose("group", "acquisition"),
              drawn(5),
              choose("then", "taps"),
              drawn(6),
              boxes,
              choose("up", ""),
              drawn(7),
              data_of("cells_mean",
                      "[d[0].type, d[0].y, d[0].error_y.array, l.xaxis.ticktext, "
                      "e.closest('figure').querySelector('figcaption').textContent]"),
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
              ("return Promise.all(['cells_mean', 'groups', 'parallel', 'front'].map((id) => Plotly.toImage(id, "
               "{format: 'png', width: 500, height: 300})))")});
  ASSERT_EQ(seen.values.size(), 24U);

  const json& cells = seen.values.at(0);
  EXPECT_EQ(cells.at("x"), json({"weighted", "uncertainty"})) << "in the order of the sweep";
  EXPECT_EQ(cells.at("y"), json({"10 mm", "1.7 cm", "2.5cm"})) << "as numbers";
  EXPECT_EQ(cells.at("title"), "rmse_m [mm], less is better");
  expect_cells(cells, rows, "acquisition", "kernel.length_scale", "rmse_m", 1000.0);
  const auto of = [&](const Cells& row) {
    return fmt::format("acquisition={}, kernel.length_scale={}, taps={}", row.at("acquisition"),
                       row.at("kernel.length_scale"), row.at("taps"));
  };
  ASSERT_EQ(seen.values.at(1).size(), 12U) << "every setting";
  for (const json& box : seen.values.at(1)) {
    expect_near(sorted(box.at(1)),
                column(rows, "rmse_m", 1000.0, [&](const Cells& row) { return of(row) == box.at(0); }));
  }
  expect_front(seen.values.at(2), directory, "robot_seconds", 1.0, "rmse_m", 1000.0);
  const json& parallel = seen.values.at(3);
  EXPECT_EQ(parallel.at(0), "parcoords");
  EXPECT_GT(parallel.at(1), 5);
  EXPECT_EQ(parallel.at(2).size(), 48U) << "a line a job";
  expect_near(sorted(parallel.at(2)), column(rows, "rmse_m", 1000.0, [](const Cells&) { return true; }));

  const json& changed = seen.values.at(7);
  EXPECT_EQ(changed.at("x"), json({"10 mm", "1.7 cm", "2.5cm"}));
  EXPECT_EQ(changed.at("y"), json({"8", "12"}));
  EXPECT_EQ(changed.at("title"), "object_taps, more is better");
  expect_cells(changed, rows, "kernel.length_scale", "taps", "object_taps", 1.0);
  ASSERT_EQ(seen.values.at(10).size(), 4U);
  for (const json& box : seen.values.at(10)) {
    const auto wanted = [&](const Cells& row) {
      return fmt::format("acquisition={}, taps={}", row.at("acquisition"), row.at("taps")) == box.at(0);
    };
    EXPECT_EQ(box.at(1).size(), 12U);
    expect_near(sorted(box.at(1)), column(rows, "object_taps", 1.0, wanted));
  }
  const json& points = seen.values.at(12);
  EXPECT_EQ(points.at(0), "scatter");
  EXPECT_THAT(points.at(4).get<std::string>(),
              MatchesRegex("Mean over [a-z, ]+ of the finished jobs; bars: standard deviation\\."));
  for (std::size_t i = 0; i < 3; ++i) {
    const std::vector<double> values = column(rows, "object_taps", 1.0, [&](const Cells& row) {
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
    EXPECT_EQ(jobs.at(i).at(7), rows[i].at("object_taps"));
  }
  std::vector<Cells> by_time = rows;
  std::stable_sort(by_time.begin(), by_time.end(), [](const Cells& a, const Cells& b) {
    return std::stod(a.at("robot_seconds")) < std::stod(b.at("robot_seconds"));
  });
  for (std::size_t i = 0; i < 48; ++i) EXPECT_EQ(seen.values.at(19).at(i).at(0), by_time[i].at("job"));
  EXPECT_EQ(seen.values.at(21).size(), 24U) << "twelve taps";
  for (const json& place : seen.values.at(22)) EXPECT_TRUE(fs::is_directory(directory / place.get<std::string>()));
  for (const json& picture : seen.values.at(23)) EXPECT_GT(picture.get<std::string>().size(), 5000U) << "painted";

  // A setting on the front that loses a job is no longer compared, so settings that it dominated may be on the front.
  const auto front_of = [&] { return csv_rows(text_of(directory / "pareto_robot_seconds_rmse_m.csv")); };
  const std::vector<Cells> before = front_of();
  const auto beaten =
      std::find_if(before.begin(), before.end(), [](const Cells& row) { return row.at("front") == "1"; });
  // The most expensive job, without which the setting would even be cheaper.
  const auto lost =
      std::find_if(by_time.rbegin(), by_time.rend(), [&](const Cells& row) { return of(row) == of(*beaten); });
  test::forget_end(directory / "jobs" / lost->at("id"));
  ASSERT_EQ(
      test::palpate({"pareto", directory.string(), "--cost", "robot_seconds", "--error", "rmse_m"}, folder_.path())
          .status,
      0);
  for (const Cells& row : front_of()) EXPECT_EQ(row.at("unfinished") == "0", of(row) != of(*beaten));
  report(directory);
  const Browsed again = browse(directory, {drawn(1), kFront});
  ASSERT_EQ(again.values.size(), 1U);
  expect_front(again.values.at(0), directory, "robot_seconds", 1.0, "rmse_m", 1000.0);
}

TEST_P(SweepNumbers, HaveCurvesOfGroupsWithBandsForEachSceneAndNoFrontOfTwo) {
  const fs::path directory = swept({paper_, "acquisition=weighted,uncertainty", "scene=object_i,object_ii", "taps=6",
                                    "seed=range(0,5)", "candidates.count=16"});
  report(directory);
  const Browsed before = browse(directory, {drawn(1), "return document.getElementById('how_to_curves').textContent"});
  EXPECT_THAT(before.values.at(0).get<std::string>(), StartsWith("palpate curves " + directory.string() + " computes"));
  for (const char* metric : {"rmse_m", "footprint_iou"}) {
    const test::Ended ended = test::palpate(
        {"curves", directory.string(), "--metric", metric, "-o", fmt::format("{}.csv", metric)}, folder_.path());
    ASSERT_EQ(ended.status, 0) << ended.err;
  }
  report(directory);
  const std::string curves =
      "return [0, 1].map((i) => { const e = document.getElementById(`curves_${i}`); return [e.closest('figure')."
      "querySelector('figcaption').textContent, e.data.filter((t) => t.name).map((t, k) => [t.name, t.x, t.y, "
      "e.data[3 * k].y, e.data[3 * k + 1].y])]; })";
  const Browsed seen = browse(directory, {drawn(1), curves, choose("curve_of", "footprint_iou"), drawn(2), curves,
                                          data_of("front", "d[0].x.length"), choose("scene", "object_ii"), drawn(3),
                                          data_of("front", "d[0].text.concat(d[4].text).join()"),
                                          "return document.querySelector('section:has(pre) tbody').textContent"});
  ASSERT_EQ(seen.values.size(), 7U);
  for (const auto& [place, metric, factor] : {std::tuple(0U, "rmse_m", 1000.0), std::tuple(2U, "footprint_iou", 1.0)}) {
    const std::vector<Cells> rows = csv_rows(text_of(folder_.path() / fmt::format("{}.csv", metric)));
    std::size_t compared = 0;
    for (const json& scene : seen.values.at(place)) {
      for (const json& curve : scene.at(1)) {
        for (const Cells& row : rows) {
          if (row.at("scene") != scene.at(0) || row.at("acquisition") != curve.at(0)) continue;
          const std::size_t tap = std::stoul(row.at("at")) - 1;
          EXPECT_EQ(curve.at(1).at(tap), std::stod(row.at("at")));
          for (const auto& [column, name] :
               {std::pair(2U, "mean"), std::pair(3U, "low_95"), std::pair(4U, "high_95")}) {
            const json& number = curve.at(column).at(tap);
            if (row.at(name).empty()) {
              EXPECT_TRUE(number.is_null()) << name;
              continue;
            }
            EXPECT_NEAR(number.get<double>(), factor * std::stod(row.at(name)), 1e-9) << name;
          }
          ++compared;
        }
      }
    }
    EXPECT_EQ(compared, 24U) << "two strategies on two scenes, six taps";
  }
  EXPECT_EQ(seen.values.at(3), 10) << "the jobs of one scene";
  EXPECT_THAT(seen.values.at(5).get<std::string>(),
              AllOf(HasSubstr("scene=object_ii"), Not(HasSubstr("scene=object_i,"))));
  EXPECT_THAT(seen.values.at(6).get<std::string>(),
              AllOf(HasSubstr("sceneobject_i, object_ii"), HasSubstr("seed0, 1, 2, 3, 4")));
}

// sweep_trouble_test.cpp tests pages without WebGL.
INSTANTIATE_TEST_SUITE_P(InABrowser, SweepNumbers, ::testing::Values(true), test::webgl_name);

}  // namespace
}  // namespace palpate
