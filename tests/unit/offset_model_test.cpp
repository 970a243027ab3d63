// SPDX-License-Identifier: MIT
// What motion and arm add to heights, against least squares by the book and against what the desk is like near objects.
#include "gp/offset_model.hpp"

#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <Eigen/LU>

#include <algorithm>

namespace palpate::test {
namespace {

constexpr double kOffset = 0.006;
constexpr double kDrift = 0.001 / 60.0;
constexpr double kNoise = 0.002;

/// Some contacts with a bare desk, everywhere, of which heights are off by `offset` and `drift`.
struct Desk {
  OffsetModel offset_model{OffsetPrior{kOffset, kDrift, kNoise}};
  std::vector<double> seconds, excess;

  Desk(int contacts, double offset, double drift, std::uint64_t seed) {
    Random random(seed, "systematic test");
    for (int i = 0; i < contacts; ++i) {
      seconds.push_back(7.0 * i);
      excess.push_back(offset + drift * seconds.back() + 0.002 * (2.0 * random.uniform() - 1.0));
      offset_model.add({0.2 * random.uniform(), 0.2 * random.uniform()}, seconds.back(), excess.back());
    }
  }
};

TEST(OffsetModel, IsTheRegressionByTheBookWhereEveryContactIsOneWithTheDesk) {
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
    const OffsetModel::Estimate estimate = desk.offset_model.at(seconds);
    // Each contact may be none with a probability of some per cent, which widens it a little.
    EXPECT_NEAR(estimate.value, at.dot(mean), 0.0002) << seconds;
    EXPECT_NEAR(std::sqrt(estimate.variance), std::sqrt(at.dot(covariance * at)), 0.0002) << seconds;
  }
}

TEST(OffsetModel, KnowsNothingButItsPriorBeforeTheFirstContact) {
  const OffsetModel::Estimate estimate = OffsetModel({kOffset, kDrift, kNoise}).at(60.0);
  EXPECT_EQ(estimate.value, 0.0);
  EXPECT_NEAR(std::sqrt(estimate.variance), std::hypot(kOffset, kDrift * 60.0), 1e-12);
}

TEST(OffsetModel, IsNotMovedByAJerkJustAboveTheDesk) {
  Desk desk(10, 0.0, 0.0, 2);
  const double before = desk.offset_model.at(70.0).value;
  desk.offset_model.add({0.1, 0.1}, 70.0, 0.009);
  EXPECT_NEAR(desk.offset_model.at(70.0).value, before, 0.0002);
}

TEST(OffsetModel, TakesTheRimOfALowThingForNoDeskAndTheFootOfAWallForOne) {
  for (const bool rim : {true, false}) {
    OffsetModel offset_model({kOffset, kDrift, kNoise});
    offset_model.add({0.10, 0.10}, 0.0, rim ? 0.02 : 0.08);
    for (int i = 1; i < 12; ++i) offset_model.add({0.11 + 0.001 * i, 0.1}, 5.0 * i, 0.005);
    EXPECT_NEAR(offset_model.at(60.0).value, rim ? 0.0 : 0.005, 0.0005) << rim;
  }
}

TEST(OffsetModel, KnowsWhatLiesAboveTheLowestOnceTwoThatAreLowAgree) {
  OffsetModel offset_model({kOffset, kDrift, kNoise});
  const auto add = [&](int i, double excess) { offset_model.add({0.02 * i, 0.1}, 7.0 * i, excess); };
  for (int i = 0; i < 6; ++i) add(i, 0.013 + 0.0002 * i);
  EXPECT_FALSE(offset_model.above(0)) << "an arm may be off by that";
  add(8, 0.0);
  EXPECT_FALSE(offset_model.above(0)) << "the one that is low may lie";
  add(9, 0.001);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(offset_model.above(i), i < 6) << i;
  EXPECT_NEAR(offset_model.at(60.0).value, 0.0005, 0.0005);
}

TEST(OffsetModel, IsNotPulledDownByOneContactThatIsLowAlone) {
  Desk desk(10, 0.0, 0.0, 4);
  desk.offset_model.add({0.1, 0.1}, 70.0, -0.012);
  for (std::size_t i = 0; i < 11; ++i) EXPECT_FALSE(desk.offset_model.above(i)) << i;
  EXPECT_NEAR(desk.offset_model.at(70.0).value, 0.0, 0.0015);
}

/// The search from below with a matrix inverted for each prediction; what is true of `left` is left.
std::vector<bool> searched_by_the_book(const Eigen::VectorXd& times, const std::vector<int>& motions,
                                       const Eigen::VectorXd& excess) {
  const auto contacts = excess.size();
  const auto covariance = [&](Eigen::Index a, Eigen::Index b) {
    const bool alike = motions[static_cast<std::size_t>(a)] == motions[static_cast<std::size_t>(b)];
    return kOffset * kOffset * (alike ? 1.0 : 0.8) + kDrift * kDrift * times(a) * times(b);
  };
  std::vector<Eigen::Index> taken;
  std::vector<bool> left(static_cast<std::size_t>(contacts), true);
  for (;;) {
    const auto n = static_cast<Eigen::Index>(taken.size());
    const auto at = [&](Eigen::Index i) { return taken[static_cast<std::size_t>(i)]; };
    const Eigen::MatrixXd inverse =
        Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(n, n, [&](Eigen::Index i, Eigen::Index j) {
          return covariance(at(i), at(j)) + (i == j ? kNoise * kNoise : 0.0);
        })).inverse();
    const Eigen::VectorXd seen = Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index i) { return excess(at(i)); });
    double lowest = 2.4;
    Eigen::Index next = -1;
    for (Eigen::Index i = 0; i < contacts; ++i) {
      if (!left[static_cast<std::size_t>(i)]) continue;
      const Eigen::VectorXd k = Eigen::VectorXd::NullaryExpr(n, [&](Eigen::Index j) { return covariance(i, at(j)); });
      const double variance = covariance(i, i) - k.dot(inverse * k) + kNoise * kNoise;
      const double deviations = (excess(i) - k.dot(inverse * seen)) / std::sqrt(variance);
      if (deviations >= lowest) continue;
      lowest = deviations;
      next = i;
    }
    if (next < 0) return left;
    left[static_cast<std::size_t>(next)] = false;
    taken.push_back(next);
  }
}

