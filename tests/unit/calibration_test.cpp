// SPDX-License-Identifier: MIT
// Honest uncertainty: on surfaces drawn from the very model, 95 % intervals hold 95 % of what was not tapped.
#include "belief/metrics.hpp"
#include "support/grids.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <Eigen/Cholesky>

namespace palpate::test {
namespace {

constexpr double kNoise = 0.002;  // m
constexpr double kSignal = 0.05;  // m

/// Standard normal, by Box and Muller.
double normal(Random& random) {
  constexpr double kTwoPi = 6.283185307179586;
  return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(kTwoPi * random.uniform());
}

/// Heights at the candidates, drawn from the prior; every tap adds noise of its own.
class DrawnSurface final : public Backend {
 public:
  DrawnSurface(const Kernel& kernel, const CandidateGrid& candidates, double level, std::uint64_t seed)
      : candidates_(candidates), random_(seed, "drawn surface") {
    const int size = candidates.size();
    Eigen::MatrixXd covariance(size, size);
    kernel.covariance(candidates.points, candidates.points, covariance);
    covariance.diagonal().array() += 1e-10;
    Eigen::VectorXd white(size);
    for (int i = 0; i < size; ++i) white(i) = normal(random_);
    heights = level + kSignal * (Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL() * white).array();
  }

  Eigen::VectorXd heights;

  TapResult tap(const TapRequest& request) override {
    const Target target = request.line.target();
    return contact_on(request.line, observed(candidates_.nearest(target.x, target.y, {0.23, 0.23})), 8.0, 1.0);
  }
  double observed(int cell) { return heights(cell) + kNoise * normal(random_); }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return false; }

 private:
  const CandidateGrid& candidates_;
  Random random_;
};

/// Mean share of untapped cells within the 95 % interval, over surfaces drawn with `kernel`.
double coverage(const std::string& kernel, const std::vector<std::string>& overrides, double level) {
  const int surfaces = brief() ? 50 : 150;
  const CandidateGrid candidates = grid_by_count({0.23, 0.23}, 12);
  double sum = 0.0;
  for (int seed = 0; seed < surfaces; ++seed) {
    const auto drawn = test::make<Kernel>(test::shared_host(), kernel, "{length_scale: 4 cm}");
    const auto surface = std::make_shared<DrawnSurface>(*drawn, candidates, level, static_cast<std::uint64_t>(seed));
    std::vector<std::string> all{"seed=" + std::to_string(seed),
                                 "kernel=" + kernel,
                                 "kernel.length_scale=4cm",
                                 "belief.height.signal=5cm",
                                 "belief.height.noise=2mm",
                                 "candidates.count=12",
                                 "taps=25",
                                 "acquisition=random"};
    all.insert(all.end(), overrides.begin(), overrides.end());
    Finished run("paper/object_i.yaml", all, surface);
    Truth truth{Eigen::VectorXd(candidates.size()), Eigen::Array<bool, Eigen::Dynamic, 1>(candidates.size())};
    truth.on.setConstant(true);
    for (int i = 0; i < candidates.size(); ++i) truth.height(i) = surface->observed(i);
    std::vector<bool> tapped(static_cast<std::size_t>(candidates.size()), false);
    for (const TapRecord& tap : run.taps) tapped[static_cast<std::size_t>(tap.candidate)] = true;
    run.read({quantity::kHeightMean, quantity::kHeightStd});
    const HeightModels& models = run.models();
    const Calibration calibrated =
        calibration(models.height_mean(), models.height_variance(), models.height_noise(), truth, tapped);
    sum += *calibrated.coverage_95;
  }
  return sum / surfaces;
}

TEST(Calibration, HoldsOnSurfacesDrawnFromTheModel) {
  for (const char* kernel : {"rbf", "matern12", "matern52"})
    EXPECT_NEAR(coverage(kernel, {}, 0.0), 0.95, 0.02) << kernel;
}

TEST(Calibration, HoldsForAnUnknownLevelOfATwoPartSurface) {
  // Eight signals up, so that every tap is on the object.
  EXPECT_NEAR(coverage("rbf", {"belief.surface=two_part", "belief.height.signal=5cm"}, 0.4), 0.95, 0.02);
}

TEST(Calibration, HoldsWithFittedHyperparameters) {
  const std::vector<std::string> fitted{"fitting=ceres", "fitting.every=25", "belief.height.signal=20cm",
                                        "belief.height.noise=1cm"};
  EXPECT_NEAR(coverage("rbf", fitted, 0.0), 0.95, 0.05);
}

}  // namespace
}  // namespace palpate::test
