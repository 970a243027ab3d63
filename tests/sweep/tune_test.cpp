// SPDX-License-Identifier: MIT
// Tuning: its description, the space of its settings, and the jobs of its first round.
#include "tune/tuner.hpp"

#include "record/json.hpp"
#include "tune/race_report.hpp"

#include "config/quantity.hpp"
#include "config/yaml.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace palpate {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

const fs::path kConfigs = test::source_folder() / "configs";
const fs::path kPaper = kConfigs / "paper/object_i.yaml";

TuneWords words(std::vector<std::string> keys, const std::string& jobs = "400") {
  return {std::move(keys), {}, {{"metric", "rmse_m"}, {"jobs", jobs}}};
}

TuneDescription described(const std::string& yaml) {
  const Tree config = parse_yaml("tune: " + yaml, "c.yaml");
  return {config.find("tune"), {}};
}

std::string refused(const std::string& yaml) {
  return test::error_of([&] { described(yaml); });
}

struct Planned {
  SweepPlan plan;
  std::vector<ResolvedConfig> configs;
};

Planned planned(const TuneDescription& description, const fs::path& file = kPaper, std::size_t budget = 400) {
  Composer composer(kConfigs, config_keys());
  const TunePlanner planner(composer, test::shared_host(), file, description);
  Planned out;
  out.plan = plan_first_round(planner, budget, "runs",
                              [&](const Job&, const ResolvedConfig& config) { out.configs.push_back(config); });
  return out;
}

double length_scale(const ResolvedConfig& config) {
  return read_quantity(*config.tree.find_path("kernel.length_scale"), "length_scale", Unit::metre);
}

std::vector<std::string> values(const SweepPlan& plan, std::size_t key) {
  std::vector<std::string> out;
  for (const Job& job : plan.sweep.jobs) out.push_back(job.values[key]);
  return out;
}

TEST(TuneDescription, RejectsWhatCannotBeTunedInOneLineWithTheRemedy) {
  const std::string rest = ", metric: rmse_m, jobs: 100}";
  EXPECT_EQ(
      refused("{keys: {scene: [block, ring]}" + rest),
      "c.yaml:1:22: tune: 'scene' changes the scene and with it the meaning of the metric, tune over several scenes "
      "with --over block,ring");
  EXPECT_EQ(
      refused("{keys: {seed: [1, 2]}" + rest),
      "c.yaml:1:21: tune: the seeds are chosen by 'palpate tune', give one value, for example seed=1000: the first "
      "seed");
  EXPECT_EQ(refused("{keys: {taps: []}" + rest),
            "c.yaml:1:21: taps: the list of values is empty, write [value, value]");
  EXPECT_EQ(refused("{keys: {taps: \"uniform(5, 5)\"}" + rest),
            "c.yaml:1:21: taps: 'uniform(5, 5)' is not a range, the first end must be below the last");
  EXPECT_THAT(refused("{keys: {taps: 5}" + rest), StartsWith("c.yaml:1:14: tune.keys: no key has several values"));
  EXPECT_THAT(refused("{keys: {name: [a, b]}" + rest), HasSubstr("'name' cannot be tuned"));
  EXPECT_THAT(refused("{metric: rmse_m, jobs: 100}"), HasSubstr("tune.keys: expects a map of keys"));
  EXPECT_THAT(refused("{keys: {taps: [5, 6]}, jobs: 100}"), HasSubstr("no metric is given, add --metric rmse_m"));
  EXPECT_EQ(refused("{keys: {taps: [5, 6]}, metric: rmse, jobs: 100}"),
            "c.yaml:1:38: tune.metric: no summary has a field 'rmse', did you mean 'rmse_m'?");
  EXPECT_THAT(refused("{keys: {taps: [5, 6]}, metric: coverage_95, jobs: 100}"),
              HasSubstr("neither less nor more of 'coverage_95' is better"));
  EXPECT_THAT(refused("{keys: {taps: [5, 6]}, metric: rmse_m}"), HasSubstr("no budget is given"));
  EXPECT_THAT(refused("{keys: {taps: [5, 6]}, metric: rmse_m, jobs: 9, time: 1 s}"), HasSubstr("exclude each other"));
  EXPECT_THAT(refused("{keys: {taps: [5, 6]}, metric: rmse_m, jobs: 9, within: 3 s}"), HasSubstr("tune.within"));
  EXPECT_THAT(refused("{keys: {taps: [5, 6]}, metric: rmse_m, jobs: 9, fresh: 1}"),
              HasSubstr("tune.fresh: so few seeds"));
  EXPECT_EQ(refused("{keyz: {}}"), "c.yaml:1:8: unknown option 'keyz' of tune, did you mean 'keys'?");
}

