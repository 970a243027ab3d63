// SPDX-License-Identifier: MIT
#include "gp/process.hpp"
#include "support/runs.hpp"

#include <palpate/random.hpp>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <cmath>

namespace palpate {
namespace {

/// A kernel of the tests' own: what the process does must not depend on which it is. Not stationary in its variance.
class Bowl final : public Kernel {
 public:
  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    for (Eigen::Index i = 0; i < a.rows(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) {
        const double scale = (1 + a(i, 0)) * (1 + b(j, 0));
        out(i, j) = scale * std::exp(-0.5 * (a.row(i) - b.row(j)).squaredNorm() / (0.3 * 0.3));
      }
    }
  }
  void variance(const PointsView& a, VectorOut out) const override { out = (1 + a.col(0).array()).square(); }
  std::vector<KernelParameter> parameters() const override { return {}; }
};

struct Data {
  Points points;
  Eigen::VectorXd values;
};

Data draw(int n, std::uint64_t seed) {
  Random random(seed, "process_test");
  Data data{Points(n, 2), Eigen::VectorXd(n)};
  for (int i = 0; i < n; ++i) {
    data.points(i, 0) = random.uniform();
    data.points(i, 1) = random.uniform();
    data.values(i) = std::sin(5 * data.points(i, 0)) + data.points(i, 1);
  }
  return data;
}

Process processed(const Data& data, const ProcessSettings& settings, const Candidates& candidates) {
  Process process(std::make_shared<Bowl>(), settings, candidates);
  for (Eigen::Index i = 0; i < data.values.size(); ++i)
    process.add({data.points(i, 0), data.points(i, 1)}, data.values(i));
  return process;
}

TEST(Process, EqualsTheTextbookFormulasWithTheWholeMatrix) {
  const Candidates candidates = grid_by_count({1.0, 1.0}, 9);
  const Data data = draw(30, 1);
  const ProcessSettings settings{2.5, 0.1, 0.7};
  const Process process = processed(data, settings, candidates);

  const Bowl kernel;
  Eigen::MatrixXd k(30, 30);
  Eigen::MatrixXd cross(30, 81);
  Eigen::VectorXd prior(81);
  kernel.covariance(data.points, data.points, k);
  kernel.covariance(data.points, candidates.points, cross);
  kernel.variance(candidates.points, prior);
  k = k * 2.5 * 2.5 + 0.01 * Eigen::MatrixXd::Identity(30, 30);
  cross *= 2.5 * 2.5;
  const Eigen::VectorXd centred = data.values.array() - 0.7;
  const Eigen::MatrixXd inverse = k.fullPivLu().inverse();
  const Eigen::VectorXd mean = (cross.transpose() * inverse * centred).array() + 0.7;
  const Eigen::VectorXd variance = 6.25 * prior - (cross.transpose() * inverse * cross).diagonal();
  EXPECT_LT((process.mean() - mean).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((process.variance() - variance).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((process.relative_variance() - variance.cwiseQuotient(6.25 * prior)).cwiseAbs().maxCoeff(), 1e-9);
  const double likelihood = -0.5 * centred.dot(inverse * centred) - 0.5 * std::log(k.determinant()) -
                            15 * std::log(2 * 3.14159265358979323846);
  EXPECT_NEAR(process.log_marginal_likelihood(), likelihood, 1e-9);
}

TEST(Process, WithoutTapsIsThePrior) {
  const Candidates candidates = grid_by_count({1.0, 1.0}, 4);
  const Process process(std::make_shared<Bowl>(), {3.0, 0.1, -2.0}, candidates);
  EXPECT_TRUE((process.mean().array() == -2.0).all());
  EXPECT_TRUE((process.relative_variance().array() == 1.0).all());
  EXPECT_EQ(process.log_marginal_likelihood(), 0.0);
}

TEST(Process, AMeasuredPlaceWithoutNoiseIsKnownExactly) {
  const Candidates candidates = grid_by_count({1.0, 1.0}, 4);
  Process process(std::make_shared<Bowl>(), {1.0, 0.0, 0.0}, candidates);
  process.add(candidates.target(5), 0.25);
  EXPECT_NEAR(process.mean()(5), 0.25, 1e-15);
  EXPECT_NEAR(process.relative_variance()(5), 0.0, 1e-15);
}

TEST(Process, MoreTapsNeverRaiseTheVariance) {
  const Candidates candidates = grid_by_count({1.0, 1.0}, 9);
  const Data data = draw(40, 5);
  Process process(std::make_shared<Bowl>(), {1.0, 1e-3, 0.0}, candidates);
  Eigen::VectorXd before = process.variance();
  for (int i = 0; i < 40; ++i) {
    process.add({data.points(i, 0), data.points(i, 1)}, data.values(i));
    const Eigen::VectorXd now = process.variance();
    EXPECT_LE((now - before).maxCoeff(), 0.0);
    EXPECT_GE(now.minCoeff(), 0.0);
    before = now;
  }
}

TEST(Process, TheOrderOfTapsDoesNotMatterBeyondRounding) {
  const Candidates candidates = grid_by_count({1.0, 1.0}, 9);
  const Data data = draw(25, 8);
  Data reversed{data.points.colwise().reverse(), data.values.reverse()};
  const Process a = processed(data, {1.0, 0.05, 0.0}, candidates);
  const Process b = processed(reversed, {1.0, 0.05, 0.0}, candidates);
  EXPECT_LT((a.mean() - b.mean()).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT((a.variance() - b.variance()).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Process, ScalingTheUnitOfTheTargetsScalesTheAnswer) {
  const Candidates candidates = grid_by_count({1.0, 1.0}, 9);
  const Data metres = draw(20, 2);
  // A power of two, so that the two computations round alike.
  const Data other{metres.points, metres.values * 1024.0};
  const Process a = processed(metres, {1.0, 0.01, 0.5}, candidates);
  const Process b = processed(other, {1024.0, 10.24, 512.0}, candidates);
  EXPECT_EQ((a.mean() * 1024.0 - b.mean()).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ((a.relative_variance() - b.relative_variance()).cwiseAbs().maxCoeff(), 0.0);
}

TEST(Process, RepeatedTapsWithNoiseAreAveraged) {
  const Candidates candidates = grid_by_count({1.0, 1.0}, 1);
  Process process(std::make_shared<Bowl>(), {1.0, 0.5, 0.0}, candidates);
  const Target centre = candidates.target(0);
  for (const double value : {1.0, 2.0, 3.0, 2.0}) process.add(centre, value);
  // n equal places: mean = average * k / (k + noise / n), variance = k noise / (n k + noise), k = 1.5^2.
  EXPECT_NEAR(process.mean()(0), 2.0 * 2.25 / (2.25 + 0.25 / 4), 1e-12);
  EXPECT_NEAR(process.variance()(0), 2.25 * 0.25 / (4 * 2.25 + 0.25), 1e-12);
  EXPECT_EQ(process.jitter(), 0.0);
}

TEST(Process, ADuplicateWithoutNoiseRaisesJitterAndReportsIt) {
  const Candidates candidates = grid_by_count({1.0, 1.0}, 5);
  Process process(std::make_shared<Bowl>(), {2.0, 0.0, 0.0}, candidates);
  process.add({0.3, 0.3}, 1.0);
  process.add({0.7, 0.3}, 0.5);
  EXPECT_EQ(process.jitter(), 0.0);
  process.add({0.3, 0.3}, 1.0);
  EXPECT_GT(process.jitter(), 0.0);
  EXPECT_LE(process.jitter(), 100 * 3 * 2.3e-16 * 4.0 * 4.0) << "100 n eps of the largest prior variance";
  EXPECT_EQ(process.jitter_raised(), 1);
  EXPECT_TRUE(process.mean().allFinite());
  EXPECT_GE(process.variance().minCoeff(), 0.0);
}

/// Doubles the signal at every contact: the simplest fit that changes something.
class Doubling final : public Fitting {
 public:
  bool due(int) const override { return true; }
  FitSummary fit(FitProblem& problem, Random&) const override {
    // The ratio of noise to signal is the problem's too: halved, it leaves the noise as it was.
    problem.outputs.front().signal *= 2;
    problem.noise_ratio /= 2;
    return {true, false, 0.0, 1, "doubled"};
  }
};

TEST(Process, AFitThatChangesHyperparametersLeavesWhatAFreshProcessWouldHave) {
  const Candidates candidates = grid_by_count({1.0, 1.0}, 6);
  const Data data = draw(12, 4);
  Process fitted = processed(data, {1.0, 0.1, 0.0}, candidates);
  Random random(1, "test");
  fitted.fit(Doubling{}, random);
  const Process fresh = processed(data, {2.0, 0.1, 0.0}, candidates);
  EXPECT_EQ((fitted.mean() - fresh.mean()).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ((fitted.variance() - fresh.variance()).cwiseAbs().maxCoeff(), 0.0);
  EXPECT_EQ(fitted.log_marginal_likelihood(), fresh.log_marginal_likelihood());
}

}  // namespace
}  // namespace palpate
