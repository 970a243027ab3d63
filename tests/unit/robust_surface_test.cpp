// SPDX-License-Identifier: MIT
// The maps of a surface without outliers against the surface at each candidate by itself.
#include "gp/robust_surface.hpp"
#include "support/grids.hpp"

#include "support/gaussian_process.hpp"
#include "support/plugins.hpp"
#include "support/testing.hpp"

#include <cmath>

namespace palpate {
namespace {

CandidateGrid lattice_of(int columns, int rows) {
  return test::product_grid(Eigen::VectorXd::LinSpaced(columns, 0.0, 0.2), Eigen::VectorXd::LinSpaced(rows, 0.0, 0.15));
}

class RobustMaps : public testing::TestWithParam<int> {};

TEST_P(RobustMaps, EqualTheSurfaceAtEachCandidate) {
  const int taps = GetParam();
  const CandidateGrid candidates = lattice_of(19, 17);  // not a multiple of the batch
  const std::shared_ptr<Kernel> kernel = test::make<Kernel>(test::shared_host(), "rbf", "{length_scale: 3 cm}");
  test::GaussianProcess process(kernel, GpSettings{0.1, 0.006, 0.02, 1.0}, candidates);
  for (int i = 0; i < taps; ++i) {
    const Target place{0.01 + 0.0137 * (i % 13), 0.012 + 0.011 * (i % 11)};
    process.add(place, i % 5 == 3 ? 0.3 : 0.05 + 0.02 * std::sin(40.0 * place.x));
  }
  RobustSurface surface(candidates);
  surface.update(process, Eigen::VectorXd::Constant(taps, 0.03));
  ASSERT_TRUE(surface.excludes_outliers());
  Eigen::VectorXd mean;
  Eigen::VectorXd variance;
  surface.read_mean(process, mean);
  surface.read_variance(process, variance);
  ASSERT_EQ(variance.size(), candidates.size());
  for (int i = 0; i < candidates.size(); ++i) {
    const RobustSurface::Height here = surface.at(process, i);
    EXPECT_NEAR(mean(i), here.mean, 1e-12) << i;
    EXPECT_NEAR(variance(i), here.variance, 1e-12) << i;
  }
  EXPECT_GT(variance.maxCoeff(), 2.0 * variance.minCoeff()) << "the variance is small near taps";
}

/// Taps of a GP with so little noise that the forms need jitter.
struct ExactTaps {
  CandidateGrid candidates = lattice_of(5, 5);
  std::shared_ptr<Kernel> kernel;
  test::GaussianProcess process;
  ExactTaps(const char* length_scale, double rough, double noise = 1e-9)
      : kernel(test::make<Kernel>(test::shared_host(), "rbf", length_scale)),
        process(kernel, GpSettings{0.1, noise, 0.0, 1.0}, candidates) {
    for (int i = 0; i < 24; ++i)
      process.add({0.01 + 0.0137 * (i % 13), 0.012 + 0.011 * (i % 11)}, 0.05 + (i % 2 == 0 ? rough : -rough));
  }
};

TEST(RobustReport, IsThatOfTheUsedPosterior) {
  const Eigen::VectorXd prior = Eigen::VectorXd::Constant(24, 0.03);
  const ExactTaps flat("{length_scale: 3 cm}", 0.0), rough("{length_scale: 50 cm}", 0.01),
      without("{length_scale: 3 cm}", 0.0, 0.0);
  RobustSurface surface(flat.candidates);
  surface.update(flat.process, prior);
  ASSERT_TRUE(surface.excludes_outliers());
  EXPECT_GT(surface.report().jitter, 0.0);
  const int raised = surface.report().raised;
  EXPECT_GT(raised, 0);
  surface.update(flat.process, prior);
  EXPECT_EQ(surface.report().raised, 2 * raised) << "every factorisation counts";
  surface.update(without.process, prior);
  EXPECT_FALSE(surface.excludes_outliers());
  EXPECT_EQ(surface.report().jitter, 0.0) << "no matrix was factorised";

  RobustSurface other(rough.candidates);
  other.update(rough.process, prior);
  ASSERT_FALSE(other.excludes_outliers()) << "a rough arm explains the heights";
  EXPECT_EQ(other.report().raised, 0) << "the posterior with the tiny noise is not used";
  EXPECT_EQ(other.report().jitter, 0.0);
}

INSTANTIATE_TEST_SUITE_P(After, RobustMaps, testing::Values(1, 2, 7, 24), testing::PrintToStringParamName());

}  // namespace
}  // namespace palpate
