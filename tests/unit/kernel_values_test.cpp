// SPDX-License-Identifier: MIT
// The shipped kernels against their closed forms (Rasmussen and Williams 2006, equations 4.9 and 4.17), computed here
// in long double, whose 64 bits of mantissa leave its own rounding out of account.
#include "support/plugins.hpp"
#include "support/support.hpp"

#include <palpate/kernel.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace palpate::test {
namespace {

using Form = long double (*)(long double r);

long double rbf(long double r) { return std::exp(-r * r / 2); }
long double matern32(long double r) { return (1 + std::sqrt(3.0L) * r) * std::exp(-std::sqrt(3.0L) * r); }
long double matern52(long double r) {
  const long double s = std::sqrt(5.0L) * r;
  return (1 + s + s * s / 3) * std::exp(-s);
}

long double matern12(long double r) { return std::exp(-r); }
long double rational_quadratic(long double r) { return std::pow(1 + r * r / 5, -2.5L); }

void expect_closed_form(const std::string& name, Form form, const std::string& options = "{length_scale: 1.7 cm}") {
  const double length_scale = 0.017;
  const auto kernel = make<Kernel>(shared_host(), name, options);
  // 11 distances from one point in one batch: packets and the scalars behind them.
  const std::vector<double> distances{0.0, 1e-9, 1e-4, 0.005, 0.01, 0.017, 0.02, 0.034, 0.05, 0.1, 0.2};
  Points a(static_cast<Eigen::Index>(distances.size()), 2);
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    // On a line of slope 3 : 4, so that both coordinates count.
    a.row(i) << 0.6 * distances[static_cast<std::size_t>(i)], 0.8 * distances[static_cast<std::size_t>(i)];
  }
  const Points b = Points::Zero(1, 2);
  Eigen::MatrixXd out(a.rows(), 1);
  kernel->covariance(a, b, out);
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const long double x = a(i, 0);
    const long double y = a(i, 1);
    const long double r = std::sqrt(x * x + y * y) / length_scale;
    const auto expected = static_cast<double>(form(r));
    // exp(-z) carries the rounding of z, some 4 ulp of z, as a relative error; the rest rounds a few times more. Here
    // z is r^2 / 2 or at most sqrt(5) r.
    const auto z = static_cast<double>(std::max(r * r / 2, std::sqrt(5.0L) * r));
    EXPECT_NEAR(out(i, 0), expected, (8 + 4 * z) * std::numeric_limits<double>::epsilon() * expected)
        << "distance " << distances[static_cast<std::size_t>(i)];
  }
}

TEST(Rbf, EqualsItsClosedForm) { expect_closed_form("rbf", rbf); }
TEST(Matern32, EqualsItsClosedForm) { expect_closed_form("matern32", matern32); }
TEST(Matern52, EqualsItsClosedForm) { expect_closed_form("matern52", matern52); }
TEST(Matern12, EqualsItsClosedForm) { expect_closed_form("matern12", matern12); }
TEST(RationalQuadratic, EqualsItsClosedForm) {
  expect_closed_form("rational_quadratic", rational_quadratic, "{length_scale: 1.7 cm, alpha: 2.5}");
}

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
