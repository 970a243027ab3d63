// SPDX-License-Identifier: MIT
// A robot that can no longer go on: the tap is recorded, the run fails with the reason, and is carried on when the
// robot was seen to.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace palpate {
namespace {

const std::string kReason = "backend/cannot_go_on: the e-stop is pressed";

class ARunWhoseRobotCannotGoOn : public Shell {
 protected:
  ARunWhoseRobotCannotGoOn() { environment_ = {test::with_plugin("cannot_go_on")}; }

  Ended fail(const Words& more = {}) const { return run(Words("backend.type=cannot_go_on --quiet") + more); }
  Ended retry() const { return resume(directory(), "--retry-failed"); }
  std::string text(const char* file) const { return text_of(directory() / file); }
  /// Announcements and results, one a line.
  std::string taps() const { return test::lasting_part_of(directory()); }
  void expect_replayed(int taps) const {
    const Ended ended = palpate({"replay", directory()});
    EXPECT_THAT(ended.out, MatchesRegex(std::to_string(taps) + " taps, [0-9]+ numbers, all equal\n")) << ended.err;
  }
};

TEST_F(ARunWhoseRobotCannotGoOn, RecordsTheTapAndFailsWithItsReason) {
  const Ended ended = fail();
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, kReason + "\n");
  EXPECT_THAT(text("summary.json"),
              AllOf(HasSubstr("\"status\": \"failed\""), HasSubstr("\"stop_reason\": \"" + kReason + "\""),
                    HasSubstr("\"failed_taps\": 1,")));
  const std::string made = taps();
  EXPECT_EQ(lines(made), 10) << "an intent and a result for each of five taps";
  EXPECT_THAT(
      made.substr(made.rfind('\n', made.size() - 2) + 1),
      AllOf(StartsWith("{\"tap\": 5,"), HasSubstr("\"outcome\": \"aborted\", \"reason\": \"the e-stop is pressed\"")));
  EXPECT_EQ(lines(text("taps.csv")), 6);
  EXPECT_THAT(status_of(directory()).out, HasSubstr(kReason));
}

TEST_F(ARunWhoseRobotCannotGoOn, IsCarriedOnOnlyWhenAskedAndRepeatsNoTap) {
  fail();
  const std::string before = taps();
  EXPECT_THAT(refused({"resume", directory()}, 1),
              HasSubstr("this run failed: " + kReason + ", resume it with --retry-failed"));
  EXPECT_EQ(taps(), before);

  EXPECT_EQ(retry().status, 0);
  const std::string after = taps();
  EXPECT_EQ(after.substr(0, before.size()), before);
  EXPECT_EQ(after.substr(before.size(), 13), "{\"intent\": 6,");
  EXPECT_EQ(lines(after), 34);
  EXPECT_THAT(text("taps.csv"), Not(HasSubstr("unknown"))) << "no tap was left with an intent alone";
  EXPECT_THAT(text("summary.json"),
              AllOf(HasSubstr("\"stop_reason\": \"tap budget\""), HasSubstr("\"failed_taps\": 1,")));
}

TEST_F(ARunWhoseRobotCannotGoOn, IsReplayedAsItFailedAndAsItWentOn) {
  // A random search reads no model: what there is of one in the record is there because the backend showed it.
  fail("acquisition=random");
  ASSERT_THAT(taps(), HasSubstr("\"signal\": 1"));
  expect_replayed(5);
  EXPECT_EQ(retry().status, 0);
  expect_replayed(17);
}

TEST_F(ARunWhoseRobotCannotGoOn, FailsAtItsLastTapTooAndThenNeedsNoOther) {
  EXPECT_EQ(fail("taps=5").status, 1);
  expect_replayed(5);
  const Ended bench =
      run({"backend=replay", "backend.record=" + directory().string(), "taps=5", "--runs", "second", "--json"});
  EXPECT_EQ(bench.status, 0) << bench.err;
  EXPECT_THAT(bench.out, HasSubstr("\"failed_taps\": 1")) << "to other runs, the tap merely failed";
  EXPECT_EQ(retry().status, 0);
  EXPECT_EQ(lines(taps()), 10);
  EXPECT_THAT(text("summary.json"), HasSubstr("\"stop_reason\": \"tap budget\""));
}

}  // namespace
}  // namespace palpate
