// SPDX-License-Identifier: MIT
// The Pareto front, compared with its definition, and the grouping of jobs into settings.
#include "analysis/pareto.hpp"

#include "analysis/gnuplot.hpp"
#include "analysis/pareto_report.hpp"
#include "support/testing.hpp"

#include <random>
#include <string_view>

namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A job of a made-up sweep over strategy, taps and seed: cost and error, or the reason of its failure.
struct MadeUpJob {
  std::string strategy;
  std::string seed;
  double seconds;
  double rmse;
  double iou = 0.5;
  std::string status = "done";
  bool has_truth = true;
};

struct MadeUp {
  Sweep sweep{"runs/x/0123456789ab", {"acquisition", "taps", "seed"}, {}};
  std::vector<Row> results;

  explicit MadeUp(const std::vector<MadeUpJob>& outcomes) {
    for (const MadeUpJob& one : outcomes) {
      const int index = static_cast<int>(sweep.jobs.size());
      sweep.jobs.push_back({index, "id", {one.strategy, "17", one.seed}});
      if (one.status == "absent") continue;
      Row row;
      row.add("job", index);
      row.add("acquisition", one.strategy);
      row.add("taps", "17");
      row.add("status", one.status);
      row.add("rmse_m", one.has_truth ? std::optional(one.rmse) : std::nullopt);
      row.add("footprint_iou", one.iou);
      row.add("coverage_95", 0.9);
      row.add("robot_seconds", one.seconds);
      row.add("found", one.iou > 0.0);
      results.push_back(std::move(row));
    }
  }
  Pareto pareto(const std::string& cost = "robot_seconds", const std::string& error = "rmse_m") const {
    return make_pareto(sweep, results, cost, error);
  }
  std::string refusal(const std::string& cost, const std::string& error, const std::string& within = "") const {
    return test::error_of([&] {
      const Pareto made = pareto(cost, error);
      if (!within.empty()) read_bound(made, within);
    });
  }
};

const Setting& setting(const Pareto& pareto, std::string_view name) {
  for (const Setting& one : pareto.settings) {
    if (one.name == name) return one;
  }
  throw std::runtime_error("no setting " + std::string(name));
}

TEST(Pareto, HasOnItsFrontWhatTheDefinitionSaysInThousandsOfRandomCases) {
  std::mt19937 random(7);
  const auto beats = [](const Setting& a, const Setting& b) {
    return a.cost.mean <= b.cost.mean && a.error.mean <= b.error.mean &&
           (a.cost.mean < b.cost.mean || a.error.mean < b.error.mean);
  };
  for (int i = 0; i < 3000; ++i) {
    const int count = std::uniform_int_distribution<int>(1, 12)(random);
    // Few different values, so that most cases have ties in one or both coordinates.
    std::uniform_int_distribution<int> value(0, i % 2 == 0 ? 4 : 1000);
    std::vector<MadeUpJob> outcomes;
    for (int k = 0; k < count; ++k)
      outcomes.push_back({std::to_string(k), "1", double(value(random)), double(value(random))});
    const std::vector<Setting> settings = MadeUp(outcomes).pareto().settings;
    ASSERT_EQ(settings.size(), outcomes.size());
    int number = 0;
    for (const Setting& one : settings) {
      const bool beaten =
          std::any_of(settings.begin(), settings.end(), [&](const Setting& other) { return beats(other, one); });
      EXPECT_EQ(one.front, beaten ? 0 : ++number) << "case " << i << ", " << one.name;
    }
  }
}

