// SPDX-License-Identifier: MIT
// Sweeps as a user calls them: one row a job, the bytes of single runs, and what becomes of broken and failed jobs.
#include "record/fields.hpp"
#include "record/json.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace palpate {
namespace {

TEST(Sweep, WritesOneRowAJobAndListsItsJobsBeforehand) {
  const TemporaryFolder folder;
  const std::vector<std::string> words{"sweep", paper(), "acquisition=weighted,random",
                                       "kernel.length_scale=log(1cm,4cm,3)", "seed=range(0,2)"};
  std::vector<std::string> list = words;
  list.push_back("--list");
  const Ended listed = test::palpate(list, folder.path());
  EXPECT_EQ(lines(listed.out), 12);
  EXPECT_FALSE(fs::exists(folder.path() / "runs"));
  EXPECT_THAT(listed.out, HasSubstr("kernel.length_scale=1 cm"));
  EXPECT_THAT(listed.out, HasSubstr("kernel.length_scale=2 cm"));

  const Ended ended = test::palpate(words, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  const fs::path directory = only_run(folder.path() / "runs");
  const std::string results = text_of(directory / "results.csv");
  EXPECT_THAT(results, StartsWith("job,id,acquisition,kernel.length_scale,seed,name,status,"));
  EXPECT_EQ(lines(results), 13);
  EXPECT_EQ(results.find("nan"), std::string::npos);
  EXPECT_EQ(results.find("null"), std::string::npos);
  EXPECT_EQ(lines(text_of(directory / "manifest.jsonl")), 12);
  EXPECT_FALSE(fs::exists(directory / "summary.json"));
  EXPECT_THAT(test::palpate({"status", directory.string()}, folder.path()).out,
              StartsWith("12 jobs, 12 done, 0 running"));
  for (const auto& job : fs::directory_iterator(directory / "jobs")) {
    EXPECT_FALSE(fs::exists(job.path() / "surface.csv")) << "not by default in a sweep";
    EXPECT_TRUE(fs::exists(job.path() / "taps.csv"));
  }
}

/// What summary.json says of the experiment and not of the machine.
std::string without_clocks(const fs::path& summary) {
  const std::optional<Row> row = parse_json_row(text_of(summary));
  EXPECT_TRUE(row) << summary;
  Row kept;
  for (const auto& [name, value] : row->fields) {
    if (!depends_on_machine(name)) kept.fields.emplace_back(name, value);
  }
  return to_json_text(kept);
}

// PALPATE_SINGLE_RUNS=1000 compares a thousand.
TEST(Sweep, GivesTheSameBytesAsSingleRunsWithAnyNumberOfWorkers) {
  const TemporaryFolder folder;
  const char* wanted = std::getenv("PALPATE_SINGLE_RUNS");
  const int runs = wanted != nullptr ? std::atoi(wanted) : 30;
  const std::string seeds = "seed=range(0," + std::to_string(runs) + ")";
  for (const char* workers : {"1", "2", "5"}) {
    ASSERT_EQ(
        test::palpate({"sweep", paper(), seeds, "-j", workers, "--runs", workers, "--quiet"}, folder.path()).status, 0);
  }
  for (int seed = 0; seed < runs; ++seed) {
    const std::string runs_folder = "single-" + std::to_string(seed);
    ASSERT_EQ(
        test::palpate({"run", paper(), "seed=" + std::to_string(seed), "--runs", runs_folder, "--quiet"}, folder.path())
            .status,
        0);
    const fs::path single = only_run(folder.path() / runs_folder);
    for (const char* workers : {"1", "2", "5"}) {
      const fs::path job = only_run(folder.path() / workers) / "jobs" / single.filename();
      EXPECT_TRUE(text_of(job / "taps.csv") == text_of(single / "taps.csv")) << "seed " << seed;
      EXPECT_EQ(without_clocks(job / "summary.json"), without_clocks(single / "summary.json")) << "seed " << seed;
    }
    fs::remove_all(folder.path() / runs_folder);
  }
}

TEST(Sweep, SaysOfItsTimeOnlyWhatItHasMeasured) {
  const TemporaryFolder folder;
  // Whatever the arm takes, before a job has run nobody knows.
  const std::vector<std::string> words{"sweep", paper(), "seed=range(0,3)", "taps=3", "backend.pace=0.002"};
  std::vector<std::string> list = words;
  list.emplace_back("--list");
  EXPECT_EQ(test::palpate(list, folder.path()).err, "3 jobs\n");
  const Ended ended = test::palpate(words, folder.path());
  EXPECT_THAT(ended.err,
              StartsWith("3 jobs in " + fs::relative(only_run(folder.path() / "runs"), folder.path()).string() + "\n"));
}

TEST(Sweep, ABadValueIsRefusedBeforeAnyJobStarts) {
  const TemporaryFolder folder;
  const Ended ended = test::palpate({"sweep", paper(), "taps=5,17,0"}, folder.path());
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("taps: 0 is out of range"));
  EXPECT_FALSE(fs::exists(folder.path() / "runs"));
}

/// The dead starts in a group's row of the table at the end of a sweep.
std::string dead_starts(const std::string& table, const std::string& group) {
  std::istringstream row(table.substr(table.find("\n" + group + " ") + 1));
  std::string name, runs, dead;
  row >> name >> runs >> dead;
  EXPECT_EQ(name, group);
  return dead;
}

TEST(Sweep, CountsDeadStartsByTheInitialTapsOfEachGroup) {
  const TemporaryFolder folder;
  const auto table = [&](const std::string& counts) {
    return test::palpate({"sweep", paper(), "initial.count=" + counts, "seed=range(0,20)", "--quiet"}, folder.path())
        .out;
  };
  const std::string one = table("1");
  const std::string eleven = table("11");
  const std::string both = table("1,11");
  const std::string turned = table("11,1");
  EXPECT_NE(dead_starts(one, "1"), dead_starts(eleven, "11")) << "else this tests nothing";
  for (const std::string& made : {both, turned}) {
    EXPECT_EQ(dead_starts(made, "1"), dead_starts(one, "1"));
    EXPECT_EQ(dead_starts(made, "11"), dead_starts(eleven, "11"));
  }
}

TEST(Sweep, CountsAsDeadStartsOfASearchWhatItNeverFound) {
  const TemporaryFolder folder;
  const std::vector<std::string> words{"sweep",
                                       test::config("benchmark/strategies.yaml"),
                                       "strategy=random,default",
                                       "scene=cube",
                                       "scene.effects=none",
                                       "taps=12",
                                       "seed=range(0,10)",
                                       "--quiet"};
  const std::string table = test::palpate(words, folder.path()).out;
  const std::vector<test::Cells> rows = test::csv_rows(text_of(only_run(folder.path() / "runs") / "results.csv"));
  const auto never = std::count_if(rows.begin(), rows.end(), [](const test::Cells& row) {
    return row.at("strategy") == "default" && row.at("found") == "false";
  });
  const auto late = std::count_if(rows.begin(), rows.end(), [](const test::Cells& row) {
    return row.at("strategy") == "default" && row.at("found") == "true" && std::stoi(row.at("first_hit_tap")) > 3;
  });
  EXPECT_GT(never, 0) << "else this tests nothing";
  EXPECT_GT(late, 0) << "else this tests nothing";
  EXPECT_THAT(table, ContainsRegex(" 10 +" + std::to_string(10 * never) + ".0% .* strategy=default,"));
}

TEST(Sweep, CarriesOnWithWhatIsMissing) {
  const TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"sweep", paper(), "seed=range(0,5)", "--quiet"}, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  const std::string before = text_of(directory / "results.csv");
  const fs::path job = fs::directory_iterator(directory / "jobs")->path();
  const std::string taps = text_of(job / "taps.csv");
  for (const char* name : {"summary.json", "taps.csv", "taps.jsonl", "timings.csv", "manifest.json"})
    fs::remove(job / name);
  EXPECT_THAT(test::palpate({"status", directory.string()}, folder.path()).out,
              HasSubstr("4 done, 0 running, 0 failed, 0 unfinished, 1 missing"));
  EXPECT_EQ(test::palpate({"resume", directory.string()}, folder.path()).status, 0);
  EXPECT_EQ(text_of(job / "taps.csv"), taps);
  EXPECT_EQ(lines(text_of(directory / "results.csv")), lines(before));
  for (const auto& other : fs::directory_iterator(directory / "jobs")) {
    EXPECT_EQ(lines(text_of(other.path() / "attempts.jsonl")), other.path() == job ? 4 : 2);
  }
}

