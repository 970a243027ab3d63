// SPDX-License-Identifier: MIT
// The objective of fits, values and gradients, against the definitions: whole matrices in extended precision, points
// really left out, and differences of values.
#include "objective.hpp"
#include "strip_matrix.hpp"
#include "support/instruction_sets.hpp"
#include "support/testing.hpp"

#include <Eigen/Dense>

namespace palpate::fitting {
namespace {

using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
constexpr long double kLogTwoPi = 1.837877066409345483560659472811235279723L;

/// What the cases differ in.
struct Setting {
  std::string name;
  std::string kernel;
  std::string options;
  int outputs = 1;
  double mean_ratio = 0.0;
  bool fit_means = false;
  Measure measure = Measure::log_marginal_likelihood;
  double shift = 0.0;  ///< of every logarithm, towards the extremes
};

void PrintTo(const Setting& setting, std::ostream* out) { *out << setting.name; }

std::vector<Setting> settings() {
  const Measure loo = Measure::leave_one_out;
  const Measure lml = Measure::log_marginal_likelihood;
  const std::string sum =
      "{kernels: [{type: scale, factor: 2, kernel: {type: rbf, length_scale: 5 cm}}, "
      "{type: rational_quadratic, length_scale: 2 cm}]}";
  return {{"rbf", "rbf", "{length_scale: 4 cm}"},
          {"rbf_per_axis", "rbf", "{length_scale: 4 cm, length_scale_y: 7 cm}"},
          {"matern12", "matern12", "{length_scale: 4 cm}"},
          {"sum", "sum", sum},
          {"two_outputs", "matern52", "{length_scale: 4 cm}", 2},
          {"unknown_constant", "matern32", "{length_scale: 4 cm}", 1, 10.0},
          {"fitted_mean", "rbf", "{length_scale: 4 cm}", 1, 0.0, true},
          {"everything", "sum", sum, 2, 3.0, true},
          {"left_out", "rbf", "{length_scale: 4 cm}", 1, 0.0, false, loo},
          {"left_out_two_outputs", "matern52", "{length_scale: 4 cm}", 2, 0.0, true, loo},
          {"left_out_unknown_constant", "matern32", "{length_scale: 4 cm}", 1, 10.0, false, loo},
          {"left_out_everything", "sum", sum, 2, 3.0, true, loo},
          {"all_small", "rbf", "{length_scale: 4 cm}", 1, 0.0, false, lml, -6.0},
          {"all_large", "matern52", "{length_scale: 4 cm}", 1, 0.0, false, lml, 6.0},
          {"left_out_all_small", "matern52", "{length_scale: 4 cm}", 1, 0.0, false, loo, -6.0},
          {"left_out_all_large", "rbf", "{length_scale: 4 cm}", 1, 0.0, false, loo, 6.0}};
}

class FitObjective : public testing::TestWithParam<Setting> {
 protected:
  static constexpr int kPoints = 14;

  FitObjective() : kernel_(test::make<Kernel>(test::contract_host(), GetParam().kernel, GetParam().options)) {
    const Setting& setting = GetParam();
    Random random(3, "fit objective");
    for (int i = 0; i < kPoints; ++i) model_.points.row(i) << 0.23 * random.uniform(), 0.23 * random.uniform();
    for (int i = 0; i < setting.outputs; ++i) {
      for (int row = 0; row < kPoints; ++row) {
        model_.targets(row, i) = std::sin(30.0 * model_.points(row, 0) + i) + 0.3 * random.uniform();
      }
    }
    for (const KernelParameter& one : kernel_->parameters()) add(std::log(one.value) + setting.shift);
    add(std::log(0.02) + setting.shift);
    for (int i = 0; i < setting.outputs; ++i) add(0.3 * i + setting.shift);
    if (setting.fit_means) {
      for (int i = 0; i < setting.outputs; ++i) add(0.1 + 0.2 * i);
    }
  }

  void add(double value) {
    x_.push_back(value);
    expectations_.push_back({value + 0.2, 0.7, value - 50.0, value + 50.0});
  }

  double value(const std::vector<double>& x, bool priors) {
    Objective objective(model_, GetParam().measure, expectations_, priors);
    double out = 0.0;
    EXPECT_TRUE(objective.evaluate(x.data(), &out, nullptr));
    return out;
  }