TEST(Pareto, GroupsOverTheSeedAndNamesOnlyTheKeysThatDiffer) {
  const Pareto pareto = MadeUp({{"a", "1", 10, 0.03}, {"b", "1", 20, 0.01}, {"a", "2", 12, 0.05}}).pareto();
  EXPECT_EQ(pareto.keys, (std::vector<std::string>{"acquisition", "taps"}));
  ASSERT_EQ(pareto.settings.size(), 2U);
  const Setting& a = setting(pareto, "acquisition=a");
  EXPECT_EQ(a.counts.all(), 2);
  EXPECT_EQ(a.first_job, 0U);
  EXPECT_DOUBLE_EQ(a.cost.mean, 11.0);
  EXPECT_DOUBLE_EQ(a.error.mean, 0.04);
}

TEST(Pareto, TakesMoreForBetterWhereItIs) {
  const Pareto pareto = MadeUp({{"a", "1", 10, 0, 0.2}, {"b", "1", 20, 0, 0.9}, {"c", "1", 30, 0, 0.5}})
                            .pareto("robot_seconds", "footprint_iou");
  EXPECT_TRUE(pareto.more_is_better());
  EXPECT_EQ(setting(pareto, "acquisition=a").front, 1);
  EXPECT_EQ(setting(pareto, "acquisition=b").front, 2);
  EXPECT_EQ(setting(pareto, "acquisition=c").front, 0);
}

TEST(Pareto, NeverNamesASettingWithAJobThatFailedIsMissingOrHasNoValue) {
  const MadeUpJob failed{"failed", "2", 1, 0.001, 0.5, "failed"};
  const MadeUpJob absent{"absent", "2", 1, 0.001, 0.5, "absent"};
  const MadeUpJob unknown{"unknown", "2", 1, 0.001, 0.5, "done", false};
  const Pareto pareto = MadeUp({{"failed", "1", 1, 0.001},
                                failed,
                                {"failed", "3", 1, 0.001},
                                {"absent", "1", 1, 0.001},
                                absent,
                                {"absent", "3", 1, 0.001},
                                {"unknown", "1", 1, 0.001},
                                unknown,
                                {"unknown", "3", 1, 0.001},
                                {"good", "1", 9, 0.01},
                                {"good", "2", 9, 0.0101}})
                            .pareto();
  for (const char* name : {"acquisition=failed", "acquisition=absent", "acquisition=unknown"}) {
    EXPECT_EQ(setting(pareto, name).front, 0) << name;
    EXPECT_EQ(setting(pareto, name).error.count, 2U) << "shown all the same";
  }
  EXPECT_EQ(pareto.unfinished, 1);
  EXPECT_EQ(setting(pareto, "acquisition=good").front, 1);
  ASSERT_NE(cheapest_within(pareto, 0.02), nullptr);
  EXPECT_EQ(cheapest_within(pareto, 0.02)->name, "acquisition=good");
  const std::string table = pareto_table(pareto);
  for (const char* note : {"1 of 3 failed", "1 of 3 unfinished", "1 of 3 without a value"})
    EXPECT_THAT(table, HasSubstr(note));
}

TEST(Pareto, LeavesOutAValueThatIsNotFiniteAndSaysSo) {
  for (const double value : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    const Pareto pareto =
        MadeUp({{"a", "1", 1, value}, {"a", "2", 1, 0.001}, {"b", "1", 9, 0.01}, {"b", "2", 9, 0.02}}).pareto();
    EXPECT_EQ(setting(pareto, "acquisition=a").front, 0);
    EXPECT_EQ(setting(pareto, "acquisition=b").front, 1);
    EXPECT_EQ(cheapest_within(pareto, 1.0), &setting(pareto, "acquisition=b"));
    EXPECT_THAT(pareto_table(pareto), HasSubstr("1 of 2 without a value"));
  }
  const Scalar text{std::string("nan")};
  EXPECT_FALSE(number_of(&text).value) << "a text may say it, too";
}

