// SPDX-License-Identifier: MIT
#include "support/requests.hpp"
#include "support/testing.hpp"

#include <palpate/backend.hpp>

namespace palpate::test {
namespace {

using testing::HasSubstr;

const char* const kRecord =
    "tap,x,y,outcome,height,force,robot_seconds\n"
    "1,0.05,0.05,contact,0.001,8,3.5\n"
    "2,0.1,0.1,contact,0.09,9,2.5\n"
    "3,0.1,0.1,contact,0.08,7,1.5\n"
    "4,0.2,0.2,timeout,,,30\n";

/// A record on disk and the backend that answers from it.
class ReplayBackend : public InFolder {
 protected:
  std::shared_ptr<Backend> open(const std::string& text, const std::string& more = "") {
    const std::string file = folder_.write("scan.csv", text).string();
    return make<Backend>(shared_host(), "replay", "{record: " + file + more + "}");
  }

  std::string refusal(const std::string& text) {
    return error_of([&] { open(text); });
  }

  static TapResult tap(Backend& backend, int number, double x, double y) {
    return backend.tap(request_at({x, y}, number));
  }
};

TEST_F(ReplayBackend, AnswersByPlaceWithAllThatWasRecorded) {
  const TapResult contact = tap(*open(kRecord), 17, 0.05, 0.05);
  EXPECT_EQ(contact.outcome, Outcome::contact);
  EXPECT_EQ(contact.height(), 0.001);
  EXPECT_EQ(contact.force, 8.0);
  EXPECT_EQ(contact.seconds, 3.5);
  EXPECT_EQ(contact.reason, "");
}

TEST_F(ReplayBackend, ReadsATableWithAByteOrderMarkAndBlankLinesAtItsEnd) {
  for (const char* end : {"", "\n", "\n\n", "\r\n\r\n", "\n  \n"})
    EXPECT_EQ(refusal("\xef\xbb\xbfx,y,outcome,height\n0.1,0.1,contact,0.05" + std::string(end)), "accepted");
  EXPECT_THAT(refusal("x,y,outcome,height\n\n0.1,0.1,contact,0.05\n"),
              HasSubstr("scan.csv:2: has a different number of"));
}

TEST_F(ReplayBackend, TapsOfOnePlaceAreToldApartByTheirNumberWhateverCameBefore) {
  const auto backend = open(kRecord);
  EXPECT_EQ(tap(*backend, 2, 0.1, 0.1).height(), 0.09);
  EXPECT_EQ(tap(*backend, 3, 0.1, 0.1).height(), 0.08);
  EXPECT_EQ(tap(*backend, 2, 0.1, 0.1).height(), 0.09);
  // No tap of that number there: the first one.
  EXPECT_EQ(tap(*backend, 9, 0.1, 0.1).height(), 0.09);
  EXPECT_EQ(tap(*backend, 1, 0.15, 0.15).outcome, Outcome::unreachable);
  EXPECT_EQ(tap(*backend, 2, 0.1, 0.1).height(), 0.09);
  EXPECT_EQ(tap(*backend, 2, 0.05, 0.05).height(), 0.001) << "the number does not count at another place";
}

TEST_F(ReplayBackend, ANumberOfATapThatIsNoneIsRefused) {
  for (const char* number : {"1e300", "-1", "1.5", "2147483648"}) {
    EXPECT_THAT(refusal(std::string("tap,x,y,outcome,height\n") + number + ",0.1,0.1,contact,0.1\n"),
                HasSubstr(std::string("scan.csv:2: tap: '") + number + "' is not a whole number of at least 0"));
  }
}

TEST_F(ReplayBackend, WhatNoArmCanHaveMeasuredIsRefusedWithItsLine) {
  const auto row = [](const std::string& values) {
    return "x,y,outcome,height,force,robot_seconds\n0.1,0.1,contact,0.1,8,2\n0.1,0.1,contact," + values + "\n";
  };
  EXPECT_THAT(refusal(row("70,8,2")), HasSubstr("scan.csv:3: height 70 m is outside -10 to 10 m (no arm is that long), "
                                                "give metres in the scene's frame (are these millimetres?)"));
  EXPECT_THAT(refusal(row("0.1,-8,2")), HasSubstr("scan.csv:3: force -8 N is outside 0 to 1000 N"));
  EXPECT_THAT(refusal(row("0.1,8,-2")), HasSubstr("scan.csv:3: seconds -2 is outside 0 to 86400"));
}

TEST_F(ReplayBackend, CellsInQuotesMayHoldCommasQuotesAndLineEnds) {
  const auto backend = open(
      "x,y,outcome,height,\"a \"\"note\"\", long\"\r\n"
      "0.1,0.1,\"contact\",0.07,\"said \"\"no\"\",\nthen yes\"\r\n"
      "0.2,0.2,contact,0.08,\r\n");
  EXPECT_EQ(tap(*backend, 1, 0.1, 0.1).height(), 0.07);
  EXPECT_EQ(tap(*backend, 1, 0.2, 0.2).height(), 0.08);
  EXPECT_THAT(refusal("x,y,outcome,height,note\n1,1,contact,1,\"a\nb\"\n1,1,touched,1,\n"),
              HasSubstr("scan.csv:4: unknown outcome 'touched'"));
  EXPECT_THAT(refusal("x,y,outcome,height,\"=note\"\n1,1,\"contact,1,1\n"),
              HasSubstr("scan.csv:2: has a different number of"));
}

TEST_F(ReplayBackend, TakesTheApostropheAwayThatKeepsSpreadsheetsFromComputing) {
  EXPECT_THAT(refusal("x,y,outcome,height\n1,1,'=1+1,1\n"), HasSubstr("unknown outcome '=1+1'"));
  EXPECT_THAT(refusal("x,y,outcome,height\n1,1,''=1,1\n"), HasSubstr("unknown outcome ''=1'"));
  EXPECT_THAT(refusal("x,y,outcome,height\n1,1,'contact,1\n"), HasSubstr("unknown outcome ''contact'"));
}

TEST_F(ReplayBackend, RecordedFailureStaysAFailure) {
  const TapResult contact = tap(*open(kRecord), 4, 0.2, 0.2);
  EXPECT_EQ(contact.outcome, Outcome::timeout);
  EXPECT_FALSE(contact.contact);
  EXPECT_EQ(contact.seconds, 30.0);
  EXPECT_NE(contact.reason, "");
}

TEST_F(ReplayBackend, PlaceThatWasNotRecordedIsUnreachable) {
  const TapResult contact = tap(*open(kRecord), 1, 0.15, 0.15);
  EXPECT_EQ(contact.outcome, Outcome::unreachable);
  EXPECT_EQ(contact.reason, "no tap was recorded at this place");
}

TEST_F(ReplayBackend, ToleranceDecidesWhatIsNear) {
  EXPECT_EQ(tap(*open(kRecord), 1, 0.0505, 0.05).outcome, Outcome::unreachable);
  const auto wide = open(kRecord, ", tolerance: 1 mm");
  EXPECT_EQ(tap(*wide, 1, 0.0505, 0.05).outcome, Outcome::contact);
  EXPECT_EQ(tap(*wide, 1, 0.0515, 0.05).outcome, Outcome::unreachable);
  const auto none = open(kRecord, ", tolerance: 0 m");
  EXPECT_EQ(tap(*none, 1, 0.05, 0.05).outcome, Outcome::contact);
  EXPECT_EQ(tap(*none, 1, 0.05, 0.0500001).outcome, Outcome::unreachable) << "it wants the very place";
}

TEST_F(ReplayBackend, NearestPlaceWithinTheToleranceAnswers) {
  const auto backend = open("x,y,outcome,height\n0.1,0.1,contact,0.01\n0.104,0.1,contact,0.02\n", ", tolerance: 1 cm");
  EXPECT_EQ(tap(*backend, 1, 0.101, 0.1).height(), 0.01);
  EXPECT_EQ(tap(*backend, 1, 0.103, 0.1).height(), 0.02);
}

TEST_F(ReplayBackend, ColumnsMayComeInAnyOrderWithOthersAndQuotedCommas) {
  const auto backend = open("reason,height,outcome,y,x\r\n\"none, all well\",0.03,contact,0.2,0.1\r\n");
  EXPECT_EQ(tap(*backend, 1, 0.1, 0.2).height(), 0.03);
  EXPECT_EQ(tap(*backend, 1, 0.1, 0.2).seconds, 0.0);
}

TEST_F(ReplayBackend, NumbersMayHaveASignAndBlanksBeforeThem) {
  const TapResult contact = tap(*open("x,y,outcome,height\n +0.1,\t0.2,contact,\t+1.2e-2\n"), 1, 0.1, 0.2);
  EXPECT_EQ(contact.outcome, Outcome::contact);
  EXPECT_EQ(contact.height(), 0.012);
}

TEST_F(ReplayBackend, IsRepeatableAndSaysWhatItIsTold) {
  EXPECT_TRUE(open(kRecord)->repeatable());
  EXPECT_FALSE(open(kRecord)->scene_is_truth());
  EXPECT_TRUE(open(kRecord, ", scene_is_truth: true")->scene_is_truth());
}

TEST_F(ReplayBackend, WhatATableLacksOrCannotMeanIsNamedWithItsLine) {
  const std::string head = "x,y,outcome,height\n";
  const std::pair<std::string, const char*> cases[] = {
      {"x,y,outcome\n0.1,0.1,contact\n", "scan.csv: has no column 'height'"},
      {"x,y,outcome,height,x\n1,1,contact,1,1\n", "scan.csv: has two columns 'x', remove or rename one of them"},
      {head + "0.1,0.1,contact,0.1\n0.1,4cm,contact,0.1\n",
       "scan.csv:3: y: '4cm' is not a number, write it without a unit, such as"},
      {head + "0.1,0.1,contact,+-0.1\n", "scan.csv:2: height: '+-0.1' is not a number"},
      {head + "0.1,0.1,contact,nan\n", "scan.csv:2: height: 'nan' is not a number"},
      {head + "0.1,0.1,contact,\n", "scan.csv:2: lacks x, y or height"},
      {head + "0.1,0.1,hit,0.1\n", "scan.csv:2: unknown outcome 'hit'"},
      {head + "0.1,0.1,contact\n", "scan.csv:2: has a different number of cells"}};
  for (const auto& [text, message] : cases) EXPECT_THAT(refusal(text), HasSubstr(message));
}

TEST_F(ReplayBackend, EmptyOrMissingFileIsRefused) {
  EXPECT_THAT(refusal(""), HasSubstr("scan.csv: cannot be read"));
  EXPECT_THAT(error_of([] { make<Backend>(shared_host(), "replay", "{record: /nowhere/scan.csv}"); }),
              HasSubstr("/nowhere/scan.csv: cannot be read"));
}

TEST_F(ReplayBackend, RecordMustBeNamed) { EXPECT_THROW(make<Backend>(shared_host(), "replay"), Error); }

}  // namespace
}  // namespace palpate::test
