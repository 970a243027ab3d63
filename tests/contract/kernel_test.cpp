// SPDX-License-Identifier: MIT
// The laws of kernel.hpp, over every kernel found, with its default options and with each real option at extremes.
#include "config/describe.hpp"
#include "support/plugins.hpp"

#include <palpate/error.hpp>
#include <palpate/kernel.hpp>

#include <Eigen/Eigenvalues>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace palpate::test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// Two values of one pair of points. Eigen computes most elements of a column by packets and the rest by scalars, with
/// different exponentials of 1 to 2 ulp error each; a kernel may combine a few such. Below 1e-300 packets stop at the
/// smallest normal number where scalars go on to 0.
void expect_same_value(double a, double b) {
  EXPECT_NEAR(a, b, 8 * kEpsilon * std::max(std::abs(a), std::abs(b)) + 1e-300);
}

/// Points spread over `extent` metres; every tenth is a copy of an earlier one.
Points spread(Eigen::Index count, double extent, std::uint64_t seed) {
  Random random(seed, "contract/kernel");
  Points points(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    points.row(i) << extent * random.uniform(), extent * random.uniform();
    if (i % 10 == 9) points.row(i) = points.row(i / 2);
  }
  return points;
}

Eigen::MatrixXd covariance(const Kernel& kernel, const Points& a, const Points& b) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(a.rows(), b.rows(), std::numeric_limits<double>::quiet_NaN());
  kernel.covariance(a, b, out);
  return out;
}

Eigen::VectorXd variance(const Kernel& kernel, const Points& a) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(a.rows(), std::numeric_limits<double>::quiet_NaN());
  kernel.variance(a, out);
  return out;
}

class KernelContract : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    kernels_.push_back(make<Kernel>(contract_host(), GetParam()));
    for (const FieldDescription& field :
         describe_fields([&](Fields& fields) { contract_host().describe("kernel", GetParam(), fields); })) {
      if (field.type != FieldDescription::Type::real) continue;
      for (const char* value : {"1e-300", "1e-3", "1", "1e300"}) {
        const std::string unit = field.unit == Unit::metre ? " m" : "";
        try {
          kernels_.push_back(make<Kernel>(contract_host(), GetParam(), "{" + field.name + ": " + value + unit + "}"));
        } catch (const Error&) {
          // Out of the option's range: not legal, so not tested.
        }
      }
    }
  }

  /// The kernel with default options first, then with one option changed.
  std::vector<std::shared_ptr<Kernel>> kernels_;
};

TEST_P(KernelContract, IsSymmetric) {
  const Points a = spread(33, 0.1, 1);
  const Points b = spread(17, 0.1, 2);
  for (const auto& kernel : kernels_) {
    const Eigen::MatrixXd forth = covariance(*kernel, a, b);
    const Eigen::MatrixXd back = covariance(*kernel, b, a);
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) expect_same_value(forth(i, j), back(j, i));
    }
  }
}

TEST_P(KernelContract, IsPositiveSemiDefinite) {
  for (const double extent : {1e-3, 0.23, 10.0}) {
    const Points a = spread(60, extent, 3);
    for (const auto& kernel : kernels_) {
      const Eigen::MatrixXd k = covariance(*kernel, a, a);
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(k, Eigen::EigenvaluesOnly);
      const double largest = solver.eigenvalues().cwiseAbs().maxCoeff();
      // Entries off by 8 ulp move eigenvalues by at most n times that; the solver adds a few n ulp of the largest.
      const double bound = 16.0 * static_cast<double>(a.rows()) * kEpsilon * largest;
      EXPECT_GE(solver.eigenvalues().minCoeff(), -bound) << "extent " << extent;
    }
  }
}

TEST_P(KernelContract, VarianceIsTheDiagonal) {
  const Points a = spread(33, 0.23, 4);
  for (const auto& kernel : kernels_) {
    const Eigen::MatrixXd k = covariance(*kernel, a, a);
    const Eigen::VectorXd diagonal = variance(*kernel, a);
    for (Eigen::Index i = 0; i < a.rows(); ++i) expect_same_value(k(i, i), diagonal(i));
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
    const Eigen::MatrixXd batch = covariance(*kernel, a, b);
    const Eigen::VectorXd variances = variance(*kernel, a);
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) {
        expect_same_value(batch(i, j), covariance(*kernel, a.row(i), b.row(j))(0, 0));
      }
      expect_same_value(variances(i), variance(*kernel, a.row(i))(0));
    }
  }
}

TEST_P(KernelContract, RowsMayComeInAnyOrder) {
  const Points a = spread(23, 0.05, 8);
  const Points b = spread(7, 0.05, 9);
  for (const auto& kernel : kernels_) {
    const Eigen::MatrixXd k = covariance(*kernel, a, b);
    const Eigen::MatrixXd reversed = covariance(*kernel, a.colwise().reverse(), b);
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) expect_same_value(k(i, j), reversed(a.rows() - 1 - i, j));
    }
  }
}

TEST_P(KernelContract, IsFiniteAtExtremesOfScale) {
  // 13 rows, so that packets and the scalars behind them both meet every scale.
  const std::vector<double> scales{0.0, 1e-310, 1e-300, 1e-200, 1e-100, 1e-9, 1e-3, 1.0, 1e3, 1e9, 1e100, 1e200, 1e300};
  const auto count = static_cast<Eigen::Index>(scales.size());
  Points a(count, 2);
  for (Eigen::Index i = 0; i < count; ++i)
    a.row(i) << scales[static_cast<std::size_t>(i)], -scales[static_cast<std::size_t>(i)];
  Points b(2 * count, 2);
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

TEST_P(KernelContract, WritesItsOutputAndNothingBesideIt) {
  const Points a = spread(5, 0.1, 11);
  const Points b = spread(3, 0.1, 12);
  for (const auto& kernel : kernels_) {
    Eigen::MatrixXd around = Eigen::MatrixXd::Constant(9, 5, 7.25);
    kernel->covariance(a, b, around.block(2, 1, 5, 3));
    EXPECT_TRUE((around.topRows(2).array() == 7.25).all());
    EXPECT_TRUE((around.bottomRows(2).array() == 7.25).all());
    EXPECT_TRUE((around.leftCols(1).array() == 7.25).all());
    EXPECT_TRUE((around.rightCols(1).array() == 7.25).all());
    Eigen::VectorXd along = Eigen::VectorXd::Constant(9, 7.25);
    kernel->variance(a, along.segment(2, 5));
    EXPECT_TRUE((along.head(2).array() == 7.25).all());
    EXPECT_TRUE((along.tail(2).array() == 7.25).all());
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
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, KernelContract, testing::ValuesIn(plugins_under_contract("kernel")),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::test
