// SPDX-License-Identifier: MIT
// `stop.expected_rmse` as a user meets it.
#include "system/shell.hpp"

#include <fmt/format.h>
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

TEST_F(Stops, AddNothingToTheTapsOfOtherRuns) {
  const fs::path directory = ran("taps=5", config("default.yaml"));
  EXPECT_THAT(text_of(directory / "taps.csv"), Not(HasSubstr("expected_rmse_m")));
  EXPECT_THAT(part_of(directory, "tap"), Not(HasSubstr("expected_rmse_m")));
}

// What is seen of the expected error, by every way on which people meet it.
TEST_F(Stops, AreNotNeededToSeeTheExpectedErrorInTableSummaryAndStatus) {
  const Ended ended = run({"taps=5"}, config("default.yaml"));
  EXPECT_THAT(ended.out, HasSubstr("contact      expected mm  error mm    IoU"));
  EXPECT_THAT(ended.out, ContainsRegex("\nerror: [0-9.]+ mm over the scene \\(expected [0-9.]+ mm\\), [0-9.]+ mm on"));
  const auto expected_in = [&] {
    return nlohmann::json::parse(text_of(directory() / "summary.json"))["expected_rmse_m"].get<double>();
  };
  const double expected = expected_in();
  EXPECT_THAT(status_of(directory()).out,
              HasSubstr(fmt::format("\nexpected error: {:.1f} mm over the scene\n", 1e3 * expected)));

  // A run that a kill has ended: what was expected before its last tap is known from the lines with the times.
  std::string record = text_of(directory() / "record.jsonl");
  record.resize(record.find("{\"objects\""));
  fs::remove(directory() / "summary.json");
  write(directory() / "record.jsonl", record);
  EXPECT_THAT(
      status_of(directory()).out,
      ContainsRegex("unfinished after 5 of 5 taps\nexpected error: [0-9.]+ mm over the scene, before the last tap\n"));
  EXPECT_EQ(resume(directory()).status, 0);
  EXPECT_EQ(expected_in(), expected);
}

TEST_F(Stops, AtBoundsThatMeanNothingAreRefused) {
  const auto refusal = [&](const std::string& word) { return refused({"run", config("default.yaml"), word}); };
  EXPECT_EQ(refusal("stop.expected_rmse=0 cm"),
            "command line: stop.expected_rmse: 0 cm is out of range, it must be above 0 m\n");
  EXPECT_EQ(refusal("stop.expected_rmse=1"),
            "command line: stop.expected_rmse: '1' has no unit, write a length like '1.7 cm'\n");
  EXPECT_EQ(refusal("stop.expected_rmse=1 s"),
            "command line: stop.expected_rmse: '1 s' is a time, not a length, write a length like '1.7 cm'\n");
  EXPECT_EQ(refusal("stop.expected_rms=1 cm"),
            "command line: unknown option 'expected_rms', did you mean 'expected_rmse'?\n");
}

}  // namespace
}  // namespace palpate
