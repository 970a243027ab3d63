// SPDX-License-Identifier: MIT
#include "gp/factor.hpp"

#include <palpate/random.hpp>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cmath>

namespace palpate {
namespace {

/// A positive definite matrix of known conditioning, from a literal seed.
Eigen::MatrixXd positive_definite(int n, std::uint64_t seed) {
  Random random(seed, "factor_test");
  Eigen::MatrixXd a(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) a(i, j) = random.uniform() - 0.5;
  }
  return a * a.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
}

TEST(Factor, GrownRowByRowEqualsTheFactorOfTheWholeMatrix) {
  const int n = 50;
  const Eigen::MatrixXd matrix = positive_definite(n, 3);
  const Eigen::MatrixXd whole = matrix.llt().matrixL();
  Factor factor;
  for (int i = 0; i < n; ++i) {
    ASSERT_TRUE(factor.append(matrix.col(i).head(i), matrix(i, i)));
    EXPECT_LT((factor.last_row() - whole.row(i).head(i).transpose()).norm(), 1e-12);
    EXPECT_NEAR(factor.last_pivot(), whole(i, i), 1e-12);
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
  EXPECT_NEAR(factor.last_pivot(), 1e-4, 1e-11);
}

TEST(Factor, RefusesWhatIsNotANumber) {
  Factor factor;
  EXPECT_FALSE(factor.append(Eigen::VectorXd(0), std::nan("")));
  EXPECT_FALSE(factor.append(Eigen::VectorXd(0), 0.0));
  EXPECT_FALSE(factor.append(Eigen::VectorXd(0), -1.0));
  EXPECT_EQ(factor.size(), 0);
}

TEST(Factor, ConditionIsALowerBoundOfTheTrueOne) {
  const Eigen::MatrixXd matrix = positive_definite(20, 9);
  Factor factor;
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(factor.append(matrix.col(i).head(i), matrix(i, i)));
  const Eigen::VectorXd eigenvalues = matrix.selfadjointView<Eigen::Lower>().eigenvalues();
  const double condition = eigenvalues.maxCoeff() / eigenvalues.minCoeff();
  EXPECT_LE(factor.condition(), condition);
  EXPECT_GE(factor.condition(), condition / 400.0);
}

}  // namespace
}  // namespace palpate
