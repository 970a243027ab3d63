// SPDX-License-Identifier: MIT
#include "support/plugins.hpp"
#include "support/support.hpp"

#include <palpate/backend.hpp>
#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

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
class ReplayBackend : public testing::Test {
 protected:
  std::shared_ptr<Backend> open(const std::string& text, const std::string& more = "") {
    const std::string file = folder_.write("scan.csv", text).string();
    return make<Backend>(shared_host(), "replay", "{record: " + file + more + "}");
  }

  std::string refusal(const std::string& text) {
    try {
      open(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "nothing was thrown";
  }

  static Contact tap(Backend& backend, int number, double x, double y) {
    TapRequest request;
    request.number = number;
    request.target = {x, y};
    return backend.tap(request);
  }

  TemporaryFolder folder_;
};

TEST_F(ReplayBackend, AnswersByPlaceWithAllThatWasRecorded) {
  const Contact contact = tap(*open(kRecord), 17, 0.05, 0.05);
  EXPECT_EQ(contact.outcome, Outcome::contact);
  EXPECT_EQ(contact.height, 0.001);
  EXPECT_EQ(contact.force, 8.0);
  EXPECT_EQ(contact.seconds, 3.5);
  EXPECT_EQ(contact.reason, "");
}

TEST_F(ReplayBackend, TapsOfOnePlaceAreToldApartByTheirNumber) {
  const auto backend = open(kRecord);
  EXPECT_EQ(tap(*backend, 3, 0.1, 0.1).height, 0.08);
  EXPECT_EQ(tap(*backend, 2, 0.1, 0.1).height, 0.09);
  // No tap of that number there: the first one.
  EXPECT_EQ(tap(*backend, 9, 0.1, 0.1).height, 0.09);
}

TEST_F(ReplayBackend, NumberDoesNotCountAtAnotherPlace) { EXPECT_EQ(tap(*open(kRecord), 2, 0.05, 0.05).height, 0.001); }

TEST_F(ReplayBackend, AnswersAlikeWhateverCameBefore) {
  const auto backend = open(kRecord);
  const double first = tap(*backend, 2, 0.1, 0.1).height;
  tap(*backend, 3, 0.1, 0.1);
  tap(*backend, 1, 0.15, 0.15);
  EXPECT_EQ(tap(*backend, 2, 0.1, 0.1).height, first);
}

TEST_F(ReplayBackend, ATableWithTwoColumnsOfOneNameIsRefused) {
  const std::string line = refusal("x,y,outcome,height,x\n1,1,contact,1,1\n");
  EXPECT_THAT(line, HasSubstr("scan.csv: has two columns 'x', take one away, or name it otherwise"));
}

TEST_F(ReplayBackend, ANumberOfATapThatIsNoneIsRefused) {
  for (const char* number : {"1e300", "-1", "1.5", "2147483648"}) {
    EXPECT_THAT(refusal(std::string("tap,x,y,outcome,height\n") + number + ",0.1,0.1,contact,0.1\n"),
                HasSubstr(std::string("scan.csv:2: tap: '") + number + "' is not a whole number from 0 on"));
  }
}

TEST_F(ReplayBackend, CellsInQuotesMayHoldCommasQuotesAndLineEnds) {
  const auto backend = open(
      "x,y,outcome,height,\"a \"\"note\"\", long\"\r\n"
      "0.1,0.1,\"contact\",0.07,\"said \"\"no\"\",\nthen yes\"\r\n"
      "0.2,0.2,contact,0.08,\r\n");
  EXPECT_EQ(tap(*backend, 1, 0.1, 0.1).height, 0.07);
  EXPECT_EQ(tap(*backend, 1, 0.2, 0.2).height, 0.08);
  EXPECT_THAT(refusal("x,y,outcome,height,note\n1,1,contact,1,\"a\nb\"\n1,1,touched,1,\n"),
              HasSubstr("scan.csv:4: unknown outcome 'touched'"));
  EXPECT_THAT(refusal("x,y,outcome,height,\"=note\"\n1,1,\"contact,1,1\n"),
              HasSubstr("scan.csv:2: has another number of"));
}

TEST_F(ReplayBackend, TakesTheApostropheAwayThatKeepsSpreadsheetsFromComputing) {
  EXPECT_THAT(refusal("x,y,outcome,height\n1,1,'=1+1,1\n"), HasSubstr("unknown outcome '=1+1'"));
  EXPECT_THAT(refusal("x,y,outcome,height\n1,1,''=1,1\n"), HasSubstr("unknown outcome ''=1'"));
  EXPECT_THAT(refusal("x,y,outcome,height\n1,1,'contact,1\n"), HasSubstr("unknown outcome ''contact'"));
}

TEST_F(ReplayBackend, RecordedFailureStaysAFailure) {
  const Contact contact = tap(*open(kRecord), 4, 0.2, 0.2);
  EXPECT_EQ(contact.outcome, Outcome::timeout);
  EXPECT_EQ(contact.height, 0.0);
  EXPECT_EQ(contact.seconds, 30.0);
  EXPECT_NE(contact.reason, "");
}

TEST_F(ReplayBackend, PlaceThatWasNotRecordedIsUnreachable) {
  const Contact contact = tap(*open(kRecord), 1, 0.15, 0.15);
  EXPECT_EQ(contact.outcome, Outcome::unreachable);
  EXPECT_EQ(contact.reason, "no tap was recorded at this place");
}

TEST_F(ReplayBackend, ToleranceDecidesWhatIsNear) {
  EXPECT_EQ(tap(*open(kRecord), 1, 0.0505, 0.05).outcome, Outcome::unreachable);
  const auto wide = open(kRecord, ", tolerance: 1 mm");
  EXPECT_EQ(tap(*wide, 1, 0.0505, 0.05).outcome, Outcome::contact);
  EXPECT_EQ(tap(*wide, 1, 0.0515, 0.05).outcome, Outcome::unreachable);
}

TEST_F(ReplayBackend, NearestPlaceWithinTheToleranceAnswers) {
  const auto backend = open("x,y,outcome,height\n0.1,0.1,contact,0.01\n0.104,0.1,contact,0.02\n", ", tolerance: 1 cm");
  EXPECT_EQ(tap(*backend, 1, 0.101, 0.1).height, 0.01);
  EXPECT_EQ(tap(*backend, 1, 0.103, 0.1).height, 0.02);
}

TEST_F(ReplayBackend, ZeroToleranceWantsTheVeryPlace) {
  const auto backend = open(kRecord, ", tolerance: 0 m");
  EXPECT_EQ(tap(*backend, 1, 0.05, 0.05).outcome, Outcome::contact);
  EXPECT_EQ(tap(*backend, 1, 0.05, 0.0500001).outcome, Outcome::unreachable);
}

TEST_F(ReplayBackend, ColumnsMayComeInAnyOrderWithOthersAndQuotedCommas) {
  const auto backend = open("reason,height,outcome,y,x\r\n\"none, all well\",0.03,contact,0.2,0.1\r\n");
  EXPECT_EQ(tap(*backend, 1, 0.1, 0.2).height, 0.03);
  EXPECT_EQ(tap(*backend, 1, 0.1, 0.2).seconds, 0.0);
}

TEST_F(ReplayBackend, IsRepeatableAndSaysWhatItIsTold) {
  EXPECT_TRUE(open(kRecord)->repeatable());
  EXPECT_FALSE(open(kRecord)->scene_is_truth());
  EXPECT_TRUE(open(kRecord, ", scene_is_truth: true")->scene_is_truth());
}

TEST_F(ReplayBackend, MissingColumnIsNamed) {
  EXPECT_THAT(refusal("x,y,outcome\n0.1,0.1,contact\n"), HasSubstr("scan.csv: has no column 'height'"));
}

TEST_F(ReplayBackend, BadNumberIsNamedWithItsLine) {
  EXPECT_THAT(refusal("x,y,outcome,height\n0.1,0.1,contact,0.1\n0.1,4cm,contact,0.1\n"),
              HasSubstr("scan.csv:3: y: '4cm' is not a number"));
  EXPECT_THAT(refusal("x,y,outcome,height\n0.1,0.1,contact,nan\n"),
              HasSubstr("scan.csv:2: height: 'nan' is not a number"));
}

TEST_F(ReplayBackend, ContactWithoutAHeightIsRefused) {
  EXPECT_THAT(refusal("x,y,outcome,height\n0.1,0.1,contact,\n"), HasSubstr("scan.csv:2: lacks x, y or height"));
}

TEST_F(ReplayBackend, UnknownOutcomeIsRefused) {
  EXPECT_THAT(refusal("x,y,outcome,height\n0.1,0.1,hit,0.1\n"), HasSubstr("scan.csv:2: unknown outcome 'hit'"));
}

TEST_F(ReplayBackend, ShortLineIsRefused) {
  EXPECT_THAT(refusal("x,y,outcome,height\n0.1,0.1,contact\n"), HasSubstr("scan.csv:2: has another number of cells"));
}

TEST_F(ReplayBackend, EmptyFileIsRefused) { EXPECT_THAT(refusal(""), HasSubstr("scan.csv: cannot be read")); }

TEST_F(ReplayBackend, MissingFileIsRefused) {
  try {
    make<Backend>(shared_host(), "replay", "{record: /nowhere/scan.csv}");
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("/nowhere/scan.csv: cannot be read"));
  }
}

TEST_F(ReplayBackend, RecordMustBeNamed) { EXPECT_THROW(make<Backend>(shared_host(), "replay"), Error); }

TEST_F(ReplayBackend, ARunIsARecord) {
  const std::string paper = (source_folder() / "configs" / "paper" / "object_i.yaml").string();
  ASSERT_EQ(palpate({"run", paper, "taps=5"}, folder_.path()).status, 0);
  const std::string run = only_run(folder_.path() / "runs").string();
  const Ended again =
      palpate({"run", paper, "taps=5", "backend={type: replay, record: " + run + "}", "--runs", "again", "--json"},
              folder_.path());
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("\"failed_taps\": 0"));
}

}  // namespace
}  // namespace palpate::test
