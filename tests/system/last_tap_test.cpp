// SPDX-License-Identifier: MIT
// A robot that can no longer go on: the tap is recorded, the run fails with the reason, and is carried on when the
// robot was seen to.
#include "support/support.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace palpate {
namespace {

constexpr const char* kReason = "backend/cannot_go_on: the e-stop is pressed";

class ARunWhoseRobotCannotGoOn : public ::testing::Test {
 protected:
  Ended palpate(std::vector<std::string> words) const {
    return test::palpate(words, folder_.path(),
                         {"PALPATE_PLUGIN_PATH=" + test::bad_plugin_folder("cannot_go_on").string()});
  }
  Ended run(const std::string& acquisition, const std::string& extra = "seed=1") const {
    return palpate({"run", test::paper(), "backend.type=cannot_go_on", "acquisition=" + acquisition, extra, "--quiet"});
  }
  fs::path directory() const { return only_run(folder_.path() / "runs"); }
  Ended resume() const { return palpate({"resume", directory().string(), "--retry-failed"}); }
  std::string text(const char* file) const { return text_of(directory() / file); }
  void expect_replayed(int taps) const {
    const Ended ended = palpate({"replay", directory().string()});
    EXPECT_THAT(ended.out, MatchesRegex(std::to_string(taps) + " taps, [0-9]+ numbers, all equal\n")) << ended.err;
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(ARunWhoseRobotCannotGoOn, RecordsTheTapAndFailsWithItsReason) {
  const Ended ended = run("weighted");
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, std::string(kReason) + "\n");
  EXPECT_THAT(text("summary.json"), HasSubstr("\"status\": \"failed\""));
  EXPECT_THAT(text("summary.json"), HasSubstr("\"stop_reason\": \"" + std::string(kReason) + "\""));
  EXPECT_THAT(text("summary.json"), HasSubstr("\"failed_taps\": 1,"));
  const std::string taps = text("taps.jsonl");
  EXPECT_EQ(test::lines(taps), 10) << "an intent and a result for each of five taps";
  const std::string last = taps.substr(taps.rfind('\n', taps.size() - 2) + 1);
  EXPECT_THAT(last, HasSubstr("\"tap\": 5,"));
  EXPECT_THAT(last, HasSubstr("\"outcome\": \"aborted\", \"reason\": \"the e-stop is pressed\""));
  EXPECT_THAT(last, Not(HasSubstr("intent")));
  EXPECT_EQ(test::lines(text("taps.csv")), 6);
  EXPECT_THAT(palpate({"status", directory().string()}).out, HasSubstr(kReason));
}

TEST_F(ARunWhoseRobotCannotGoOn, IsCarriedOnOnlyWhenAskedAndRepeatsNoTap) {
  run("weighted");
  const std::string before = text("taps.jsonl");
  const Ended refused = palpate({"resume", directory().string()});
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("this run failed: " + std::string(kReason) + ", --retry-failed carries on"));
  EXPECT_EQ(text("taps.jsonl"), before);

  const Ended ended = resume();
  EXPECT_EQ(ended.status, 0) << ended.err;
  const std::string after = text("taps.jsonl");
  EXPECT_EQ(after.substr(0, before.size()), before);
  EXPECT_EQ(after.substr(before.size(), 26), "{\"tap\": 6, \"intent\": true,");
  EXPECT_EQ(test::lines(after), 34);
  EXPECT_THAT(text("taps.csv"), Not(HasSubstr("unknown"))) << "no tap was left with an intent alone";
  EXPECT_THAT(text("summary.json"), HasSubstr("\"stop_reason\": \"tap budget\""));
  EXPECT_THAT(text("summary.json"), HasSubstr("\"failed_taps\": 1,"));
}

TEST_F(ARunWhoseRobotCannotGoOn, IsReplayedAsItFailedAndAsItWentOn) {
  // A random search reads no model: what there is of one in the record is there because the backend showed it.
  run("random");
  ASSERT_THAT(text("taps.jsonl"), HasSubstr("\"signal\": 1"));
  expect_replayed(5);
  EXPECT_EQ(resume().status, 0);
  expect_replayed(17);
}

TEST_F(ARunWhoseRobotCannotGoOn, FailsAtItsLastTapTooAndThenNeedsNoOther) {
  EXPECT_EQ(run("weighted", "taps=5").status, 1);
  expect_replayed(5);
  EXPECT_EQ(resume().status, 0);
  EXPECT_EQ(test::lines(text("taps.jsonl")), 10);
  EXPECT_THAT(text("summary.json"), HasSubstr("\"stop_reason\": \"tap budget\""));
}

TEST_F(ARunWhoseRobotCannotGoOn, IsABenchForOtherRunsInWhichTheTapMerelyFailed) {
  run("weighted", "taps=5");
  const Ended ended = palpate({"run", test::paper(), "backend=replay", "backend.record=" + directory().string(),
                               "taps=5", "--runs", "second", "--quiet", "--json"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("\"failed_taps\": 1"));
}

}  // namespace
}  // namespace palpate
