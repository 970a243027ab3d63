// SPDX-License-Identifier: MIT
// The laws of kernel.hpp for kernels whose hyperparameters a fit may change.
#include "contract/kernel_cases.hpp"
#include "support/arrays.hpp"

#include <palpate/kernel.hpp>

#include <set>

namespace palpate::test {
namespace {

/// Points, and one more with which the first of them has the distance 0.
struct Places {
  explicit Places(Eigen::Index count, double extent = 0.05) : a(spread(count, extent, 21)), b(a.row(0)) {}
  Points a;
  Points b;
};

class KernelDerivatives : public testing::TestWithParam<KernelCase> {
 protected:
  void SetUp() override {
    kernels_ = variants(GetParam());
    if (!kernels_.front()->differentiable()) {
      GTEST_SKIP() << "kernel/" << GetParam().type << " is not differentiable: no fit may change it";
    }
  }

  std::vector<std::shared_ptr<Kernel>> kernels_;
};

TEST_P(KernelDerivatives, ComeWithTheCovariance) {
  const Places at(300);
  for (const auto& kernel : kernels_) {
    expect_same_values(derivatives(*kernel, at.a, at.b).value, covariance(*kernel, at.a, at.b));
  }
}

/// Change of the covariances with log parameter `which`: central differences at two steps, extrapolated to step 0.
Eigen::VectorXd differences(Kernel& kernel, Eigen::Index which, const Places& at, double step) {
  const Eigen::VectorXd here = parameter_values(kernel);
  const auto value = [&](double change) -> Eigen::VectorXd {
    Eigen::VectorXd there = here;
    there(which) *= std::exp(change);
    kernel.set_parameters(there);
    return covariance(kernel, at.a, at.b).col(0);
  };
  const Eigen::VectorXd wide = (value(2 * step) - value(-2 * step)) / (4 * step);
  const Eigen::VectorXd narrow = (value(step) - value(-step)) / (2 * step);
  kernel.set_parameters(here);
  return (4 * narrow - wide) / 3;
}

TEST_P(KernelDerivatives, EqualFiniteDifferences) {
  // The extrapolation leaves step^4 / 30 times the fifth derivative, which stays below some thousand variances for the
  // kernels in use; differences lose some 1000 ulp of the variance (the power of a rational quadratic with alpha =
  // 1000) over the step. At 1e-3 both are below 1e-9.
  constexpr double kStep = 1e-3;
  for (const Eigen::Index count : {7, 40}) {
    const Places at(count);
    for (const auto& kernel : kernels_) {
      const Eigen::MatrixXd slopes = derivatives(*kernel, at.a, at.b).slopes;
      const double tolerance = 1e-9 * variance(*kernel, at.a).maxCoeff();
      for (Eigen::Index p = 0; p < slopes.cols(); ++p) {
        const Eigen::VectorXd expected = differences(*kernel, p, at, kStep);
        EXPECT_LE((slopes.col(p) - expected).cwiseAbs().maxCoeff(), tolerance)
            << kernel->parameters()[static_cast<std::size_t>(p)].name << " = "
            << kernel->parameters()[static_cast<std::size_t>(p)].value;
      }
    }
  }
}

TEST_P(KernelDerivatives, AreFiniteAtExtremesOfScale) {
  const Points a = points_of_every_scale();
  const auto& kernel = kernels_.front();
  const std::vector<KernelParameter> parameters = kernel->parameters();
  const Eigen::VectorXd values = parameter_values(*kernel);
  for (const double length : {1e-300, 1e-150, 1e-3, 1.0, 1e150, 1e300}) {
    for (const double number : {1e-30, 1e-3, 1.0, 1e3, 1e30}) {
      Eigen::VectorXd extreme = values;
      for (Eigen::Index p = 0; p < values.size(); ++p) {
        extreme(p) = parameters[static_cast<std::size_t>(p)].unit == Unit::metre ? length : number;
      }
      kernel->set_parameters(extreme);
      EXPECT_TRUE(covariance(*kernel, a, -a).allFinite()) << length << ", " << number;
      for (Eigen::Index j = 0; j < a.rows(); ++j) {
        for (const double sign : {1.0, -1.0}) {
          const Derivatives out = derivatives(*kernel, a, sign * a.row(j));
          EXPECT_TRUE(out.value.allFinite()) << length << ", " << number << ", point " << j;
          EXPECT_TRUE(out.slopes.allFinite()) << length << ", " << number << ", point " << j;
        }
      }
    }
  }
}

TEST_P(KernelDerivatives, FollowTheParametersThatWereSet) {
  const Places at(20);
  for (const auto& kernel : kernels_) {
    const Eigen::VectorXd before = parameter_values(*kernel);
    const Eigen::MatrixXd covariances = covariance(*kernel, at.a, at.b);
    Eigen::VectorXd other(before.size());
    for (Eigen::Index p = 0; p < other.size(); ++p) other(p) = 0.011 * static_cast<double>(p + 2);
    const std::vector<KernelParameter> old = kernel->parameters();
    kernel->set_parameters(other);
    EXPECT_EQ(parameter_values(*kernel), other);
    const std::vector<KernelParameter> now = kernel->parameters();
    for (std::size_t p = 0; p < now.size(); ++p) {
      EXPECT_EQ(now[p].name, old[p].name);
      EXPECT_EQ(now[p].unit, old[p].unit);
    }
    expect_same_values(derivatives(*kernel, at.a, at.b).value, covariance(*kernel, at.a, at.b));
    expect_same_values(variance(*kernel, at.b), covariance(*kernel, at.b, at.b));
    kernel->set_parameters(before);
    EXPECT_EQ(parameter_values(*kernel), before);
    EXPECT_TRUE(covariance(*kernel, at.a, at.b) == covariances)
        << "the old parameters do not bring back the old kernel";
  }
}

TEST_P(KernelDerivatives, OfABatchEqualThoseRowByRow) {
  const Places at(23);
  for (const auto& kernel : kernels_) {
    const Derivatives batch = derivatives(*kernel, at.a, at.b);
    for (Eigen::Index i = 0; i < at.a.rows(); ++i) {
      const Derivatives one = derivatives(*kernel, at.a.row(i), at.b);
      expect_same_value(batch.value(i), one.value(0));
      for (Eigen::Index p = 0; p < batch.slopes.cols(); ++p) {
        // Where a slope is a difference of larger terms, those terms have the 8 ulp: as large as the value.
        EXPECT_NEAR(batch.slopes(i, p), one.slopes(0, p),
                    8 * kEpsilon * std::max(std::abs(one.slopes(0, p)), std::abs(one.value(0))) + kNothing);
      }
    }
  }
}

TEST_P(KernelDerivatives, OfSeveralPointsEqualThoseOfEach) {
  const Places at(13);
  const Points others = spread(5, 0.05, 22);
  for (const auto& kernel : kernels_) {
    const Derivatives batch = derivatives(*kernel, at.a, others);
    for (Eigen::Index j = 0; j < others.rows(); ++j) {
      const Derivatives one = derivatives(*kernel, at.a, others.row(j));
      expect_same_values(batch.value.col(j), one.value);
      for (Eigen::Index p = 0; p < one.slopes.cols(); ++p) {
        const Eigen::VectorXd slopes = batch.slopes.col(p * others.rows() + j);
        const double size = std::max(one.slopes.col(p).cwiseAbs().maxCoeff(), one.value.cwiseAbs().maxCoeff());
        EXPECT_LE((slopes - one.slopes.col(p)).cwiseAbs().maxCoeff(), 8 * kEpsilon * size) << j << ", parameter " << p;
      }
    }
  }
}

TEST_P(KernelDerivatives, WriteTheirOutputsAndNothingBeside) {
  const Places at(5);
  for (const auto& kernel : kernels_) {
    const auto parameters = static_cast<Eigen::Index>(kernel->parameters().size());
    written_inside(5, 1, [&](MatrixOut value) {
      // Views go by value. NOLINTNEXTLINE(performance-unnecessary-value-param)
      written_inside(5, parameters, [&](MatrixOut slopes) { kernel->derivatives(at.a, at.b, value, slopes); });
    });
  }
}

TEST_P(KernelDerivatives, OfNoPointsAreNone) {
  const Places at(1);
  for (const auto& kernel : kernels_) EXPECT_EQ(derivatives(*kernel, Points(0, 2), at.b).slopes.rows(), 0);
}

TEST_P(KernelDerivatives, BelongToParametersOfDifferentNames) {
  for (const auto& kernel : kernels_) {
    std::set<std::string> names;
    for (const KernelParameter& one : kernel->parameters()) names.insert(one.name);
    EXPECT_EQ(names.size(), kernel->parameters().size());
  }
}

INSTANTIATE_TEST_SUITE_P(Every, KernelDerivatives, testing::ValuesIn(kernel_cases()),
                         [](const auto& one) { return one.param.name; });

/// Those of which a variant says that it has slopes.
std::vector<KernelCase> slope_cases() {
  std::vector<KernelCase> out;
  for (const KernelCase& one : kernel_cases()) {
    const auto all = variants(one);
    if (std::any_of(all.begin(), all.end(), [](const auto& kernel) { return kernel->has_gradient(); }))
      out.push_back(one);
  }
  return out;
}

class KernelSlopes : public testing::TestWithParam<KernelCase> {
 protected:
  void SetUp() override {
    for (const auto& kernel : variants(GetParam())) {
      if (kernel->has_gradient()) kernels_.push_back(kernel);
    }
  }

