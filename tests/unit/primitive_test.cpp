// SPDX-License-Identifier: MIT
// Solids of one primitive against their definition as sets of points.
#include "solids/primitive.hpp"

#include "space_bench.hpp"
#include "support/testing.hpp"

#include <algorithm>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

Line through(const Primitive& primitive, Random& random) {
  const Vector3d direction = random_direction(random);
  return {primitive.centre + 0.04 * random_direction(random) - 0.4 * direction, direction};
}

TEST(Primitive, IsWithinALineExactlyWhereItHoldsThePointsOfTheLine) {
  Random random(1, "test/piece");
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const Primitive primitive = random_primitive(random);
    const Line line = through(primitive, random);
    const auto chords = primitive.inside(line);
    met += chords[0].empty() ? 0 : 1;
    EXPECT_EQ(primitive.first_intersection(line), chords[0].empty() ? kNoHit : chords[0].begin);
    for (int k = 0; k < 400; ++k) {
      const double x = 0.8 * (k + random.uniform()) / 400;
      const auto margin = [&](const Chord& chord) {
        return std::min(std::abs(x - chord.begin), std::abs(x - chord.end));
      };
      if (std::min(margin(chords[0]), margin(chords[1])) < 1e-9) continue;
      const bool inside = (x > chords[0].begin && x < chords[0].end) || (x > chords[1].begin && x < chords[1].end);
      ASSERT_EQ(inside, holds(primitive, line.origin + x * line.direction)) << i << " at " << x;
    }
  }
  EXPECT_GT(met, 150);
}

TEST(Primitive, TellsTheSideOfItsSurfaceByTheSignOfTheDistanceWhichIsNoneOnIt) {
  Random random(2, "test/piece");
  for (int i = 0; i < 300; ++i) {
    const Primitive primitive = random_primitive(random);
    for (int k = 0; k < 50; ++k) {
      const Vector3d point = primitive.centre + 0.1 * random.uniform() * random_direction(random);
      const double distance = primitive.distance(point);
      if (std::abs(distance) > 1e-9) {
        EXPECT_EQ(distance < 0.0, holds(primitive, point));
      }
    }
    const Line line = through(primitive, random);
    const double hit = primitive.first_intersection(line);
    if (hit < kNoHit) {
      EXPECT_NEAR(primitive.distance(line.origin + hit * line.direction), 0.0, 1e-9);
    }
  }
}

TEST(Primitive, SaysWhatAngleALineMeetsItAt) {
  Random random(3, "test/piece");
  for (int i = 0; i < 300; ++i) {
    const Primitive primitive = random_primitive(random);
    const Line line = through(primitive, random);
    const Chord chord = primitive.inside(line)[0];
    if (chord.empty()) continue;
    const Vector3d at = line.origin + chord.begin * line.direction;
    Vector3d slope;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const Vector3d step = 1e-7 * Vector3d::Unit(k);
      slope(k) = primitive.distance(at + step) - primitive.distance(at - step);
    }
    EXPECT_NEAR(chord.begin_cosine, std::abs(slope.normalized().dot(line.direction)), 1e-4);
  }
}

TEST(Primitive, IsPassedByALineThatIsMovedAsFarAsideAsItSays) {
  Random random(4, "test/piece");
  for (int i = 0; i < 200; ++i) {
    Primitive primitive = random_primitive(random);
    primitive.wall = 0.0;
    const Line line = through(primitive, random);
    if (primitive.first_intersection(line) == kNoHit) continue;
    // Over all directions across the line: by some it gets clear within that way, and by none in much less.
    const Vector3d one = line.direction.unitOrthogonal();
    const Vector3d other = line.direction.cross(one);
    const double aside = primitive.aside(line);
    bool clear = false;
    for (int k = 0; k < 360; ++k) {
      const double angle = 3.14159265358979323846 * k / 180;
      const Vector3d across = std::cos(angle) * one + std::sin(angle) * other;
      clear = clear ||
              primitive.first_intersection({line.origin + (1.01 * aside + 5e-4) * across, line.direction}) == kNoHit;
      EXPECT_LT(primitive.first_intersection({line.origin + 0.95 * aside * across, line.direction}), kNoHit);
    }
    EXPECT_TRUE(clear);
  }
}

TEST(Primitive, IsAsFarAsideUpToALimitAsWithoutOne) {
  Random random(14, "test/piece");
  int limited = 0;
  for (int i = 0; i < 3000; ++i) {
    Primitive primitive = random_primitive(random);
    for (double& half : primitive.half) half = 0.004 * std::pow(30.0, random.uniform());
    const Line line{primitive.centre + 0.02 * random_direction(random) - 0.4 * primitive.turn.col(2),
                    primitive.turn.col(2)};
    const double aside = primitive.aside(line);
    const double most = 0.02 * random.uniform();
    EXPECT_EQ(primitive.aside(line, most), std::min(aside, most));
    limited += aside > most ? 1 : 0;
  }
  EXPECT_GT(limited, 500);
  EXPECT_LT(limited, 2900);
}

}  // namespace
}  // namespace palpate::test
