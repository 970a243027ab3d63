// SPDX-License-Identifier: MIT
// The block `compare:` of a sweep: its checks, its words, and the verdicts of a planned comparison.
#include "analysis/compare_plan.hpp"

#include "config/hash.hpp"
#include "config/yaml.hpp"
#include "support/made_sweep.hpp"
#include "sweep/description.hpp"

#include <fmt/format.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using test::error_of;
using test::MadeJob;
using test::MadeSweep;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

Tree block(const std::string& text) { return *parse_yaml("compare: {" + text + "}", "plan.yaml").find("compare"); }

ComparePlan plan(const std::string& more = "") {
  return ComparePlan(block("metric: rmse_m, by: acquisition, seeds: 8" + more));
}

/// Returns jobs of the strategies a and b with one kernel. The difference b - a in metres is 0.1 + seed / 1000, or 0.2
/// for every seed if `equal`.
MadeSweep pairs(int seeds, bool equal = false) {
  std::vector<MadeJob> jobs;
  for (int seed = 0; seed < seeds; ++seed) {
    jobs.push_back({"a", "rbf", seed, 0.25});
    jobs.push_back({"b", "rbf", seed, 0.25 + (equal ? 0.2 : 0.1 + seed / 1000.0)});
  }
  return MadeSweep(jobs);
}

TEST(ComparePlan, HasTheValuesOfItsBlockInSiUnits) {
  const ComparePlan made(block(
      "metric: [rmse_m, footprint_iou], by: [acquisition, kernel], baseline: 'a, rbf', where: taps > 3, seeds: 40, "
      "difference: 1 mm"));
  EXPECT_THAT(made.metrics, ElementsAre("rmse_m", "footprint_iou"));
  EXPECT_THAT(made.by, ElementsAre("acquisition", "kernel"));
  EXPECT_EQ(made.baseline, "a, rbf");
  EXPECT_EQ(made.where, "taps > 3");
  EXPECT_EQ(made.seeds, 40);
  EXPECT_DOUBLE_EQ(made.difference.value(), 0.001);
  EXPECT_EQ(made.words(),
            "rmse_m by acquisition, kernel where taps > 3, baseline a, rbf, 40 seeds, differences from 1 mm matter, "
            "secondary footprint_iou");
  EXPECT_EQ(plan().words(), "rmse_m by acquisition, 8 seeds");
  EXPECT_FALSE(plan().difference);
}

TEST(ComparePlan, HasTheFirstTwelveDigitsOfTheHashOfItsBlockAsItsName) {
  EXPECT_EQ(plan().hash, hash_of(plan().written.canonical()).substr(0, 12));
  EXPECT_EQ(plan().hash.size(), 12U);
  EXPECT_NE(plan().hash, plan(", baseline: a").hash);
  EXPECT_NE(plan(", difference: 1 mm").hash, plan(", difference: 2 mm").hash);
}

