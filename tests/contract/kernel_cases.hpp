// SPDX-License-Identifier: MIT
// The kernels that the contract tests run over: each found with its defaults, and compositions, which have none.
#pragma once

#include "config/describe.hpp"
#include "support/testing.hpp"

#include <palpate/kernel.hpp>

#include <cstdint>
#include <ostream>

namespace palpate::test {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// A kernel with its options.
struct KernelCase {
  std::string name;            ///< of the case
  std::string type;            ///< of the plugin
  std::string options = "{}";  ///< as a YAML map
};

inline void PrintTo(const KernelCase& one, std::ostream* out) { *out << one.type << " " << one.options; }

/// Kernels made of kernels, one inside the other too, and options that are rarely chosen.
inline std::vector<KernelCase> chosen_cases() {
  const std::string wide = "{type: rbf, length_scale: 8 cm}";
  const std::string stretched = "{type: rbf, length_scale: 3 cm, length_scale_y: 1 cm}";
  const std::string rough = "{type: matern32, length_scale: 4 cm}";
  const std::string mixed = "{type: rational_quadratic, length_scale: 2 cm, alpha: 0.7}";
  return {
      {"rbf_along_two_axes", "rbf", "{length_scale: 3 cm, length_scale_y: 1 cm}"},
      {"rational_quadratic_near_rbf", "rational_quadratic", "{alpha: 1000}"},
      {"rational_quadratic_of_all_scales", "rational_quadratic", "{alpha: 0.01, length_scale_y: 5 mm}"},
      {"sum_of_one", "sum", "{kernels: [" + wide + "]}"},
      {"sum_of_two", "sum", "{kernels: [" + wide + ", " + rough + "]}"},
      {"product_of_one", "product", "{kernels: [" + mixed + "]}"},
      {"product_of_two", "product", "{kernels: [" + stretched + ", {type: matern12}]}"},
      {"product_of_three", "product", "{kernels: [" + wide + ", {type: matern52}, " + mixed + "]}"},
      {"scale", "scale", "{factor: 0.3, kernel: " + rough + "}"},
      {"scale_by_little", "scale", "{factor: 1e-12, kernel: " + wide + "}"},
      {"scale_by_much", "scale", "{factor: 1e12, kernel: " + mixed + "}"},
      {"scale_of_scale", "scale", "{factor: 3, kernel: {type: scale, factor: 0.2, kernel: {type: matern52}}}"},
      {"sum_of_scale_and_product", "sum",
       "{kernels: [{type: scale, factor: 2.5, kernel: " + stretched + "}, {type: product, kernels: [" + rough + ", " +
           mixed + "]}]}"},
      {"product_of_sums", "product",
       "{kernels: [{type: sum, kernels: [" + wide + ", {type: matern12}]}, {type: sum, kernels: [" + rough +
           ", {type: scale, factor: 0.01, kernel: " + stretched + "}]}]}"},
      {"sum_at_the_extremes", "sum",
       "{kernels: [{type: rbf, length_scale: 1e-300 m}, {type: matern12, length_scale: 1e300 m}]}"},
      {"product_at_the_extremes", "product",
       "{kernels: [{type: matern32, length_scale: 1e-300 m}, {type: matern52, length_scale: 1e300 m}]}"},
  };
}

/// Compositions of other plugins are for their authors to test, with these laws at hand.
inline std::vector<KernelCase> kernel_cases() {
  std::vector<KernelCase> out;
  for (const std::string& name : plugins_under_contract("kernel")) out.push_back({test_name(name), name});
  for (KernelCase& one : chosen_cases()) out.push_back(std::move(one));
  return out;
}

/// The kernel of the case first, then with each real option at extremes.
inline std::vector<std::shared_ptr<Kernel>> variants(const KernelCase& one) {
  std::vector<std::shared_ptr<Kernel>> out{make<Kernel>(contract_host(), one.type, one.options)};
  if (one.options != "{}") return out;
  for (const FieldDescription& field :
       describe_fields([&](Fields& fields) { contract_host().describe("kernel", one.type, fields); })) {
    if (field.type != FieldDescription::Type::real) continue;
    for (const char* value : {"1e-300", "1e-3", "1", "1e300"}) {
      const std::string unit = field.unit == Unit::metre ? " m" : "";
      try {
        out.push_back(make<Kernel>(contract_host(), one.type, "{" + field.name + ": " + value + unit + "}"));
      } catch (const Error&) {
        // Out of the option's range: not legal, so not tested.
      }
    }
  }
  return out;
}

/// What is below counts as 0: packets stop at the smallest normal number where scalars go on to 0, and slopes multiply
/// it by squared distances.
constexpr double kNothing = 1e-280;

/// Two values of one pair of points. Eigen computes most elements of a column by packets and the rest by scalars, with
/// different exponentials of 1 to 2 ulp error each; a kernel may combine a few such.
inline void expect_same_value(double a, double b) {
  EXPECT_NEAR(a, b, 8 * kEpsilon * std::max(std::abs(a), std::abs(b)) + kNothing);
}

inline void expect_same_values(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  for (Eigen::Index i = 0; i < a.size(); ++i) expect_same_value(a(i), b(i));
}

/// Points spread over `extent` metres; every tenth is a copy of an earlier one.
inline Points spread(Eigen::Index count, double extent, std::uint64_t seed) {
  Random random(seed, "contract/kernel");
  Points points(count, 2);
  for (Eigen::Index i = 0; i < count; ++i) {
    points.row(i) << extent * random.uniform(), extent * random.uniform();
    if (i % 10 == 9) points.row(i) = points.row(i / 2);
  }
  return points;
}

/// From 0 to 1e300: 13 rows, so that packets and the scalars behind them both meet every scale.
inline Points points_of_every_scale() {
  const std::vector<double> scales{0.0, 1e-310, 1e-300, 1e-200, 1e-100, 1e-9, 1e-3, 1.0, 1e3, 1e9, 1e100, 1e200, 1e300};
  Points out(static_cast<Eigen::Index>(scales.size()), 2);
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const double scale = scales[static_cast<std::size_t>(i)];
    out.row(i) << scale, -scale;
  }
  return out;
}

inline Eigen::VectorXd parameter_values(const Kernel& kernel) {
  const std::vector<KernelParameter> parameters = kernel.parameters();
  Eigen::VectorXd out(static_cast<Eigen::Index>(parameters.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) out(i) = parameters[static_cast<std::size_t>(i)].value;
  return out;
}

inline Eigen::MatrixXd covariance(const Kernel& kernel, const Points& a, const Points& b) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Constant(a.rows(), b.rows(), std::numeric_limits<double>::quiet_NaN());
  kernel.covariance(a, b, out);
  return out;
}

inline Eigen::VectorXd variance(const Kernel& kernel, const Points& a) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(a.rows(), std::numeric_limits<double>::quiet_NaN());
  kernel.variance(a, out);
  return out;
}

/// What Kernel::derivatives answers.
struct Derivatives {
  Eigen::MatrixXd value;
  Eigen::MatrixXd slopes;
};

inline Derivatives derivatives(const Kernel& kernel, const Points& a, const Points& b) {
  const auto count = static_cast<Eigen::Index>(kernel.parameters().size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Derivatives out{Eigen::MatrixXd::Constant(a.rows(), b.rows(), nan),
                  Eigen::MatrixXd::Constant(a.rows(), count * b.rows(), nan)};
  kernel.derivatives(a, b, out.value, out.slopes);
  return out;
}

}  // namespace palpate::test