  /// The covariance of output `i`, as the definition has it, with the smallest noise that a fit allows.
  Wide covariance(int i) {
    const Setting& setting = GetParam();
    const std::size_t parameters = kernel_->parameters().size();
    Eigen::VectorXd values(static_cast<Eigen::Index>(parameters));
    for (std::size_t p = 0; p < parameters; ++p) values(static_cast<Eigen::Index>(p)) = std::exp(x_[p]);
    kernel_->set_parameters(values);
    Eigen::MatrixXd k(kPoints, kPoints);
    kernel_->covariance(model_.points, model_.points, k);
    const double floor = 10.0 * kPoints * 2.220446049250313e-16 * k(0, 0);
    Wide out = k.cast<long double>();
    out.array() += static_cast<long double>(setting.mean_ratio * setting.mean_ratio);
    out.diagonal().array() += static_cast<long double>(std::exp(x_[parameters])) + static_cast<long double>(floor);
    return out * std::exp(static_cast<long double>(x_[parameters + 1 + static_cast<std::size_t>(i)]));
  }

  long double mean(int i) const {
    const std::size_t first = x_.size() - static_cast<std::size_t>(GetParam().outputs);
    return GetParam().fit_means ? x_[first + static_cast<std::size_t>(i)] : 0.25;
  }

