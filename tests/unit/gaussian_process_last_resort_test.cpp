// SPDX-License-Identifier: MIT
// What a process does with matrices that no Cholesky factorisation takes: it raises the jitter within its limits,
// and at the very last sets taps aside. It never gives a number that is none.
#include "support/gaussian_process.hpp"
#include "support/grids.hpp"
#include "support/mocks.hpp"
#include "support/testing.hpp"

#include <functional>

namespace palpate::test {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

/// Any function of the distance, a covariance or not.
std::shared_ptr<Kernel> shaped(const std::function<double(double)>& shape) {
  return std::make_shared<FormulaKernel>([shape](const auto& a, const auto& b) { return shape((a - b).norm()); });
}

double bell(double r) { return std::exp(-0.5 * r * r / (0.3 * 0.3)); }
/// Not positive semi-definite: the Fourier transform of a box has negative values.
double box(double r) { return r < 0.5 ? 1.0 : 0.0; }
double hole(double r) { return r > 0.45 && r < 0.55 ? std::nan("") : bell(r); }

const CandidateGrid kCandidates = grid_by_count({1.0, 1.0}, 5);

GaussianProcess process_of(double (*shape)(double), double noise = 0.0, double mean_ratio = 0.0, double signal = 1.0) {
  return GaussianProcess(shaped(shape), {signal, noise, 0.0, mean_ratio}, kCandidates);
}

void expect_numbers(const GaussianProcess& process, double kernel_variance = 1.0) {
  const double square = process.settings().signal * process.settings().signal;
  const double prior = square * (kernel_variance + process.settings().mean_ratio * process.settings().mean_ratio);
  EXPECT_TRUE(process.mean().allFinite());
  EXPECT_TRUE(process.variance().allFinite());
  EXPECT_GE(process.variance().minCoeff(), 0.0);
  EXPECT_LE(process.variance().maxCoeff(), prior * (1 + 4 * kEps));
  EXPECT_TRUE(std::isfinite(process.diagnostics().log_marginal_likelihood));
  EXPECT_TRUE(std::isfinite(process.diagnostics().condition));
  const double limit = 100 * process.size() * kEps * square * kernel_variance;
  EXPECT_LE(process.diagnostics().factors.jitter, limit * (1 + 4 * kEps));
}

TEST(LastResort, DuplicatesWithoutNoiseNeedJitterButNoTapIsSetAside) {
  for (const double signal : {1e-12, 1.0, 1e12}) {
    GaussianProcess process = process_of(bell, 0.0, 0.0, signal);
    for (int i = 0; i < 60; ++i) {
      process.add({0.3 + 0.1 * (i % 3), 0.3}, signal * (i % 3));
      expect_numbers(process);
      EXPECT_EQ(process.diagnostics().factors.jitter > 0.0, i >= 3) << "from the first duplicate on";
      EXPECT_EQ(process.diagnostics().factors.raised > 0, i >= 3);
    }
    EXPECT_EQ(process.diagnostics().factors.pivoted, 0);
    EXPECT_EQ(process.diagnostics().factors.redundant_taps, 0);
    EXPECT_LE(process.diagnostics().factors.raised, 3) << "each step is worth ten times more taps";
  }
}

TEST(LastResort, JitterIsInProportionToTheVarianceOfTheKernel) {
  for (const double variance : {1e-6, 1e6}) {
    GaussianProcess process(shaped([variance](double r) { return variance * bell(r); }), {2.0, 0.0, 0.0, 0.0},
                            kCandidates);
    for (int i = 0; i < 6; ++i) {
      process.add({0.3, 0.3}, 1.0);
      expect_numbers(process, variance);
    }
    EXPECT_GT(process.diagnostics().factors.jitter, kEps * variance);
  }
}

TEST(LastResort, OneValueForAPlaceTappedOftenIsTheirAverage) {
  GaussianProcess process = process_of(bell);
  for (const double value : {1.0, 2.0, 3.0, 2.0}) process.add(kCandidates.target(12), value);
  // Contradictory taps without noise: rounding, eps, against a jitter of 10 n eps leaves 1 / (10 n) of their spread.
  EXPECT_NEAR(process.mean()(12), 2.0, 2.0 / (10 * 4));
  EXPECT_NEAR(process.relative_variance()(12), 0.0, 1e-12);
}

TEST(LastResort, AKernelThatIsNoCovarianceIsMetByPivoting) {
  GaussianProcess process = process_of(box);
  for (int i = 0; i < 25; ++i) {
    process.add(kCandidates.target(i), std::sin(i));
    expect_numbers(process);
  }
  EXPECT_GT(process.diagnostics().factors.pivoted, 0);
  EXPECT_GT(process.diagnostics().factors.redundant_taps, 0);
  EXPECT_LT(process.diagnostics().factors.redundant_taps, 25);
  EXPECT_EQ(process.size(), 25) << "they stay recorded";
}

TEST(LastResort, PivotingWorksWithAnUnknownMeanToo) {
  GaussianProcess process = process_of(box, 1e-6, 10.0);
  for (int i = 0; i < 25; ++i) process.add(kCandidates.target(i), 3.0);
  expect_numbers(process);
  EXPECT_GT(process.diagnostics().factors.redundant_taps, 0);
}

TEST(LastResort, ATapWhoseCovariancesAreNotNumbersIsSetAside) {
  // The candidates keep clear of the hole: theirs are numbers.
  const CandidateGrid candidates = scattered((Points(2, 2) << 0.0, 0.0, 0.1, 0.0).finished());
  GaussianProcess process(shaped(hole), {1.0, 0.1, 0.0, 0.0}, candidates);
  process.add({0.0, 0.1}, 1.0);
  const Eigen::VectorXd before = process.mean();
  process.add({0.0, 0.6}, 5.0);
  EXPECT_TRUE(process.mean().allFinite());
  EXPECT_EQ(process.size(), 2);
  EXPECT_EQ(process.diagnostics().factors.redundant_taps, 1);
  EXPECT_LT((process.mean() - before).cwiseAbs().maxCoeff(), 1e-10) << "it told nothing";
  process.add({0.05, 0.15}, 1.0);
  EXPECT_TRUE(process.mean().allFinite());
  EXPECT_EQ(process.diagnostics().factors.redundant_taps, 1) << "a later tap counts again";
}

TEST(LastResort, OfAKernelOfNothingButNoNumbersTheFirstTapIsLeft) {
  const CandidateGrid candidates = scattered(Points::Zero(1, 2));
  GaussianProcess process(shaped([](double r) { return r == 0.0 ? 1.0 : std::nan(""); }), {1.0, 0.0, 0.0, 0.0},
                          candidates);
  process.add({0.0, 0.0}, 1.0);
  process.add({0.1, 0.0}, 1.0);
  process.add({0.2, 0.0}, 1.0);
  EXPECT_TRUE(process.mean().allFinite());
  EXPECT_TRUE(process.variance().allFinite());
  EXPECT_EQ(process.diagnostics().factors.redundant_taps, 2);
}

TEST(LastResort, JitterThatOnceWasNeededGoesWithTheHyperparametersThatNeededIt) {
  GaussianProcess process = process_of(bell);
  for (int i = 0; i < 8; ++i) process.add({0.5, 0.5}, 1.0);
  EXPECT_GT(process.diagnostics().factors.jitter, 0.0);
  Random random(1, "test");
  process.fit(ChangingFit([](FitProblem& problem) { problem.noise_ratio = 0.1; }), random);
  EXPECT_EQ(process.diagnostics().factors.jitter, 0.0);
  EXPECT_DOUBLE_EQ(process.settings().noise, 0.1);
  expect_numbers(process);
}

}  // namespace
}  // namespace palpate::test
