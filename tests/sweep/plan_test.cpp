// SPDX-License-Identifier: MIT
// Plans of the shipped configs: each job equals a single run with the same options.
#include "sweep/plan.hpp"

#include "config/yaml.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <boost/algorithm/string/replace.hpp>

#include <gtest/gtest.h>

#include <algorithm>

namespace palpate {
namespace {

namespace fs = std::filesystem;

using Texts = std::vector<std::string>;

const fs::path kConfigs = test::source_folder() / "configs";
const fs::path kPaper = kConfigs / "paper/object_i.yaml";

struct Planned {
  SweepPlan plan;
  std::vector<ResolvedConfig> configs;  ///< by job, as passed to the sink
};

Planned planned(const fs::path& file, const Texts& words) {
  Composer composer(kConfigs, config_keys());
  Planned out;
  out.plan = plan_sweep(composer, test::shared_host(), file, words, "runs", [&](const Job& job, const auto& config) {
    EXPECT_EQ(config.id, job.id);
    out.configs.push_back(config);
  });
  return out;
}

SweepPlan plan_of(const Texts& words) { return planned(kPaper, words).plan; }

Texts ids(const SweepPlan& plan) {
  Texts out;
  for (const Job& job : plan.sweep.jobs) out.push_back(job.id);
  return out;
}

std::string refused(const Texts& words) {
  return test::error_of([&] { plan_of(words); });
}

/// Returns the swept values, one line per job.
Texts rows(const SweepPlan& plan) {
  Texts out;
  for (const Job& job : plan.sweep.jobs) {
    std::string line;
    for (const std::string& value : job.values) line += (line.empty() ? "" : "|") + value;
    out.push_back(line);
  }
  return out;
}

TEST(Plan, GivesEveryJobTheConfigOfASingleRunWhereverTheSeedStands) {
  for (const Texts& words :
       {Texts{"seed=range(0,5)", "acquisition=weighted,random"},
        Texts{"acquisition=weighted,random", "seed=range(0,5)"}, Texts{"sweep.zip={seed: [1, 2], taps: [12, 17]}"},
        Texts{"sweep.list=[{seed: [5, 6]}, {taps: 12, seed: [3, 4]}, {}, {taps: 9}]"},
        Texts{"seed=range(0,3)", "taps=10,11"}}) {
    const Planned out = planned(kPaper, words);
    ASSERT_GE(out.configs.size(), 2U);
    for (std::size_t i = 0; i < out.configs.size(); ++i) {
      Texts single{"log.surface=false"};
      for (std::size_t key = 0; key < out.plan.sweep.keys.size(); ++key)
        single.push_back(out.plan.sweep.keys[key] + "=" + out.plan.sweep.jobs[i].values[key]);
      EXPECT_EQ(to_yaml(out.configs[i].tree), to_yaml(test::shipped_config("paper/object_i.yaml", single).tree)) << i;
    }
  }
}

TEST(Plan, LeavesOutOptionsThatAPluginLacksAndTakesEqualJobsForOne) {
  const SweepPlan plan = plan_of({"kernel=rbf,rational_quadratic,matern52", "kernel.alpha=1,2", "seed=1,2"});
  EXPECT_EQ(rows(plan), (Texts{"rbf||1", "rbf||2", "rational_quadratic|1|1", "rational_quadratic|1|2",
                               "rational_quadratic|2|1", "rational_quadratic|2|2", "matern52||1", "matern52||2"}));
  for (std::size_t i = 0; i < plan.sweep.jobs.size(); ++i) EXPECT_EQ(plan.sweep.jobs[i].index, static_cast<int>(i));
  EXPECT_EQ(plan.sweep.jobs[0].id, test::shipped_config("paper/object_i.yaml", {"kernel=rbf", "seed=1"}).id);
  EXPECT_EQ(plan.sweep.jobs[5].id,
            test::shipped_config("paper/object_i.yaml", {"kernel=rational_quadratic", "kernel.alpha=2", "seed=2"}).id);
}

TEST(Plan, LeavesOutOptionsOfAChoiceInTheConfigThatTheCommandLineNames) {
  const test::TemporaryFolder folder;
  const fs::path file =
      folder.write("c.yaml",
                   "defaults: [kernel: rbf, acquisition: weighted, fitting: fixed, backend: simulator, "
                   "scene: object_i]\nsweep: {grid: {acquisition: [grid, random]}}\n");
  EXPECT_EQ(rows(planned(file, {"acquisition.count=3,4"}).plan), (Texts{"grid|3", "grid|4", "random|"}));
}

TEST(Plan, LeavesOutOptionsOfMotionsAndOfWholeGroups) {
  EXPECT_EQ(rows(plan_of({"motion=paper,two_stage,continuous", "motion.back_off=1cm,3cm"})),
            (Texts{"paper|", "two_stage|1cm", "two_stage|3cm", "continuous|"}));
}

TEST(Plan, CountsAnOptionThatAnotherProcessTakesOverAsTakingPart) {
  const SweepPlan plan = plan_of({"kernel=rbf,rational_quadratic", "kernel.alpha=1,2",
                                  "belief.height.kernel={type: rational_quadratic, length_scale: 2 cm}"});
  EXPECT_EQ(rows(plan).size(), 4U) << "the heights have alpha whatever the shared kernel is";
  EXPECT_EQ(rows(plan)[0].substr(0, 6), "rbf|1|");
}

TEST(Plan, RefusesAnOptionThatNoJobHas) {
  EXPECT_EQ(refused({"acquisition=weighted,grid", "acquisition.cuont=1,2"}),
            "command line: no job of the sweep has an option 'acquisition.cuont', did you mean 'count'?");
  EXPECT_EQ(refused({"acquisition=weighted,random", "acquisition.beta=1,2"}),
            "command line: no job of the sweep has an option 'acquisition.beta', remove it");
  EXPECT_EQ(refused({"motion=paper,two_stage", "motion.spede=1cm/s,2cm/s"}),
            "command line: no job of the sweep has an option 'motion.spede', did you mean 'speed'?");
  EXPECT_NE(refused({"acquisition.beta=1,2"}).find("unknown option 'beta'"), std::string::npos);
}

TEST(Plan, RefusesJobsThatAreTheSameRunForAnotherReason) {
  const std::string same = " of the sweep are the same run";
  const std::string twice = ", a value occurs twice: write it once";
  const auto differ = [](const std::string& key) {
    return " though they differ in " + key +
           ", this has no effect there: remove it, or values that are written differently but equal";
  };
  const auto ends = [&](const Texts& words, const std::string& jobs, const std::string& why) {
    EXPECT_EQ(refused(words), kPaper.string() + ": jobs " + jobs + same + why);
  };
  ends({"seed=1,1"}, "0 and 1", twice);
  ends({"name=a,b"}, "0 and 1", differ("name"));
  ends({"log.maps=true,false", "seed=1,2", "belief.engine.threads=1,2"}, "0 and 1", differ("belief.engine.threads"));
  ends({"kernel.length_scale=1cm,10mm"}, "0 and 1", differ("kernel.length_scale"));
  ends({"acquisition=grid,weighted,weighted", "acquisition.count=3,4"}, "2 and 3", twice);
  ends({"acquisition=weighted,grid", "acquisition.count=3,4,3"}, "1 and 3", twice);
  ends({"sweep.list=[{taps: 12}, {taps: 12}]"}, "0 and 1", twice);
}

TEST(Plan, DropsUnwantedCombinationsBeforeTheyAreResolved) {
  const Texts words{"taps=2,5", "initial.count=1,4"};
  EXPECT_NE(refused(words).find("the budget is smaller"), std::string::npos);
  Texts with = words;
  with.emplace_back("sweep.where=initial.count <= taps");
  EXPECT_EQ(rows(plan_of(with)), (Texts{"2|1", "5|1", "5|4"}));
}

TEST(Plan, AsksTheConfigForNamesThatAreNotSwept) {
  EXPECT_EQ(rows(plan_of({"seed=1,2", "sweep.where=kernel == rbf and taps == 17"})).size(), 2U);
  EXPECT_EQ(rows(plan_of({"seed=1,2", "sweep.where=belief.surface == single or seed == 1"})).size(), 2U)
      << "a default that the config does not write";
  EXPECT_EQ(rows(plan_of({"seed=1,2", "sweep.where=kernel.length_scale == 17 mm and seed < 2"})).size(), 1U);
  EXPECT_EQ(refused({"seed=1,2", "sweep.where=surfaces == single"}).substr(0, 86),
            "command line: the condition 'surfaces == single' has the unknown name 'surfaces', know");
}

TEST(Plan, DoesNotAskTheConfigForWhatASweptStrategyDecides) {
  EXPECT_EQ(
      refused({"strategy=random,weighted", "sweep.where=belief.surface == single"}),
      "command line: 'belief.surface' depends on 'strategy', which is swept, sweep it too, or compare 'strategy'");
  EXPECT_EQ(rows(plan_of({"strategy=random,weighted", "sweep.where=taps == 17"})).size(), 2U);
}

TEST(Plan, RefusesASweepOfNothing) {
  EXPECT_EQ(refused({}), kPaper.string() + ": nothing to sweep, give KEY=V1,V2 or a 'sweep:' in the config");
  EXPECT_EQ(
      refused({"seed=1,2,3", "sweep.where=seed > 3"}),
      "command line: sweep.where: matches none of the 3 combinations, relax the condition, or sweep other values");
}

TEST(Plan, SaysWhatAJobHasWhereOtherItemsOfAListSayIt) {
  const SweepPlan plan =
      plan_of({"sweep.list=[{taps: 12}, {acquisition: grid, acquisition.count: [3, 4]}, {belief.surface: two_part}]"});
  EXPECT_EQ(plan.sweep.keys, (Texts{"taps", "acquisition", "acquisition.count", "belief.surface"}));
  EXPECT_EQ(rows(plan),
            (Texts{"12|weighted||single", "17|grid|3|single", "17|grid|4|single", "17|weighted||two_part"}));
}

struct RoundTrip {
  fs::path file;
  Texts words;
};

/// Checks that planning the config of a plan gives the same plan.
void expect_same_plan(const RoundTrip& one) {
  const test::TemporaryFolder elsewhere;
  const SweepPlan first = planned(one.file, one.words).plan;
  const SweepPlan again = planned(elsewhere.write("config.yaml", to_yaml(first.config)), {}).plan;
  SCOPED_TRACE(one.file.string() + (one.words.empty() ? "" : " " + one.words.front()) + "\n" + to_yaml(first.config) +
               to_yaml(again.config));
  EXPECT_EQ(ids(again), ids(first));
  EXPECT_EQ(rows(again), rows(first));
  EXPECT_EQ(again.sweep.directory, first.sweep.directory);
}

TEST(Plan, WritesAConfigThatMakesTheSameSweepAgain) {
  const std::vector<RoundTrip> cases{
      {"paper/object_i.yaml", {"seed=range(0,3)", "taps=12,17"}},
      {"paper/object_i.yaml", {"kernel=rbf,matern52,rational_quadratic", "kernel.alpha=1,2"}},
      {"paper/object_i.yaml", {"motion=paper,two_stage,adaptive", "motion.speed=3cm/s,6cm/s"}},
      {"paper/object_i.yaml", {"motion.type=two_stage,continuous,paper"}},
      {"paper/object_i.yaml", {"candidates.spacing=5 mm,1 cm", "candidates.count=none"}},
      {"paper/object_i.yaml", {"scene=object_i,two_blocks,cone", "fitting=fixed,ceres"}},
      {"paper/object_i.yaml", {"belief.height.kernel=matern32,rbf", "kernel.length_scale=2cm,3cm"}},
      {"paper/object_i.yaml", {"sweep.zip={taps: [12, 17], acquisition: [random, grid]}", "seed=1,2"}},
      {"paper/object_i.yaml",
       {"sweep.list=[{acquisition: random}, {acquisition: grid, acquisition.count: [3, 4]}, {taps: 9}]", "seed=1,2",
        "sweep.where=not (seed == 1 and taps == 9)"}},
      {"paper/object_i.yaml",
       {"sweep.sobol={samples: 5, keys: {kernel.length_scale: 'log_uniform(1cm,10cm)', belief.height.noise: "
        "'uniform(0.1mm,1mm)'}}",
        "expect.failed_runs=<= 1", "name=points"}},
      {"paper/object_i.yaml",
       {"sweep.sobol={samples: 2, keys: {kernel.length_scale: 'uniform(1cm,3cm)', taps: 'uniform(8,9)'}}", "taps=8,9"}},
      {"paper/comparison.yaml", {"seed=range(0,3)"}},
      {"sweep/fitting.yaml", {"seed=4", "taps=17"}},
      {"sweep/trade_compute.yaml", {"seed=4"}},
      {"sweep/trade_motion.yaml", {"seed=4", "taps=17"}},
      {"ci/strategy.yaml", {}},
      {"benchmark/strategies.yaml", {"seed=1000,1001", "scene=ring,rod"}},
      {"benchmark/clutter.yaml", {"seed=1000,1001"}},
      {"paper/object_i.yaml",
       {"scene=clutter", "sweep.zip={scene.objects.draw.least: [1, 4], scene.objects.draw.most: [1, 4]}", "seed=1,2"}},
      {"paper/object_i.yaml", {"strategy=weighted_two_part,default", "scene.effects=none,standard"}},
  };
  for (const RoundTrip& one : cases) expect_same_plan({kConfigs / one.file, one.words});
}

TEST(Plan, WritesAConfigThatNeedsNoGroupThatItDoesNotSweep) {
  const test::TemporaryFolder folder;
  folder.write("there/kernel/mine.yaml", "kernel: {type: matern12, length_scale: 3 cm}\n");
  const fs::path file = folder.write(
      "there/c.yaml",
      "defaults: [kernel: mine, acquisition: weighted, fitting: fixed, backend: simulator, scene: object_i]\n");
  expect_same_plan({file, {"seed=1,2", "acquisition=weighted,random"}});
}

TEST(Plan, WritesAConfigWhoseSweptBackendsBringTheMotionThatTheBaseLeavesToThem) {
  const test::TemporaryFolder folder;
  const std::string simulator = "backend: {type: simulator}\n";
  folder.write("there/backend/slow.yaml", simulator + "motion: {type: continuous, speed: 1 cm/s}\n");
  folder.write("there/backend/fast.yaml", simulator + "motion: {type: continuous, speed: 9 cm/s}\n");
  const std::string rest = "kernel: rbf\nacquisition: random\nfitting: fixed\nscene: object_i\n";
  for (const std::string defaults : {"defaults: [backend: slow, motion: gentle]\n", "backend: slow\n"}) {
    const SweepPlan first = planned(folder.write("there/c.yaml", defaults + rest), {"backend=slow,fast"}).plan;
    const SweepPlan again = planned(folder.write("there/again.yaml", to_yaml(first.config)), {}).plan;
    EXPECT_EQ(ids(again), ids(first)) << to_yaml(first.config);
    EXPECT_NE(ids(first).front(), ids(first).back()) << "each has the motion of its own backend";
  }
}

TEST(Plan, DoesNotAskTheConfigForTheMotionThatASweptBackendDecides) {
  const std::string depends = " depends on 'backend', which is swept, sweep it too, or compare 'backend'";
  EXPECT_EQ(refused({"backend=simulator,baxter", "sweep.where=motion.speed > 1 cm/s"}),
            "command line: 'motion.speed'" + depends);
  EXPECT_EQ(rows(plan_of({"backend=simulator", "sweep.where=backend == simulator"})).size(), 1U);
}

TEST(Plan, NamesASweepAlikeOnAnyNumberOfThreads) {
  const test::TemporaryFolder folder;
  const auto directory = [&](const std::string& engine) {
    const std::string block = engine.empty() ? "" : "  engine: {" + engine + "}\n";
    const fs::path file =
        folder.write("c.yaml", boost::replace_first_copy(test::text_of(kPaper), "belief:\n", "belief:\n" + block));
    return planned(file, {"seed=1,2"}).plan.sweep.directory;
  };
  EXPECT_EQ(directory("type: auto, threads: 1"), directory("type: auto, threads: 2"));
  EXPECT_EQ(directory("threads: 2"), directory(""));
  EXPECT_NE(directory("type: dense, threads: 1"), directory("type: auto, threads: 1"));
}

TEST(Plan, WritesAConfigOfABaseThatIsNoneWithoutItsSweepOrLeavesOptionsOut) {
  const test::TemporaryFolder folder;
  const std::string rest = "fitting: fixed\nbackend: simulator\nscene: object_i\n";
  for (const std::string& text :
       {"defaults: [kernel: rbf]\n" + rest + "sweep: {grid: {acquisition: [random, grid], seed: [1, 2]}}\n",
        "defaults: [kernel: rational_quadratic]\nkernel: {type: rbf}\nacquisition: weighted\n" + rest +
            "sweep: {grid: {kernel.length_scale: [1 cm, 2 cm]}}\n"}) {
    expect_same_plan({folder.write("c.yaml", text), {}});
  }
}

TEST(Plan, WritesAConfigThatKeepsTheStrategyBelowWhatIsSwept) {
  const test::TemporaryFolder folder;
  for (const char* text : {"defaults: [backend: simulator, scene: object_i, scene.effects: standard]\n"
                           "strategy: weighted\n",
                           "defaults: [strategy: weighted, backend: simulator, scene: object_i]\n"}) {
    const RoundTrip one{folder.write("c.yaml", text), {"kernel=rbf,matern52", "scene=ring,rod"}};
    EXPECT_EQ(ids(planned(one.file, one.words).plan).size(), 4U);
    expect_same_plan(one);
  }
}

TEST(Plan, NamesAStrategyAndASetOfEffectsInItsTable) {
  const SweepPlan plan = plan_of({"strategy=random,default", "scene.effects=standard"});
  EXPECT_EQ(plan.sweep.keys, (Texts{"strategy", "scene.effects"}));
  EXPECT_EQ(rows(plan), (Texts{"random|standard", "default|standard"}));
}

TEST(Plan, TakesASurfaceThatIsAskedFor) {
  EXPECT_FALSE(planned(kPaper, {"seed=1,2"}).configs[0].options.log.surface) << "not by default";
  EXPECT_TRUE(planned(kPaper, {"seed=1,2", "log.surface=true"}).configs[0].options.log.surface);
}

}  // namespace
}  // namespace palpate
