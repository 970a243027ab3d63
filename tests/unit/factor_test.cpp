// SPDX-License-Identifier: MIT
#include "gp/factor.hpp"
#include "regular/regular_factor.hpp"

#include "support/eigenvalues.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <Eigen/Cholesky>

namespace palpate::test {
namespace {

/// A positive definite matrix of known conditioning, from a literal seed.
Eigen::MatrixXd positive_definite(int n, std::uint64_t seed) {
  Random random(seed, "factor_test");
  const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return random.uniform() - 0.5; });
  return a * a.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
}

TEST(Factor, GrownRowByRowEqualsTheFactorOfTheWholeMatrix) {
  const int n = 50;
  const Eigen::MatrixXd matrix = positive_definite(n, 3);
  const Eigen::MatrixXd whole = matrix.llt().matrixL();
  Factor factor;
  for (int i = 0; i < n; ++i) {
    ASSERT_TRUE(factor.append(matrix.col(i).head(i), matrix(i, i)));
    EXPECT_LT((factor.row(i) - whole.row(i).head(i).transpose()).norm(), 1e-12);
    EXPECT_NEAR(factor.pivot(i), whole(i, i), 1e-12);
  }
  EXPECT_NEAR(factor.log_determinant(), 2.0 * whole.diagonal().array().log().sum(), 1e-10);
}

TEST(Factor, RefusesARowThatMakesTheMatrixSingularAndStaysAsItWas) {
  Factor factor;
  ASSERT_TRUE(factor.append(Eigen::VectorXd(0), 1.0));
  const Eigen::VectorXd duplicate = Eigen::VectorXd::Ones(1);
  EXPECT_FALSE(factor.append(duplicate, 1.0));
  EXPECT_EQ(factor.size(), 1);
  EXPECT_TRUE(factor.append(duplicate, 1.0 + 1e-8)) << "with noise a duplicate is legal";
  EXPECT_NEAR(factor.pivot(1), 1e-4, 1e-11);
}

TEST(Factor, RefusesWhatIsNotANumber) {
  Factor factor;
  EXPECT_FALSE(factor.append(Eigen::VectorXd(0), std::nan("")));
  EXPECT_FALSE(factor.append(Eigen::VectorXd(0), 0.0));
  EXPECT_FALSE(factor.append(Eigen::VectorXd(0), -1.0));
  EXPECT_EQ(factor.size(), 0);
}

void append_all(Factor& factor, const Eigen::MatrixXd& matrix) {
  for (int i = 0; i < matrix.rows(); ++i) EXPECT_TRUE(factor.append(matrix.col(i).head(i), matrix(i, i)));
}

Factor factor_of(const Eigen::MatrixXd& matrix) {
  Factor factor;
  append_all(factor, matrix);
  return factor;
}

double condition_of(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd eigenvalues = test::eigenvalues(matrix);
  return eigenvalues.maxCoeff() / eigenvalues.minCoeff();
}

/// The covariance of n points on a line from 0 to 1 with the squared-exponential kernel.
Eigen::MatrixXd smooth(int n, double length_scale, double noise) {
  const auto covariance = [&](Eigen::Index i, Eigen::Index j) {
    return std::exp(-0.5 * std::pow(static_cast<double>(i - j) / (n * length_scale), 2));
  };
  return Eigen::MatrixXd::NullaryExpr(n, n, covariance) + noise * Eigen::MatrixXd::Identity(n, n);
}

/// All covariances alike: one eigenvalue is large.
Eigen::MatrixXd alike(int n, double noise) {
  return Eigen::MatrixXd::Ones(n, n) + noise * Eigen::MatrixXd::Identity(n, n);
}

TEST(Factor, ConditionOfADiagonalIsExact) {
  const Eigen::MatrixXd matrix = Eigen::Vector4d(3.0, 0.25, 16.0, 1.0).asDiagonal();
  EXPECT_DOUBLE_EQ(factor_of(matrix).condition(), 64.0);
  EXPECT_EQ(Factor().condition(), 1.0);
}

TEST(Factor, ConditionIsALowerBoundWithinAFactorOfTheTrueOne) {
  std::vector<Eigen::MatrixXd> matrices;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) matrices.push_back(positive_definite(20, seed));
  for (const int n : {2, 10, 60}) {
    for (const double noise : {1e-10, 1e-6, 1e-2, 1.0}) {
      matrices.push_back(alike(n, noise));
      for (const double length_scale : {0.01, 0.1, 1.0}) matrices.push_back(smooth(n, length_scale, noise));
    }
  }
  double worst = 1.0;
  for (const Eigen::MatrixXd& matrix : matrices) {
    const double ratio = condition_of(matrix) / factor_of(matrix).condition();
    // Up to what the eigenvalues themselves are rounded by.
    EXPECT_GE(ratio, 1.0 - 1e-4);
    worst = std::max(worst, ratio);
  }
  EXPECT_LE(worst, 10.0);
}

TEST(Factor, ConditionFollowsAFactorThatWasClearedAndGrownAgain) {
  Factor factor = factor_of(smooth(30, 1.0, 1e-6));
  factor.clear();
  EXPECT_EQ(factor.condition(), 1.0);
  const Eigen::MatrixXd matrix = positive_definite(20, 4);
  append_all(factor, matrix);
  EXPECT_EQ(factor.condition(), factor_of(matrix).condition());
}

TEST(IndependentRows, OfAnIndependentMatrixAreAllTheLeastExplainedFirst) {
  Eigen::MatrixXd matrix = Eigen::Vector4d(3.0, 0.25, 16.0, 1.0).asDiagonal();
  EXPECT_EQ(independent_rows(matrix), (std::vector<int>{2, 0, 3, 1}));
}

TEST(IndependentRows, AreAsManyAsTheRank) {
  for (const int rank : {1, 3, 17}) {
    Random random(static_cast<std::uint64_t>(rank), "factor_test");
    const Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(30, rank, [&] { return random.uniform() - 0.5; });
    Eigen::MatrixXd matrix = a * a.transpose();
    std::vector<int> rows = independent_rows(matrix);
    EXPECT_EQ(static_cast<int>(rows.size()), rank);
    std::sort(rows.begin(), rows.end());
    EXPECT_EQ(std::unique(rows.begin(), rows.end()), rows.end()) << "a row was taken twice";
  }
}

TEST(IndependentRows, OfDuplicatesIsOneEach) {
  Eigen::MatrixXd matrix = smooth(10, 0.1, 0.0).replicate(2, 2);
  std::vector<int> rows = independent_rows(matrix);
  for (int& row : rows) row %= 10;
  std::sort(rows.begin(), rows.end());
  EXPECT_EQ(rows, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(IndependentRows, LeaveOutWhatIsIndefiniteOrNotANumber) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(5, 5);
  matrix(0, 1) = matrix(1, 0) = 2.0;  // more alike than a point is to itself
  matrix.row(3).setConstant(std::nan(""));
  matrix.col(3).setConstant(std::nan(""));
  EXPECT_EQ(independent_rows(matrix), (std::vector<int>{0, 2, 4}));
  Eigen::MatrixXd nothing = -Eigen::MatrixXd::Identity(3, 3);
  EXPECT_TRUE(independent_rows(nothing).empty());
  Eigen::MatrixXd empty(0, 0);
  EXPECT_TRUE(independent_rows(empty).empty());
}

}  // namespace
}  // namespace palpate::test
