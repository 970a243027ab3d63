// SPDX-License-Identifier: MIT
// The log marginal likelihood, and an unknown constant in the mean, against the oracle with 100 digits; there, the
// constant is nothing but a constant added to every covariance.
#include "stability/oracle.hpp"
#include "stability/reference.hpp"
#include "support/gaussian_process.hpp"
#include "support/testing.hpp"

namespace palpate::stability {
namespace {

using test::GaussianProcess;
using test::scattered;

constexpr double kEps = std::numeric_limits<double>::epsilon();

Case with(double mean_ratio, int points, double signal, double mean) {
  Case one;
  one.kernel = "matern52";
  one.mean_ratio = mean_ratio;
  one.points = points;
  one.signal = signal;
  one.mean = mean;
  one.noise_variance = 1e-4 * signal * signal;
  one.height = signal;
  return one;
}

GaussianProcess processed(const Problem& problem, const CandidateGrid& candidates) {
  const Case& one = problem.one;
  const auto kernel = test::make<Kernel>(test::shared_host(), one.kernel, "{length_scale: 2.3 cm}");
  GaussianProcess process(kernel, {one.signal, one.noise(), one.mean, one.mean_ratio}, candidates);
  for (Eigen::Index i = 0; i < problem.values.size(); ++i) {
    process.add({problem.places(i, 0), problem.places(i, 1)}, problem.values(i));
  }
  return process;
}

TEST(UnknownMean, MeanVarianceAndLikelihoodAgreeWithTheOracle) {
  for (const double ratio : {0.0, 1e-6, 0.1, 10.0, 1e3, 1e6}) {
    for (const int points : {1, 2, 30}) {
      for (const double signal : {1e-6, 1.0, 1e6}) {
        const Case one = with(ratio, points, signal, 0.25 * signal);
        const Problem problem(one);
        const CandidateGrid candidates = scattered(problem.probes);
        const GaussianProcess process = processed(problem, candidates);
        Oracle oracle(one, problem.places, problem.values);
        ASSERT_TRUE(oracle.factorise(0.0));
        // n eps cond of the covariance without the constant: what the constant adds is computed apart.
        const double bound = 10 * points * kEps * spectrum(problem).condition();
        for (Eigen::Index i = 0; i < problem.probes.rows(); ++i) {
          const Oracle::Posterior truth = oracle.at(problem.probes(i, 0), problem.probes(i, 1));
          const double mean = (process.mean()(i) - one.mean) / one.signal;
          EXPECT_NEAR(mean, static_cast<double>(truth.mean), bound) << ratio << ' ' << points << ' ' << signal;
          EXPECT_NEAR(process.variance()(i) / one.signal / one.signal, static_cast<double>(truth.variance),
                      bound * one.prior());
        }
        const auto likelihood = static_cast<double>(oracle.log_marginal_likelihood());
        EXPECT_NEAR(process.diagnostics().log_marginal_likelihood, likelihood, bound * (1.0 + std::abs(likelihood)))
            << ratio << ' ' << points << ' ' << signal;
      }
    }
  }
}

TEST(UnknownMean, OfNoKnowledgeAtAllFollowsTheLevelOfTheData) {
  const Case one = with(1e6, 30, 1.0, 0.0);
  Problem problem(one);
  problem.values.array() += 1000.0;
  const CandidateGrid candidates = scattered(problem.probes);
  const GaussianProcess process = processed(problem, candidates);
  const Eigen::Index far = problem.probes.rows() - 1;
  const Case plain = with(0.0, 30, 1.0, 0.0);
  EXPECT_NEAR(process.mean()(far), 1000.0, 1.0) << "far from all taps it stays at their level";
  EXPECT_NEAR(processed(Problem(plain), candidates).mean()(far), 0.0, 1e-12) << "a known mean does not";
}

}  // namespace
}  // namespace palpate::stability
