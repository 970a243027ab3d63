// SPDX-License-Identifier: MIT
// Outlines that nobody drew keep their promises.
#include "support/sanitizers.hpp"
#include "support/shape_laws.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

std::shared_ptr<Shape> outline(int number, std::uint64_t seed = 1, const std::string& more = "") {
  return make<Shape>(shared_host(), "random_outline", "{number: " + std::to_string(number) + more + "}", seed);
}

/// The largest difference of the tops of two over a grid, where both are; infinity if they are not over the same cells.
double difference(const Shape& one, const Shape& other) {
  double most = 0.0;
  for (double s = -0.07; s < 0.07; s += 0.003) {
    for (double t = -0.07; t < 0.07; t += 0.003) {
      const double a = one.top(s, t);
      const double b = other.top(s, t);
      if (a != b) most = std::max(most, std::abs(a - b));
    }
  }
  return most;
}

/// Whether the middle between two places within the outline is beside it, well beyond a facet of it.
bool is_concave(const Shape& shape) {
  Random random(1, "test/concave");
  const auto within = [&] {
    while (true) {
      const double s = 0.14 * (random.uniform() - 0.5);
      const double t = 0.14 * (random.uniform() - 0.5);
      if (shape.top(s, t) > 0.0) return Vector3d(s, t, 0.0);
    }
  };
  for (int i = 0; i < 400; ++i) {
    const Vector3d middle = (within() + within()) / 2;
    bool beside = true;
    for (const double s : {-0.003, 0.003}) {
      for (const double t : {-0.003, 0.003}) beside = beside && std::isinf(shape.top(middle.x() + s, middle.y() + t));
    }
    if (beside) return true;
  }
  return false;
}

TEST(RandomOutline, IsTheSameForTheSameSeedAndNumberAndAnotherForAnother) {
  EXPECT_EQ(difference(*outline(0), *outline(0)), 0.0);
  EXPECT_EQ(difference(*outline(7, 5), *outline(7, 5)), 0.0);
  EXPECT_EQ(difference(*outline(0), *outline(1)), HUGE_VAL);
  EXPECT_EQ(difference(*outline(0), *outline(0, 2)), HUGE_VAL);
}

TEST(RandomOutline, IsMostlyConcave) {
  int concave = 0;
  for (int number = 0; number < 20; ++number) concave += is_concave(*outline(number));
  EXPECT_GE(concave, 10);
}

TEST(RandomOutline, IsAsLongAsPromisedAlongNoWiderThanLongAndTwoCentimetresThickSomewhere) {
  const int outlines = brief() ? 20 : 100;
  for (const char* more :
       {", length: 14 cm, roughness: 0.5", ", length: 14 cm, roughness: 1", ", length: 14 cm, roughness: 0"}) {
    for (int number = 0; number < outlines; ++number) {
      const auto shape = outline(number, 3, more);
      EXPECT_NEAR(shape->support({1, 0, 0}) + shape->support({-1, 0, 0}), 0.14, 1e-15);
      EXPECT_LE(shape->support({0, 1, 0}), shape->support({1, 0, 0}) + 1e-15);
      EXPECT_GE(shape->support({0, 1, 0}), 0.01);
    }
  }
  const auto small = outline(0, 3, ", length: 5 cm, height: 2 cm, roughness: 1");
  EXPECT_NEAR(small->support({1, 0, 0}), 0.025, 1e-15);
}

TEST(RandomOutline, IsInOnePieceNowhereLowerThanFifteenMillimetresAndReachesAsFarAsItsPoints) {
  constexpr int kSide = 141;  // of a grid of millimetres
  constexpr int kMiddle = 70;
  for (int number = 0; number < (brief() ? 5 : 20); ++number) {
    const auto shape = outline(number, 4, ", roughness: 1");
    std::vector<Vector3d> points;
    std::vector<bool> within;
    for (int i = 0; i < kSide * kSide; ++i) {
      const int row = i / kSide;
      const double s = 1e-3 * (row - kMiddle);
      const double t = 1e-3 * (i - kSide * row - kMiddle);
      const double top = shape->top(s, t);
      within.push_back(std::isfinite(top));
      if (std::isinf(top)) continue;
      EXPECT_GE(top, 0.015 - 1e-12);
      points.emplace_back(s, t, top);
      points.emplace_back(s, t, 0.0);
    }

    Random random(1, "test/reach");
    for (int i = 0; i < 20; ++i) {
      const Vector3d direction = random_direction(random);
      double most = -HUGE_VAL;
      for (const Vector3d& point : points) most = std::max(most, direction.dot(point));
      EXPECT_GE(shape->support(direction), most);
      EXPECT_LE(shape->support(direction), most + 0.004) << "a spacing and what a steep top rises over it";
    }

    std::size_t together = 0;
    std::vector<int> waiting{static_cast<int>(std::find(within.begin(), within.end(), true) - within.begin())};
    within[static_cast<std::size_t>(waiting[0])] = false;
    while (!waiting.empty()) {
      const int i = waiting.back();
      waiting.pop_back();
      ++together;
      for (const int step : {-1, 1, -kSide, kSide, -kSide - 1, -kSide + 1, kSide - 1, kSide + 1}) {
        const int beside = i + step;
        if (beside < 0 || beside >= kSide * kSide || !within[static_cast<std::size_t>(beside)]) continue;
        within[static_cast<std::size_t>(beside)] = false;
        waiting.push_back(beside);
      }
    }
    EXPECT_EQ(2 * together, points.size()) << number;
  }
}

TEST(RandomOutline, IsMetByTiltedLinesWhereAMarchDownThemFirstIsNotAboveItsTop) {
  constexpr double kStep = 2e-5;
  Random random(1, "test/march");
  int hits = 0;
  for (int i = 0; i < (brief() ? 100 : 400); ++i) {
    const auto shape = outline(i % 8, 5);
    Line line{{0.16 * (random.uniform() - 0.5), 0.16 * (random.uniform() - 0.5), 0.09}, {}};
    do {
      line.direction = random_direction(random);
    } while (line.direction.z() > -0.15);
    const double end = -line.origin.z() / line.direction.z();
    double marched = HUGE_VAL;
    for (double x = 0.0; x < end && std::isinf(marched); x += kStep) {
      const Vector3d p = line.origin + x * line.direction;
      if (p.z() <= shape->top(p.x(), p.y())) marched = x;
    }
    const double hit = shape->first_intersection(line);
    // A march may step over a corner that the line cuts by less than a step.
    if (std::isinf(marched)) {
      if (std::isinf(hit)) continue;
      const Vector3d behind = line.origin + (hit + kStep) * line.direction;
      EXPECT_GT(behind.z(), shape->top(behind.x(), behind.y())) << i;
      continue;
    }
    ++hits;
    EXPECT_LE(hit, marched + 1e-12) << i;
    EXPECT_GE(hit, marched - kStep - 1e-12) << i;
    const Vector3d point = line.origin + hit * line.direction;
    const double top = shape->top(point.x(), point.y());
    // On the top to rounding, or on a wall below it.
    EXPECT_TRUE(std::isinf(top) || point.z() <= top + 1e-9) << i;
  }
  EXPECT_GT(hits, brief() ? 10 : 30);
}

TEST(RandomOutline, KeepsTheLawsOfShapes) {
  for (int number = 0; number < 8; ++number) check_shape_laws(*outline(number, 6, ", roughness: 0.9"));
}

}  // namespace
}  // namespace palpate::test
