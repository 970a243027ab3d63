// SPDX-License-Identifier: MIT
// The posterior of the outliers against a sum over all sets, signals and noises, where every set is factorised by
// itself with 50 digits.
#include "gp/outlier_posterior.hpp"

#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/textbook.hpp"

#include <palpate/random.hpp>

#include <Eigen/LU>
#include <boost/multiprecision/mpfr.hpp>

namespace palpate::test {
namespace {

using Real =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<50>, boost::multiprecision::et_off>;

constexpr double kLengthScale = 0.03;
constexpr double kBroader = 0.075;
constexpr double kTwoPi = 6.28318530717958647693;

template <class Number>
Number covariance(const Target& a, const Target& b, double length_scale) {
  using std::exp;
  const Number dx = (Number(a.x) - b.x) / length_scale;
  const Number dy = (Number(a.y) - b.y) / length_scale;
  return exp(-(dx * dx + dy * dy) / 2);
}

/// Random taps with some outliers, and positions at which the surface is compared.
struct Trial {
  std::vector<Target> places, probes;
  OutlierProblem problem;

  Trial(int taps, double level, bool broad, std::uint64_t seed, double share_of_outliers = 0.25) {
    Random random(seed, "lies test");
    const auto some = [&](int count) {
      std::vector<Target> out;
      for (int i = 0; i < count; ++i) out.push_back({0.12 * random.uniform(), 0.12 * random.uniform()});
      return out;
    };
    places = some(taps);
    probes = some(5);
    problem.mean_deviation = level;
    problem.outlier_deviation = 1.3;
    problem.signals = {1.0, 0.2};
    problem.noises = {0.05, 0.02};
    problem.heights.resize(taps);
    problem.prior.resize(taps);
    for (int i = 0; i < taps; ++i) {
      const bool is_outlier = random.uniform() < share_of_outliers;
      const double inlier = 0.6 + 0.1 * std::sin(places[static_cast<std::size_t>(i)].x / 0.03);
      problem.heights(i) = is_outlier ? 3.0 * random.uniform() - 1.0 : inlier + 0.05 * random.uniform();
      problem.prior(i) = random.uniform() < 0.3 ? 0.3 : 0.03;
    }
    problem.covariance = between(places, kLengthScale);
    if (!broad) return;
    problem.broad_covariance = between(places, kBroader);
    problem.broad_signal = 0.5;
  }

