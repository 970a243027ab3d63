// SPDX-License-Identifier: MIT
// `palpate tune` as a user runs it: a race, its files, kills, and what is rejected.
#include "support/programs.hpp"
#include "system/shell.hpp"

#include "sweep/sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <random>
#include <regex>

namespace palpate {
namespace {

using test::Words;

class Tune : public test::Shell {
 protected:
  static Words race(const Words& more = Words(), const std::string& fresh = "5") {
    const Words all{"tune",
                    paper(),
                    "kernel.length_scale=log_uniform(5mm,10cm)",
                    "acquisition=weighted,uncertainty",
                    "--metric",
                    "rmse_m",
                    "--jobs",
                    "100",
                    "--fresh",
                    fresh,
                    "--quiet"};
    return all + more;
  }
  std::string refused_race(const Words& more) const { return refused(Words{"tune", paper()} + more); }
};

TEST_F(Tune, FindsASettingThatIsBetterThanTheConfigAndWritesItAsAConfigThatRuns) {
  const test::Ended ended = palpate(race(Words(), "40"));
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("config as it stands"), HasSubstr("best"),
                               HasSubstr("on 40 seeds that had no part in the choice: ")));
  const fs::path race_of = directory();
  const Sweep sweep = read_sweep(race_of);
  EXPECT_LE(sweep.rounds[sweep.rounds.size() - 2].jobs, 100U);
  EXPECT_EQ(sweep.rounds.back().jobs, sweep.rounds[sweep.rounds.size() - 2].jobs + 80) << "both settings on 40 seeds";
  EXPECT_EQ(lines(text_of(race_of / "results.csv")), static_cast<int>(sweep.jobs.size()) + 1);
  int last = 0;
  for (const test::Cells& row : test::csv_rows(text_of(race_of / "race.csv")))
    last += row.at("lost_after_seeds").empty();
  EXPECT_LE(last, 5) << "settings in the last stage";
  EXPECT_THAT(text_of(race_of / "best.yaml"),
              AllOf(StartsWith("# Best of "), HasSubstr("\nname: \"object_i_best\"\n")));
  EXPECT_EQ(palpate({"run", (race_of / "best.yaml").string(), "--quiet", "--runs", "again"}).status, 0);
  EXPECT_THAT(palpate({"status", race_of}).out, HasSubstr(" 0 missing"));
  EXPECT_EQ(palpate({"compare", race_of.string(), "--by", "acquisition", "--metric", "rmse_m"}).status, 0);
  const std::string before = text_of(race_of / "manifest.jsonl");
  EXPECT_EQ(palpate(race(Words(), "40")).status, 0) << "a finished race is shown";
  EXPECT_EQ(text_of(race_of / "manifest.jsonl"), before);
}

TEST_F(Tune, KilledAtAnyMomentEndsWithTheDecisionsOfTheUnbrokenRace) {
  ASSERT_EQ(palpate(race({"--runs", "unbroken"})).status, 0);
  const fs::path unbroken = directory("unbroken");
  std::mt19937 random(7);
  const int races = std::getenv("PALPATE_LONG") != nullptr ? 40 : 4;
  for (int i = 0; i < races; ++i) {
    const std::string runs = "killed" + std::to_string(i);
    auto child = begin(race({"--runs", runs}));
    std::this_thread::sleep_for(std::chrono::milliseconds(20 + random() % 500));
    child->signal(SIGKILL);
    child->wait();
    ASSERT_EQ(palpate(race({"--runs", runs})).status, 0) << i;
    for (const char* const file : {"manifest.jsonl", "best.yaml"})
      EXPECT_EQ(text_of(directory(runs) / file), text_of(unbroken / file)) << i << " " << file;
  }
}

TEST_F(Tune, IgnoresJobsWithoutTheLineOfTheirRoundAndRejectsChangedLines) {
  ASSERT_EQ(palpate(race()).status, 0);
  const fs::path manifest = directory() / "manifest.jsonl";
  const std::string whole = text_of(manifest);
  const std::size_t last = whole.rfind("\n{\"round\"") + 1;
  write(manifest, whole.substr(0, last));  // the process was killed before it wrote the line of the last round
  ASSERT_EQ(resume(directory()).status, 0);
  EXPECT_EQ(text_of(manifest), whole);
  write(manifest, whole.substr(0, last + 20));
  ASSERT_EQ(resume(directory()).status, 0);
  EXPECT_EQ(text_of(manifest), whole);
  for (const auto& [old, changed] :
       {std::pair("\"seeds\": 4", "\"seeds\": 5"), std::pair("\"end\": \"", "\"end\": \"x")}) {
    replace(manifest, old, changed);  // in the first and in the last round
    const test::Ended ended = resume(directory());
    EXPECT_EQ(ended.status, 2);
    EXPECT_THAT(ended.err, HasSubstr("is not a round of this sweep, or lines before it were changed"));
    write(manifest, whole);
  }
}

TEST_F(Tune, TwoProcessesAtOnceMakeTheDecisionsOfOne) {
  const Words words = race({"backend.pace=0.001", "-j", "1"});
  ASSERT_EQ(palpate(words + Words{"--runs", "alone"}).status, 0);
  auto first = begin(words + Words{"--runs", "both"});
  ASSERT_TRUE(test::eventually([&] { return fs::exists(here() / "both") && !fs::is_empty(here() / "both"); }));
  auto second = begin(words + Words{"--runs", "both"});
  EXPECT_EQ(first->wait().status, 0);
  EXPECT_EQ(second->wait().status, 0);
  EXPECT_EQ(text_of(directory("both") / "manifest.jsonl"), text_of(directory("alone") / "manifest.jsonl"));
}

