// SPDX-License-Identifier: MIT
// Contours of solids whose sections are known.
#include "report/contours.hpp"
#include "support/shape_cases.hpp"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

constexpr double kSide = 0.002;
constexpr double kPi = 3.14159265358979323846;

std::vector<Ring> contours_of(const std::string& object) { return contours(*scene_of({object}), 0.01, kSide); }

/// Counter-clockwise, as somebody sees it to whom `normal` points.
double area_of(const Ring& ring, const Vector3d& normal) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < ring.size(); ++i) sum += ring[i].cross(ring[(i + 1) % ring.size()]);
  return 0.5 * sum.dot(normal);
}

bool is_level(const Ring& ring) {
  return std::all_of(ring.begin(), ring.end(), [&](const Vector3d& at) { return at.z() == ring.front().z(); });
}

TEST(Contours, OfARingAreTwoCirclesOnEachLevelAndRectanglesUpright) {
  const double outer = 0.05, inner = 0.03, height = 0.062;
  int levels = 0;
  int upright = 0;
  for (const Ring& ring : contours_of("{type: ring, outer: 10 cm, inner: 6 cm, height: 6.2 cm, at: [20 cm, 20 cm]}")) {
    ASSERT_GT(ring.size(), 3U);
    for (const Vector3d& at : ring) {
      const double away = std::hypot(at.x() - 0.2, at.y() - 0.2);
      const double off =
          std::min({std::abs(away - outer), std::abs(away - inner), std::abs(at.z()), std::abs(at.z() - height)});
      EXPECT_LT(off, 1e-9);
      EXPECT_GT(away, inner - 1e-9);
      EXPECT_LT(away, outer + 1e-9);
    }
    if (!is_level(ring)) {
      ++upright;
      continue;
    }
    ++levels;
    // Chords of at most 2 mm, and points left out within 0.2 mm of a straight line, lie that far inside at most.
    const double radius = std::abs(std::hypot(ring[0].x() - 0.2, ring[0].y() - 0.2) - outer) < 1e-9 ? outer : -inner;
    const double area = std::copysign(kPi * radius * radius, radius);
    EXPECT_NEAR(area_of(ring, Vector3d::UnitZ()), area, 2.0 * kPi * std::abs(radius) * 0.0003);
  }
  EXPECT_EQ(levels, 2 * 6);  // at 0.5 to 5.5 cm
  // Of 37 planes along either axis those within 5 cm of the middle; through the hole, two rectangles each.
  EXPECT_EQ(upright, 2 * (10 + 6));
}

TEST(Contours, OfABoxAreItsEdgesInEachPlane) {
  for (const Ring& ring : contours_of("{type: block, length: 10 cm, width: 6 cm, height: 5 cm, at: [20 cm, 20 cm]}")) {
    // A corner is cut off between two lines of the grid.
    EXPECT_LE(ring.size(), 8U);
    EXPECT_GE(ring.size(), 4U);
    const double area = std::abs(area_of(ring, Vector3d::UnitX())) + std::abs(area_of(ring, Vector3d::UnitY())) +
                        std::abs(area_of(ring, Vector3d::UnitZ()));
    const Vector3d most(0.10, 0.06, 0.05);
    EXPECT_TRUE(std::abs(area - most.x() * most.y()) < 4 * kSide * kSide ||
                std::abs(area - most.x() * most.z()) < 4 * kSide * kSide ||
                std::abs(area - most.y() * most.z()) < 4 * kSide * kSide)
        << area;
  }
}

TEST(Contours, AreNoneOfAnEmptyDesk) { EXPECT_TRUE(contours(*scene_of({}), 0.01, kSide).empty()); }

}  // namespace
}  // namespace palpate::test