TEST(Sweep, CalledAgainItRunsWhatIsMissingAndTellsTheSame) {
  const TemporaryFolder folder;
  const std::vector<std::string> words{"sweep", paper(), "seed=range(0,3)"};
  const Ended first = test::palpate(words, folder.path());
  const fs::path directory = only_run(folder.path() / "runs");
  fs::remove_all(fs::directory_iterator(directory / "jobs")->path() / "summary.json");
  fs::remove(directory / "results.csv");
  const Ended again = test::palpate(words, folder.path());
  EXPECT_EQ(again.status, 0);
  EXPECT_THAT(again.err, HasSubstr("which exists: what is missing is run"));
  EXPECT_EQ(again.out, first.out);
  EXPECT_EQ(only_run(folder.path() / "runs"), directory) << "and leaves nothing beside it";
  EXPECT_EQ(lines(text_of(directory / "results.csv")), 4);
}

TEST(Sweep, OfAnotherBuildIsNotMixedWithThisOne) {
  const TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"sweep", paper(), "seed=range(0,2)", "--quiet"}, folder.path()).status, 0);
  const fs::path job = fs::directory_iterator(only_run(folder.path() / "runs") / "jobs")->path();
  std::string manifest = text_of(job / "manifest.json");
  const auto at = manifest.find("\"build\": \"") + 10;
  manifest[at] = manifest[at] == '0' ? '1' : '0';
  folder.write(fs::relative(job / "manifest.json", folder.path()).string(), manifest);
  const Ended ended = test::palpate({"sweep", paper(), "seed=range(0,2)"}, folder.path());
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("by another build"));
  EXPECT_EQ(lines(ended.err), 1);
}

