// SPDX-License-Identifier: MIT
#include "tapping/guarded_tap.hpp"

#include "simulator/arm.hpp"
#include "support/testing.hpp"

namespace palpate::tapping {
namespace {

/// Samples every `spacing` from `above` over the kink down to `below` under it, on a hinge.
std::vector<Sample> hinge(double kink, double slope, double zero, double spacing, double above, double below) {
  std::vector<Sample> out;
  for (double height = kink + above; height > kink - below; height -= spacing) {
    out.push_back({height, zero + slope * std::max(0.0, kink - height)});
  }
  return out;
}

TEST(Onset, IsTheKinkOfAHingeWhateverItsSlopeZeroAndSampling) {
  Random random(1, "hinges");
  for (int i = 0; i < 300; ++i) {
    const double kink = random.uniform() * 0.2 - 0.05;
    const double slope = std::pow(10.0, 2.0 + 3.0 * random.uniform());
    const double zero = 10.0 * random.uniform() - 5.0;
    const double spacing = 0.0002 + 0.001 * random.uniform();
    const auto samples = hinge(kink, slope, zero, spacing, 0.02 + spacing * random.uniform(), 0.008);
    const std::optional<double> found = onset(samples);
    ASSERT_TRUE(found);
    EXPECT_NEAR(*found, kink, 1e-7) << "slope " << slope << ", spacing " << spacing;
  }
}

TEST(Onset, IsUnbiasedUnderNoiseAndFarBetterThanTheHeightAtAThreshold) {
  Random seeds(2, "noise");
  double bias = 0.0;
  double squares = 0.0;
  constexpr int kTrials = 1000;
  for (int i = 0; i < kTrials; ++i) {
    backends::GaussianNumbers normal(Random(seeds.bits(), "normal"));
    auto samples = hinge(0.05, 1500.0, 0.0, 0.0005, 0.02, 0.009);
    for (Sample& one : samples) one.force += 1.5 * normal();
    const double error = onset(samples).value() - 0.05;
    bias += error / kTrials;
    squares += error * error / kTrials;
  }
  // 10 N at 1500 N/m are 6.7 mm of bias. The standard error of the mean is rms / sqrt(1000).
  EXPECT_LT(std::sqrt(squares), 0.0008);
  EXPECT_LT(std::abs(bias), 4.0 * std::sqrt(squares / kTrials));
}

TEST(Onset, OfARigidSurfaceLiesWithinOneSampleAboveIt) {
  // The tip stops dead at 0.03 while the force goes on rising.
  std::vector<Sample> samples;
  for (int i = 20; i > 0; --i) samples.push_back({0.0302 + 0.0005 * i, 0.1});
  for (int i = 1; i < 5; ++i) samples.push_back({0.03, 5.0 * i});
  const double found = onset(samples).value();
  EXPECT_GE(found, 0.03);
  EXPECT_LE(found, 0.0307);
}

TEST(Onset, IsNoneWithoutARiseOrWithoutEnoughToTell) {
  EXPECT_FALSE(onset({}));
  EXPECT_FALSE(onset({{0.03, 0.0}, {0.02, 0.0}, {0.01, 5.0}})) << "three samples";
  EXPECT_FALSE(onset({{0.04, 1.0}, {0.03, 1.0}, {0.02, 1.0}, {0.01, 1.0}})) << "a constant force";
  EXPECT_FALSE(onset({{0.04, 4.0}, {0.03, 3.0}, {0.02, 2.0}, {0.01, 1.0}})) << "a force that falls with the depth";
  EXPECT_FALSE(onset({{0.04, 0.0}, {0.04, 1.0}, {0.04, 2.0}, {0.04, 3.0}})) << "an arm that stands still";
}

}  // namespace
}  // namespace palpate::tapping