TEST(Pareto, SaysHowManySeedsItsMeansAreOver) {
  const Pareto two = MadeUp({{"a", "1", 5, 0.010}, {"a", "2", 5, 0.012}, {"b", "1", 5, 0.02}}).pareto();
  EXPECT_THAT(pareto_table(two), HasSubstr("mean over 1 to 2 seeds, with its 95 % interval (Student's t)"));
  EXPECT_THAT(pareto_table(two), HasSubstr("only 1 seed: too few for an interval; run 10 or more\n"));
  const Pareto none = MadeUp({{"a", "1", 5, 0.010}, {"b", "1", 5, 0.02}}).pareto();
  EXPECT_THAT(pareto_table(none), HasSubstr("the seed is not swept: mean over jobs"));
  std::vector<MadeUpJob> many;
  for (int seed = 0; seed < 12; ++seed) many.push_back({"a", std::to_string(seed), 5, 0.01 + 0.001 * seed});
  EXPECT_THAT(pareto_table(MadeUp(many).pareto()), Not(HasSubstr("\nonly")));
  EXPECT_EQ(pareto_rows(MadeUp(many).pareto()).front().number("seeds"), 12.0);
}

TEST(Within, AsksForTheUpperEndOfTheInterval) {
  // 10 and 12 mm have the mean 11 mm and the half width 12.706 * 1 mm.
  const Pareto pareto = MadeUp({{"a", "1", 5, 0.010}, {"a", "2", 5, 0.012}}).pareto();
  EXPECT_EQ(cheapest_within(pareto, 0.0237), nullptr);
  EXPECT_NE(cheapest_within(pareto, 0.0238), nullptr);
}

TEST(Within, AsksForTheLowerEndWhereMoreIsBetter) {
  const Pareto pareto =
      MadeUp({{"a", "1", 5, 0, 0.80}, {"a", "2", 5, 0, 0.82}}).pareto("robot_seconds", "footprint_iou");
  EXPECT_EQ(cheapest_within(pareto, 0.69), nullptr) << "0.81 - 12.706 * 0.01 = 0.683";
  EXPECT_NE(cheapest_within(pareto, 0.68), nullptr);
}

TEST(Within, TakesTheCheapestAndOfEqualCostsTheBetter) {
  const Pareto pareto = MadeUp({{"dear", "1", 30, 0.001},
                                {"dear", "2", 30, 0.00101},
                                {"worse", "1", 10, 0.003},
                                {"worse", "2", 10, 0.0031},
                                {"better", "1", 10, 0.002},
                                {"better", "2", 10, 0.0021},
                                {"cheap", "1", 5, 0.009},
                                {"cheap", "2", 5, 0.0091}})
                            .pareto();
  EXPECT_EQ(cheapest_within(pareto, 0.005)->name, "acquisition=better");
  EXPECT_EQ(cheapest_within(pareto, 0.0005), nullptr);
  EXPECT_EQ(best_bounded(pareto)->name, "acquisition=dear");
}

TEST(Within, OneSeedIsNeverWithin) {
  const Pareto pareto = MadeUp({{"a", "1", 5, 0.0}}).pareto();
  EXPECT_EQ(cheapest_within(pareto, 1.0), nullptr);
  EXPECT_EQ(best_bounded(pareto), nullptr);
}

TEST(Within, EqualValuesAreNeverWithinBecauseTheyTellNothingOfTheNext) {
  const Pareto pareto = MadeUp({{"a", "1", 5, 0.001}, {"a", "2", 5, 0.001}, {"a", "3", 5, 0.001}}).pareto();
  EXPECT_FALSE(pareto.settings.front().error.interval);
  EXPECT_EQ(cheapest_within(pareto, 1.0), nullptr);
  EXPECT_EQ(best_bounded(pareto), nullptr);
  EXPECT_THAT(pareto_table(pareto), HasSubstr("1.00 [-]"));
  EXPECT_THAT(pareto_table(pareto),
              HasSubstr("a setting with equal values for all seeds has no interval: the values show no spread"));
}

