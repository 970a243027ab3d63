// SPDX-License-Identifier: MIT
// The laws of kernel.hpp, over every kernel found, with its default options and with each real option at extremes, and
// over compositions.
#include "contract/kernel_cases.hpp"
#include "support/arrays.hpp"
#include "support/eigenvalues.hpp"

#include <palpate/kernel.hpp>

#include <thread>

namespace palpate::test {
namespace {

class KernelContract : public testing::TestWithParam<KernelCase> {
 protected:
  void SetUp() override { kernels_ = variants(GetParam()); }

  std::vector<std::shared_ptr<Kernel>> kernels_;
};

TEST_P(KernelContract, IsSymmetric) {
  const Points a = spread(33, 0.1, 1);
  const Points b = spread(17, 0.1, 2);
  for (const auto& kernel : kernels_) {
    expect_same_values(covariance(*kernel, a, b), covariance(*kernel, b, a).transpose());
  }
}

TEST_P(KernelContract, IsPositiveSemiDefinite) {
  for (const double extent : {1e-3, 0.23, 10.0}) {
    const Points a = spread(60, extent, 3);
    for (const auto& kernel : kernels_) {
      const Eigen::MatrixXd k = covariance(*kernel, a, a);
      const Eigen::VectorXd values = eigenvalues(k);
      const double largest = values.cwiseAbs().maxCoeff();
      // Entries off by 8 ulp move eigenvalues by at most n times that; the solver adds a few n ulp of the largest.
      const double bound = 16.0 * static_cast<double>(a.rows()) * kEpsilon * largest;
      EXPECT_GE(values.minCoeff(), -bound) << "extent " << extent;
    }
  }
}

TEST_P(KernelContract, VarianceIsTheDiagonal) {
  const Points a = spread(33, 0.23, 4);
  for (const auto& kernel : kernels_) {
    expect_same_values(covariance(*kernel, a, a).diagonal(), variance(*kernel, a));
  }
}

TEST_P(KernelContract, HoldsTheCauchySchwarzInequality) {
  const Points a = spread(33, 0.02, 5);
  for (const auto& kernel : kernels_) {
    const Eigen::MatrixXd k = covariance(*kernel, a, a);
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < a.rows(); ++j) {
        EXPECT_LE(std::abs(k(i, j)), std::sqrt(k(i, i)) * std::sqrt(k(j, j)) * (1 + 8 * kEpsilon));
      }
    }
  }
}

TEST_P(KernelContract, BatchEqualsOneByOne) {
  const Points a = spread(23, 0.05, 6);
  const Points b = spread(7, 0.05, 7);
  for (const auto& kernel : kernels_) {
    Eigen::MatrixXd covariances(23, 7);
    Eigen::VectorXd variances(23);
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) covariances(i, j) = covariance(*kernel, a.row(i), b.row(j))(0);
      variances(i) = variance(*kernel, a.row(i))(0);
    }
    expect_same_values(covariance(*kernel, a, b), covariances);
    expect_same_values(variance(*kernel, a), variances);
  }
}

TEST_P(KernelContract, RowsMayComeInAnyOrder) {
  const Points a = spread(23, 0.05, 8);
  const Points b = spread(7, 0.05, 9);
  for (const auto& kernel : kernels_) {
    const Eigen::MatrixXd reversed = covariance(*kernel, a.colwise().reverse(), b);
    expect_same_values(covariance(*kernel, a, b), reversed.colwise().reverse());
  }
}

TEST_P(KernelContract, IsFiniteAtExtremesOfScale) {
  const Points a = points_of_every_scale();
  Points b(2 * a.rows(), 2);
  b << a, -a.colwise().reverse();
  for (const auto& kernel : kernels_) {
    EXPECT_TRUE(covariance(*kernel, a, b).allFinite());
    EXPECT_TRUE(covariance(*kernel, b, a).allFinite());
    EXPECT_TRUE(variance(*kernel, b).allFinite());
    EXPECT_GE(variance(*kernel, b).minCoeff(), 0.0);
  }
}

