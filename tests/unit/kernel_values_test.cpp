// SPDX-License-Identifier: MIT
// How the shipped kernels relate to each other; their closed forms are in contract/kernel_autodiff_test.cpp.
#include "support/testing.hpp"

#include <palpate/kernel.hpp>

namespace palpate::test {
namespace {

/// The covariance of two points that are `dx` and `dy` apart.
double at(const std::string& name, const std::string& options, double dx, double dy) {
  Points a(1, 2);
  a << 0.1 + dx, 0.1 + dy;
  const Points b = Points::Constant(1, 2, 0.1);
  Eigen::MatrixXd out(1, 1);
  make<Kernel>(shared_host(), name, options)->covariance(a, b, out);
  return out(0, 0);
}

TEST(RationalQuadratic, ComesNearToRbfAsAlphaGrows) {
  // (1 + r^2 / (2 alpha))^-alpha = exp(-r^2 / 2) (1 + r^4 / (8 alpha) + ...).
  const double rbf_there = at("rbf", "{length_scale: 1 cm}", 0.01, 0.0);
  EXPECT_NEAR(at("rational_quadratic", "{length_scale: 1 cm, alpha: 1000}", 0.01, 0.0) / rbf_there, 1 + 1 / 8e3, 1e-6);
}

TEST(LengthScales, MayDifferAlongTheAxes) {
  for (const char* name : {"rbf", "matern12", "matern32", "matern52", "rational_quadratic"}) {
    const std::string both = "{length_scale: 2 cm, length_scale_y: 5 mm}";
    // Rounding of 0.1 + d, some 1e-16 of distances from 1e-3 on.
    EXPECT_NEAR(at(name, both, 0.012, 0.0), at(name, "{length_scale: 2 cm}", 0.012, 0.0), 1e-13) << name;
    EXPECT_NEAR(at(name, both, 0.0, 0.003), at(name, "{length_scale: 5 mm}", 0.0, 0.003), 1e-13) << name;
    EXPECT_NEAR(at(name, both, 0.012, 0.003), at(name, "{length_scale: 1 m}", 0.6, 0.6), 1e-13) << name;
    EXPECT_EQ(at(name, "{length_scale: 2 cm, length_scale_y: 2 cm}", 0.012, 0.007),
              at(name, "{length_scale: 2 cm}", 0.012, 0.007))
        << name;
  }
}

TEST(Compositions, AddMultiplyAndScaleTheirParts) {
  const std::string one = "{type: rbf, length_scale: 3 cm}";
  const std::string other = "{type: matern32, length_scale: 1 cm}";
  const double a = at("rbf", "{length_scale: 3 cm}", 0.01, 0.02);
  const double b = at("matern32", "{length_scale: 1 cm}", 0.01, 0.02);
  const double ulp = 4 * std::numeric_limits<double>::epsilon();
  EXPECT_NEAR(at("sum", "{kernels: [" + one + ", " + other + "]}", 0.01, 0.02), a + b, ulp * (a + b));
  EXPECT_NEAR(at("product", "{kernels: [" + one + ", " + other + "]}", 0.01, 0.02), a * b, ulp * a * b);
  EXPECT_NEAR(at("scale", "{factor: 0.3, kernel: " + other + "}", 0.01, 0.02), 0.3 * b, ulp * b);
  EXPECT_NEAR(at("sum",
                 "{kernels: [{type: scale, factor: 9, kernel: " + one + "}, {type: product, kernels: [" + other + ", " +
                     other + "]}]}",
                 0.01, 0.02),
              9 * a + b * b, ulp * (9 * a + b * b));
}

TEST(Compositions, NameTheirParametersByTheirOptions) {
  const auto kernel = make<Kernel>(shared_host(), "sum",
                                   "{kernels: [{type: scale, factor: 2, kernel: {type: rational_quadratic, alpha: 3}}, "
                                   "{type: rbf, length_scale: 2 cm, length_scale_y: 1 cm}]}");
  std::string text;
  for (const KernelParameter& one : kernel->parameters()) {
    text += one.name + "=" + std::to_string(one.value) + (one.unit == Unit::metre ? "m " : " ");
  }
  EXPECT_EQ(text,
            "kernels.0.factor=2.000000 kernels.0.kernel.length_scale=0.017000m kernels.0.kernel.alpha=3.000000 "
            "kernels.1.length_scale=0.020000m kernels.1.length_scale_y=0.010000m ");
}

}  // namespace
}  // namespace palpate::test
