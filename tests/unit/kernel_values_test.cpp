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

void expect_closed_form(const std::string& name, Form form) {
  const double length_scale = 0.017;
  const auto kernel = make<Kernel>(shared_host(), name, "{length_scale: 1.7 cm}");
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

}  // namespace
}  // namespace palpate::test
