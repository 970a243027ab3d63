// SPDX-License-Identifier: MIT
// Sweeps as a user calls them: one row a job, the bytes of single runs, and what becomes of broken and failed jobs.
#include "support/lasting.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

namespace palpate {
namespace {

using Sweeps = Shell;

TEST_F(Sweeps, WriteOneRowAJobAndListTheirJobsBeforehand) {
  const Words words = "acquisition=weighted,random kernel.length_scale=logspace(1cm,4cm,3) seed=range(0,2)";
  const Ended listed = sweep(words + "--list");
  EXPECT_EQ(lines(listed.out), 12);
  EXPECT_TRUE(left_nothing());
  EXPECT_THAT(listed.out, AllOf(HasSubstr("kernel.length_scale=1 cm"), HasSubstr("kernel.length_scale=2 cm")));

  const fs::path directory = swept(words);
  const std::string results = text_of(directory / "results.csv");
  EXPECT_THAT(results, StartsWith("job,id,acquisition,kernel.length_scale,seed,name,status,"));
  EXPECT_EQ(lines(results), 13);
  EXPECT_THAT(results, AllOf(Not(HasSubstr("nan")), Not(HasSubstr("null"))));
  EXPECT_EQ(lines(text_of(directory / "manifest.jsonl")), 12);
  EXPECT_FALSE(fs::exists(directory / "summary.json"));
  EXPECT_THAT(status_of(directory).out, StartsWith("12 jobs, 12 done, 0 running"));
  for (const fs::path& job : jobs_of(directory)) {
    EXPECT_FALSE(fs::exists(job / "surface.csv")) << "not by default in a sweep";
    EXPECT_TRUE(fs::exists(job / "taps.csv"));
  }
}

// PALPATE_SINGLE_RUNS=1000 compares a thousand.
TEST_F(Sweeps, GiveTheSameBytesAsSingleRunsWithAnyNumberOfWorkers) {
  const char* wanted = std::getenv("PALPATE_SINGLE_RUNS");
  const int runs = wanted != nullptr ? std::atoi(wanted) : 30;
  std::vector<fs::path> sweeps;
  for (const char* workers : {"1", "2", "5"})
    sweeps.push_back(swept({"seed=range(0," + std::to_string(runs) + ")", "-j", workers, "--runs", workers}));
  for (int seed = 0; seed < runs; ++seed) {
    const fs::path single = ran("--runs single seed=" + std::to_string(seed));
    for (const fs::path& directory : sweeps) {
      const fs::path job = directory / "jobs" / single.filename();
      EXPECT_TRUE(text_of(job / "taps.csv") == text_of(single / "taps.csv")) << "seed " << seed;
      EXPECT_EQ(test::lasting(job / "summary.json"), test::lasting(single / "summary.json")) << "seed " << seed;
    }
    fs::remove_all(single);
  }
}

TEST_F(Sweeps, SayOfTheirTimeOnlyWhatTheyHaveMeasured) {
  // Whatever the arm takes, before a job has run nobody knows.
  const Words words = "seed=range(0,3) taps=3 backend.pace=0.002";
  EXPECT_EQ(sweep(words + "--list").err, "3 jobs\n");
  const std::string said = sweep(words).err;
  EXPECT_THAT(said, StartsWith("3 jobs in " + fs::relative(directory(), here()).string() + "\n"));
}

TEST_F(Sweeps, WithABadValueAreRefusedBeforeAnyJobStartsAndLeaveNothing) {
  const Words words{"sweep", paper(), "taps=5,17,0"};
  EXPECT_THAT(refused(words), HasSubstr("taps: 0 is out of range"));
  EXPECT_TRUE(fs::is_empty(here()));
  write("runs/mine.txt", "kept");
  refused(words);
  EXPECT_EQ(fs::directory_iterator(here() / "runs")->path().filename(), "mine.txt");
  EXPECT_EQ(std::distance(fs::directory_iterator(here() / "runs"), {}), 1);
}

/// The starts without contact in a group's row of the table at the end of a sweep.
std::string starts_without_contact(const std::string& table, const std::string& group) {
  const auto begin = table.find("\n" + group + " ");
  EXPECT_NE(begin, std::string::npos) << group << "\n" << table;
  if (begin == std::string::npos) return {};
  std::istringstream row(table.substr(begin + 1 + group.size()));
  std::string runs, share;
  row >> runs >> share;
  return share;
}

TEST_F(Sweeps, CountStartsWithoutContactByTheInitialTapsOfEachGroup) {
  const auto table = [&](const std::string& counts) {
    return sweep("initial.count=" + counts + " seed=range(0,20) --quiet").out;
  };
  const std::string one = table("1");
  const std::string eleven = table("11");
  EXPECT_NE(starts_without_contact(one, "all jobs"), starts_without_contact(eleven, "all jobs"))
      << "else this tests nothing";
  for (const std::string& made : {table("1,11"), table("11,1")}) {
    EXPECT_EQ(starts_without_contact(made, "1"), starts_without_contact(one, "all jobs"));
    EXPECT_EQ(starts_without_contact(made, "11"), starts_without_contact(eleven, "all jobs"));
  }
}

TEST_F(Sweeps, CountAsStartsWithoutContactOfASearchWhatItNeverFound) {
  const std::string table =
      sweep("motion=per_tap strategy=random,default scene=cube scene.effects=none taps=12 seed=range(0,10) --quiet",
            config("benchmark/strategies.yaml"))
          .out;
  int never = 0;
  int late = 0;
  for (const Cells& row : csv_rows(text_of(directory() / "results.csv"))) {
    if (row.at("strategy") != "default") continue;
    never += row.at("found") == "false" ? 1 : 0;
    late += row.at("found") == "true" && std::stoi(row.at("first_hit_tap")) > 3 ? 1 : 0;
  }
  EXPECT_GT(never, 0) << "else this tests nothing";
  EXPECT_GT(late, 0) << "else this tests nothing";
  EXPECT_EQ(starts_without_contact(table, "default"), std::to_string(10 * never) + ".0%");
}

TEST_F(Sweeps, CountAsDeadStartsFromAnySideWhatNeverHitAndNoneWhereACameraLooked) {
  const auto of = [&](const Words& more) {
    return starts_without_contact(
        sweep(Words("scene=any_bowl acquisition=random taps=6 seed=1,2 --quiet") + more, config("any_side.yaml")).out,
        "all jobs");
  };
  EXPECT_EQ(of("belief.moves=2"), "0.0%");
  bool late = false;
  for (const Cells& row : csv_rows(text_of(directory() / "results.csv")))
    late = late || std::stoi(row.at("first_hit_tap")) > 3;
  EXPECT_TRUE(late) << "else this tests nothing: its initial taps are more than initial.count";
  EXPECT_EQ(of({"belief.view={azimuth: 30 deg, rays: 100}", "name=view"}), "-");
}

TEST_F(Sweeps, CalledAgainRunWhatIsMissingAndTellTheSame) {
  const Ended first = sweep("seed=range(0,3)");
  const fs::path before = directory();
  test::forget_end(jobs_of(before).front());
  fs::remove(before / "results.csv");
  const Ended again = sweep("seed=range(0,3)");
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.err, HasSubstr("which exists: only missing jobs are run"));
  EXPECT_EQ(again.out, first.out);
  EXPECT_EQ(directory(), before) << "and leaves nothing beside it";
  EXPECT_EQ(lines(text_of(before / "results.csv")), 4);
}

TEST_F(Sweeps, OfAnotherBuildAreNotMixedWithThisOne) {
  make_of_another_build(jobs_of(swept("seed=range(0,2)")).front());
  EXPECT_THAT(refused({"sweep", paper(), "seed=range(0,2)"}), HasSubstr("by another build"));
}

TEST_F(Sweeps, CarryOnAJobThatWasBrokenOffThoughOtherJobsUseOtherPlugins) {
  const fs::path directory = swept("acquisition=weighted,random,grid");
  for (const fs::path& job : jobs_of(directory)) {
    const std::string taps = text_of(job / "taps.csv");
    break_off(job);
    const Ended ended = palpate({"resume", directory});
    EXPECT_EQ(ended.status, 0) << ended.out;
    EXPECT_EQ(text_of(job / "taps.csv"), taps);
    EXPECT_EQ(part_of(job, "manifest").find("/random.so") != std::string::npos,
              text_of(job / "config.yaml").find("type: random") != std::string::npos)
        << "a manifest names the plugins of its own run";
  }
}

}  // namespace
}  // namespace palpate
