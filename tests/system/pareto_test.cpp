// SPDX-License-Identifier: MIT
// `palpate pareto` as a user calls it: table, files, the config of the cheapest setting, and what it refuses.
#include "record/json.hpp"
#include "record/session.hpp"
#include "sweep/sweep.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>

namespace palpate {
namespace {

/// A sweep of two strategies, two budgets and some seeds, made once for each test that asks for it.
fs::path swept(const TemporaryFolder& folder, const std::vector<std::string>& more = {}) {
  const Ended ended = test::palpate(test::plus({"sweep", paper(), "acquisition=weighted,uncertainty", "taps=8,17",
                                                "candidates.count=16", "seed=range(0,4)", "--quiet"},
                                               more),
                                    folder.path());
  EXPECT_EQ(ended.status, 0) << ended.err;
  return only_run(folder.path() / "runs");
}

Ended pareto(const TemporaryFolder& folder, const fs::path& directory, const std::string& cost,
             const std::string& error, const std::vector<std::string>& more = {},
             const std::vector<std::string>& environment = {}) {
  return test::palpate(test::plus({"pareto", directory.string(), "--cost", cost, "--error", error}, more),
                       folder.path(), environment);
}

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

TEST(Pareto, PrintsATableAndLeavesAPictureAndTheTableAsCsv) {
  const TemporaryFolder folder;
  const fs::path directory = swept(folder);
  const Ended ended = pareto(folder, directory, "robot_seconds", "rmse_m");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(lines(ended.out), 1 + 4 + 1);
  EXPECT_THAT(ended.out, StartsWith("front  setting "));
  EXPECT_THAT(ended.out, HasSubstr("    1  acquisition="));
  EXPECT_THAT(ended.out, HasSubstr("robot_seconds [s]"));
  EXPECT_THAT(ended.out, HasSubstr("rmse_m [mm]"));
  EXPECT_THAT(ended.err, StartsWith("picture: "));

  const std::string png = text_of(directory / "pareto_robot_seconds_rmse_m.png");
  ASSERT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(big_endian(png, 16), 1300U);
  EXPECT_EQ(big_endian(png, 20), 760U);
  EXPECT_GT(png.size(), 10'000U);
  EXPECT_FALSE(fs::exists(directory / "pareto_robot_seconds_rmse_m.png.tmp"));

  const std::vector<Cells> table = csv_rows(text_of(directory / "pareto_robot_seconds_rmse_m.csv"));
  ASSERT_EQ(table.size(), 4U);
  // The means against those of results.csv.
  for (const Cells& setting : table) {
    double sum = 0.0;
    int jobs = 0;
    for (const Cells& job : csv_rows(text_of(directory / "results.csv"))) {
      if (job.at("acquisition") != setting.at("acquisition") || job.at("taps") != setting.at("taps")) continue;
      sum += std::stod(job.at("rmse_m"));
      ++jobs;
    }
    EXPECT_EQ(setting.at("jobs"), std::to_string(jobs));
    EXPECT_NEAR(std::stod(setting.at("rmse_m.mean")), sum / jobs, 1e-15);
    EXPECT_LT(std::stod(setting.at("rmse_m.low_95")), std::stod(setting.at("rmse_m.mean")));
  }
}

TEST(Pareto, TheCheapestSettingWithinIsAConfigThatRunsAsTheSameJob) {
  const TemporaryFolder folder;
  const fs::path directory = swept(folder, {"expect.taps=>= 1", "log.surface=true"});
  const Ended ended = pareto(folder, directory, "robot_seconds", "rmse_m", {"--within", "20cm"});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, StartsWith("# acquisition="));
  EXPECT_THAT(ended.out, HasSubstr("whose upper 95 % bound of rmse_m is at most 200 mm:\n# rmse_m "));
  EXPECT_THAT(ended.out, HasSubstr("; 4 seeds, of which this is the first.\nname: "));
  EXPECT_EQ(ended.out.find("expect"), std::string::npos) << "what the sweep expected of all its runs";
  EXPECT_THAT(ended.err, HasSubstr("front  setting"));

  folder.write("best.yaml", ended.out);
  const Ended run = test::palpate({"run", "best.yaml", "--quiet", "--runs", "again"}, folder.path());
  ASSERT_EQ(run.status, 0) << run.err;
  const fs::path again = only_run(folder.path() / "again");
  const fs::path job = directory / "jobs" / again.filename();
  for (const char* name : {"taps.csv", "surface.csv"}) EXPECT_EQ(text_of(again / name), text_of(job / name)) << name;
  const auto rmse = [](const fs::path& run_directory) {
    return std::get<double>(*parse_json_row(text_of(run_directory / "summary.json"))->find("rmse_m"));
  };
  EXPECT_EQ(rmse(again), rmse(job));
}

TEST(Pareto, WhereNothingIsWithinNamesTheNearestAndEndsWith1) {
  const TemporaryFolder folder;
  const fs::path directory = swept(folder);
  const Ended ended = pareto(folder, directory, "robot_seconds", "rmse_m", {"--within", "1um"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.out, "");
  EXPECT_THAT(ended.err, ::testing::ContainsRegex("\nno setting keeps to rmse_m within 0.001 mm, the nearest is "
                                                  "acquisition=[a-z]+, taps=[0-9]+: rmse_m [0-9.]+ .*\n$"));
}

TEST(Pareto, AsksForTheLowerBoundOfWhatIsBetterWhenItIsMore) {
  const TemporaryFolder folder;
  const fs::path directory = swept(folder);
  const Ended ended = pareto(folder, directory, "compute_seconds", "found", {"--within", "-1"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("whose lower 95 % bound of found is at least -1"));
  EXPECT_EQ(pareto(folder, directory, "compute_seconds", "found", {"--within", "1.01"}).status, 1);
}

TEST(Pareto, NotesJobsThatHaveNotEndedAndComparesOnlyTheOthers) {
  const TemporaryFolder folder;
  const fs::path directory = swept(folder);
  const std::vector<Cells> jobs = csv_rows(text_of(directory / "results.csv"));
  fs::remove(directory / "jobs" / jobs.front().at("id") / "summary.json");
  const Ended ended = pareto(folder, directory, "robot_seconds", "rmse_m");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, StartsWith("1 of 16 jobs have not ended"));
  EXPECT_THAT(ended.out, HasSubstr("1 of 4 unfinished"));
  EXPECT_THAT(ended.out, HasSubstr("are not compared\n"));
}

TEST(Pareto, NeverNamesASettingWithAFailedJobAndSaysSo) {
  const TemporaryFolder folder;
  const Ended sweep = test::palpate(
      {"sweep", paper(), "scene.placement=random", "scene.objects.0.length=10cm,40cm", "seed=range(0,3)", "--quiet"},
      folder.path());
  EXPECT_EQ(sweep.status, 1);
  const Ended ended = pareto(folder, only_run(folder.path() / "runs"), "robot_seconds", "rmse_m", {"--within", "1m"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, StartsWith("# scene.objects.0.length=10cm\n"));
  EXPECT_THAT(ended.err, HasSubstr("3 of 3 failed"));
}

TEST(Pareto, WithoutGnuplotTheTableIsStillRight) {
  const TemporaryFolder folder;
  const fs::path directory = swept(folder);
  const Ended ended = pareto(folder, directory, "robot_seconds", "rmse_m", {}, {"PATH=/nowhere"});
  EXPECT_EQ(ended.status, 0);
  EXPECT_THAT(ended.out, StartsWith("front  setting "));
  EXPECT_THAT(ended.err, StartsWith("no picture was drawn: gnuplot is not installed, the package gnuplot-nox has it"));
  EXPECT_EQ(lines(ended.err), 1);
  EXPECT_TRUE(fs::exists(directory / "pareto_robot_seconds_rmse_m.csv"));
  EXPECT_FALSE(fs::exists(directory / "pareto_robot_seconds_rmse_m.png"));
}

TEST(Pareto, AGnuplotThatFailsLeavesNoPictureAndItsWords) {
  const TemporaryFolder folder;
  const fs::path directory = swept(folder);
  fs::permissions(folder.write("bin/gnuplot", "#!/bin/sh\necho out of ink >&2\nexit 3\n"), fs::perms::owner_all);
  const Ended ended =
      pareto(folder, directory, "robot_seconds", "rmse_m", {}, {"PATH=" + (folder.path() / "bin").string()});
  EXPECT_EQ(ended.status, 0);
  EXPECT_THAT(ended.err, StartsWith("no picture was drawn: gnuplot failed: out of ink; table: "));
  EXPECT_FALSE(fs::exists(directory / "pareto_robot_seconds_rmse_m.png"));
}

TEST(Pareto, ANameFullOfCommandsIsOnlyAName) {
  const TemporaryFolder folder;
  const std::string evil = "x'; system(\"touch owned\"); `touch owned` $(touch owned) @owned {/Bold b} \\n";
  const fs::path directory = swept(folder);
  std::string config = text_of(directory / "config.yaml");
  config.replace(config.find("name: "), config.find('\n') - config.find("name: "), "name: |-\n  " + evil);
  folder.write((directory / "config.yaml").string(), config);
  Sweep sweep = read_sweep(directory);
  for (Job& job : sweep.jobs) {
    for (std::string& value : job.values)
      value = value == "weighted" ? "`touch owned` x'; system('touch owned')" : value;
  }
  folder.write((directory / "manifest.jsonl").string(),
               manifest_text(sweep, sweep_id(read_run_config(directory), sweep)));
  const Ended ended = pareto(folder, directory, "robot_seconds", "rmse_m");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, StartsWith("picture: "));
  EXPECT_TRUE(fs::exists(directory / "pareto_robot_seconds_rmse_m.png"));
  for (const fs::path& place : {folder.path(), directory}) EXPECT_FALSE(fs::exists(place / "owned")) << place;
}

TEST(Pareto, RefusesWhatCannotBeComparedInOneLine) {
  const TemporaryFolder folder;
  const fs::path directory = swept(folder);
  const auto refused = [&](const std::string& cost, const std::string& error, const std::vector<std::string>& more) {
    const Ended ended = pareto(folder, directory, cost, error, more);
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(ended.out, "");
    return ended.err;
  };
  EXPECT_EQ(refused("robot_second", "rmse_m", {}),
            "command line: --cost: results.csv has no column 'robot_second', did you mean 'robot_seconds'?\n");
  EXPECT_EQ(refused("robot_seconds", "stop_reason", {}),
            "command line: --error: the column 'stop_reason' holds tap budget, not numbers, name one that can be "
            "averaged\n");
  EXPECT_THAT(refused("robot_seconds", "rmse_m", {"--within", ""}), HasSubstr("--within"))
      << "a variable that is not set";
  EXPECT_EQ(refused("robot_seconds", "rmse_m", {"--within", "5"}),
            "command line: --within: '5' lacks its unit, write a length like '1.7 cm'\n");
  const Ended run = pareto(folder, folder.path(), "robot_seconds", "rmse_m");
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("is not the directory of a sweep, it has no manifest.jsonl\n"));
}

}  // namespace
}  // namespace palpate