TEST(TuneDescription, OfTheCommandLineReplacesThatOfTheConfigKeyByKey) {
  const Tree config =
      parse_yaml("tune: {keys: {taps: [5, 6], kernel: [rbf, matern52]}, metric: nlpd, time: 1 h}", "c.yaml");
  const TuneDescription both(config.find("tune"), words({"taps=7,8,9", "seed=50"}));
  ASSERT_THAT(both.keys, SizeIs(2));
  EXPECT_THAT(both.keys[0].values, SizeIs(3));
  EXPECT_EQ(both.metric, "rmse_m");
  EXPECT_EQ(both.jobs, 400U);
  EXPECT_FALSE(both.seconds);
  const TuneDescription again(&both.written, {});
  EXPECT_EQ(again.written.canonical(), both.written.canonical());
  EXPECT_THAT(again.job_keys(), ElementsAre("taps", "kernel", "seed"));
}

TEST(SearchSpace, ReturnsTheCoordinateOfEachOfItsValues) {
  const TuneDescription description(nullptr, words({"kernel.length_scale=log_uniform(5mm,10cm)", "taps=uniform(5,20)",
                                                    "kernel=rbf,matern52", "belief.label.noise=uniform(0,1)"}));
  const SearchSpace space(description.keys, {false, true, false, false});
  for (const Point& point : space.sobol(64)) {
    for (std::size_t key = 0; key < point.size(); ++key) {
      const Tree value = space.value(key, point[key]);
      const std::optional<double> again = space.coordinate(key, value.text);
      ASSERT_TRUE(again) << value.text;
      EXPECT_NEAR(*again, point[key], key == 1 ? 0.5 / 15.0 : 1e-5) << value.text;
    }
  }
  EXPECT_EQ(space.value(0, 0.0).text, "5 mm");
  EXPECT_EQ(space.value(0, 1.0).text, "100 mm");
  EXPECT_NEAR(*space.coordinate(0, "2 cm"), std::log(4.0) / std::log(20.0), 1e-9) << "another unit";
  EXPECT_EQ(space.coordinate(0, "1 m"), 1.0) << "clipped";
  EXPECT_EQ(space.coordinate(0, "2 s"), std::nullopt);
  EXPECT_EQ(space.coordinate(2, "sum"), std::nullopt);
}

TEST(SearchSpace, DistinguishesATypeWithOptionsFromItsName) {
  const TuneDescription description =
      described("{keys: {kernel: [{type: matern52, length_scale: 1.8 cm}, matern52]}, metric: rmse_m, jobs: 99}");
  const SearchSpace space(description.keys, {false});
  EXPECT_EQ(space.coordinate(0, "matern52"), 1.0);
  EXPECT_EQ(space.coordinate(0, value_text(space.value(0, 0.0))), 0.0);
}

TEST(SearchSpace, ComparesTheValuesOfAListAsQuantities) {
  const TuneDescription description =
      described("{keys: {kernel.length_scale: [3 cm, 17 mm, 0.2 m], taps: [5, 1e1]}, metric: rmse_m, jobs: 99}");
  const SearchSpace space(description.keys, {false, false});
  EXPECT_EQ(space.coordinate(0, "1.7 cm"), 1.0) << "as the config of the paper has it";
  EXPECT_EQ(space.coordinate(0, "1.7 s"), std::nullopt);
  EXPECT_EQ(space.coordinate(0, "18 mm"), std::nullopt);
  EXPECT_EQ(space.coordinate(1, "10"), 1.0);
  EXPECT_EQ(description.keys[0].position("200 mm"), 2.0) << "the page";
}

