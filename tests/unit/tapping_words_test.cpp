// SPDX-License-Identifier: MIT
// What a person is told of a tap before it is made, motion by motion.
#include "support/filled.hpp"
#include "support/requests.hpp"
#include "support/testing.hpp"
#include "tapping/motion.hpp"

namespace palpate::tapping {
namespace {

using ::testing::ElementsAre;

MotionOptions motion(const std::string& yaml) { return test::filled<MotionOptions>(yaml); }

/// The second tap of a run, at (3, 4) cm, where the models expect 5 +- 1 cm.
TapRequest second() {
  TapRequest out = test::request_at({0.03, 0.04}, 2);
  out.previous = line_from_above({0.115, 0.2});
  out.predicted = Prediction{0.05, 0.01};
  return out;
}

TEST(ATapInWords, SaysWayDescentAndForceOfEachMotion) {
  EXPECT_THAT(describe(motion("{type: paper}"), 0.0, second(), Target{0.115, 0.2}),
              ElementsAre("travel from (11.5, 20.0) cm to (3.0, 4.0) cm at 13.5 cm above the desk, 30.0 cm/s",
                          "descend at 2.4 cm/s in steps of 3.0 cm to at most 3.0 cm below the desk",
                          "stop at 10.0 N above the tare: a contact"));
  EXPECT_THAT(describe(motion("{type: two_stage, speed: 5 cm/s, threshold: 8 N}"), 0.0, second(), std::nullopt),
              ElementsAre("travel to (3.0, 4.0) cm at 13.5 cm above the desk, 30.0 cm/s",
                          "descend at 5.0 cm/s to at most 3.0 cm below the desk",
                          "stop at 8.0 N above the tare: a contact; then 2.0 cm back and again at 2.0 cm/s to 6.0 N"));
}

TEST(ATapInWords, HasTheHeightAtWhichAnAdaptiveDescentSlowsDown) {
  const MotionOptions adaptive = motion("{type: continuous, adaptive_hover: {deviations: 2, clearance: 1 cm}}");
  const double desk = 0.02;  // 5 cm expected + 2 * 1 cm + 1 cm are 6 cm above it
  EXPECT_EQ(describe(adaptive, desk, second(), std::nullopt)[1],
            "descend at 10.0 cm/s to 6.0 cm above the desk, just above what is expected, and on at 2.4 cm/s to at most "
            "3.0 cm below the desk");
}

}  // namespace
}  // namespace palpate::tapping