TEST(Pareto, CountsCopiesOfARunOnceWhereTheSeedIsNotSwept) {
  std::vector<MadeUpJob> jobs{{"a", "1", 5, 0.01}, {"a", "1", 6, 0.02}, {"a", "1", 7, 0.04}};
  const MeanInterval once = *MadeUp(jobs).pareto().settings.front().error.interval;
  const std::vector<MadeUpJob> runs = jobs;
  for (int copy = 0; copy < 2; ++copy) jobs.insert(jobs.end(), runs.begin(), runs.end());
  const Pareto thrice = MadeUp(jobs).pareto();
  EXPECT_EQ(thrice.settings.front().error.clusters, 3U);
  EXPECT_NEAR(thrice.settings.front().error.interval->high, once.high, 1e-12);
  EXPECT_THAT(pareto_table(thrice), HasSubstr("the only setting: 6 of 9 jobs are copies of another run"));
}

TEST(Within, ReadsTheBoundInTheUnitOfTheError) {
  const MadeUp made({{"a", "1", 5, 0.01}});
  EXPECT_EQ(read_bound(made.pareto(), "5mm"), 0.005);
  EXPECT_EQ(read_bound(made.pareto("robot_seconds", "footprint_iou"), "0.8"), 0.8);
  EXPECT_EQ(made.refusal("robot_seconds", "rmse_m", "5"),
            "command line: --within: '5' has no unit, write a length like '1.7 cm'");
  EXPECT_EQ(made.refusal("robot_seconds", "rmse_m", "5 s"),
            "command line: --within: '5 s' is a time, not a length, write a length like '1.7 cm'");
  EXPECT_EQ(made.refusal("robot_seconds", "footprint_iou", "80 %"),
            "command line: --within: '80 %' is not a plain number, write it without a unit");
}

TEST(Pareto, RefusesColumnsThatCannotBeCompared) {
  const MadeUp made({{"a", "1", 5, 0.01}});
  EXPECT_EQ(made.refusal("robot_second", "rmse_m"),
            "command line: --cost: results.csv has no column 'robot_second', did you mean 'robot_seconds'?");
  EXPECT_EQ(made.refusal("robot_seconds", "rmse"),
            "command line: --error: results.csv has no column 'rmse', did you mean 'rmse_m'?");
  EXPECT_EQ(made.refusal("status", "rmse_m"),
            "command line: --cost: the column 'status' holds done, not numbers, name a column of numbers");
  EXPECT_EQ(made.refusal("robot_seconds", "coverage_95"),
            "command line: --error: coverage_95 is best at 0.95, not at its least or greatest value, use nlpd, which "
            "rates heights and intervals together");
  EXPECT_EQ(made.refusal("footprint_iou", "rmse_m"),
            "command line: --cost: more of footprint_iou is better, so it is not a cost, use it with --error");
  EXPECT_EQ(MadeUp({{"a", "1", 1, 1, 0.5, "absent"}}).refusal("robot_seconds", "rmse_m"),
            "runs/x/0123456789ab: no job of this sweep has ended, run it with 'palpate resume'");
}

TEST(Pareto, ComparesSweptNumbersAndFlagsToo) {
  const Pareto pareto = MadeUp({{"a", "1", 5, 0.01, 0.0}, {"a", "2", 5, 0.01, 0.5}}).pareto("taps", "found");
  EXPECT_EQ(pareto.settings.front().cost.mean, 17.0);
  EXPECT_EQ(pareto.settings.front().error.mean, 0.5);
  EXPECT_TRUE(pareto.more_is_better());
}

TEST(ParetoTable, AlignsItsColumnsAndChoosesReadableUnits) {
  const Pareto pareto =
      MadeUp({{"weighted", "1", 0.0101, 0.030}, {"weighted", "2", 0.0099, 0.032}, {"a", "1", 0.2, 0.01}}).pareto();
  EXPECT_EQ(pareto_table(pareto).substr(0, pareto_table(pareto).find("mean over")),
            "front  setting               jobs  robot_seconds [ms]        rmse_m [mm]\n"
            "    1  acquisition=weighted     2         10.0 +- 1.3  31.0 [18.3, 43.7]\n"
            "    2  acquisition=a            1          200.0 +- -           10.0 [-]\n");
}