TEST(SearchSpace, DrawsNeighboursWithinTheRanges) {
  const TuneDescription description(nullptr,
                                    words({"kernel.length_scale=log_uniform(5mm,10cm)", "kernel=rbf,matern52"}));
  const SearchSpace space(description.keys, {false, false});
  Random random(1, "neighbours");
  double squares = 0.0;
  int other = 0;
  for (int i = 0; i < 4000; ++i) {
    const Point near = space.near({0.5, 0.0}, 0.02, random);
    squares += (near[0] - 0.5) * (near[0] - 0.5) / 4000.0;
    other += near[1] == 1.0 ? 1 : 0;
    const Point edge = space.near({0.0, 1.0}, 0.5, random);
    EXPECT_GE(edge[0], 0.0);
    EXPECT_LE(edge[0], 1.0);
  }
  // The scales 0.5, 1 and 2 have the mean square 1.75.
  EXPECT_NEAR(std::sqrt(squares), 0.02 * std::sqrt(1.75), 0.001);
  EXPECT_NEAR(other / 4000.0, 0.05, 0.015) << "drawn anew in one of ten, of which half are equal";
}

TEST(FirstRound, RunsTheConfigAsItStandsAndSettingsOfTheWholeRangeOnFourSeeds) {
  const Planned made = planned(TuneDescription(
      nullptr, words({"kernel.length_scale=log_uniform(5mm,10cm)", "acquisition=weighted,uncertainty"})));
  const SweepPlan& plan = made.plan;
  EXPECT_THAT(plan.sweep.jobs, SizeIs(4 * 32));
  EXPECT_EQ(plan.sweep.jobs[0].values, (std::vector<std::string>{"1.7 cm", "weighted", "1"}));
  EXPECT_EQ(plan.sweep.jobs[0].id, test::shipped_config("paper/object_i.yaml", {"log.surface=false"}).id)
      << "the run that `palpate run` makes";
  std::vector<double> lengths;
  for (std::size_t i = 0; i < 32; ++i) lengths.push_back(length_scale(made.configs[i]));
  std::sort(lengths.begin(), lengths.end());
  EXPECT_LT(lengths.front(), 0.007);
  EXPECT_GT(lengths.back(), 0.08);
  const std::vector<std::string> seeds = values(plan, 2);
  EXPECT_EQ(std::set<std::string>(seeds.begin(), seeds.end()), (std::set<std::string>{"1", "2", "3", "4"}));
}

TEST(FirstRound, FindsOutThatAnOptionTakesWholeNumbers) {
  const Planned made = planned(TuneDescription(nullptr, words({"taps=uniform(5,20)", "initial.count=uniform(1,4)"})));
  for (const ResolvedConfig& one : made.configs) EXPECT_LE(one.options.taps, 20);
  EXPECT_THAT(values(made.plan, 1), Contains("4"));
}

TEST(FirstRound, AlternatesScenesFromSeedToSeed) {
  TuneWords given = words({"kernel.length_scale=2cm,3cm"}, "40");
  given.scenes = {"block", "ring"};
  const Planned made = planned(TuneDescription(nullptr, given), kConfigs / "default.yaml");
  EXPECT_THAT(values(made.plan, 0), ElementsAre("block", "block", "ring", "ring", "block", "block", "ring", "ring"))
      << "3 cm is the config as it stands";
}

TEST(FirstRound, LeavesOutSettingsThatViolateTheCondition) {
  TuneWords given = words({"kernel.length_scale=log_uniform(5mm,10cm)"});
  given.settings.emplace_back("where", "kernel.length_scale > 3 cm");
  const Planned made = planned(TuneDescription(nullptr, given));
  for (std::size_t i = 1; i < 32; ++i) EXPECT_GT(length_scale(made.configs[i]), 0.03);
}

