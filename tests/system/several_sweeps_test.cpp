// SPDX-License-Identifier: MIT
// `palpate compare`, `curves` and `pareto` over several sweeps and runs of different plans.
#include "support/lasting.hpp"
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <boost/algorithm/string/replace.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr const char* kPlan = "taps=6 candidates.count=16 seed=range(0,5)";

class SeveralSweeps : public Shell {
 protected:
  /// A sweep with the name, in a folder of its own.
  fs::path named(const std::string& name, const Words& more, const std::string& file = paper()) const {
    const Ended ended = palpate(set_by(Words{"sweep", file, "--quiet", "name=" + name} + kPlan, more));
    EXPECT_EQ(ended.status, 0) << ended.err;
    return fs::directory_iterator(here() / "runs" / name)->path();
  }
  /// What a command prints of these records, and what it says beside its files.
  Ended about(const std::string& command, const std::vector<fs::path>& records, const Words& more) const {
    Words words{command};
    for (const fs::path& one : records) words.push_back(one.string());
    const Ended ended = palpate(words + more);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended;
  }
  /// A config of one's own, whose acquisition is not swept.
  std::string own() const {
    return write("own.yaml",
                 "defaults: [{strategy: uncertainty}, {backend: simulator}, {motion: paper}]\nname: own\nscene: "
                 "object_i\ntaps: 30\n")
        .string();
  }
};

TEST_F(SeveralSweeps, AreComparedDrawnAndRankedAsTheOneSweepOfAllTheirJobs) {
  const Words scenes = "scene=ring,block seed=range(0,5)";
  const fs::path whole = named("whole", "acquisition=random,grid,uncertainty" + scenes);
  const std::vector<fs::path> parts{named("earlier", "acquisition=random,grid" + scenes),
                                    named("later", "acquisition=uncertainty" + scenes)};
  for (const char* const format : {"text", "latex", "csv"}) {
    const Words words = Words("--by acquisition --metric rmse_m,footprint_iou --format") + Words{format};
    EXPECT_EQ(about("compare", parts, words).out, about("compare", {whole}, words).out);
  }
  const Words at = "--by acquisition,scene --metric rmse_m --at 4 --format csv";
  EXPECT_EQ(about("compare", parts, at).out, about("compare", {whole}, at).out);
  const Words front = "--cost robot_seconds --error rmse_m";
  EXPECT_EQ(about("pareto", parts, front).out, about("pareto", {whole}, front).out);
  EXPECT_EQ(about("curves", parts, "-o parts.csv").out, about("curves", {whole}, "-o whole.csv").out);
  EXPECT_EQ(text_of(here() / "parts.csv"), text_of(here() / "whole.csv"));
}

TEST_F(SeveralSweeps, DoNotDifferInTheNumberOfThreads) {
  const auto with_engine = [&](const std::string& name, const std::string& engine) {
    const std::string block = "belief:\n  engine: {" + engine + "}\n";
    const std::string text = boost::replace_first_copy(text_of(paper()), "belief:\n", block);
    return named(name, {}, write(name + ".yaml", text).string());
  };
  const fs::path first = with_engine("first", "threads: 1");
  const auto notes = [&](const fs::path& other) {
    return about("compare", {first, other}, "--by acquisition --metric rmse_m").err;
  };
  EXPECT_THAT(notes(with_engine("second", "threads: 2")), Not(HasSubstr("engine")));
  EXPECT_THAT(notes(with_engine("third", "type: dense")), HasSubstr("differ in belief.engine.type"));
}

TEST_F(SeveralSweeps, GroupAnOptionThatOneSweepsAndTheOtherHasInItsConfig) {
  const fs::path swept = named("earlier", "acquisition=random,uncertainty belief.height.noise=2mm");
  // The same acquisition and noise, in another unit, on seeds of which four are the same.
  const fs::path fixed =
      named("later", "seed=range(1,6) belief.height.noise=0.2cm motion.speed=5cm/s acquisition=uncertainty");
  const Ended ended = about("compare", {swept, fixed},
                            "--by acquisition,motion.speed --metric rmse_m --format csv --baseline random,0.024m/s");
  std::vector<std::string> groups;
  for (const Cells& row : csv_rows(ended.out)) {
    if (row.at("kind") != "group") continue;
    groups.push_back(row.at("group") + ": " + row.at("n"));
  }
  EXPECT_THAT(groups, ElementsAre("random, 0.024 m/s: 5", "uncertainty, 0.024 m/s: 5", "uncertainty, 5cm/s: 5"));
  const Cells last = csv_rows(ended.out).back();
  EXPECT_EQ(last.at("group"), "uncertainty, 5cm/s");
  EXPECT_EQ(last.at("n"), "4") << "2mm and 0.2cm are a pair";
}

