// SPDX-License-Identifier: MIT
// Clouds against all pairs of their points.
#include "solids/cloud_distances.hpp"

#include "solids/primitive.hpp"
#include "support/shape_laws.hpp"
#include "support/testing.hpp"

#include <algorithm>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

TEST(Cloud, FindsTheNearestAmongAllPointsAndNoneFartherThanTenCentimetres) {
  Random random(5, "test/cloud");
  Cloud from, to;
  for (int i = 0; i < 300; ++i) {
    from.push_back(0.2 * random.uniform() * random_direction(random));
    to.push_back(Vector3d(0.05, 0.0, 0.0) + 0.1 * random.uniform() * random_direction(random));
  }
  const std::vector<double> found = nearest_distances(from, to);
  int far = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    double least = kNoHit;
    for (const Vector3d& point : to) least = std::min(least, (point - from[i]).norm());
    EXPECT_DOUBLE_EQ(found[i], least <= 0.1 ? least : kNoHit);
    far += least > 0.1 ? 1 : 0;
  }
  EXPECT_GT(far, 30);
  EXPECT_LT(far, 200);
}

TEST(Cloud, HasNoErrorAgainstItselfAndTheKnownOneAgainstAShiftedCopy) {
  Cloud one, other;
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 20; ++k) {
      one.emplace_back(0.01 * i, 0.01 * k, 0.0);
      other.emplace_back(0.01 * i, 0.01 * k, 0.003);
    }
  }
  const CloudErrors none = compare_clouds(one, one);
  EXPECT_EQ(none.mean, 0.0);
  EXPECT_EQ(none.f_score, 1.0);
  const CloudErrors shifted = compare_clouds(one, other);
  EXPECT_NEAR(shifted.mean, 0.003, 1e-12);
  EXPECT_NEAR(shifted.rms, 0.003, 1e-12);
  EXPECT_EQ(shifted.f_score, 1.0);
  other.resize(200);  // half of it is missing, none is too much
  const CloudErrors half = compare_clouds(other, one);
  EXPECT_NEAR(half.of_belief, 0.003, 1e-12);
  EXPECT_GT(half.of_truth, 0.02);
  EXPECT_NEAR(half.f_score, 2.0 * 0.5 / 1.5, 1e-12);
  EXPECT_EQ(compare_clouds({}, one).f_score, 0.0);
}

TEST(LineBundle, HasLinesFromAllSidesThatBeginOutsideAndAboveTheDesk) {
  const LineBundle bundle({0.1, 0.1, 0.05}, 0.15, 100, 0.02);
  Vector3d least = Vector3d::Ones();
  Vector3d most = -Vector3d::Ones();
  for (const Line& line : bundle.lines) {
    EXPECT_NEAR(line.direction.norm(), 1.0, 1e-12);
    EXPECT_GT(line.origin.z(), 0.0);
    EXPECT_NEAR((line.origin - Vector3d(0.1, 0.1, 0.05)).norm(), 0.15, 1e-12);
    least = least.cwiseMin(line.direction);
    most = most.cwiseMax(line.direction);
  }
  EXPECT_LT(least.maxCoeff(), -0.9);
  EXPECT_GT(most.x(), 0.9);
  EXPECT_GT(most.y(), 0.9);
  EXPECT_GT(most.z(), 0.4);
  EXPECT_LE(most.z(), 0.5);
}

}  // namespace
}  // namespace palpate::test