TEST(FirstRound, JudgesTheConditionByTheOptionsOfEachSetting) {
  const Planned made =
      planned(described("{keys: {kernel: [{type: matern52, length_scale: 5 cm}, {type: rbf, length_scale: 1 cm}]}, "
                        "metric: rmse_m, jobs: 99, "
                        "where: kernel.length_scale < 2 cm}"));
  ASSERT_THAT(made.configs, SizeIs(8));
  EXPECT_DOUBLE_EQ(length_scale(made.configs[1]), 0.01);
}

TEST(FirstRound, IsRejectedIfNoSettingDiffersFromTheConfigOrTwoLookAlike) {
  TuneWords given = words({"taps=10,12"});
  given.settings.emplace_back("where", "taps > 100");
  EXPECT_THAT(test::error_of([&] { planned(TuneDescription(nullptr, given)); }),
              HasSubstr("no setting differs from the config as it stands"));
  const test::TemporaryFolder folder;
  std::string gentle = test::text_of(kPaper);
  const std::string group = "  - backend: simulator\n";
  gentle.insert(gentle.find(group) + group.size(), "  - motion: gentle\n");
  const fs::path file = folder.write("gentle.yaml", gentle);
  EXPECT_THAT(test::error_of([&] { planned(TuneDescription(nullptr, words({"motion=continuous,two_stage"})), file); }),
              HasSubstr("two settings have the same type, but different options"));
}

TEST(FirstRound, ChecksAllScenesBeforeTheRace) {
  TuneWords given = words({"kernel.length_scale=2cm,4cm"}, "40");
  given.scenes = {"block", "ring", "block", "ring", "nonsense"};
  EXPECT_THAT(test::error_of([&] { planned(TuneDescription(nullptr, given), kConfigs / "default.yaml"); }),
              HasSubstr("nonsense"));
  given.scenes = {"block", "ring"};
  given.keys.emplace_back("scene=block");
  EXPECT_THAT(test::error_of([&] { TuneDescription(nullptr, given); }), HasSubstr("leave one of them out"));
}

TEST(FirstRound, IsRejectedIfTheBudgetDoesNotSuffice) {
  const auto line = [](const std::string& key, std::size_t budget) {
    return test::error_of([&] { planned(TuneDescription(nullptr, words({key})), kPaper, budget); });
  };
  EXPECT_EQ(
      line("kernel.length_scale=1cm,2cm,3cm", 15),
      "tune: 15 jobs are fewer than the first round needs: 4 settings on 4 seeds, give at least 16, more time, or "
      "fewer values");
  EXPECT_EQ(line("kernel.length_scale=uniform(1cm,2cm)", 59),
            "tune: 59 jobs are too few for a search in continuous ranges, give at least 60, more time, or "
            "lists of values");
  EXPECT_THAT(line("kernel.lenght_scale=1cm,2cm", 100), HasSubstr("did you mean 'length_scale'?"));
  EXPECT_THAT(line("belief.height.noise=3", 100), HasSubstr("no key has several values"));
}

TEST(ReadRace, RejectsARoundThatDoesNotFitItsSettings) {
  const TuneDescription description(nullptr, words({"kernel.length_scale=1cm,2cm,3cm"}));
  const Sweep good = planned(description).plan.sweep;
  EXPECT_THAT(read_race(good, description).settings, SizeIs(4));
  const auto line = [&](const std::string& field, const Scalar& value) {
    Sweep bad = good;
    for (auto& [name, old] : bad.rounds.front().decision.fields) {
      if (name == field) old = value;
    }
    return test::error_of([&] { read_race(bad, description); });
  };
  for (const char* const racing : {"[]", "[1, 1]", "[2, 1]", "[4]", "[-1]"})
    EXPECT_THAT(line("racing", JsonList{racing}), HasSubstr("a round has no valid 'racing'")) << racing;
  for (const std::int64_t seeds : {0, 1, 5, 1000})
    EXPECT_THAT(line("seeds", seeds), HasSubstr("a round has no valid 'seeds'")) << seeds;
  EXPECT_THAT(line("stage", std::int64_t{7}), HasSubstr("a round has no valid 'stage'"));
}