TEST(OffsetModel, SearchesFromBelowAsByTheBook) {
  Random random(5, "systematic test");
  int high = 0;
  int checked = 0;
  for (int trial = 0; trial < 300; ++trial) {
    constexpr int kContacts = 12;
    OffsetModel offset_model({kOffset, kDrift, kNoise});
    Eigen::VectorXd times(kContacts), excess(kContacts);
    std::vector<int> motions;
    for (int i = 0; i < kContacts; ++i) {
      times(i) = 20.0 * i;
      excess(i) = 0.012 * random.uniform() + (random.uniform() < 0.4 ? 0.014 : 0.0);
      motions.push_back(static_cast<int>(3.0 * random.uniform()));
      offset_model.add({0.2 * random.uniform(), 0.2 * random.uniform()}, times(i), excess(i), motions.back());
    }
    const std::vector<bool> expected = searched_by_the_book(times, motions, excess);
    const auto above = std::count(expected.begin(), expected.end(), true);
    if (above >= kContacts - 1) continue;  // what is low alone bounds nothing
    ++checked;
    for (std::size_t i = 0; i < kContacts; ++i) {
      EXPECT_EQ(offset_model.above(i), expected[i]) << trial << " " << i;
      high += expected[i] ? 1 : 0;
    }
  }
  EXPECT_GT(checked, 200);
  EXPECT_GT(high, 200);
}

}  // namespace
}  // namespace palpate::test