TEST(ComparePlan, IsRejectedWithPlaceReasonAndRemedyIfItsBlockIsInvalid) {
  const auto refusal = [](const std::string& text) { return error_of([&] { ComparePlan{block(text)}; }); };
  const std::string good = "metric: rmse_m, by: acquisition, seeds: 8";
  EXPECT_EQ(refusal(good), "accepted");
  EXPECT_EQ(refusal(good + ", basline: a"),
            "plan.yaml:1:54: unknown option 'basline' of compare, did you mean 'baseline'?");
  EXPECT_EQ(refusal("metric: rsme_m, by: acquisition, seeds: 8"),
            "plan.yaml:1:19: compare.metric: results.csv has no column 'rsme_m', did you mean 'rmse_m'?");
  EXPECT_THAT(refusal("metric: [rmse_m, status], by: acquisition, seeds: 8"),
              HasSubstr("compare.metric: results.csv has no column 'status'"))
      << "a text cannot be compared";
  EXPECT_THAT(refusal("metric: seed, by: acquisition, seeds: 8"), HasSubstr("no column 'seed'"));
  EXPECT_THAT(refusal("by: acquisition, seeds: 8"),
              HasSubstr("compare: 'metric' is missing, write compare: {metric: rmse_m"));
  EXPECT_THAT(refusal("metric: rmse_m, seeds: 8"), HasSubstr("compare: 'by' is missing"));
  EXPECT_THAT(refusal("metric: rmse_m, by: acquisition"), HasSubstr("compare: 'seeds' is missing"));
  EXPECT_THAT(refusal("metric: [], by: acquisition, seeds: 8"), HasSubstr("compare.metric: is empty"));
  EXPECT_THAT(refusal("metric: rmse_m, by: acquisition, seeds: many"), StartsWith("plan.yaml:1:51: compare.seeds"));
  EXPECT_THAT(refusal(good + ", difference: 1 s"), StartsWith("plan.yaml:1:66: compare.difference"));
  EXPECT_THAT(refusal(good + ", difference: 0.001"), HasSubstr("compare.difference")) << "a length needs its unit";
  EXPECT_THAT(refusal(good + ", difference: -1 mm"), HasSubstr("is not above 0"));
  EXPECT_THAT(refusal(good + ", where: taps >"), StartsWith("plan.yaml:1:61: the condition"));
  EXPECT_THAT(error_of([] { plan_in(parse_yaml("compare: 3", "plan.yaml")); }), HasSubstr("compare: expects a map"));
  EXPECT_FALSE(plan_in(parse_yaml("compare: none", "plan.yaml")));
}

TEST(ComparePlan, IsRejectedIfTheSweepLacksItsKeysGroupsOrSeeds) {
  const Sweep sweep = pairs(8).sweep;
  const auto refusal = [&](const ComparePlan& made) { return error_of([&] { made.check(sweep); }); };
  EXPECT_EQ(refusal(plan(", baseline: a, where: first_hit_tap <= 3 and kernel == rbf")), "accepted");
  EXPECT_EQ(refusal(plan(", where: status == done and found == true")), "accepted") << "a condition on a text";
  EXPECT_EQ(refusal(plan(", baseline: c")),
            "plan.yaml:1:64: compare.baseline: there is no group 'c', did you mean 'a'?");
  EXPECT_EQ(refusal(plan(", where: first_hit_tab <= 3")),
            "plan.yaml:1:61: the condition 'first_hit_tab <= 3' has the unknown name 'first_hit_tab', did you mean "
            "'first_hit_tap'?");
  const auto with = [](const std::string& by, int seeds) {
    return ComparePlan(block(fmt::format("metric: rmse_m, by: {}, seeds: {}", by, seeds)));
  };
  EXPECT_THAT(refusal(with("taps", 8)), StartsWith("plan.yaml:1:31: compare.by: this sweep does not vary 'taps'"));
  EXPECT_THAT(refusal(with("seed", 8)), HasSubstr("compare.by: the seed repeats a job"));
  EXPECT_THAT(refusal(with("[]", 8)), HasSubstr("compare.by: the sweep has only one group"));
  EXPECT_THAT(refusal(with("[acquisition, acquisition]", 8)), HasSubstr("'acquisition' is named twice"));
  EXPECT_THAT(refusal(with("kernel", 8)), HasSubstr("compare.by: the sweep has only one group"));
  EXPECT_THAT(refusal(with("acquisition", 9)), HasSubstr("compare.seeds: group 'a' has 8 seeds, not 9, "));
  MadeSweep uneven({{"a", "rbf", 0, 0.1}, {"a", "rbf", 1, 0.1}, {"b", "rbf", 0, 0.1}});
  EXPECT_THAT(error_of([&] { with("acquisition", 2).check(uneven.sweep); }), HasSubstr("group 'b' has 1 seeds, not 2"));
}

