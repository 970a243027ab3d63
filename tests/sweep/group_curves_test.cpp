// SPDX-License-Identifier: MIT
// Curves of groups of made-up jobs, compared with means computed by hand.
#include "analysis/group_curves_report.hpp"
#include "support/testing.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;
using Values = std::vector<double>;

const double kNone = std::nan("");

/// A sweep over strategies, scenes and seeds. The jobs have these errors after each tap, and a tap takes one second
/// unless given.
struct TappedSweep {
  struct TappedJob {
    std::string strategy;
    std::string scene;
    int seed;
    Values errors;  ///< empty: the job failed
    double seconds = 1.0;
  };

  Sweep sweep{"runs/x/0123456789ab", {"acquisition", "scene", "seed"}, {}};
  std::vector<Row> results;
  std::vector<TapValues> values;

  explicit TappedSweep(const std::vector<TappedJob>& jobs) {
    for (const TappedJob& one : jobs) {
      const auto index = static_cast<int>(sweep.jobs.size());
      sweep.jobs.push_back({index, "id", {one.strategy, one.scene, std::to_string(one.seed)}});
      Row row;
      row.add("job", index);
      row.add("status", one.errors.empty() ? "failed" : "done");
      row.add("rmse_m", one.errors.empty() ? std::optional<double>() : std::optional(one.errors.back()));
      row.add("robot_seconds", one.seconds * static_cast<double>(one.errors.size()));
      results.push_back(std::move(row));
      values.emplace_back();
      if (one.errors.empty()) continue;
      values.back()["rmse_m"] = one.errors;
      for (std::size_t tap = 1; tap <= one.errors.size(); ++tap)
        values.back()["robot_seconds"].push_back(one.seconds * static_cast<double>(tap));
    }
  }

  GroupCurves curves(const std::vector<std::string>& by, const std::string& against = "taps") const {
    return make_group_curves(sweep, results, values, {by, "rmse_m", against});
  }
};

Values means_of(const GroupCurve& curve) {
  Values out;
  for (const CurvePoint& point : curve.points) out.push_back(point.mean.mean);
  return out;
}

TEST(GroupCurves, AreNeverMadeOfTwoScenes) {
  const TappedSweep made({{"a", "cube", 1, {0.4, 0.2}}, {"a", "ring", 1, {0.8, 0.6}}, {"b", "cube", 1, {0.5, 0.3}}});
  const GroupCurves curves = made.curves({"acquisition"});
  ASSERT_EQ(curves.curves.size(), 3U);
  EXPECT_EQ(curves.scenes, std::vector<std::string>{"scene"});
  EXPECT_EQ(curves.scene_names(), (std::vector<std::string>{"cube", "ring"}));
  EXPECT_EQ(means_of(curves.curves[0]), (Values{0.4, 0.2}));
  EXPECT_EQ(curves.curves[1].name(), "b") << "those of a scene stand together";
  EXPECT_EQ(means_of(curves.curves[2]), (Values{0.8, 0.6}));
  const GroupCurves by_scene = made.curves({"scene"});
  EXPECT_TRUE(by_scene.scenes.empty()) << "it makes the groups";
  EXPECT_EQ(means_of(by_scene.curves[0]), (Values{0.45, 0.25}));
}

TEST(GroupCurves, HaveJobsThatEndedEarlyAsTheyEndedAndNoneThatFailedAndSaySo) {
  const TappedSweep made({{"a", "cube", 1, {0.4, 0.2, 0.1}}, {"a", "cube", 2, {0.6, 0.4}}, {"a", "cube", 3, {}}});
  const GroupCurves curves = made.curves({"acquisition"});
  ASSERT_EQ(curves.curves.size(), 1U);
  const GroupCurve& curve = curves.curves[0];
  ASSERT_EQ(curve.points.size(), 3U);
  EXPECT_EQ(curve.points[1].mean.mean, (0.2 + 0.4) / 2);
  EXPECT_EQ(curve.points[2].mean.mean, (0.1 + 0.4) / 2);
  EXPECT_EQ(curve.points[2].mean.count, 2U);
  const std::string table = curves_table(curves);
  EXPECT_THAT(table, HasSubstr("a: jobs in no point, of 3: 1 failed\n"));
  EXPECT_THAT(table,
              HasSubstr("a: 1 of 2 jobs made fewer taps than others and count afterwards with their final values\n"));
  const Row last = curves_rows(curves).back();
  EXPECT_EQ(last.cell("at"), "3");
  EXPECT_EQ(last.cell("failed"), "1");
  EXPECT_EQ(last.cell("ended"), "1");
}

