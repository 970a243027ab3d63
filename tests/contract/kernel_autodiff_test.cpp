// SPDX-License-Identifier: MIT
// The shipped kernels and compositions of them against their formulas, written once more here and differentiated
// automatically (ceres::Jet), in long double, whose 64 bits of mantissa leave the oracle's rounding out of account.
#include "config/quantity.hpp"
#include "contract/kernel_cases.hpp"
#include "support/instruction_sets.hpp"

#include <palpate/kernel.hpp>

#include <ceres/jet.h>

#include <functional>
#include <map>

namespace palpate::test {
namespace {

constexpr int kMost = 10;  // parameters of one case
using Jet = ceres::Jet<long double, kMost>;

/// A walk through the resolved options of a kernel and of those inside it, in the order of the parameters.
struct Walk {
  long double dx, dy;        ///< between the two points
  int next = 0;              ///< parameter
  double largest_alpha = 0;  ///< of the rational quadratics on the way
  int formulas = 0;          ///< that were passed, and of the last with a distance its square in length scales
  double r2 = 0;

  /// The option as the next parameter: its slope is by the logarithm.
  Jet parameter(const Tree& options, const char* name, Unit unit) {
    const long double value = read_quantity(*options.find(name), name, unit);
    Jet out(value);
    out.v(next++) = value;
    return out;
  }

