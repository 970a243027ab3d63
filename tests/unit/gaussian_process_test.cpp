// SPDX-License-Identifier: MIT
#include "support/grids.hpp"
#include "support/mocks.hpp"
#include "unit/engine_data.hpp"

#include <palpate/random.hpp>

namespace palpate::test {
namespace {

/// A kernel of the tests' own: what the process does must not depend on which it is. Not stationary in its variance.
std::shared_ptr<Kernel> bowl() {
  return std::make_shared<FormulaKernel>([](const auto& a, const auto& b) {
    return (1 + a.x()) * (1 + b.x()) * std::exp(-0.5 * (a - b).squaredNorm() / (0.3 * 0.3));
  });
}

/// Taps of one output in the unit square.
Data drawn(int n, std::uint64_t seed) {
  Random random(seed, "process_test");
  Data data{Points(n, 2), Eigen::MatrixXd(n, 1)};
  for (int i = 0; i < n; ++i) {
    data.places.row(i) << random.uniform(), random.uniform();
    data.values(i) = std::sin(5 * data.places(i, 0)) + data.places(i, 1);
  }
  return data;
}

GaussianProcess processed(const Data& data, const GpSettings& settings, const CandidateGrid& candidates) {
  GaussianProcess process(bowl(), settings, candidates);
  for (Eigen::Index i = 0; i < data.values.size(); ++i) {
    process.add({data.places(i, 0), data.places(i, 1)}, data.values(i));
  }
  return process;
}

TEST(GaussianProcess, EqualsTheTextbookFormulasWithTheWholeMatrix) {
  const CandidateGrid candidates = grid_by_count({1.0, 1.0}, 9);
  const Data data = drawn(30, 1);
  const GpSettings settings{2.5, 0.1, 0.7};
  const GaussianProcess process = processed(data, settings, candidates);
  const auto book = by_the_book(*bowl(), data, candidates.points, settings, 0);
  Eigen::VectorXd prior(81);
  bowl()->variance(candidates.points, prior);
  const Eigen::VectorXd mean = book.mean().array() + 0.7;
  EXPECT_LT(apart(process.mean(), mean), 1e-9);
  EXPECT_LT(apart(process.variance(), book.variance()), 1e-9);
  EXPECT_LT(apart(process.relative_variance(), book.variance().cwiseQuotient(6.25 * prior)), 1e-9);
  EXPECT_NEAR(process.diagnostics().log_marginal_likelihood, book.log_marginal_likelihood(), 1e-9);
}

TEST(GaussianProcess, WithoutTapsIsThePrior) {
  const CandidateGrid candidates = grid_by_count({1.0, 1.0}, 4);
  const GaussianProcess process(bowl(), {3.0, 0.1, -2.0}, candidates);
  EXPECT_TRUE((process.mean().array() == -2.0).all());
  EXPECT_TRUE((process.relative_variance().array() == 1.0).all());
  EXPECT_EQ(process.diagnostics().log_marginal_likelihood, 0.0);
}

TEST(GaussianProcess, AMeasuredPlaceWithoutNoiseIsKnownExactly) {
  const CandidateGrid candidates = grid_by_count({1.0, 1.0}, 4);
  GaussianProcess process(bowl(), {1.0, 0.0, 0.0}, candidates);
  process.add(candidates.target(5), 0.25);
  EXPECT_NEAR(process.mean()(5), 0.25, 1e-15);
  EXPECT_NEAR(process.relative_variance()(5), 0.0, 1e-15);
}

TEST(GaussianProcess, MoreTapsNeverRaiseTheVariance) {
  const CandidateGrid candidates = grid_by_count({1.0, 1.0}, 9);
  const Data data = drawn(40, 5);
  GaussianProcess process(bowl(), {1.0, 1e-3, 0.0}, candidates);
  Eigen::VectorXd before = process.variance();
  for (int i = 0; i < 40; ++i) {
    process.add({data.places(i, 0), data.places(i, 1)}, data.values(i));
    const Eigen::VectorXd now = process.variance();
    EXPECT_LE((now - before).maxCoeff(), 0.0);
    EXPECT_GE(now.minCoeff(), 0.0);
    before = now;
  }
}

TEST(GaussianProcess, TheOrderOfTapsDoesNotMatterBeyondRounding) {
  const CandidateGrid candidates = grid_by_count({1.0, 1.0}, 9);
  const Data data = drawn(25, 8);
  Data reversed{data.places.colwise().reverse(), data.values.colwise().reverse()};
  const GaussianProcess a = processed(data, {1.0, 0.05, 0.0}, candidates);
  const GaussianProcess b = processed(reversed, {1.0, 0.05, 0.0}, candidates);
  EXPECT_LT(apart(a.mean(), b.mean()), 1e-10);
  EXPECT_LT(apart(a.variance(), b.variance()), 1e-10);
}

TEST(GaussianProcess, ScalingTheUnitOfTheTargetsScalesTheAnswer) {
  const CandidateGrid candidates = grid_by_count({1.0, 1.0}, 9);
  const Data metres = drawn(20, 2);
  // A power of two, so that the two computations round alike.
  const Data other{metres.places, metres.values * 1024.0};
  const GaussianProcess a = processed(metres, {1.0, 0.01, 0.5}, candidates);
  const GaussianProcess b = processed(other, {1024.0, 10.24, 512.0}, candidates);
  EXPECT_EQ(apart(a.mean() * 1024.0, b.mean()), 0.0);
  EXPECT_EQ(apart(a.relative_variance(), b.relative_variance()), 0.0);
}

TEST(GaussianProcess, RepeatedTapsWithNoiseAreAveraged) {
  const CandidateGrid candidates = grid_by_count({1.0, 1.0}, 1);
  GaussianProcess process(bowl(), {1.0, 0.5, 0.0}, candidates);
  const Target centre = candidates.target(0);
  for (const double value : {1.0, 2.0, 3.0, 2.0}) process.add(centre, value);
  // n equal places: mean = average * k / (k + noise / n), variance = k noise / (n k + noise), k = 1.5^2.
  EXPECT_NEAR(process.mean()(0), 2.0 * 2.25 / (2.25 + 0.25 / 4), 1e-12);
  EXPECT_NEAR(process.variance()(0), 2.25 * 0.25 / (4 * 2.25 + 0.25), 1e-12);
  EXPECT_EQ(process.diagnostics().factors.jitter, 0.0);
}

}  // namespace
}  // namespace palpate::test
