// SPDX-License-Identifier: MIT
// Elementary functions against 50 digits, at their ends, and against the bytes that every machine has to give.
#include "support/instruction_sets.hpp"
#include "support/testing.hpp"

#include <palpate/math.hpp>
#include <palpate/random.hpp>

#include <boost/multiprecision/mpfr.hpp>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace palpate {
namespace {

using Wide =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<50>, boost::multiprecision::et_off>;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const double kNaN = std::nan("");

struct Function {
  const char* name;
  double (*ours)(double);
  std::function<Wide(const Wide&)> truth;
  double from, to;
  bool of_exponents;  ///< arguments are e^x with x from `from` to `to`
  double ulps;        ///< as palpate/math.hpp says
};

void PrintTo(const Function& function, std::ostream* out) { *out << function.name; }

/// On all instruction sets by turns.
double vector_exp(double x) {
  static std::size_t turn = 0;
  const std::vector<Instructions> sets = math::instruction_sets();
  const test::OnInstructions on(sets[turn++ % sets.size()]);
  double out = 0.0;
  math::exp(&x, 1, &out);
  return out;
}
double square_root_of_power(double x) { return math::pow(x, 0.5); }
double large_power(double x) { return math::pow(x, -10000.0); }
double odd_power(double x) { return math::pow(x, 137.25); }
double atan(double x) { return math::atan2(x, 1.0); }
double atan_of_steep(double x) { return math::atan2(1.0, x); }

const Wide& one() {
  static const Wide out = 1;
  return out;
}

std::vector<Function> functions() {
  using namespace boost::multiprecision;  // NOLINT(google-build-using-namespace)
  const auto of = [](auto f) { return std::function<Wide(const Wide&)>(f); };
  const auto exp_of = of([](const Wide& x) -> Wide { return exp(x); });
  const auto log_of = of([](const Wide& x) -> Wide { return log(x); });
  const auto sin_of = of([](const Wide& x) -> Wide { return sin(x); });
  const auto cos_of = of([](const Wide& x) -> Wide { return cos(x); });
  const auto erfc_of = of([](const Wide& x) -> Wide {
    Wide out;
    mpfr_erfc(out.backend().data(), x.backend().data(), MPFR_RNDN);
    return out;
  });
  const auto power = [&](double y) { return of([y](const Wide& x) -> Wide { return pow(x, Wide(y)); }); };
  return {{"exp", [](double x) { return math::exp(x); }, exp_of, -708.0, 709.7, false, 0.9},
          {"exp_near_0", [](double x) { return math::exp(x); }, exp_of, -1.0, 1.0, false, 0.9},
          {"vector_exp", vector_exp, exp_of, -708.0, 709.0, false, 1.2},
          {"log", math::log, log_of, -708.0, 709.0, true, 0.8},
          {"log_near_1", math::log, log_of, 0.5, 2.0, false, 0.8},
          {"log1p", math::log1p, of([](const Wide& x) -> Wide { return log1p(x); }), -50.0, 100.0, true, 1.2},
          {"log1p_near_0", math::log1p, of([](const Wide& x) -> Wide { return log1p(x); }), -0.9, 1.0, false, 1.2},
          {"log2", math::log2, of([](const Wide& x) -> Wide { return log(x) / log(Wide(2)); }), 0.0, 8.0, false, 1.7},
          {"sin", math::sin, sin_of, -10.0, 10.0, false, 0.8},
          {"sin_of_many_turns", math::sin, sin_of, -1e6, 1e6, false, 0.8},
          {"cos", math::cos, cos_of, -10.0, 10.0, false, 0.8},
          {"cos_of_many_turns", math::cos, cos_of, -1e6, 1e6, false, 0.8},
          {"atan", atan, of([](const Wide& x) -> Wide { return atan(x); }), -30.0, 30.0, true, 1.8},
          {"atan_of_steep", atan_of_steep, of([](const Wide& x) -> Wide { return atan2(one(), x); }), -9.0, 9.0, false,
           1.8},
          {"asin", math::asin, of([](const Wide& x) -> Wide { return asin(x); }), -1.0, 1.0, false, 2.6},
          {"acos", math::acos, of([](const Wide& x) -> Wide { return acos(x); }), -1.0, 1.0, false, 2.6},
          {"erfc", math::erfc, erfc_of, -6.0, 26.5, false, 8.0},
          {"erfc_near_0", math::erfc, erfc_of, -1.0, 1.0, false, 8.0},
          {"root_by_pow", square_root_of_power, power(0.5), -700.0, 700.0, true, 1.0},
          {"large_pow", large_power, power(-10000.0), 0.0, 0.07, true, 1.0},
          {"odd_pow", odd_power, power(137.25), -5.0, 5.0, true, 1.0}};
}

class Elementary : public testing::TestWithParam<Function> {};

TEST_P(Elementary, FunctionsAreAsExactAsTheirHeaderSays) {
  const Function& function = GetParam();
  Random random(6, "math_test");
  double worst = 0.0;
  double where = 0.0;
  for (int i = 0; i < 4000; ++i) {
    double x = function.from + (function.to - function.from) * random.uniform();
    if (function.of_exponents) x = std::exp(x);
    const Wide truth = function.truth(Wide(x));
    const double near = std::abs(static_cast<double>(truth));
    const double ulp = std::nextafter(near, kInfinity) - near;
    const auto error = static_cast<double>(abs(truth - Wide(function.ours(x))) / Wide(ulp));
    if (error > worst) worst = error, where = x;
  }
  RecordProperty("ulp", std::to_string(worst));
  EXPECT_LE(worst, function.ulps) << "at " << where;
  EXPECT_TRUE(std::isnan(function.ours(kNaN)));
}

INSTANTIATE_TEST_SUITE_P(Every, Elementary, testing::ValuesIn(functions()),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(ElementaryFunctions, HaveTheLimitsOfTheirDomains) {
  EXPECT_EQ(math::exp(-1e300), 0.0);
  EXPECT_EQ(math::exp(kInfinity), kInfinity);
  EXPECT_EQ(math::exp(-745.0), 5e-324);
  EXPECT_EQ(math::log(0.0), -kInfinity);
  EXPECT_EQ(math::log(kInfinity), kInfinity);
  EXPECT_TRUE(std::isnan(math::log(-1.0)));
  EXPECT_NEAR(math::log(5e-324), -744.4400719213812, 1e-12);
  EXPECT_EQ(math::log1p(1e300), math::log(1e300));
  EXPECT_EQ(math::log1p(-1.0), -kInfinity);
  EXPECT_EQ(math::pow(0.0, 2.0), 0.0);
  EXPECT_EQ(math::pow(0.0, -2.0), kInfinity);
  EXPECT_EQ(math::pow(7.0, 0.0), 1.0);
  EXPECT_EQ(math::pow(1e300, -1e4), 0.0);
  EXPECT_EQ(math::pow(1e300, 1e4), kInfinity);
  EXPECT_EQ(math::pow(kInfinity, -1.0), 0.0);
  EXPECT_EQ(math::atan2(0.0, 0.0), 0.0);
  EXPECT_EQ(math::atan2(0.0, -1.0), 3.141592653589793);
  EXPECT_EQ(math::atan2(1.0, 0.0), 0.5 * 3.141592653589793);
  EXPECT_EQ(math::atan2(-1.0, -1.0), -0.75 * 3.141592653589793);
  EXPECT_EQ(math::asin(1.0), 0.5 * 3.141592653589793);
  EXPECT_TRUE(std::isnan(math::acos(1.1)));
  EXPECT_EQ(math::erfc(-30.0), 2.0);
  EXPECT_EQ(math::erfc(30.0), 0.0);
  EXPECT_EQ(math::erfc(0.0), 1.0);
  EXPECT_EQ(math::hypot(-3.0, 4.0), 5.0);
}

class Exponentials : public testing::TestWithParam<Instructions> {
  test::OnInstructions on_{GetParam()};
};

TEST_P(Exponentials, EndAtTheLeastNumberAndAtInfinity) {
  const double least = std::exp(-708.0);
  const std::vector<double> x{-kInfinity, -1e300, -709.0, 709.8, 1e6, kInfinity, kNaN, 0.0};
  std::vector<double> out(x.size());
  math::exp(x.data(), 8, out.data());
  for (const std::size_t i : {0U, 1U, 2U}) EXPECT_DOUBLE_EQ(out[i], least) << i;
  for (const std::size_t i : {3U, 4U, 5U}) EXPECT_EQ(out[i], kInfinity) << i;
  EXPECT_TRUE(std::isnan(out[6]));
  EXPECT_EQ(out[7], 1.0);
}

TEST_P(Exponentials, HaveTheSameBytesAtEveryPlaceOfAnArray) {
  std::vector<double> x(43);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = 3.0 - 0.37 * static_cast<double>(i);
  std::vector<double> whole(x.size());
  math::exp(x.data(), 43, whole.data());
  for (std::ptrdiff_t first = 0; first < 43; ++first) {
    for (const std::ptrdiff_t count : {1, 3, 8, 17}) {
      if (first + count > 43) continue;
      std::vector<double> part(x.begin() + first, x.begin() + first + count);
      math::exp(part.data(), count, part.data());
      for (std::ptrdiff_t i = 0; i < count; ++i)
        EXPECT_EQ(part[static_cast<std::size_t>(i)], whole[static_cast<std::size_t>(first + i)]) << first << " " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Exponentials, testing::ValuesIn(math::instruction_sets()),
                         [](const auto& each) { return test::test_name(each.param); });

TEST(ElementaryFunctions, GiveTheBytesThatWereWrittenDownOnEveryMachine) {
  Random random(8, "math_test");
  std::vector<double> out;
  for (int i = 0; i < 20000; ++i) {
    const double x = 40.0 * random.uniform() - 20.0;
    const double y = 3.0 * random.uniform();
    for (const double value :
         {math::exp(x), math::log(y), math::log1p(y), math::pow(y, x), math::sin(x), math::cos(x), math::atan2(x, y),
          math::asin(y / 3.0), math::acos(y / 3.0), math::erfc(0.3 * x), math::log2(y), math::hypot(x, y)})
      out.push_back(value);
  }
  EXPECT_EQ(test::hash_of(out.data(), out.size()), 0x3c52368fde59cdeULL);
}

TEST(ElementaryFunctions, GiveTheSameExponentialsWhereverProductsAreFusedWithSums) {
  Random random(9, "math_test");
  std::vector<double> x(20000);
  for (double& each : x) each = 1400.0 * random.uniform() - 700.0;
  for (const Instructions set : math::instruction_sets()) {
    if (set == Instructions::baseline) continue;
    const test::OnInstructions on(set);
    std::vector<double> out(x.size());
    math::exp(x.data(), static_cast<std::ptrdiff_t>(x.size()), out.data());
    EXPECT_EQ(test::hash_of(out.data(), out.size()), 0x3301156e1486331cULL) << math::name_of(set);
  }
}

}  // namespace
}  // namespace palpate