TEST_P(KernelContract, TakesNoPointsAtAll) {
  const Points some = spread(3, 0.1, 10);
  const Points none(0, 2);
  for (const auto& kernel : kernels_) {
    EXPECT_EQ(covariance(*kernel, none, some).size(), 0);
    EXPECT_EQ(covariance(*kernel, some, none).size(), 0);
    EXPECT_EQ(covariance(*kernel, none, none).size(), 0);
    EXPECT_EQ(variance(*kernel, none).size(), 0);
  }
}

TEST_P(KernelContract, IfSeparableIsTheProductOfItsFactors) {
  for (const double extent : {0.01, 0.23, 5.0}) {
    const Points a = spread(19, extent, 13);
    const Points b = spread(11, extent, 14);
    for (const auto& kernel : kernels_) {
      if (!kernel->separable()) continue;
      const Eigen::MatrixXd whole = covariance(*kernel, a, b);
      Eigen::MatrixXd along_x(19, 11);
      Eigen::MatrixXd along_y(19, 11);
      kernel->axis_covariance(0, a.col(0), b.col(0), along_x);
      kernel->axis_covariance(1, a.col(1), b.col(1), along_y);
      for (Eigen::Index i = 0; i < a.rows(); ++i) {
        for (Eigen::Index j = 0; j < b.rows(); ++j) {
          const double k = whole(i, j);
          // Below the smallest normal number there are no ulps to speak of.
          const double ulps = 8.0 + std::abs(std::log(std::max(k, 1e-300)));
          EXPECT_NEAR(along_x(i, j) * along_y(i, j), k, ulps * kEpsilon * k + 1e-300);
          Eigen::MatrixXd alone(1, 1);
          kernel->axis_covariance(0, a.col(0).segment(i, 1), b.col(0).segment(j, 1), alone);
          expect_same_value(alone(0, 0), along_x(i, j));
        }
      }
    }
  }
}

TEST_P(KernelContract, IfSeparableHasFiniteFactorsAtExtremesOfScale) {
  const Points a = points_of_every_scale();
  for (const auto& kernel : kernels_) {
    if (!kernel->separable()) continue;
    for (const int axis : {0, 1}) {
      Eigen::MatrixXd factor(a.rows(), a.rows());
      kernel->axis_covariance(axis, a.col(0), -a.col(1), factor);
      EXPECT_TRUE(factor.allFinite());
    }
  }
}

TEST_P(KernelContract, WritesItsOutputAndNothingBesideIt) {
  const Points a = spread(5, 0.1, 11);
  const Points b = spread(3, 0.1, 12);
  for (const auto& kernel : kernels_) {
    written_inside(5, 3, [&](MatrixOut out) { kernel->covariance(a, b, out); });
    written_inside(5, 1, [&](MatrixOut out) { kernel->variance(a, out.col(0)); });
  }
}

TEST_P(KernelContract, ServesTwoThreadsAtOnce) {
  const Points a = spread(40, 0.1, 13);
  for (const auto& kernel : kernels_) {
    const Eigen::MatrixXd alone = covariance(*kernel, a, a);
    Eigen::MatrixXd one;
    Eigen::MatrixXd other;
    std::thread thread([&] { one = covariance(*kernel, a, a); });
    other = covariance(*kernel, a, a);
    thread.join();
    EXPECT_TRUE(one == alone);
    EXPECT_TRUE(other == alone);
  }
}

TEST_P(KernelContract, NamesItsParameters) {
  for (const auto& kernel : kernels_) {
    for (const KernelParameter& parameter : kernel->parameters()) {
      EXPECT_FALSE(parameter.name.empty());
      EXPECT_TRUE(std::isfinite(parameter.value)) << parameter.name;
      EXPECT_GT(parameter.value, 0.0) << parameter.name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, KernelContract, testing::ValuesIn(kernel_cases()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace palpate::test