TEST(Sweep, AJobThatWasBrokenOffIsCarriedOnThoughOtherJobsUseOtherPlugins) {
  const TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"sweep", paper(), "acquisition=weighted,random,grid", "--quiet"}, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  for (const auto& job : fs::directory_iterator(directory / "jobs")) {
    const std::string taps = text_of(job.path() / "taps.csv");
    fs::remove(job.path() / "summary.json");
    fs::resize_file(job.path() / "taps.jsonl", fs::file_size(job.path() / "taps.jsonl") / 2);
    const Ended ended = test::palpate({"resume", directory.string()}, folder.path());
    EXPECT_EQ(ended.status, 0) << ended.out;
    EXPECT_EQ(text_of(job.path() / "taps.csv"), taps);
    EXPECT_EQ(text_of(job.path() / "manifest.json").find("/random.so") != std::string::npos,
              text_of(job.path() / "config.yaml").find("type: random") != std::string::npos)
        << "a manifest names the plugins of its own run";
  }
}

TEST(Sweep, AFailedJobIsCountedNamedAndStopsNoOther) {
  const TemporaryFolder folder;
  const Ended ended = test::palpate(
      {"sweep", paper(), "scene.placement=random", "scene.objects.0.length=10cm,16cm,40cm"}, folder.path());
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out, HasSubstr("failed: job 2"));
  EXPECT_THAT(ended.out, HasSubstr("does not fit into the area"));
  const fs::path directory = only_run(folder.path() / "runs");
  EXPECT_THAT(test::palpate({"status", directory.string()}, folder.path()).out,
              StartsWith("3 jobs, 2 done, 0 running, 1 failed"));
  EXPECT_EQ(lines(text_of(directory / "results.csv")), 4);
}

}  // namespace
}  // namespace palpate