TEST_F(SeveralSweeps, PairTheSameSeedsAndNameWhatElseDiffers) {
  const fs::path earlier = named("earlier", "acquisition=random");
  const fs::path later = named("later", "acquisition=uncertainty seed=range(2,7)");
  const Words words = "--by acquisition --metric rmse_m --format csv";
  const Cells pair = csv_rows(about("compare", {earlier, later}, words).out).back();
  EXPECT_EQ(pair.at("n"), "3") << "seeds 2, 3 and 4";
  EXPECT_EQ(pair.at("seeds"), "3");

  // An own config, in which more is different than the acquisition.
  const fs::path mine = named("mine", "taps=6", own());
  const Ended by_key = about("compare", {earlier, mine}, "--by acquisition --metric rmse_m");
  EXPECT_THAT(by_key.err, StartsWith("note: besides the swept keys, the records differ in kernel.length_scale\n"));
  EXPECT_THAT(by_key.out, HasSubstr("have no pairs: compare them with '--by acquisition,"));
  // By name all of it is what is compared.
  const Ended named_groups = about("compare", {earlier, mine}, "--by name --metric rmse_m --format csv");
  EXPECT_EQ(named_groups.err, "note: the names differ in acquisition, kernel.length_scale\n");
  const std::vector<Cells> by_name = csv_rows(named_groups.out);
  EXPECT_EQ(by_name.back().at("group"), "mine");
  EXPECT_EQ(by_name.back().at("n"), "5");
}

TEST_F(SeveralSweeps, TakeASweepWithoutAStrategyForAStrategyOfItsName) {
  const fs::path earlier = named("earlier", "strategy=grid,random");
  const fs::path own = named("own", "acquisition=uncertainty");
  const Ended ended = about("compare", {earlier, own}, "--by strategy --metric rmse_m --format csv");
  EXPECT_EQ(ended.err, "note: the strategies differ in acquisition\n");
  const Cells last = csv_rows(ended.out).back();
  EXPECT_EQ(last.at("group") + " - " + last.at("minus") + ": " + last.at("n"), "own - random: 5");
}

TEST_F(SeveralSweeps, CountARunOnceThatStandsInBothAndSayWhichScenesOneLacks) {
  const fs::path both = named("both", "acquisition=random scene=ring,block");
  const fs::path one = named("one", "acquisition=random,grid scene=ring");
  const fs::path run = ran(set_by(kPlan, "seed=9 acquisition=random scene=ring name=alone"));
  const Ended ended = about("compare", {both, one, run, run}, "--by acquisition --metric rmse_m --format csv");
  EXPECT_THAT(ended.err, HasSubstr("note: 6 of 22 jobs are also in an earlier record and count once\n"));
  EXPECT_THAT(
      ended.err,
      HasSubstr("note: scene=block is missing in one, alone: compare scene by scene, or exclude it with --where\n"));
  EXPECT_EQ(csv_rows(ended.out).front().at("n"), "11") << "five seeds on two scenes, and the run";
}

TEST_F(SeveralSweeps, ANameStandsForAllItsRunsWhereItHasNoSweep) {
  for (const char* const words :
       {"acquisition=random seed=1", "acquisition=random seed=2", "acquisition=grid seed=1", "acquisition=grid seed=2"})
    ASSERT_EQ(run(Words("name=loop taps=4 candidates.count=16 --quiet") + words).status, 0);
  const Words words = "--by acquisition --metric rmse_m";
  const Ended ended = palpate(Words{"compare", "loop"} + words);
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("\nrandom          2"));
  EXPECT_THAT(ended.out, HasSubstr("pair: two jobs with equal seed.\n"));
  // What it has left beside the runs does not disturb a * for them.
  Words star{"compare"};
  for (const auto& one : fs::directory_iterator(here() / "runs/loop")) star.push_back(one.path().string());
  EXPECT_EQ(star.size(), 6U) << "a table and four runs";
  EXPECT_EQ(palpate(star + words).status, 0);
  EXPECT_THAT(refused(Words{"compare", "loop", here() / "runs/loop/nothing"} + words), HasSubstr("nothing"));
}

