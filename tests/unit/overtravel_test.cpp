// SPDX-License-Identifier: MIT
// How deep contacts come, learnt from the desk, and which are with it: against what made them.
#include "solids/overtravel.hpp"

#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <cmath>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

constexpr double kMost = 0.01;

/// Told `deep` metres beyond where it touched, `height` above the desk, of a tool that came down at a slope.
SurfaceTouch told(double height, double down, double deep) {
  const Vector3d direction(std::sqrt(1.0 - down * down), 0.0, -down);
  const Vector3d at(0.1, 0.1, height);
  return {{at - 0.2 * direction, direction}, 0.2 + deep, true, false};
}

double noise(Random& random) { return 2.0 * random.uniform() - 1.0; }

TEST(Overtravel, TakesNothingOffContactsThatLieOnTheDesk) {
  Overtravel overtravel(0.0, kMost);
  Random random(1, "overtravel");
  for (int i = 0; i < 20; ++i) {
    const SurfaceTouch on_desk = told(0.0, 0.6 + 0.4 * random.uniform(), 0.0);
    overtravel.add(on_desk, 10.0);
    overtravel.add(told(0.001, 1.0, 0.0), 10.0);  // an object as flat as that
    const SurfaceTouch read = overtravel.read(on_desk, 10.0);
    EXPECT_EQ(read.length, on_desk.length);
    EXPECT_TRUE(read.desk);
  }
  EXPECT_EQ(overtravel.spread(), Overtravel::kLeastSpread);
  EXPECT_EQ(overtravel.at(25.0), 0.0);
}

TEST(Overtravel, LearnsFromTheDeskHowDeepContactsComeByTheirForceWhateverTheSlope) {
  Overtravel overtravel(0.0, kMost);
  Random random(2, "overtravel");
  const auto deep = [](double force) { return 0.002 + 0.0005 * force; };
  for (int i = 0; i < 12; ++i) {
    const double force = 12.0 + 12.0 * random.uniform();
    overtravel.add(told(0.001 * noise(random), 0.5 + 0.5 * random.uniform(), deep(force)), force);
    overtravel.add(told(0.05, 0.8, deep(force)), force);  // an object
  }
  // 12 contacts that err by 0.6 mm: the mean of a few of them, at the ends of the forces twice that of the middle.
  for (const double force : {12.0, 18.0, 24.0}) EXPECT_NEAR(overtravel.at(force), deep(force), 0.0008) << force;
  // Contacts above and beside the desk come as deep.
  const Vector3d level = Vector3d::UnitX();
  const SurfaceTouch side{{{0.0, 0.1, 0.05}, level}, 0.1 + deep(20.0), true, false};
  EXPECT_NEAR(overtravel.read(side, 20.0).length, 0.1, 0.0008);
  EXPECT_FALSE(overtravel.read(side, 20.0).desk);
  EXPECT_TRUE(overtravel.read(told(0.0, 0.7, deep(20.0)), 20.0).desk);
  EXPECT_FALSE(overtravel.read(told(0.006, 0.7, deep(20.0)), 20.0).desk) << "told 2.4 mm below the desk, 6 mm above it";
}

TEST(Overtravel, KnowsByHowMuchContactsErrAndTakesThemForTheDesksSoFarAboveIt) {
  Overtravel overtravel(0.0, kMost);
  Random random(3, "overtravel");
  const auto normal = [&] {
    return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(6.283185307179586 * random.uniform());
  };
  for (int i = 0; i < 60; ++i) overtravel.add(told(0.001 * normal(), 0.6 + 0.4 * random.uniform(), 0.008), 20.0);
  EXPECT_NEAR(overtravel.spread(), 0.001, 0.0003) << "30 below it tell within 13 %, and the prior pulls down";
  EXPECT_TRUE(overtravel.read(told(0.002, 1.0, 0.008), 20.0).desk);
  EXPECT_FALSE(overtravel.read(told(0.005, 1.0, 0.008), 20.0).desk);
  Overtravel strict(0.0, 0.001);
  EXPECT_FALSE(strict.read(told(0.0012, 1.0, 0.0), 20.0).desk) << "higher than scene.min_object_height";
}

TEST(Overtravel, TakesARoundTipOnTheBareDeskForOneAtWhateverSlopeItComes) {
  constexpr double kRadius = 0.005;
  const Overtravel overtravel(kRadius, kMost);
  const Overtravel point(0.0, kMost);
  for (const double down : {0.3, 0.6, 1.0}) {
    const SurfaceTouch touch = told(kRadius * (1.0 - down), down, 0.0);
    EXPECT_TRUE(overtravel.read(touch, 10.0).desk) << down;
    EXPECT_EQ(point.read(touch, 10.0).desk, down == 1.0) << down;
    EXPECT_FALSE(overtravel.read(told(kRadius * (1.0 - down) + 0.003, down, 0.0), 10.0).desk) << down;
  }
}

TEST(Overtravel, IsNotMovedByAJerkInTheAir) {
  Overtravel overtravel(0.0, kMost);
  for (int i = 0; i < 8; ++i) overtravel.add(told(0.0, 0.9, 0.01), 20.0);
  const double before = overtravel.at(20.0);
  overtravel.add(told(0.04, 0.9, 0.0), 20.0);
  overtravel.add(told(0.004, 0.9, 0.005), 20.0);  // just above the desk, told as low as the margin is
  EXPECT_NEAR(overtravel.at(20.0), before, 0.0005);
}

}  // namespace
}  // namespace palpate::test
