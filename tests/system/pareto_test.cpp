// SPDX-License-Identifier: MIT
// `palpate pareto` as a user calls it: table, files, the config of the cheapest setting, and what it refuses.
#include "record/json.hpp"
#include "record/run.hpp"
#include "sweep/sweep.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>

namespace palpate {
namespace {

class Pareto : public Shell {
 protected:
  /// A sweep of two strategies, two budgets and four seeds.
  fs::path settings(const Words& more = {}) const {
    return swept(Words("acquisition=weighted,uncertainty taps=8,17 candidates.count=16 seed=range(0,4)") + more);
  }
  static Words words(const fs::path& sweep, const std::string& cost, const std::string& error) {
    return {"pareto", sweep, "--cost", cost, "--error", error};
  }
  Ended pareto(const fs::path& sweep, const Words& more = {}) const {
    return palpate(words(sweep, "robot_seconds", "rmse_m") + more);
  }
};

std::uint32_t big_endian(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = at; i < at + 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

TEST_F(Pareto, PrintsATableAndLeavesAPictureAndTheTableAsCsv) {
  const fs::path directory = settings();
  const Ended ended = pareto(directory);
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(lines(ended.out), 1 + 4 + 3);
  EXPECT_THAT(ended.out, HasSubstr("\nonly 4 seeds: an interval over so few (Student's t) can miss the true mean"));
  EXPECT_THAT(ended.out, AllOf(StartsWith("front  setting "), HasSubstr("    1  acquisition="),
                               HasSubstr("robot_seconds [s]"), HasSubstr("rmse_m [mm]")));
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
    EXPECT_EQ(setting.at("seeds"), std::to_string(jobs));
    EXPECT_NEAR(std::stod(setting.at("rmse_m.mean")), sum / jobs, 1e-15);
    EXPECT_LT(std::stod(setting.at("rmse_m.low_95")), std::stod(setting.at("rmse_m.mean")));
  }
  environment_ = {"PATH=/nowhere"};
  const Ended undrawn = pareto(directory);
  EXPECT_EQ(undrawn.status, 0);
  EXPECT_EQ(undrawn.out, ended.out);
  EXPECT_THAT(undrawn.err, StartsWith("no picture was drawn: gnuplot is not installed, install the package"));
}

TEST_F(Pareto, TheCheapestSettingWithinIsAConfigThatRunsAsTheSameJob) {
  const fs::path directory = settings({"expect.taps=>= 1", "log.surface=true"});
  const Ended ended = pareto(directory, "--within 20cm");
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, StartsWith("# acquisition="));
  EXPECT_THAT(ended.out, HasSubstr("whose upper 95 % bound of rmse_m is at most 200 mm:\n# rmse_m "));
  EXPECT_THAT(ended.out, HasSubstr("; 4 seeds, of which this is the first.\ncomplete: 1\nname: "));
  EXPECT_THAT(ended.out, Not(HasSubstr("expect"))) << "what the sweep expected of all its runs";
  EXPECT_THAT(ended.err, HasSubstr("front  setting"));

  const fs::path again = ran("--runs again", write("best.yaml", ended.out));
  const fs::path job = directory / "jobs" / again.filename();
  for (const char* name : {"taps.csv", "surface.csv"}) EXPECT_EQ(text_of(again / name), text_of(job / name)) << name;
  const auto rmse = [](const fs::path& run_directory) {
    return std::get<double>(*parse_json_row(text_of(run_directory / "summary.json"))->find("rmse_m"));
  };
  EXPECT_EQ(rmse(again), rmse(job));
}

TEST_F(Pareto, WhereNothingIsWithinNamesTheNearestAndEndsWith1) {
  const Ended ended = pareto(settings(), "--within 1um");
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.out, "");
  EXPECT_THAT(
      ended.err,
      ContainsRegex(
          "\n"
          "no setting keeps rmse_m within 0.001 mm, the nearest is acquisition=[a-z]+, taps=[0-9]+: rmse_m [0-9.]+ .*\n"
          "$"));
}

TEST_F(Pareto, RefusesWhatCannotBeComparedInOneLine) {
  const fs::path sweep = settings();
  EXPECT_EQ(refused(words(sweep, "robot_second", "rmse_m")),
            "command line: --cost: results.csv has no column 'robot_second', did you mean 'robot_seconds'?\n");
  EXPECT_THAT(refused(words(sweep, "robot_seconds", "rmse_m") + Words{"--within", ""}), HasSubstr("--within"))
      << "a variable that is not set";
  fs::create_directory(here() / "empty");
  EXPECT_THAT(refused(words(here() / "empty", "robot_seconds", "rmse_m")),
              EndsWith("is neither a run nor a sweep, it has no record of one\n"));
}

}  // namespace
}  // namespace palpate
