// SPDX-License-Identifier: MIT
#include "gp/axis_basis.hpp"

#include "support/arrays.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

std::shared_ptr<Kernel> rbf(const std::string& length_scale) {
  return make<Kernel>(shared_host(), "rbf", "{length_scale: " + length_scale + "}");
}

Eigen::VectorXd places(int count, double from = 0.0, double to = 0.23) {
  return Eigen::VectorXd::LinSpaced(count, from, to);
}

Eigen::MatrixXd covariance(const Kernel& kernel, const Eigen::VectorXd& a) {
  Eigen::MatrixXd out(a.size(), a.size());
  kernel.axis_covariance(0, a, a, out);
  return out;
}

TEST(AxisBasis, IsOrthonormalAndHoldsTheCovariancesForAnyNumberOfPlacesAndLengthScale) {
  for (const char* length : {"1 mm", "1 cm", "3 cm", "20 cm", "10 m"}) {
    const auto kernel = rbf(length);
    for (const int count : {1, 2, 3, 8, 47, 48, 231, 232}) {
      for (const double tolerance : {1e-6, 1e-15}) {
        const Eigen::VectorXd line = places(count);
        const AxisBasis basis = axis_basis(*kernel, 0, line, tolerance);
        const Eigen::MatrixXd& u = basis.directions;
        const Eigen::MatrixXd k = covariance(*kernel, line);
        EXPECT_LT(apart(u.transpose() * u, Eigen::MatrixXd::Identity(basis.rank(), basis.rank())), 1e-14);
        // An entry is known to the last digits of the largest; what is left at every place is below the tolerance.
        EXPECT_LE(apart(k, u * (u.transpose() * k)), 4.0 * tolerance + 4e-15) << length << ", " << count << " places";
        EXPECT_LE(basis.rank(), count);
      }
    }
  }
}

TEST(AxisBasis, OfARegularLineIsSplitIntoEvenAndOddDirections) {
  const auto kernel = rbf("3 cm");
  for (const int count : {46, 47}) {
    const AxisBasis basis = axis_basis(*kernel, 0, places(count, 0.1, 0.33), 1e-15);
    ASSERT_TRUE(basis.mirrored);
    EXPECT_NEAR(basis.even, basis.rank() / 2.0, 1.0);
    for (int i = 0; i < basis.rank(); ++i) {
      const Eigen::VectorXd direction = basis.directions.col(i);
      const Eigen::VectorXd image = direction.reverse() * (i < basis.even ? 1.0 : -1.0);
      EXPECT_EQ(apart(direction, image), 0.0) << i;
    }
  }
}

TEST(AxisBasis, OfALineThatIsNotItsMirrorImageIsNotSplit) {
  const auto kernel = rbf("3 cm");
  Eigen::VectorXd line = places(40);
  line(3) += 1e-4;
  const AxisBasis basis = axis_basis(*kernel, 0, line, 1e-15);
  EXPECT_FALSE(basis.mirrored);
  EXPECT_EQ(basis.even, basis.rank());
}

TEST(AxisBasis, ItsRankCanBeHadAloneAndNotBeyondWhatIsOfUse) {
  const auto kernel = rbf("1 cm");
  for (const int count : {1, 46, 47, 231}) {
    const int rank = axis_basis(*kernel, 0, places(count), 1e-13).rank();
    EXPECT_EQ(axis_rank(*kernel, 0, places(count), 1e-13, 1000), rank);
    EXPECT_EQ(axis_rank(*kernel, 0, places(count), 1e-13, 5), std::min(rank, 5));
  }
}

TEST(AxisBasis, GrowsWithTheToleranceAndWithShorterLengthScales) {
  const auto rank = [](const char* length, double tolerance) {
    return axis_basis(*rbf(length), 0, places(461), tolerance).rank();
  };
  EXPECT_LT(rank("3 cm", 1e-6), rank("3 cm", 1e-13));
  EXPECT_LT(rank("6 cm", 1e-13), rank("3 cm", 1e-13));
  // Measured elsewhere for 461 places over 23 cm at 1e-13, whole: 16, 25, 44 and 63.
  EXPECT_NEAR(rank("6 cm", 1e-13), 16, 3);
  EXPECT_NEAR(rank("3 cm", 1e-13), 25, 3);
  EXPECT_NEAR(rank("1.5 cm", 1e-13), 44, 4);
  EXPECT_NEAR(rank("1 cm", 1e-13), 63, 4);
}

}  // namespace
}  // namespace palpate::test