TEST_F(Tune, RestoresTheConfigsOfJobsThatWereDeleted) {
  ASSERT_EQ(palpate(race()).status, 0);
  const std::string before = text_of(directory() / "manifest.jsonl");
  const Sweep sweep = read_sweep(directory());
  const fs::path in_race = job_directory(sweep, sweep.jobs[9]);
  const fs::path fresh = job_directory(sweep, sweep.jobs.back());
  const auto configs = [&] {  // without the places of the values, which are now in the config of the race
    return std::regex_replace(text_of(in_race / "config.yaml") + text_of(fresh / "config.yaml"), std::regex(" +#.*"),
                              "");
  };
  const std::string written = configs();
  fs::remove_all(in_race);
  fs::remove(fresh / "config.yaml");
  const test::Ended ended = resume(directory());
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(configs(), written);
  EXPECT_EQ(text_of(directory() / "manifest.jsonl"), before);
}

TEST_F(Tune, RejectsInOneLineWhatCannotBeRacedAndBeginsNothing) {
  const Words rest{"--metric", "rmse_m", "--jobs", "100"};
  EXPECT_THAT(refused_race(Words{"scene=block,ring"} + rest), HasSubstr("--over block,ring"));
  EXPECT_THAT(refused_race(Words{"kernel.length_scale=uniform(2cm,2cm)"} + rest), HasSubstr("is not a range"));
  EXPECT_THAT(refused_race(Words{"kernel.length_scale=range(10mm,60mm,1mm)"} + rest),
              HasSubstr("are fewer than the first round needs"));
  EXPECT_THAT(refused_race({"taps=5,6", "--metric", "rmse", "--jobs", "100"}), HasSubstr("tune.metric"));
  EXPECT_THAT(refused_race({"taps=5,6", "--metric", "rms_surface_distance_m", "--jobs", "100"}),
              HasSubstr("the first 4 runs of the config have no value of 'rms_surface_distance_m'"));
  EXPECT_TRUE(left_nothing());
}

TEST_F(Tune, OfAConfigIsCheckedByValidateAndIgnoredByRun) {
  const std::string config = text_of(paper()) + "tune:\n  keys: {taps: [14, 15]}\n  metric: rmse_m\n  jobs: ";
  const fs::path good = write("good.yaml", config + "40\n");
  const fs::path bad = write("bad.yaml", config + "8\n");
  EXPECT_EQ(palpate({"validate", good}).status, 0);
  EXPECT_THAT(palpate({"validate", bad}).err, HasSubstr("8 jobs are fewer than the first round needs"));
  EXPECT_THAT(run({}, good).err, HasSubstr("tune: is ignored by 'palpate run'; 'palpate tune' runs all its jobs"));
  EXPECT_EQ(palpate({"tune", good, "--quiet", "--fresh", "0"}).status, 0);
}

TEST_F(Tune, EndsAtOnceIfAKeyHasNoEffect) {
  const test::Ended ended =
      palpate({"tune", paper(), "belief.height.noise=0.1mm,0.2mm,0.3mm", "acquisition=random", "--metric", "rmse_m",
               "--jobs", "200", "--within", "0.5mm", "--fresh", "0", "--quiet"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out,
              HasSubstr("12 runs; the race ended because all settings left are within the given difference"));
  EXPECT_THAT(ended.out, HasSubstr("the config as it stands is the best setting"));
}

TEST_F(Tune, KeepsTheFrontOfErrorAndCostAndWritesItsConfigs) {
  const Words words{"tune",
                    paper(),
                    "taps=uniform(5,40)",
                    "acquisition=weighted,uncertainty",
                    "--metric",
                    "rmse_m",
                    "--cost",
                    "robot_seconds",
                    "--jobs",
                    "120",
                    "--fresh",
                    "6",
                    "--quiet"};
  const test::Ended ended = palpate(words);
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, AllOf(HasSubstr("on the front of rmse_m and robot_seconds"), HasSubstr("on fresh seeds")));
  EXPECT_THAT(ended.out, Not(HasSubstr(" worse"))) << "of which of the two metrics?";
  EXPECT_TRUE(fs::exists(directory() / "front_1.yaml"));
  EXPECT_TRUE(fs::exists(directory() / "front_2.yaml")) << "more taps give a smaller error";
  EXPECT_FALSE(fs::exists(directory() / "best.yaml"));
  EXPECT_EQ(palpate({"run", (directory() / "front_2.yaml").string(), "--quiet", "--runs", "again"}).status, 0);
  EXPECT_THAT(refused_race({"taps=5,6", "--metric", "rmse_m", "--cost", "footprint_iou", "--jobs", "99"}),
              HasSubstr("'footprint_iou' is not a cost"));
}

TEST_F(Tune, StopsIfTheGroupsOfTheConfigWereChangedSinceItBegan) {
  write("configs/kernel/own.yaml", "kernel: {type: rbf, length_scale: 2 cm}\n");
  write("configs/mine.yaml", text_of(paper()));
  const Words words{"tune",
                    "configs/mine.yaml",
                    "kernel=own,matern52",
                    "acquisition=weighted,uncertainty",
                    "--metric",
                    "rmse_m",
                    "--jobs",
                    "60",
                    "--quiet"};
  const test::Ended first = palpate(words);
  ASSERT_EQ(first.status, 0) << first.err;
  const fs::path manifest = directory() / "manifest.jsonl";
  const std::string whole = text_of(manifest);
  write(manifest, whole.substr(0, whole.find('\n', whole.find("{\"round\"")) + 1));  // after the first round
  write("configs/kernel/own.yaml", "kernel: {type: rbf, length_scale: 3 cm}\n");
  const test::Ended ended = resume(directory());
  EXPECT_NE(ended.status, 0);
  EXPECT_THAT(ended.err, HasSubstr("were changed since it began"));
}

}  // namespace
}  // namespace palpate
