// SPDX-License-Identifier: MIT
// What motion and arm add to heights, against least squares by the book and against what the desk is like near objects.
#include "experiment/systematic.hpp"

#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <Eigen/LU>

namespace palpate::test {
namespace {

constexpr double kOffset = 0.006;
constexpr double kDrift = 0.001 / 60.0;
constexpr double kNoise = 0.002;

/// Some contacts with a bare desk, everywhere, of which heights are off by `offset` and `drift`.
struct Desk {
  Systematic systematic{kOffset, kDrift, kNoise};
  std::vector<double> seconds, excess;

  Desk(int contacts, double offset, double drift, std::uint64_t seed) {
    Random random(seed, "systematic test");
    for (int i = 0; i < contacts; ++i) {
      seconds.push_back(7.0 * i);
      excess.push_back(offset + drift * seconds.back() + 0.002 * (2.0 * random.uniform() - 1.0));
      systematic.add({0.2 * random.uniform(), 0.2 * random.uniform()}, seconds.back(), excess.back(), false);
    }
  }
};

TEST(Systematic, IsTheRegressionByTheBookWhereEveryContactIsOneWithTheDesk) {
  const Desk desk(25, 0.004, kDrift, 1);
  // Rasmussen and Williams 2006, equation 2.8.
  Eigen::MatrixXd basis(25, 2);
  for (Eigen::Index i = 0; i < 25; ++i) basis.row(i) << 1.0, desk.seconds[static_cast<std::size_t>(i)];
  const Eigen::Matrix2d prior = Eigen::Vector2d(1.0 / (kOffset * kOffset), 1.0 / (kDrift * kDrift)).asDiagonal();
  const Eigen::Matrix2d covariance = (basis.transpose() * basis / (kNoise * kNoise) + prior).inverse();
  const Eigen::Vector2d mean =
      covariance * basis.transpose() * Eigen::Map<const Eigen::VectorXd>(desk.excess.data(), 25) / (kNoise * kNoise);
  for (const double seconds : {0.0, 100.0, 300.0}) {
    const Eigen::Vector2d at(1.0, seconds);
    const Systematic::Estimate estimate = desk.systematic.at(seconds);
    // Each contact may be none with a probability of some per cent, which widens it a little.
    EXPECT_NEAR(estimate.value, at.dot(mean), 0.0002) << seconds;
    EXPECT_NEAR(std::sqrt(estimate.variance), std::sqrt(at.dot(covariance * at)), 0.0002) << seconds;
  }
}

TEST(Systematic, KnowsNothingButItsPriorBeforeTheFirstContact) {
  const Systematic::Estimate estimate = Systematic(kOffset, kDrift, kNoise).at(60.0);
  EXPECT_EQ(estimate.value, 0.0);
  EXPECT_NEAR(std::sqrt(estimate.variance), std::hypot(kOffset, kDrift * 60.0), 1e-12);
}

TEST(Systematic, IsNotMovedByAJerkJustAboveTheDesk) {
  Desk desk(10, 0.0, 0.0, 2);
  const double before = desk.systematic.at(70.0).value;
  desk.systematic.add({0.1, 0.1}, 70.0, 0.009, false);
  EXPECT_NEAR(desk.systematic.at(70.0).value, before, 0.0002);
}

TEST(Systematic, TakesTheRimOfALowThingForNoDeskAndTheFootOfAWallForOne) {
  for (const bool rim : {true, false}) {
    Systematic systematic(kOffset, kDrift, kNoise);
    systematic.add({0.10, 0.10}, 0.0, rim ? 0.02 : 0.08, true);
    for (int i = 1; i < 12; ++i) systematic.add({0.11 + 0.001 * i, 0.1}, 5.0 * i, 0.005, false);
    EXPECT_NEAR(systematic.at(60.0).value, rim ? 0.0 : 0.005, 0.0005) << rim;
  }
}

}  // namespace
}  // namespace palpate::test
