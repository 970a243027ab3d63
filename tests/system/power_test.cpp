// SPDX-License-Identifier: MIT
// `palpate power` as a user calls it: the table of a pilot, and what it refuses.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

namespace palpate {
namespace {

class Power : public Shell {
 protected:
  /// A pilot of two strategies on these seeds.
  fs::path pilot(const std::string& seeds) const {
    return swept("acquisition=uncertainty,weighted taps=6 candidates.count=16 seed=" + seeds);
  }
  static Words words(const fs::path& sweep, const std::string& difference) {
    return {"power", sweep, "--by", "acquisition", "--metric", "rmse_m", "--difference", difference};
  }
};

TEST_F(Power, PlansSeedsFromTheDifferencesInResultsCsv) {
  const fs::path directory = pilot("range(0,8)");
  const Ended ended = palpate(words(directory, "0.5mm"));
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_THAT(ended.out, StartsWith("rmse_m [mm] by acquisition: seeds for a difference of 0.5 mm with 80 % power\n"));
  EXPECT_THAT(ended.out, HasSubstr("\nseeds needed: then, a two-sided paired t test at 5 % has this power"));

  std::map<std::string, double> differences;
  for (const Cells& job : csv_rows(text_of(directory / "results.csv")))
    differences[job.at("seed")] += (job.at("acquisition") == "weighted" ? 1e3 : -1e3) * std::stod(job.at("rmse_m"));
  double sum = 0.0;
  double squares = 0.0;
  for (const auto& [seed, difference] : differences) {
    sum += difference;
    squares += difference * difference;
  }
  std::smatch cells;
  ASSERT_TRUE(std::regex_search(ended.out, cells, std::regex(R"(weighted - uncertainty +8 +([0-9.]+) \[)")));
  EXPECT_NEAR(std::stod(cells[1]), std::sqrt((squares - sum * sum / 8.0) / 7.0), 0.06) << "one decimal or more";

  const Ended both = palpate(words(directory, "5") + "--metric object_taps,found --power 0.9");
  EXPECT_EQ(both.status, 2) << "rmse_m needs a unit";
  const Ended taps = palpate({"power", directory, "--by", "acquisition", "--metric", "object_taps,robot_seconds",
                              "--difference", "5", "--power", "0.9"});
  EXPECT_THAT(taps.err, HasSubstr("'5' has no unit, write a time"));
  EXPECT_THAT(taps.out, StartsWith("object_taps by acquisition: seeds for a difference of 5 with 90 % power\n"));
}

TEST_F(Power, RefusesADifferenceOrAPowerThatCannotBePlanned) {
  const fs::path directory = pilot("range(0,3)");
  for (const char* const difference : {"0mm", "-1mm"}) {
    EXPECT_EQ(refused(words(directory, difference)),
              "command line: --difference: not positive, give the smallest that matters\n");
  }
  EXPECT_EQ(refused(words(directory, "2")),
            "command line: --difference: '2' has no unit, write a length like '1.7 cm'\n");
  EXPECT_EQ(refused(words(directory, "2 N")),
            "command line: --difference: '2 N' is a force, not a length, write a length like '1.7 cm'\n");
  for (const char* const power : {"0.4", "1", "80"}) {
    EXPECT_EQ(refused(words(directory, "2mm") + Words{"--power", power}),
              "command line: --power: outside 0.5 to 0.99, 0.8 is usual\n");
  }
  EXPECT_THAT(refused({"power", directory, "--by", "acquisition", "--metric", "rmse_m"}),
              HasSubstr("--difference is required"));
}

TEST_F(Power, RefusesAPilotWithoutSpread) {
  const fs::path directory = pilot("range(0,3)");
  EXPECT_EQ(refused({"power", directory, "--by", "kernel", "--metric", "rmse_m", "--difference", "1mm"}),
            "command line: --by: this sweep does not vary 'kernel', known: acquisition, taps, candidates.count\n");
  EXPECT_EQ(refused(words(directory, "1mm") + Words{"--where", "seed < 2"}),
            "weighted - uncertainty: fewer than 3 common seeds, run more; see 'palpate compare'\n");
  EXPECT_EQ(refused({"power", directory, "--by", "acquisition", "--metric", "taps", "--difference", "1"}),
            "weighted - uncertainty: the sd is 0, as all differences are equal, choose another metric or group\n");
  fs::remove_all(here() / "runs");
  EXPECT_EQ(refused(words(pilot("7"), "1mm")),
            "command line: the seed is not swept, sweep it, as in \"seed=range(0,20)\"\n");
}

}  // namespace
}  // namespace palpate
