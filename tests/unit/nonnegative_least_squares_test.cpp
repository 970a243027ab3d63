// SPDX-License-Identifier: MIT
#include "solids/nonnegative_least_squares.hpp"

#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <algorithm>
#include <cmath>

namespace palpate::test {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Problem {
  MatrixXd s;
  VectorXd d;
};

/// S = A A' + floor of n unknowns, A of `rank` columns.
Problem any_problem(int n, int rank, double floor, Random& random) {
  MatrixXd a(n, rank);
  Problem out{MatrixXd(n, n), VectorXd(n)};
  for (double& one : a.reshaped()) one = 2.0 * random.uniform() - 1.0;
  for (double& one : out.d) one = 2.0 * random.uniform() - 1.0;
  out.s = a * a.transpose();
  out.s.diagonal().array() += floor;
  return out;
}

VectorXd all_of(const NonnegativeSolver& solver, Eigen::Index n) {
  VectorXd out = VectorXd::Zero(n);
  for (std::size_t i = 0; i < solver.held().size(); ++i)
    out(solver.held()[i]) = solver.values()(static_cast<Eigen::Index>(i));
  return out;
}

TEST(NonnegativeUnknowns, AreWhereTheSlopeIsNotNegativeAndNothingButZeroIsWhereItIsPositive) {
  Random random(1, "test/nonnegative");
  for (int k = 0; k < 200; ++k) {
    const int n = 1 + static_cast<int>(random.index(40));
    const Problem problem = any_problem(n, 1 + static_cast<int>(random.index(40)), 0.01, random);
    NonnegativeSolver solver;
    solver.append(problem.s, problem.d);
    solver.solve();
    const VectorXd l = all_of(solver, n);
    EXPECT_GE(l.minCoeff(), 0.0);
    // Values are below sqrt(n) / 0.01 < 1e3, entries of S below 41: 41 * 1e3 * 40 roundings of 1e-16.
    constexpr double kRounding = 1e-9;
    const VectorXd slope = problem.s * l - problem.d;
    EXPECT_GE(slope.minCoeff(), -kRounding);
    for (const int i : solver.held()) EXPECT_LE(std::abs(slope(i)), kRounding);
    EXPECT_EQ(solver.redundant_taps(), 0);
  }
}

TEST(NonnegativeUnknowns, ThatComeOneByOneEndWhereAllAtOnceDo) {
  Random random(2, "test/nonnegative");
  for (int k = 0; k < 50; ++k) {
    const Problem problem = any_problem(30, 10, 0.1, random);
    NonnegativeSolver once, often;
    once.append(problem.s, problem.d);
    once.solve();
    for (Eigen::Index n = 0; n < 30; n += 3) {
      often.append(problem.s.block(0, n, n + 3, 3), problem.d.segment(n, 3));
      often.solve();
    }
    EXPECT_LT((all_of(once, 30) - all_of(often, 30)).norm(), 1e-10);  // a strictly convex problem has one optimum
  }
}

TEST(NonnegativeUnknowns, WithWhichTheFormIsNotPositiveDefiniteAreSetAsideAndCounted) {
  Random random(3, "test/nonnegative");
  int aside = 0;
  for (int k = 0; k < 200; ++k) {
    Problem problem = any_problem(30, 5, 0.0, random);  // of rank 5
    if (k % 2 == 0) problem.s.diagonal().array() -= 0.5;
    NonnegativeSolver solver;
    for (Eigen::Index n = 0; n < 30; n += 10) {
      solver.append(problem.s.block(0, n, n + 10, 10), problem.d.segment(n, 10));
      solver.solve();
    }
    EXPECT_TRUE(solver.values().allFinite());
    EXPECT_TRUE((solver.values().array() >= 0.0).all());
    aside += solver.redundant_taps();
  }
  EXPECT_GT(aside, 200);
}

/// As the free ways of a residual GP are: values of one smooth process, some of them close to each other.
TEST(NonnegativeUnknowns, OfPlacesCloseToEachOtherAreFoundInTheEnd) {
  Random random(4, "test/nonnegative");
  for (int k = 0; k < 3000; ++k) {
    const int n = 12 + static_cast<int>(random.index(40));
    VectorXd at(n);
    Problem problem{MatrixXd(n, n), VectorXd(n)};
    for (double& one : at) one = 3.0 * random.uniform();
    for (double& one : problem.d) one = 1e-3 * (random.uniform() - 0.3);
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) {
        const double r = std::abs(at(i) - at(j));
        problem.s(i, j) = 4e-6 * (1.0 + r) * std::exp(-r) + (i == j ? 2.5e-7 : 0.0);
      }
    }
    NonnegativeSolver solver;
    const int half = n / 2;
    solver.append(problem.s.topLeftCorner(half, half), problem.d.head(half));
    solver.solve();
    solver.append(problem.s.rightCols(n - half), problem.d.tail(n - half));
    solver.solve();
    const VectorXd l = all_of(solver, n);
    EXPECT_GE(l.minCoeff(), 0.0);
    // Of a condition below 1e3 and values below 1e4 roundings are some 1e-12 of the slopes, which are 1e-3.
    EXPECT_GE((problem.s * l - problem.d).minCoeff(), -1e-12);
  }
}

}  // namespace
}  // namespace palpate::test