TEST(GroupCurves, TakeSeedsAsUnitsOfTheirIntervals) {
  std::vector<TappedSweep::TappedJob> jobs;
  for (int seed = 1; seed <= 5; ++seed) {
    for (const char* kernel : {"a", "b"}) jobs.push_back({kernel, "cube", seed, {0.1 * seed}});
  }
  const MeanEstimate mean = TappedSweep(jobs).curves({}).curves[0].points[0].mean;
  EXPECT_EQ(mean.count, 10U);
  EXPECT_EQ(mean.clusters, 5U);
  // Student's t with four degrees of freedom times the standard error of 0.1, 0.2, ... 0.5.
  const double half = 2.7764451 * std::sqrt(0.025 / 5.0);
  ASSERT_TRUE(mean.interval);
  EXPECT_NEAR(mean.interval->low, 0.3 - half, 1e-7);
  EXPECT_NEAR(mean.interval->high, 0.3 + half, 1e-7);
}

TEST(GroupCurves, AgainstTimeHaveEachJobAsItWasAfterItsLastTapByThen) {
  // Taps of one and of two seconds: the curve begins at 2 s, when both jobs have a tap, and ends at 6 s.
  const TappedSweep made({{"a", "cube", 1, {0.8, 0.4, 0.2}, 1.0}, {"a", "cube", 2, {0.6, 0.4, 0.0}, 2.0}});
  const std::vector<CurvePoint> points = made.curves({"acquisition"}, "robot_seconds").curves[0].points;
  EXPECT_EQ(points.front().at, 2.0);
  EXPECT_EQ(points.back().at, 6.0);
  for (const CurvePoint& point : points) {
    const double first = point.at < 3.0 ? 0.4 : 0.2;
    const double second = point.at < 4.0 ? 0.6 : point.at < 6.0 ? 0.4 : 0.0;
    EXPECT_NEAR(point.mean.mean, (first + second) / 2, 1e-12) << point.at;
  }
}

TEST(GroupCurves, LeaveOutOfAPointTheJobsThatHaveNoValueThereAndSaySo) {
  const TappedSweep made({{"a", "cube", 1, {kNone, 0.2}}, {"a", "cube", 2, {0.6, 0.4}}});
  const GroupCurves curves = made.curves({"acquisition"});
  EXPECT_EQ(means_of(curves.curves[0])[0], 0.6);
  EXPECT_EQ(curves.curves[0].points[0].mean.count, 1U);
  EXPECT_THAT(curves_table(curves), HasSubstr("a: 1 to 2 jobs have a value, depending on the point of the curve\n"));
}

TEST(GroupCurves, AreRefusedWhereThereIsNothingToDraw) {
  const auto refusal = [](const TappedSweep& made, const std::vector<std::string>& by, const std::string& against) {
    return test::error_of([&] { made.curves(by, against); });
  };
  EXPECT_THAT(refusal(TappedSweep({{"a", "cube", 1, {}}}), {}, "taps"),
              HasSubstr("none of the jobs to draw ended well"));
  EXPECT_THAT(refusal(TappedSweep({{"a", "cube", 1, {0.1}, 0.0}}), {}, "robot_seconds"),
              HasSubstr("--against: no job took any robot time"));
  EXPECT_THAT(refusal(TappedSweep({{"a", "cube", 1, {0.1}}}), {"seed"}, "taps"), HasSubstr("cannot form groups"));
  EXPECT_THAT(refusal(TappedSweep({{"a", "cube", 1, {kNone, kNone}}}), {}, "taps"), HasSubstr("no job has a value"));
}

}  // namespace
}  // namespace palpate