  /// Returns the covariances of all taps with some points.
  Eigen::MatrixXd between(const std::vector<Target>& points, double length_scale) const {
    const auto at = [](const std::vector<Target>& all, Eigen::Index i) { return all[static_cast<std::size_t>(i)]; };
    return Eigen::MatrixXd::NullaryExpr(
        static_cast<Eigen::Index>(places.size()), static_cast<Eigen::Index>(points.size()),
        [&](Eigen::Index i, Eigen::Index j) { return covariance<double>(at(places, i), at(points, j), length_scale); });
  }
};

struct Inferred {
  Eigen::VectorXd probability, mean, variance;
};

/// Returns the posterior at the probes.
Inferred read(const Trial& trial, const OutlierPosterior& posterior) {
  const auto taps = static_cast<Eigen::Index>(trial.places.size());
  const auto probes = static_cast<Eigen::Index>(trial.probes.size());
  Eigen::MatrixXd z = Eigen::MatrixXd::Ones(probes, 1 + 2 * taps);
  z.middleCols(1, taps) = trial.between(trial.probes, kLengthScale).transpose();
  z.rightCols(taps) = trial.between(trial.probes, kBroader).transpose();
  const Eigen::VectorXd form = (z * posterior.b).cwiseProduct(z).rowwise().sum();
  return {posterior.probability, z * posterior.a, Eigen::VectorXd::Constant(probes, posterior.s2) + form};
}

Inferred sum_over_all_sets(const Trial& trial) {
  const std::size_t taps = trial.places.size();
  const OutlierProblem& t = trial.problem;
  Points probes(5, 2);
  for (Eigen::Index i = 0; i < 5; ++i)
    probes.row(i) << trial.probes[static_cast<std::size_t>(i)].x, trial.probes[static_cast<std::size_t>(i)].y;
  Inferred out{Eigen::VectorXd::Zero(t.heights.size()), Eigen::VectorXd::Zero(5), Eigen::VectorXd::Zero(5)};
  double sum = 0.0;
  for (const double signal : t.signals) {
    for (const double noise : t.noises) {
      for (unsigned set = 0; set < 1u << taps; ++set) {
        Textbook<Real> others(
            [&](const Target& a, const Target& b) {
              return Real(Real(signal) * signal * covariance<Real>(a, b, kLengthScale) +
                          Real(t.broad_signal) * t.broad_signal * covariance<Real>(a, b, kBroader) +
                          Real(t.mean_deviation) * t.mean_deviation);
            },
            Real(noise) * noise, probes);
        double log_weight = 0.0;
        for (std::size_t i = 0; i < taps; ++i) {
          const auto row = static_cast<Eigen::Index>(i);
          const double pi = t.prior(row);
          if ((set >> i & 1u) == 0) {
            others.add(trial.places[i], {Real(t.heights(row))});
            log_weight += std::log(1.0 - pi);
          } else {
            const double outlier = t.heights(row) / t.outlier_deviation;
            log_weight += std::log(pi / t.outlier_deviation) - 0.5 * (outlier * outlier + std::log(kTwoPi));
          }
        }
        const double weight = std::exp(log_weight + others.log_marginal_likelihood());
        sum += weight;
        for (std::size_t i = 0; i < taps; ++i)
          out.probability(static_cast<Eigen::Index>(i)) += (set >> i & 1u) != 0 ? weight : 0.0;
        // The level is part of the surface, and of the variance that it has before any tap.
        out.mean += weight * others.mean();
        out.variance += weight * (others.variance() + others.mean().cwiseAbs2());
      }
    }
  }
  out.probability /= sum;
  out.mean /= sum;
  out.variance = out.variance / sum - out.mean.cwiseAbs2();
  return out;
}

class Outliers : public testing::TestWithParam<int> {};

TEST_P(Outliers, EqualTheSumOverAllSetsIfNoneIsLeftOut) {
  const int taps = GetParam();
  for (const bool rich : {false, true}) {
    const Trial trial(taps, rich ? 1.0 : 0.0, rich, static_cast<std::uint64_t>(taps));
    const Inferred expected = sum_over_all_sets(trial);
    const OutlierPosterior posterior = infer_outliers(trial.problem, {1 << taps, 0.0, 0.0});
    EXPECT_EQ(posterior.summed_sets, 4 << taps) << "two signals, two noises";
    EXPECT_EQ(posterior.next_weight, 0.0);
    const Inferred got = read(trial, posterior);
    // The covariance has a condition of some ten thousand, which takes four or five digits off sixteen.
    EXPECT_LT((got.probability - expected.probability).lpNorm<Eigen::Infinity>(), 1e-10);
    EXPECT_LT((got.mean - expected.mean).lpNorm<Eigen::Infinity>(), 1e-10);
    EXPECT_LT((got.variance - expected.variance).lpNorm<Eigen::Infinity>(), 1e-10);
  }
}

// Before, the covariance was factorised unchecked, and its inverse had no correct digit.
TEST(TinyNoise, IsRaisedAndTheSumIsThatOfTheRaisedNoise) {
  for (const double noise : {0.0, 1e-12, 1e-9, 1e-7}) {
    for (const bool repeated : {false, true}) {
      Trial trial(8, 1.0, true, 21, 0.0);
      trial.problem.signals = {1.0};
      trial.problem.noises = {noise};
      for (std::size_t i = 1; repeated && i < 8; i += 2) trial.places[i] = trial.places[i - 1];
      trial.problem.covariance = trial.between(trial.places, kLengthScale);
      trial.problem.broad_covariance = trial.between(trial.places, kBroader);
      for (Eigen::Index i = 0; i < 8; ++i)
        trial.problem.heights(i) = 0.6 + 0.1 * std::sin(trial.places[static_cast<std::size_t>(i)].x / 0.03);
      const OutlierPosterior posterior = infer_outliers(trial.problem, {1 << 8, 0.0, 0.0});
      ASSERT_GT(posterior.report.jitter, 0.0);
      EXPECT_EQ(posterior.report.raised, 1);
      EXPECT_LT(posterior.report.jitter, 1e-9) << "it is negligible";
      EXPECT_TRUE(std::isfinite(posterior.log_evidence));
      trial.problem.noises = {std::sqrt(noise * noise + posterior.report.jitter)};
      const Inferred expected = sum_over_all_sets(trial);
      const Inferred got = read(trial, posterior);
      EXPECT_LT((got.probability - expected.probability).lpNorm<Eigen::Infinity>(), 1e-3) << noise << repeated;
      EXPECT_LT((got.mean - expected.mean).lpNorm<Eigen::Infinity>(), 1e-4) << noise << repeated;
      EXPECT_LT((got.variance - expected.variance).lpNorm<Eigen::Infinity>(), 1e-4) << noise << repeated;
    }
  }
}

TEST(OutlierSearch, LeavesOutTapsOfAnInvalidCovarianceWhichKeepTheirPrior) {
  Trial trial(6, 1.0, true, 5);
  trial.problem.covariance(2, 4) = trial.problem.covariance(4, 2) = 7.0;
  const OutlierPosterior posterior = infer_outliers(trial.problem);
  EXPECT_GT(posterior.report.redundant_taps, 0);
  EXPECT_GT(posterior.report.pivoted, 0);
  const Inferred got = read(trial, posterior);
  EXPECT_TRUE(got.probability.allFinite() && got.mean.allFinite() && got.variance.allFinite());
}

// Rows are left out for each signal by itself.
TEST(OutlierSearch, DoesNotDependOnTheOrderOfSignalsThatLeaveOutTaps) {
  Trial trial(6, 1.0, true, 5);
  trial.problem.covariance(2, 4) = trial.problem.covariance(4, 2) = 7.0;
  trial.problem.signals = {0.005, 1.0};
  const OutlierPosterior one = infer_outliers(trial.problem);
  ASSERT_GT(one.report.redundant_taps, 0);
  trial.problem.signals = {0.005};
  ASSERT_EQ(infer_outliers(trial.problem).report.redundant_taps, 0)
      << "the noise is larger than what is wrong with so small a signal";
  trial.problem.signals = {1.0, 0.005};
  EXPECT_LT((infer_outliers(trial.problem).probability - one.probability).lpNorm<Eigen::Infinity>(), 1e-12);
}

INSTANTIATE_TEST_SUITE_P(OfSoMany, Outliers, testing::Values(1, 2, 5, 8));
/// 4096 sets for each of four combinations of signal and noise.
INSTANTIATE_TEST_SUITE_P(OfTwelve, Outliers, testing::ValuesIn(brief() ? std::vector<int>() : std::vector<int>{12}));
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Outliers);

TEST(OutlierSearch, FindsEnoughSetsForProbabilitiesAndSurface) {
  double probability = 0.0;
  double mean = 0.0;
  double deviation = 0.0;
  for (int i = 0; i < (brief() ? 2 : 10); ++i) {
    const Trial trial(10, 1.0, true, static_cast<std::uint64_t>(100 + i), 0.1);
    const Inferred all = read(trial, infer_outliers(trial.problem, {1 << 10, 0.0, 0.0}));
    const Inferred some = read(trial, infer_outliers(trial.problem));
    probability = std::max(probability, (some.probability - all.probability).lpNorm<Eigen::Infinity>());
    mean = std::max(mean, (some.mean - all.mean).lpNorm<Eigen::Infinity>());
    deviation = std::max(deviation, (some.variance.cwiseSqrt() - all.variance.cwiseSqrt()).lpNorm<Eigen::Infinity>());
  }
  // Sets of a ten-thousandth of the likeliest one's weight are left out, of which there may be a hundred.
  EXPECT_LT(probability, 0.02);
  EXPECT_LT(mean, 0.02);
  EXPECT_LT(deviation, 0.02);
}

TEST(OutlierSearch, FindsTheOnlyTapThatDisagreesWithTheOthers) {
  Trial trial(12, 1.0, true, 7);
  trial.problem.heights.setConstant(0.6);
  trial.problem.prior.setConstant(0.03);
  EXPECT_LT(infer_outliers(trial.problem).probability.maxCoeff(), 0.05);
  // A tap with others within a length scale.
  Eigen::Index closest = 0;
  trial.problem.covariance.colwise().sum().maxCoeff(&closest);
  trial.problem.heights(closest) = 1.6;
  const Eigen::VectorXd probability = infer_outliers(trial.problem).probability;
  EXPECT_GT(probability(closest), 0.9);
  for (Eigen::Index i = 0; i < 12; ++i)
    EXPECT_TRUE(i == closest || probability(i) < 0.2) << i << ": " << probability(i);
}

TEST(OutlierSearch, KeepsThePriorOfASingleTap) {
  // The height of a single tap is as probable for an outlier as for an inlier, so only the prior counts.
  Trial trial(1, 1.0, false, 3);
  trial.problem.signals = {1.0};
  trial.problem.noises = {1e-6};
  trial.problem.outlier_deviation = std::sqrt(2.0);
  trial.problem.prior.setConstant(0.2);
  EXPECT_NEAR(infer_outliers(trial.problem).probability(0), 0.2, 1e-9);
}

}  // namespace
}  // namespace palpate::test
