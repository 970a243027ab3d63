// SPDX-License-Identifier: MIT
// How often the intervals of `palpate compare` contain the value of a recorded population: the short form of
// tests/benchmark/interval_coverage.cpp. 1200 jobs of tests/benchmark/coverage/arm.yaml: two motions, six other
// settings, 100 seeds.
#include "support/populations.hpp"
#include "support/sanitizers.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

/// `least` percent, within three standard deviations of such a share.
void expect_coverage(const test::Coverage& found, double least, const std::string& what) {
  ASSERT_GT(found.all, 0) << what;
  EXPECT_GE(found.percent(), least - 3.0 * found.error(least)) << what;
}

class IntervalCoverage : public ::testing::TestWithParam<std::pair<std::size_t, double>> {
 protected:
  void expect(std::size_t others, int copies) const {
    const test::Population arm =
        test::read_population(test::source_folder() / "tests" / "data" / "coverage_arm.csv", "rmse_m");
    const auto [seeds, least] = GetParam();
    // Of few seeds an interval costs next to nothing.
    const int samples = seeds < kLeastForBootstrap ? 200 : test::brief() ? 20 : 60;
    const test::Coverages found = test::coverages_of(arm, seeds, others, copies, samples);
    expect_coverage(found.means, least, "means");
    expect_coverage(found.differences, least, "differences");
    // Of 60 intervals of 95 % all hit in one trial of 22; of 120, in one of 470.
    const int all = found.means.all + found.differences.all;
    if (all >= 120) {
      EXPECT_LT(found.means.hits + found.differences.hits, all) << "far too wide";
    }
  }
};

TEST_P(IntervalCoverage, HoldsThoughEachSeedHasAJobInSixOtherSettings) { expect(6, 1); }
TEST_P(IntervalCoverage, HoldsThoughEachRunIsThereInThreeCopies) { expect(1, 3); }

INSTANTIATE_TEST_SUITE_P(OverSeeds, IntervalCoverage,
                         ::testing::Values(std::pair(5, 89.0), std::pair(10, 91.0), std::pair(20, 91.0),
                                           std::pair(60, 93.0)),
                         [](const auto& one) { return "Of" + std::to_string(one.param.first); });

}  // namespace
}  // namespace palpate