TEST(ComparePlan, GivesAVerdictFromTheIntervalOfTheFirstMetric) {
  // The 95 % interval of the mean of 0.1, 0.101, ..., 0.107 m by Student's t: 0.1035 +- 2.365 * 0.00245 / sqrt(8),
  // which is 0.1015 to 0.1055.
  const auto verdict = [](const MadeSweep& made, const std::string& difference, const std::string& baseline) {
    const ComparePlan planned = plan(", baseline: " + baseline + ", difference: " + difference);
    std::vector<Comparison> comparisons{made.by({"acquisition"}, "rmse_m", baseline),
                                        made.by({"acquisition"}, "footprint_iou", baseline)};
    EXPECT_THAT(mark_planned(comparisons, planned, true), StartsWith("planned before the first run"));
    EXPECT_THAT(compare_tables(comparisons[0]), HasSubstr("verdict"));
    EXPECT_THAT(compare_tables(comparisons[1]), Not(HasSubstr("verdict"))) << "a secondary metric";
    EXPECT_EQ(compare_rows(comparisons[1], "").back().text("verdict"), "");
    return compare_rows(comparisons[0], "").back().text("verdict");
  };
  for (const char* baseline : {"a", "b"}) {
    EXPECT_EQ(verdict(pairs(8), "101 mm", baseline), "larger");
    EXPECT_EQ(verdict(pairs(8), "102 mm", baseline), "not decided");
    EXPECT_EQ(verdict(pairs(8), "105 mm", baseline), "not decided");
    EXPECT_EQ(verdict(pairs(8), "106 mm", baseline), "smaller");
    EXPECT_EQ(verdict(pairs(8, true), "1 mm", baseline), "not decided") << "without an interval";
  }
}

TEST(ComparePlan, IsNamedInEveryRowAndCountsItsSeedsWithValues) {
  std::vector<MadeJob> jobs;
  for (int seed = 0; seed < 8; ++seed) {
    jobs.push_back({"a", "rbf", seed, 0.1, seed < 2 ? "failed" : "done"});
    jobs.push_back({"b", "rbf", seed, 0.1 + 0.01 * seed});
  }
  const MadeSweep made(jobs);
  const auto marked = [&](const std::optional<ComparePlan>& planned, bool is_planned, std::string& line) {
    std::vector<Comparison> out{made.by({"acquisition"})};
    line = mark_planned(out, planned, is_planned);
    return compare_rows(out.front(), "");
  };
  std::string line;
  const std::string hash = plan().hash;
  for (const Row& row : marked(plan(), true, line)) {
    EXPECT_EQ(row.flag("planned"), true);
    EXPECT_EQ(row.text("plan"), hash);
  }
  EXPECT_EQ(line, "planned before the first run (plan " + hash +
                      "): rmse_m by acquisition, 8 seeds; 6 of 8 seeds have values");
  for (const Row& row : marked(plan(), false, line)) {
    EXPECT_EQ(row.flag("planned"), false);
    EXPECT_EQ(row.text("plan"), hash);
    EXPECT_EQ(row.text("verdict"), "");
  }
  EXPECT_EQ(line, "chosen afterwards: the plan " + hash + " is another comparison");
  for (const Row& row : marked(std::nullopt, false, line)) EXPECT_EQ(row.text("plan"), "");
  EXPECT_EQ(line, "chosen afterwards");
}

TEST(ComparePlan, IsSetButNotSweptByWordsOfTheCommandLine) {
  const SweepOverrides words = parse_sweep_words({"seed=1,2", "compare.seeds=2", "compare.by=[acquisition, kernel]"});
  EXPECT_EQ(words.axes.size(), 1U);
  ASSERT_EQ(words.expectations.size(), 2U);
  EXPECT_EQ(words.expectations[1].path, "compare.by");
  EXPECT_EQ(words.expectations[1].value.items.size(), 2U);
  const Tree config = parse_yaml("grid: {compare.seeds: [2, 3]}", "plan.yaml");
  EXPECT_THAT(error_of([&] { SweepDescription(&config, {}); }),
              HasSubstr("'compare.seeds' cannot be swept, write it under 'compare:'"));
}

}  // namespace
}  // namespace palpate