TEST(ParetoScript, QuotesEveryNameSoThatNothingInItIsACommand) {
  const std::string evil = "x'; system(\"touch /tmp/owned\"); `touch owned` @macro\nset output";
  EXPECT_EQ(gnuplot_text("it's"), "'it''s'");
  const std::string script =
      pareto_script(MadeUp({{evil, "1", 5, 0.01}, {"b", "1", 6, 0.002}}).pareto(), evil, 0.005, nullptr);
  EXPECT_THAT(script, Not(HasSubstr("\nset output")));
  EXPECT_THAT(script, Not(HasSubstr("x'; ")));
  EXPECT_THAT(script, HasSubstr("x''; system("));
}

/// Returns the front of two strategies on an easy scene and on a hard one, where each is worse than both on the easy
/// one.
Pareto on_two_scenes(const char* where = nullptr) {
  static Sweep sweep{"runs/x/0123456789ab", {"acquisition", "scene", "seed"}, {}};
  static std::vector<Row> results;
  sweep.jobs.clear();
  results.clear();
  for (const char* scene : {"cube", "ring"}) {
    for (const char* strategy : {"a", "b"}) {
      for (const int seed : {1, 2}) {
        const double hard = scene == std::string_view("ring") ? 1.0 : 0.0;
        const double slow = strategy == std::string_view("b") ? 1.0 : 0.0;
        const auto index = static_cast<int>(sweep.jobs.size());
        sweep.jobs.push_back({index, "id", {strategy, scene, std::to_string(seed)}});
        Row row;
        row.add("job", index);
        row.add("status", "done");
        row.add("rmse_m", 0.1 + hard - 0.05 * slow + 0.001 * seed);
        row.add("robot_seconds", 10.0 + 10.0 * hard + slow + 0.1 * seed);
        results.push_back(std::move(row));
      }
    }
  }
  if (where == nullptr) return make_pareto(sweep, results, "robot_seconds", "rmse_m");
  const WhereCondition condition(Tree::scalar(where, true));
  return make_pareto(sweep, results, "robot_seconds", "rmse_m", &condition);
}

TEST(ParetoOfScenes, HasAFrontOfEachAndNoneOfSeveral) {
  const Pareto made = on_two_scenes();
  EXPECT_EQ(made.scenes, (std::vector<std::string>{"scene=cube", "scene=ring"}));
  ASSERT_EQ(made.settings.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(made.settings[i].scene, i / 2);
    EXPECT_EQ(made.settings[i].front, static_cast<int>(i % 2) + 1)
        << "the easy scene beats no strategy on the hard one";
  }
  EXPECT_THAT(pareto_table(made), HasSubstr("\n2 scenes, each with its own front\n"));
  const std::string script = pareto_script(made, "two", {}, nullptr);
  EXPECT_THAT(script, AllOf(HasSubstr("'front: scene=cube'"), HasSubstr("'front: scene=ring'")));
}

TEST(ParetoOfScenes, ChoosesWithinABoundOnOneSceneAlone) {
  EXPECT_EQ(test::error_of([] { read_bound(on_two_scenes(), "2 m"); }),
            "command line: --within: the sweep has 2 scenes, whose best settings may differ, choose one: --where "
            "\"scene == cube\"");
  const Pareto ring = on_two_scenes("scene == ring");
  EXPECT_EQ(ring.settings.size(), 2U);
  const Setting* const cheapest = cheapest_within(ring, read_bound(ring, "2 m"));
  ASSERT_NE(cheapest, nullptr);
  EXPECT_EQ(cheapest->name, "acquisition=a, scene=ring");
}

}  // namespace
}  // namespace palpate
