// SPDX-License-Identifier: MIT
#include "support/shape_laws.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

/// A few roundings of lengths up to a metre, divided by slopes of walls.
constexpr double kRounding = 1e-11;

/// Down, or anywhere.
Line random_line(const Shape& shape, Random& random, bool down) {
  const double length = shape.support({1, 0, 0});
  const double width = shape.support({0, 1, 0});
  const double height = shape.support({0, 0, 1});
  Line line;
  line.origin = {2.4 * length * (random.uniform() - 0.5), 2.4 * width * (random.uniform() - 0.5),
                 height * random.uniform()};
  do {
    line.direction = random_direction(random);
  } while (down && line.direction.z() > -0.1);
  return line;
}

}  // namespace

Vector3d random_direction(Random& random) {
  while (true) {
    const Vector3d out(2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1);
    if (out.norm() > 0.1 && out.norm() <= 1.0) return out.normalized();
  }
}

void check_shape_laws(const Shape& shape) {
  EXPECT_NEAR(shape.support({0, 0, -1}), 0.0, 1e-15) << "rests on the plane 0";
  EXPECT_NEAR(shape.support({1, 0, 0}), shape.support({-1, 0, 0}), kRounding) << "centred along";
  EXPECT_NEAR(shape.support({0, 1, 0}), shape.support({0, -1, 0}), kRounding) << "centred across";
  const double size = shape.support({1, 0, 0}) + shape.support({0, 1, 0}) + shape.support({0, 0, 1});

  Random random(1, "test/shape");
  for (int i = 0; i < 300; ++i) {
    const Vector3d a = random_direction(random);
    const Vector3d b = random_direction(random);
    EXPECT_LE(shape.support(a + b), shape.support(a) + shape.support(b) + kRounding) << "convex";
    EXPECT_NEAR(shape.support(3 * a), 3 * shape.support(a), kRounding) << "homogeneous";
  }

  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Line line = random_line(shape, random, i < 1000);
    const double hit = shape.first_intersection(line);
    ASSERT_FALSE(std::isnan(hit));
    ASSERT_GT(hit, -HUGE_VAL);
    const double moved = shape.first_intersection({line.origin + 0.25 * line.direction, line.direction});
    if (std::isinf(hit) != std::isinf(moved)) {
      // On a silhouette a rounding decides: then a line beside agrees with either.
      ADD_FAILURE() << "hit only from one of two origins: " << line.origin.transpose();
    } else if (std::isfinite(hit)) {
      ++hits;
      EXPECT_NEAR(moved, hit - 0.25, 1e-6 * size) << "counted from the origin";
      const Vector3d point = line.origin + hit * line.direction;
      for (int k = 0; k < 20; ++k) {
        const Vector3d direction = random_direction(random);
        EXPECT_LE(direction.dot(point), shape.support(direction) + 1e-6 * size) << "no further out than support";
      }
    }
    // In front of a plane that touches the solid, and parallel to it, nothing is met.
    const Vector3d normal = line.direction.unitOrthogonal();
    const Vector3d beyond = (shape.support(normal) + 1e-5 * size) * normal;
    EXPECT_EQ(shape.first_intersection({beyond, line.direction}), HUGE_VAL);
  }
  EXPECT_GT(hits, 100);

  // The other way along the same line the solid begins where it ends: both ways it is met, or neither, and no later.
  for (int i = 0; i < 1000; ++i) {
    const Line line = random_line(shape, random, false);
    const double there = shape.first_intersection(line);
    const double back = shape.first_intersection({line.origin, -line.direction});
    if (std::isinf(there) != std::isinf(back)) {
      ADD_FAILURE() << "met one way only: " << line.origin.transpose() << " along " << line.direction.transpose();
    } else if (std::isfinite(there)) {
      EXPECT_LE(there, -back + 1e-6 * size) << "of a solid that begins behind its end";
    }
  }

  // What lies in the solid on a line begins and ends there; and a point that is within on one line is within on
  // another.
  int points = 0;
  int within = 0;
  int agree = 0;
  for (int i = 0; i < 1000; ++i) {
    const Line line = random_line(shape, random, false);
    const std::vector<LineInterval> intervals = shape.intervals(line);
    if (!intervals.empty()) {
      EXPECT_NEAR(intervals.front().begin, shape.first_intersection(line), 1e-6 * size);
      EXPECT_NEAR(intervals.back().end, -shape.first_intersection({line.origin, -line.direction}), 1e-5 * size);
    }
    for (std::size_t k = 0; k < intervals.size(); ++k) {
      EXPECT_LE(intervals[k].begin, intervals[k].end);
      EXPECT_TRUE(k == 0 || intervals[k].begin > intervals[k - 1].end);
    }
    const auto holds = [&](const Vector3d& point, const Vector3d& direction) {
      const std::vector<LineInterval> through = shape.intervals({point, direction});
      return std::any_of(through.begin(), through.end(),
                         [](const LineInterval& s) { return s.begin < 0.0 && s.end > 0.0; });
    };
    const double first = intervals.empty() ? 0.0 : intervals.front().begin;
    const double last = intervals.empty() ? 0.0 : intervals.back().end;
    const Vector3d point = line.origin + (first + (last - first) * random.uniform()) * line.direction;
    ++points;
    const bool inside = holds(point, random_direction(random));
    within += inside ? 1 : 0;
    agree += inside == holds(point, random_direction(random)) ? 1 : 0;
  }
  EXPECT_GT(within, 10);
  EXPECT_GE(agree, points - 2) << "a rounding may decide on the surface";

  for (int i = 0; i < 300; ++i) {
    const Line line = random_line(shape, random, true);
    const double s = line.origin.x();
    const double t = line.origin.y();
    const double straight = -shape.first_intersection({{s, t, 0.0}, {0.0, 0.0, -1.0}});
    const double top = shape.top(s, t);
    EXPECT_TRUE(top == straight || std::abs(top - straight) < kRounding) << top << " " << straight;
  }
}

}  // namespace palpate::test
