// SPDX-License-Identifier: MIT
// The surface of taps some of which may lie: its maps, made of many candidates at once, against each place by itself.
#include "gp/doubt.hpp"

#include "support/plugins.hpp"
#include "support/process.hpp"
#include "support/testing.hpp"

#include <cmath>

namespace palpate {
namespace {

Candidates lattice_of(int columns, int rows) {
  return product_grid(Eigen::VectorXd::LinSpaced(columns, 0.0, 0.2), Eigen::VectorXd::LinSpaced(rows, 0.0, 0.15));
}

class Doubted : public testing::TestWithParam<int> {};

TEST_P(Doubted, MapsAreAtEachPlaceWhatItsOwnTestimonySays) {
  const int taps = GetParam();
  const Candidates candidates = lattice_of(19, 17);  // no whole number of what is computed together
  const std::shared_ptr<Kernel> kernel = test::make<Kernel>(test::shared_host(), "rbf", "{length_scale: 3 cm}");
  test::Process process(kernel, ProcessSettings{0.1, 0.006, 0.02, 1.0}, candidates);
  for (int i = 0; i < taps; ++i) {
    const Target place{0.01 + 0.0137 * (i % 13), 0.012 + 0.011 * (i % 11)};
    process.add(place, i % 5 == 3 ? 0.3 : 0.05 + 0.02 * std::sin(40.0 * place.x));
  }
  DoubtedSurface surface(candidates);
  surface.judge(process, Eigen::VectorXd::Constant(taps, 0.03));
  ASSERT_TRUE(surface.judged());
  Eigen::VectorXd mean;
  Eigen::VectorXd variance;
  surface.read_mean(process, mean);
  surface.read_variance(process, variance);
  ASSERT_EQ(variance.size(), candidates.size());
  for (int i = 0; i < candidates.size(); ++i) {
    const DoubtedSurface::Height here = surface.at(process, i);
    EXPECT_NEAR(mean(i), here.mean, 1e-12) << i;
    EXPECT_NEAR(variance(i), here.variance, 1e-12) << i;
  }
  EXPECT_GT(variance.maxCoeff(), 2.0 * variance.minCoeff()) << "it is better known where taps are";
}

INSTANTIATE_TEST_SUITE_P(After, Doubted, testing::Values(1, 2, 7, 24), testing::PrintToStringParamName());

}  // namespace
}  // namespace palpate