  static double scale_of(const Kernel& kernel) { return kernel.parameters().front().value; }
  /// Whether squares of a length scale are numbers that have a reciprocal.
  static bool has_squares(double scale) { return scale > 1e-100 && scale < 1e100; }

  struct Found {
    Eigen::VectorXd across, along;
  };
  static Found slopes(const Kernel& kernel, const Eigen::VectorXd& distances) {
    Found out{Eigen::VectorXd(distances.size()), Eigen::VectorXd(distances.size())};
    kernel.gradient_covariance(distances, out.across, out.along);
    return out;
  }

  std::vector<std::shared_ptr<Kernel>> kernels_;
};

TEST_P(KernelSlopes, EqualFiniteDifferences) {
  for (const auto& kernel : kernels_) {
    const double scale = scale_of(*kernel);
    if (!has_squares(scale)) continue;
    const double step = 1e-4 * scale;
    const auto value = [&](double r) {
      Points b(1, 2);
      b << r, 0.0;
      return covariance(*kernel, Points::Zero(1, 2), b)(0, 0);
    };
    const Eigen::VectorXd at = Eigen::VectorXd::LinSpaced(30, 0.01, 5.0) * scale;
    const Found found = slopes(*kernel, at);
    for (Eigen::Index i = 0; i < at.size(); ++i) {
      const double first = (value(at(i) + step) - value(at(i) - step)) / (2 * step);
      const double second = (value(at(i) + step) - 2 * value(at(i)) + value(at(i) - step)) / (step * step);
      EXPECT_NEAR(found.across(i) * scale * scale, -first / at(i) * scale * scale, 1e-5);
      EXPECT_NEAR(found.along(i) * scale * scale, -second * scale * scale, 1e-5);
    }
  }
}

TEST_P(KernelSlopes, AreAlikeInAllDirectionsAtOnePlaceAndTheLimitBesideIt) {
  for (const auto& kernel : kernels_) {
    const double scale = scale_of(*kernel);
    if (!has_squares(scale)) continue;
    const Found found = slopes(*kernel, Eigen::Vector2d(0.0, 1e-9 * scale));
    EXPECT_EQ(found.across(0), found.along(0));
    EXPECT_GT(found.across(0), 0.0);
    EXPECT_NEAR(found.across(1), found.across(0), 1e-8 * found.across(0));
    EXPECT_NEAR(found.along(1), found.along(0), 1e-8 * found.across(0));
  }
}

TEST_P(KernelSlopes, AreFiniteAtEveryDistance) {
  for (const auto& kernel : kernels_) {
    const Found found =
        slopes(*kernel, (Eigen::VectorXd(7) << 0.0, 1e-308, 1e-150, 1e-8, 1.0, 1e160, 1.7e308).finished());
    EXPECT_TRUE(found.across.allFinite());
    EXPECT_TRUE(found.along.allFinite());
  }
}

INSTANTIATE_TEST_SUITE_P(Every, KernelSlopes, testing::ValuesIn(slope_cases()),
                         [](const auto& one) { return one.param.name; });

TEST(ShippedKernel, HasSlopesIfItIsRbfOrASmoothMaternOfOneLengthScale) {
  const std::set<std::string> with{"rbf", "matern32", "matern52"};
  for (const PluginListing& row : shared_host().list("kernel", "")) {
    const std::string options = row.name == "scale"                          ? "{factor: 2, kernel: {type: rbf}}"
                                : row.name == "sum" || row.name == "product" ? "{kernels: [{type: rbf}]}"
                                                                             : "{}";
    EXPECT_EQ(make<Kernel>(shared_host(), row.name, options)->has_gradient(), with.count(row.name) > 0) << row.name;
    if (with.count(row.name) > 0) {
      EXPECT_FALSE(make<Kernel>(shared_host(), row.name, "{length_scale: 3 cm, length_scale_y: 1 cm}")->has_gradient());
    }
  }
}

TEST(ShippedKernel, IsDifferentiableWhicheverItIs) {
  const std::vector<KernelCase> cases = kernel_cases();
  int shipped = 0;
  for (const PluginListing& row : shared_host().list("kernel", "")) {
    ++shipped;
    bool tried = false;
    for (const KernelCase& one : cases) {
      if (one.type != row.name) continue;
      tried = true;
      EXPECT_TRUE(make<Kernel>(contract_host(), one.type, one.options)->differentiable()) << one.name;
    }
    EXPECT_TRUE(tried) << "kernel/" << row.name << " needs options and has no case in kernel_cases.hpp";
  }
  EXPECT_GE(shipped, 8);
}

}  // namespace
}  // namespace palpate::test
