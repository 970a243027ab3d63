// SPDX-License-Identifier: MIT
// `stop.expected_rmse` as a user meets it.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>

namespace palpate {
namespace {

using Stops = Shell;

TEST_F(Stops, AtTheExpectedErrorAreInTheRecordAndReplayed) {
  const fs::path directory = ran({"scene=dome", "taps=60", "stop.expected_rmse=1.5 cm"}, config("default.yaml"));
  const nlohmann::json summary = nlohmann::json::parse(text_of(directory / "summary.json"));
  EXPECT_EQ(summary["stop_reason"], "expected_rmse");
  EXPECT_LT(summary["taps"], 60);
  EXPECT_LT(summary["expected_rmse_m"], 0.015);

  for (const std::string& line : lines_of(part_of(directory, "tap"))) {
    const nlohmann::json tap = nlohmann::json::parse(line);
    ASSERT_TRUE(tap.contains("expected_rmse_m"));
    EXPECT_EQ(tap["expected_rmse_m"].is_null(), tap["tap"] <= summary["first_hit_tap"]);
  }
  const Ended replay = palpate({"replay", directory});
  EXPECT_THAT(replay.out, MatchesRegex("[0-9]+ taps, [0-9]+ numbers, all equal\n")) << replay.err;
}

TEST_F(Stops, AddNothingToTheRecordOfOtherRuns) {
  const fs::path directory = ran("taps=5", config("default.yaml"));
  for (const char* file : {"record.jsonl", "taps.csv", "summary.json"})
    EXPECT_THAT(text_of(directory / file), Not(HasSubstr("expected_rmse_m"))) << file;
}

TEST_F(Stops, AtBoundsThatMeanNothingAreRefused) {
  const auto refusal = [&](const std::string& word) { return refused({"run", config("default.yaml"), word}); };
  EXPECT_EQ(refusal("stop.expected_rmse=0 cm"),
            "command line: stop.expected_rmse: 0 cm is out of range, it must be above 0 m\n");
  EXPECT_EQ(refusal("stop.expected_rmse=1"),
            "command line: stop.expected_rmse: '1' lacks its unit, write a length like '1.7 cm'\n");
  EXPECT_EQ(refusal("stop.expected_rmse=1 s"),
            "command line: stop.expected_rmse: '1 s' is a time, not a length, write a length like '1.7 cm'\n");
  EXPECT_EQ(refusal("stop.expected_rms=1 cm"),
            "command line: unknown option 'expected_rms', did you mean 'expected_rmse'?\n");
}

}  // namespace
}  // namespace palpate
