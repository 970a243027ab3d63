// SPDX-License-Identifier: MIT
// The factor of a whole covariance where rounding decides: what is added, what is set aside, and what is told of both.
#include "regular/regular_factor.hpp"

#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <Eigen/LU>

namespace palpate::test {
namespace {

Eigen::MatrixXd positive_definite(int n) {
  Random random(5, "regular factor");
  const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.uniform() - 0.5; });
  return a * a.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
}

TEST(RegularFactor, OfARegularMatrixIsThatOfItsFactorisationAndReportsNothing) {
  const Eigen::MatrixXd matrix = positive_definite(12);
  RegularFactor factor;
  factor.factorise(matrix);
  EXPECT_LT((factor.inverse() * matrix - Eigen::MatrixXd::Identity(12, 12)).norm(), 1e-11);
  EXPECT_NEAR(2.0 * factor.half_log_determinant(), std::log(matrix.determinant()), 1e-11);
  Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(12, -1.0, 1.0);
  const Eigen::VectorXd expected = matrix.lu().solve(b);
  factor.solve(b);
  EXPECT_LT((b - expected).norm(), 1e-11);
  EXPECT_EQ(factor.report().jitter, 0.0);
  EXPECT_EQ(factor.report().raised + factor.report().pivoted + factor.report().redundant_taps, 0);
}

TEST(RegularFactor, OfRowsThatRepeatAddsAJitterThatNobodySeesAndCountsIt) {
  for (const double scale : {1e-12, 1.0, 1e12}) {
    RegularFactor factor;
    factor.factorise(Eigen::MatrixXd::Constant(20, 20, scale));
    EXPECT_GT(factor.report().jitter, 0.0);
    EXPECT_LE(factor.report().jitter, 100.0 * 20 * kEpsilon * scale * 1.0001);
    EXPECT_EQ(factor.report().raised, 1);
    EXPECT_EQ(factor.report().redundant_taps, 0);
    Eigen::VectorXd b = Eigen::VectorXd::Constant(20, scale);
    factor.solve(b);
    EXPECT_NEAR(b.sum(), 1.0, 1e-3) << "all rows have their share";
    factor.factorise(scale * positive_definite(5));
    EXPECT_EQ(factor.report().jitter, 0.0) << "it goes with the matrix that needed it";
    EXPECT_EQ(factor.report().raised, 1) << "what was counted stays";
  }
}

/// Of the first row and the last the covariance is more than their variances allow.
Eigen::MatrixXd indefinite() {
  Eigen::MatrixXd matrix = positive_definite(4);
  matrix(3, 0) = matrix(0, 3) = 10.0;
  return matrix;
}

TEST(RegularFactor, OfAMatrixThatIsNoCovarianceSetsRowsAsideAndLeavesThemOutOfEveryAnswer) {
  RegularFactor factor;
  factor.factorise(indefinite());
  EXPECT_EQ(factor.report().pivoted, 1);
  ASSERT_EQ(factor.report().redundant_taps, 1);
  const Eigen::MatrixXd inverse = factor.inverse();
  EXPECT_TRUE(inverse.allFinite());
  EXPECT_EQ((inverse.diagonal().array() == 0.0).count(), 1);
  Eigen::MatrixXd b = Eigen::MatrixXd::Ones(4, 3);
  factor.solve(b);
  EXPECT_LT((b - inverse * Eigen::MatrixXd::Ones(4, 3)).norm(), 1e-9);
  Eigen::VectorXd half = Eigen::VectorXd::Ones(4);
  factor.solve_lower(half);
  EXPECT_NEAR(half.squaredNorm(), b.col(0).sum(), 1e-9);
}

TEST(RegularFactor, SetsAsideWhatIsNotFinite) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Eigen::MatrixXd matrix = positive_definite(4);
    matrix.row(2).setConstant(bad);
    matrix.col(2).setConstant(bad);
    RegularFactor factor;
    factor.factorise(matrix);
    EXPECT_GE(factor.report().redundant_taps, 1);
    EXPECT_TRUE(factor.inverse().allFinite());
    factor.factorise(Eigen::MatrixXd::Constant(3, 3, bad));
    EXPECT_TRUE(factor.inverse().allFinite());
  }
}

TEST(RegularFactor, OfNothingIsNothing) {
  RegularFactor factor;
  factor.factorise(Eigen::MatrixXd(0, 0));
  EXPECT_EQ(factor.inverse().size(), 0);
  EXPECT_EQ(factor.half_log_determinant(), 0.0);
}

}  // namespace
}  // namespace palpate::test