  std::shared_ptr<Kernel> kernel_;
  FitModel model_{Points(kPoints, 2),
                  Eigen::MatrixXd(kPoints, GetParam().outputs),
                  Eigen::VectorXd::Zero(GetParam().outputs),
                  Eigen::VectorXd::Ones(GetParam().outputs),
                  *kernel_,
                  GetParam().mean_ratio,
                  Eigen::VectorXd::Constant(GetParam().outputs, 0.25),
                  GetParam().fit_means,
                  {}};
  std::vector<double> x_;
  std::vector<HyperPrior> expectations_;
};

TEST_P(FitObjective, IsTheDensityByDefinition) {
  long double sum = 0.0L;
  for (int i = 0; i < GetParam().outputs; ++i) {
    const Wide c = covariance(i);
    const Wide y = model_.targets.col(i).cast<long double>().array() - mean(i);
    if (GetParam().measure == Measure::log_marginal_likelihood) {
      const Eigen::LLT<Wide> llt(c);
      const Wide factor = llt.matrixL();
      sum -= 0.5L * (y.transpose() * llt.solve(y))(0, 0) + factor.diagonal().array().log().sum() +
             0.5L * kPoints * kLogTwoPi;
      continue;
    }
    for (int out = 0; out < kPoints; ++out) {
      std::vector<int> rest;
      for (int j = 0; j < kPoints; ++j) {
        if (j != out) rest.push_back(j);
      }
      const Wide inner = c(rest, rest);
      const Wide cross = c(rest, std::vector<int>{out});
      const Eigen::LLT<Wide> llt(inner);
      const Wide known = y(rest, std::vector<int>{0});
      const long double predicted = (cross.transpose() * llt.solve(known))(0, 0);
      const long double variance = c(out, out) - (cross.transpose() * llt.solve(cross))(0, 0);
      const long double error = y(out, 0) - predicted;
      sum -= 0.5L * (kLogTwoPi + std::log(variance) + error * error / variance);
    }
  }
  const auto truth = static_cast<double>(sum / (kPoints * GetParam().outputs));
  for (const Instructions set : math::instruction_sets()) {
    const test::OnInstructions on(set);
    EXPECT_NEAR(value(x_, false), truth, 1e-9 * std::max(1.0, std::abs(truth))) << math::name_of(set);
  }
}

TEST_P(FitObjective, HasTheGradientThatDifferencesHave) {
  double here = 0.0;
  std::vector<std::vector<double>> gradients;
  for (const Instructions set : math::instruction_sets()) {
    const test::OnInstructions on(set);
    Objective objective(model_, GetParam().measure, expectations_, true);
    gradients.emplace_back(x_.size());
    ASSERT_TRUE(objective.evaluate(x_.data(), &here, gradients.back().data()));
  }
  constexpr double kStep = 1e-3;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const auto at = [&](double steps) {
      std::vector<double> x = x_;
      x[i] += steps * kStep;
      return value(x, true);
    };
    // Fourth order: the error is that of rounding, eps |value| / step, not that of the step.
    const double slope = (8.0 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12.0 * kStep);
    for (const std::vector<double>& gradient : gradients) {
      EXPECT_NEAR(gradient[i], slope, 1e-8 * std::max(1.0, std::abs(here)) + 1e-8 * std::abs(slope))
          << "parameter " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, FitObjective, testing::ValuesIn(settings()),
                         [](const auto& one) { return one.param.name; });

StripMatrix strips_of(const Eigen::MatrixXd& matrix) {
  StripMatrix out(matrix.rows());
  for (Eigen::Index j = 0; j < matrix.rows(); ++j) out.put(j, matrix.col(j).tail(matrix.rows() - j / 8 * 8));
  return out;
}

class FitMatrices : public testing::TestWithParam<Instructions> {
  test::OnInstructions on_{GetParam()};
};

TEST_P(FitMatrices, InvertWhatTheyFactorisedToTheBytesThatWereWrittenDown) {
  Random random(4, "fit matrices");
  std::uint64_t hash = 0;
  for (const Eigen::Index n : {1, 2, 7, 8, 9, 31, 33, 50, 63, 64, 65, 100, 131, 200}) {
    Eigen::MatrixXd a(n, n);
    for (Eigen::Index i = 0; i < a.size(); ++i) a.data()[i] = random.uniform() - 0.5;
    Eigen::MatrixXd k = Eigen::MatrixXd::Identity(n, n);
    for (Eigen::Index i = 0; i < k.size(); ++i) {  // Eigen has other bytes on ARM
      for (Eigen::Index m = 0; m < n; ++m) k.data()[i] += a.data()[i / n * n + m] * a.data()[i % n * n + m];
    }
    StripMatrix matrix = strips_of(k);
    std::vector<double> reciprocals;
    ASSERT_TRUE(factorise(matrix, reciprocals)) << n;
    const Eigen::MatrixXd factor = matrix.mirrored().triangularView<Eigen::Lower>();
    EXPECT_LT((factor * factor.transpose() - k).cwiseAbs().maxCoeff(), 1e-12 * static_cast<double>(n)) << n;

    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, -1.0, 2.0);
    Eigen::VectorXd x = b;
    solve_lower(matrix, x);
    EXPECT_LT((factor * x - b).cwiseAbs().maxCoeff(), 1e-12) << n;
    StripMatrix upper(n);
    invert_transposed(matrix, reciprocals, upper);
    multiply_upper(upper, x);
    EXPECT_LT((k * x - b).cwiseAbs().maxCoeff(), 1e-11) << n;
    square_upper(upper, matrix);
    const Eigen::MatrixXd inverse = matrix.mirrored();
    EXPECT_LT((inverse * k - Eigen::MatrixXd::Identity(n, n)).cwiseAbs().maxCoeff(), 1e-11) << n;
    hash = test::hash_of(inverse.data(), n * n, test::hash_of(x.data(), n, hash));
  }
  if (GetParam() != Instructions::baseline) {  // which does not fuse products with sums
    EXPECT_EQ(hash, 0x18f25ed808f9804cULL);
  }
}

TEST_P(FitMatrices, RefuseWhatIsNotPositiveDefinite) {
  std::vector<double> reciprocals;
  for (const Eigen::Index n : {2, 9, 70}) {
    Eigen::MatrixXd indefinite = Eigen::MatrixXd::Identity(n, n);
    indefinite(n - 1, 0) = indefinite(0, n - 1) = 2.0;
    StripMatrix matrix = strips_of(indefinite);
    EXPECT_FALSE(factorise(matrix, reciprocals)) << n;
    for (const double nothing : {std::nan(""), HUGE_VAL}) {
      StripMatrix wrong = strips_of(Eigen::MatrixXd::Constant(n, n, nothing));
      EXPECT_FALSE(factorise(wrong, reciprocals)) << n;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, FitMatrices, testing::ValuesIn(math::instruction_sets()),
                         [](const auto& one) { return test::test_name(one.param); });

}  // namespace
}  // namespace palpate::fitting