TEST_F(SeveralSweeps, AreNamedByWordsThatNoFileInTheWorkingFolderHides) {
  named("earlier", "acquisition=random");
  named("later", "acquisition=uncertainty");
  const Words by = "--by acquisition --metric rmse_m";
  const std::string both = palpate(Words("compare earlier later") + by).out;
  write("later", "a file of that name");
  EXPECT_EQ(palpate(Words("compare earlier later") + by).out, both);
  EXPECT_THAT(both, AllOf(HasSubstr("\nrandom "), HasSubstr("\nuncertainty ")));
  write("tables/one.csv", "");
  write("tables/two.csv", "");
  EXPECT_THAT(refused(Words("compare tables/one.csv tables/two.csv") + by), HasSubstr("no sweep and no run is given"));
}

TEST_F(SeveralSweeps, MayBeOneRunAndAreNotMergedWhereTheSameRunMeasuredSomethingElse) {
  const fs::path run = ran("taps=6 candidates.count=16 name=alone");
  const Words by = "--by name --metric rmse_m";
  EXPECT_THAT(palpate(Words{"compare", run} + by).out, HasSubstr("\nalone "));
  const fs::path copy = here() / "elsewhere" / run.filename();
  fs::create_directories(copy.parent_path());
  fs::copy(run, copy);
  const Words both{"compare", run, copy, "--by", "acquisition", "--metric", "rmse_m"};
  EXPECT_THAT(palpate(both).err, HasSubstr("note: 1 of 2 jobs are also in an earlier record"));
  replace(copy / "taps.csv", "initial", "IniTial");
  EXPECT_THAT(refused(both, 1),
              AllOf(HasSubstr("has the same id as "), HasSubstr(" but other taps, give each run its own seed")));
}

TEST_F(SeveralSweeps, ByNameHaveEachItsOwnJobsThoughAnotherHasTheSame) {
  named("earlier", "acquisition=random,uncertainty");
  named("later", "acquisition=random");
  for (const char* records : {"compare earlier later", "compare later earlier"}) {
    const std::string out = palpate(Words(records) + "--by name --metric rmse_m").out;
    EXPECT_THAT(out, testing::ContainsRegex("\nearlier +10 +10 "));
    EXPECT_THAT(out, testing::ContainsRegex("\nlater +5 +5 "));
  }
}

TEST_F(SeveralSweeps, MergeByCopyingTheFoldersOfTheirJobs) {
  const fs::path earlier = named("earlier", "acquisition=random,grid");
  const fs::path later = named("later", "acquisition=uncertainty seed=range(0,4)");
  // The whole plan, broken off at once.
  const Words plan = set_by(Words{"sweep", paper(), "name=whole"} + kPlan, "acquisition=random,grid,uncertainty");
  const auto begun = begin(plan + "-j 1");
  EXPECT_TRUE(test::eventually([&] {
    const fs::path part = test::run_in(here() / "runs/whole");  // of the sweep
    return !part.empty() && fs::exists(part.parent_path() / "manifest.jsonl");
  }));
  begun->signal(SIGINT);
  begun->wait();
  const fs::path whole = fs::directory_iterator(here() / "runs/whole")->path();
  std::map<std::string, std::string> records;
  for (const fs::path& part : {earlier, later}) {
    for (const fs::path& job : jobs_of(part)) {
      fs::copy(job, whole / "jobs" / job.filename(),
               fs::copy_options::recursive | fs::copy_options::overwrite_existing);
      records[job.filename().string()] = text_of(job / "record.jsonl");
    }
  }
  EXPECT_EQ(resume(whole).status, 0);
  for (const auto& [id, record] : records)
    EXPECT_EQ(text_of(whole / "jobs" / id / "record.jsonl"), record) << "not run again";
  const std::vector<Cells> results = csv_rows(text_of(whole / "results.csv"));
  EXPECT_EQ(results.size(), 15U);
  for (const Cells& job : results) EXPECT_EQ(job.at("status"), "done");
}

}  // namespace
}  // namespace palpate