TEST(ReadRace, NamesTheStageThatDidNotTakeASetting) {
  const TuneDescription description(nullptr, words({"kernel.length_scale=1cm,2cm,3cm"}));
  Sweep sweep = planned(description).plan.sweep;
  SweepRound next = sweep.rounds.front();
  for (auto& [name, value] : next.decision.fields) {
    if (name == "stage") value = std::int64_t{2};
    if (name == "racing") value = JsonList{"[0, 3]"};
    if (name == "dropped") value = JsonList{R"([{"setting": 1, "seeds": 4, "difference": 0.002, "p": 0.01}])"};
  }
  sweep.rounds.push_back(next);
  next.decision.erase("stage");
  next.decision.add("stage", std::int64_t{3});
  sweep.rounds.push_back(next);
  const RaceRecord race = read_race(sweep, description);
  const RaceValues values{std::vector<std::optional<double>>(16, 0.01), {}};
  const RaceResults results(sweep, description, race, values);
  EXPECT_EQ(remark_about(results, 0), "config as it stands");
  EXPECT_EQ(remark_about(results, 1), "lost after 4 seeds: 2.0 mm worse, p 0.01");
  EXPECT_EQ(remark_about(results, 2), "not taken into stage 2");
  EXPECT_EQ(remark_about(results, 3), "");
  const std::vector<Row> rows = race_rows(results);
  EXPECT_EQ(rows[2].number("lost_after_seeds"), 4.0);
  EXPECT_EQ(rows[2].number("p"), std::nullopt);
  EXPECT_EQ(rows[3].number("lost_after_seeds"), std::nullopt);
}

TEST(RaceResults, HaveNoGainBeforeTheRunsOnFreshSeedsHaveEnded) {
  const TuneDescription description(nullptr, words({"kernel.length_scale=1cm,2cm,3cm"}));
  Sweep sweep = planned(description).plan.sweep;
  RaceRecord race = read_race(sweep, description);
  RaceValues values;
  read_results(sweep, description, values);
  EXPECT_EQ(values.unfinished, 16U);
  race.end = "one setting is left";
  race.front = {1};
  race.settings[0].fresh = {0, 1, 2, 3};
  race.settings[1].fresh = {4, 5, 6, 7};
  const RaceResults during(sweep, description, race, values);
  EXPECT_EQ(fresh_words(during), "the runs on fresh seeds have not ended");
  EXPECT_EQ(during.gain.count, 0U);
  EXPECT_TRUE(during.is_best(1));
  for (std::size_t job = 0; job < 16; ++job) values.metric[job] = job < 4 ? 0.012 : 0.01;
  values.unfinished = 0;
  const RaceResults after(sweep, description, race, values);
  EXPECT_THAT(fresh_words(after), StartsWith("gain over the config as it stands, on 4 seeds"));
}

TEST(FirstRound, CanBePlannedAgainFromTheConfigThatItWrites) {
  const test::TemporaryFolder folder;
  const TuneDescription description(nullptr, words({"kernel.length_scale=log_uniform(5mm,10cm)", "kernel=rbf,matern52",
                                                    "belief.label.noise=0.01,0.1", "seed=77"}));
  const Planned first = planned(description);
  const fs::path file = folder.write("config.yaml", to_yaml(first.plan.config));
  const Tree written = read_yaml(file);
  const TuneDescription again(written.find("tune"), {});
  const Planned second = planned(again, file);
  ASSERT_THAT(second.plan.sweep.jobs, SizeIs(first.plan.sweep.jobs.size()));
  for (std::size_t i = 0; i < first.plan.sweep.jobs.size(); ++i)
    EXPECT_EQ(second.plan.sweep.jobs[i].id, first.plan.sweep.jobs[i].id) << i;
  EXPECT_EQ(second.plan.sweep.directory, first.plan.sweep.directory);
}

}  // namespace
}  // namespace palpate