  Jet evaluate(const std::string& type, const Tree& options);
  Jet nested(const Tree& choice) { return evaluate(choice.find("type")->text, choice); }
};

Jet scaled_square(const Tree& options, Walk& walk) {
  const Jet along_x = walk.parameter(options, "length_scale", Unit::metre);
  const bool own_y = options.find("length_scale_y") != nullptr;
  const Jet along_y = own_y ? walk.parameter(options, "length_scale_y", Unit::metre) : along_x;
  const Jet x = walk.dx / along_x;
  const Jet y = walk.dy / along_y;
  const Jet r2 = x * x + y * y;
  walk.r2 = static_cast<double>(r2.a);
  return r2;
}

using Formula = std::function<Jet(const Tree& options, Walk& walk)>;
using RadialShape = Jet (*)(const Jet& r2);

/// A kernel of unit variance without parameters but its length scales. At r = 0 it is 1 whatever they are; there the
/// slope of the square root would be infinity times 0.
Formula stationary(RadialShape shape) {
  return [shape](const Tree& options, Walk& walk) {
    const Jet r2 = scaled_square(options, walk);
    return r2.a > 0 ? shape(r2) : Jet(1);
  };
}

const std::map<std::string, Formula>& all_formulas() {
  static const std::map<std::string, Formula> all{
      {"rbf", stationary([](const Jet& r2) { return exp(-r2 / 2.0L); })},
      {"matern12", stationary([](const Jet& r2) { return exp(-sqrt(r2)); })},
      {"matern32", stationary([](const Jet& r2) {
         const Jet s = sqrt(3.0L * r2);
         return (1.0L + s) * exp(-s);
       })},
      {"matern52", stationary([](const Jet& r2) {
         const Jet s = sqrt(5.0L * r2);
         return (1.0L + s + s * s / 3.0L) * exp(-s);
       })},
      {"rational_quadratic",
       [](const Tree& options, Walk& walk) {
         const Jet r2 = scaled_square(options, walk);
         const Jet alpha = walk.parameter(options, "alpha", Unit::none);
         walk.largest_alpha = std::max(walk.largest_alpha, static_cast<double>(alpha.a));
         return exp(-alpha * log(1.0L + r2 / (2.0L * alpha)));
       }},
      {"sum",
       [](const Tree& options, Walk& walk) {
         Jet out(0);
         for (const Tree& part : options.find("kernels")->items) out += walk.nested(part);
         return out;
       }},
      {"product",
       [](const Tree& options, Walk& walk) {
         Jet out(1);
         for (const Tree& part : options.find("kernels")->items) out *= walk.nested(part);
         return out;
       }},
      {"scale",
       [](const Tree& options, Walk& walk) {
         const Jet factor = walk.parameter(options, "factor", Unit::none);
         return factor * walk.nested(*options.find("kernel"));
       }},
  };
  return all;
}

Jet Walk::evaluate(const std::string& type, const Tree& options) {
  ++formulas;
  return all_formulas().at(type)(options, *this);
}

class KernelFormula : public testing::TestWithParam<KernelCase> {
 protected:
  static void expect_formula();
};

TEST_P(KernelFormula, HasTheValuesAndSlopesThatAutomaticDifferentiationFindsOnEveryInstructionSet) {
  for (const Instructions set : math::instruction_sets()) {
    SCOPED_TRACE(math::name_of(set));
    const OnInstructions on(set);
    expect_formula();
  }
}

void KernelFormula::expect_formula() {
  const PluginChoice choice = choose(shared_host(), "kernel", GetParam().type, GetParam().options);
  const auto kernel = context_of(shared_host()).create<Kernel>(choice);
  const auto parameters = static_cast<Eigen::Index>(kernel->parameters().size());
  ASSERT_LE(parameters, kMost);
  for (const double extent : {0.003, 0.05, 0.4}) {
    Points a = spread(45, extent, 31);
    a.row(1) << a(0, 0), a(1, 1);  // straight along y
    a.row(2) << a(2, 0), a(0, 1);  // straight along x
    const Points b = a.row(0);
    const double variance_here = variance(*kernel, b)(0);
    const Derivatives found = derivatives(*kernel, a, b);
    const Eigen::MatrixXd covariances = covariance(*kernel, a, b);
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      Walk walk{static_cast<long double>(a(i, 0)) - b(0, 0), static_cast<long double>(a(i, 1)) - b(0, 1)};
      const Jet expected = walk.evaluate(choice.type, *choice.options);
      ASSERT_EQ(walk.next, parameters);
      // exp(-z) carries the rounding of z, some 4 ulp of z, as a relative error, and z is no more than the logarithm of
      // what comes out; a power with exponent alpha carries that of its base alpha times. The rest rounds a few times.
      const auto near = [&](long double number) {
        const auto size = static_cast<double>(std::abs(number));
        const double z = size > 0 ? std::abs(std::log(size)) : 0.0;
        return (16 + 4 * z + 4 * walk.largest_alpha) * kEpsilon * size + 1e-280 * variance_here;
      };
      const auto value = static_cast<double>(expected.a);
      EXPECT_NEAR(found.value(i), value, near(expected.a)) << "extent " << extent << ", point " << i;
      // Of a kernel that is no composition z is r^2 / 2 or at most sqrt(5) r.
      const double z = std::max(walk.r2 / 2, std::sqrt(5 * walk.r2));
      const double powers = walk.largest_alpha > 2.5 ? 4 * walk.largest_alpha : 0.0;
      const double plain = (8 + 4 * z + powers) * kEpsilon * value + 1e-280;
      EXPECT_NEAR(covariances(i, 0), value, walk.formulas > 1 ? near(expected.a) : plain) << "extent " << extent;
      for (Eigen::Index p = 0; p < parameters; ++p) {
        const KernelParameter parameter = kernel->parameters()[static_cast<std::size_t>(p)];
        const long double slope = expected.v(p);
        // The slope by alpha is a difference: its terms are as large as alpha times the value.
        const bool difference = parameter.name.find("alpha") != std::string::npos;
        const double lost = difference ? 8 * kEpsilon * std::max(1.0, parameter.value) * value : 0.0;
        EXPECT_NEAR(found.slopes(i, p), static_cast<double>(slope), near(slope) + lost)
            << parameter.name << ", extent " << extent << ", point " << i;
      }
    }
  }
}

/// Kernels from elsewhere have formulas that this test cannot know.
std::vector<KernelCase> shipped_cases() {
  std::vector<KernelCase> out;
  for (const KernelCase& one : kernel_cases()) {
    if (all_formulas().count(one.type) != 0) out.push_back(one);
  }
  return out;
}

INSTANTIATE_TEST_SUITE_P(Every, KernelFormula, testing::ValuesIn(shipped_cases()),
                         [](const auto& one) { return one.param.name; });

TEST(ShippedKernel, HasItsFormulaInThisFile) {
  for (const PluginListing& row : shared_host().list("kernel", "")) {
    EXPECT_EQ(all_formulas().count(row.name), 1U) << "kernel/" << row.name;
  }
}

TEST(Compositions, NameTheirParametersByTheirOptions) {
  const auto kernel = make<Kernel>(contract_host(), "sum",
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
