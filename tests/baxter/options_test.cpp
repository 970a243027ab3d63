// SPDX-License-Identifier: MIT
// Rejection of options that are unsafe for an arm.
#include "baxter/options.hpp"
#include "support/filled.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::baxter {
namespace {

using testing::HasSubstr;

/// Returns the error for these options of motion, with the mandatory ones added; empty if they are accepted.
std::string refusal(const std::string& motion, const std::string& more = "") {
  try {
    palpate::test::filled<BaxterOptions>(
        "{tool: {tip: [0 cm, 0 cm, 15 cm]}, scene_pose: {corner: [50 cm, 7 cm], height: "
        "-17 cm}, motion: " +
        motion + more + "}");
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(BaxterOptions, OfTheShippedMotionsAreTaken) {
  EXPECT_EQ(refusal("{type: paper}"), "");
  EXPECT_EQ(refusal("{type: two_stage}"), "");
  EXPECT_EQ(refusal("{type: continuous, adaptive_hover: {}}"), "");
}

TEST(BaxterOptions, WithWhichTheFirmwareWouldStopTheArmAreRefused) {
  EXPECT_THAT(refusal("{type: paper, threshold: 12.5 N}"), HasSubstr("choose at most 10 N"));
  EXPECT_THAT(refusal("{type: two_stage, threshold: 6 N, fine_threshold: 20 N}"),
              HasSubstr("must not lie above motion.threshold"));
  EXPECT_THAT(refusal("{type: paper, threshold: 10 N}", ", force_stop: 9 N"),
              HasSubstr("must lie above motion.threshold"));
  EXPECT_THAT(refusal("{type: paper}", ", force_stop: 16 N"), HasSubstr("force_stop"));
}

TEST(BaxterOptions, ThatComeDownTooFastOrTooFarAreRefused) {
  EXPECT_THAT(refusal("{type: continuous, speed: 20 cm/s}"), HasSubstr("choose at most 10 cm/s"));
  EXPECT_THAT(refusal("{type: two_stage, fine_speed: 20 cm/s}"), HasSubstr("choose at most 10 cm/s"));
  EXPECT_THAT(refusal("{type: paper, adaptive_hover: {speed: 20 cm/s}}"), HasSubstr("choose at most 10 cm/s"));
  EXPECT_THAT(refusal("{type: paper, overrun: 20 cm}"), HasSubstr("choose an overrun of at most 10 cm"));
  EXPECT_EQ(refusal("{type: per_tap, of: [{type: continuous}, {type: paper}]}"), "");
  EXPECT_THAT(refusal("{type: per_tap, of: [{type: continuous}, {type: continuous, speed: 20 cm/s}]}"),
              AllOf(HasSubstr("motion.of.1.speed"), HasSubstr("choose at most 10 cm/s")));
}

TEST(BaxterOptions, WithWhichATapWouldMeanNothingOrNeverEndAreRefused) {
  EXPECT_THAT(refusal("{type: paper, threshold: 1 N}"), HasSubstr("choose at least 3 N"));
  EXPECT_THAT(refusal("{type: two_stage, fine_threshold: 1 N}"), HasSubstr("choose at least 3 N"));
  EXPECT_THAT(refusal("{type: paper, tare: 0 s}"), HasSubstr("choose at least 100 ms"));
  EXPECT_THAT(refusal("{type: paper, travel_speed: 0.1 mm/s}"), HasSubstr("choose at least 1 cm/s for both"));
  EXPECT_THAT(refusal("{type: paper, retreat_speed: 0.1 mm/s}"), HasSubstr("at least 1 cm/s"));
}

TEST(BaxterOptions, ThatAreNoNumbersAreRefused) {
  EXPECT_NE(refusal("{type: paper, threshold: nan N}"), "");
  EXPECT_NE(refusal("{type: paper, speed: inf cm/s}"), "");
}

}  // namespace
}  // namespace palpate::baxter
