// SPDX-License-Identifier: MIT
// The motions of configs/backend on an arm like Baxter's: whole runs of the paper's experiment, tap by tap.
#include "config/compose.hpp"
#include "experiment/experiment.hpp"
#include "record/resolved_config.hpp"
#include "support/runs.hpp"
#include "support/support.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::test {
namespace {

struct Motion {
  double error = 0.0;    ///< rms of the heights of contacts, m
  double seconds = 0.0;  ///< a tap
  int taps = 0;
};

Motion measured(const std::string& motion, int seeds) {
  Motion out;
  for (int seed = 0; seed < seeds; ++seed) {
    const ResolvedConfig config = shipped_config(
        "paper/object_i.yaml", {"scene=object_i_arm", "belief.surface=two_part", "belief.height.signal=5cm",
                                "motion=" + motion, "seed=" + std::to_string(seed)});
    Experiment experiment(config.options, {shared_host()});
    Collector collector;
    experiment.run(collector);
    for (const TapRecord& tap : collector.taps) {
      EXPECT_EQ(tap.result.outcome, Outcome::contact);
      out.error += std::pow(tap.result.height() - experiment.scene().height(tap.target().x, tap.target().y), 2);
      out.seconds += tap.result.seconds;
      ++out.taps;
    }
  }
  out.error = std::sqrt(out.error / out.taps);
  out.seconds /= out.taps;
  return out;
}

TEST(Motions, OfThePaperHasTheErrorAndTheTimeThatAreKnownOfIt) {
  const Motion paper = measured("paper", 40);
  EXPECT_NEAR(paper.error, 0.013, 0.0012);
  EXPECT_NEAR(paper.seconds, 6.4, 0.4);
}

TEST(Motions, OfOurOwnAreExactToTwoMillimetresAtLessThanFiveSeconds) {
  for (const char* motion : {"continuous", "adaptive"}) {
    const Motion ours = measured(motion, 40);
    EXPECT_LT(ours.error, 0.002) << motion;
    EXPECT_LT(ours.seconds, 5.0) << motion;
  }
}

TEST(Motions, AdaptiveHoverSavesTimeWhereTheModelIsSure) {
  // A long length scale: after a few taps the height of a block is known everywhere.
  const auto seconds = [](const std::string& motion) {
    const ResolvedConfig config =
        shipped_config("paper/object_ii.yaml", {"kernel.length_scale=10cm", "belief.surface=two_part",
                                                "belief.height.signal=5cm", "taps=30", "seed=3", "motion=" + motion});
    Experiment experiment(config.options, {shared_host()});
    Collector collector;
    experiment.run(collector);
    return experiment.result().robot_seconds;
  };
  EXPECT_LT(seconds("adaptive"), 0.95 * seconds("continuous"));
}

}  // namespace
}  // namespace palpate::test
