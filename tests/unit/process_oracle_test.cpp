// SPDX-License-Identifier: MIT
// Mean and variance of whole runs against a computation with 50 digits that shares nothing with ours: the covariance
// is built from the recorded taps, factorised and solved anew after every tap, in Boost.Multiprecision over MPFR.
#include "belief/height_map.hpp"
#include "support/arrays.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"
#include "support/textbook.hpp"

#include <boost/multiprecision/mpfr.hpp>

#include <tuple>

namespace palpate::test {
namespace {

using Real =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<50>, boost::multiprecision::et_off>;

struct Worst {
  double mean = 0.0;      ///< in prior standard deviations
  double variance = 0.0;  ///< in prior variances
  double condition = 1.0;
  int hits = 0;
};

/// What is compared.
const QuantitySet kRead{quantity::kHeightMean, quantity::kHeightStd, quantity::kLabelMean};

/// Follows a run, and compares both processes with the oracle at every candidate, whenever they have taken in a tap.
class Comparison final : public Observer {
 public:
  Comparison(HeightMapBelief& belief, double length_scale)
      : belief_(belief),
        oracle_(
            // The squared-exponential kernel of unit variance, point by point.
            [length_scale](const Target& a, const Target& b) {
              const Real dx = (Real(a.x) - b.x) / length_scale;
              const Real dy = (Real(a.y) - b.y) / length_scale;
              return Real(exp(-(dx * dx + dy * dy) / 2));
            },
            Real(1e-4 * 1e-4), grid_of(belief.candidates()).points, 2) {}

  Worst worst;

  void announce(const TapRecord&) override {
    if (worst.hits + misses_ > 0) compare();
  }
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override {
    const bool on_object = tap.reading->on_object;
    oracle_.add(tap.target(), {Real(tap.result.height()), Real(on_object ? 1 : 0)});
    ++(on_object ? worst.hits : misses_);
  }

  /// Once for each tap, the last one after the run.
  void compare() {
    belief_.update();
    belief_.infer();
    const HeightModels& models = belief_.models();
    const Eigen::VectorXd variance = oracle_.variance();
    worst.mean = std::max(
        {worst.mean, apart(oracle_.mean(0), models.height_mean()), apart(oracle_.mean(1), models.label_map().mean())});
    Eigen::VectorXd of_weights(variance.size());
    models.gps().label.process->read_variance(0, of_weights);
    worst.variance = std::max({worst.variance, apart(variance, models.height_variance()), apart(variance, of_weights)});
    // An upper bound of the condition number: trace (n + noise) over the smallest eigenvalue, which is at least the
    // noise variance; the smallest pivot squared bounds it closer where that is larger, up to the factor n.
    const Real least = *std::min_element(oracle_.pivots.begin(), oracle_.pivots.end());
    worst.condition =
        std::max(worst.condition, static_cast<double>(static_cast<double>(oracle_.pivots.size()) / (least * least)));
  }

 private:
  HeightMapBelief& belief_;
  Textbook<Real> oracle_;
  int misses_ = 0;
};

Worst errors_of_run(const std::string& length_scale, double metres, const std::string& acquisition, int seed,
                    const std::vector<std::string>& more = {}) {
  std::vector<std::string> overrides{"kernel.length_scale=" + length_scale, "acquisition=" + acquisition,
                                     "seed=" + std::to_string(seed)};
  overrides.insert(overrides.end(), more.begin(), more.end());
  Prepared prepared("paper/object_i_right.yaml", overrides, nullptr, shared_host(), kRead);
  Comparison comparison(prepared.belief(), metres);
  prepared.experiment.run(comparison);
  comparison.compare();
  return comparison.worst;
}

class OracleTest : public ::testing::TestWithParam<std::tuple<const char*, int>> {};

// The bound is the promise to users, in prior standard deviations (variances for the variance).
constexpr double kPromised = 1e-10;

void expect_promised(const Worst& worst) {
  EXPECT_LE(worst.mean, kPromised);
  EXPECT_LE(worst.variance, kPromised);
  EXPECT_GE(worst.hits, 1) << "without a hit all targets are 0 and the means prove nothing";
}

TEST_P(OracleTest, MeanAndVarianceAgreeAt17And30Millimetres) {
  const auto [acquisition, seed] = GetParam();
  expect_promised(errors_of_run("1.7cm", 0.017, acquisition, seed));
  expect_promised(errors_of_run("3cm", 0.03, acquisition, seed));
}

TEST_P(OracleTest, At130MillimetresTheErrorStaysWithinTheConditionOfTheMatrix) {
  const auto [acquisition, seed] = GetParam();
  const Worst worst = errors_of_run("13cm", 0.13, acquisition, seed);
  // A backward stable solve perturbs K by about n eps; the solution then moves by at most condition times that.
  const double bound = 17 * std::numeric_limits<double>::epsilon() * worst.condition;
  EXPECT_LE(worst.mean, bound);
  EXPECT_LE(worst.variance, bound);
  EXPECT_LT(bound, 1e-4) << "a bound that everything meets would prove nothing";
  EXPECT_GE(worst.hits, 1);
}

TEST(OracleOfAStall, FourteenTapsAtOnePlaceAreWithinThePromiseToo) {
  // A start without contact of the published rule: the matrix is as near to singular as the noise lets it be.
  for (const auto& [text, metres] : {std::pair("1.7cm", 0.017), std::pair("3cm", 0.03)}) {
    const Worst worst = errors_of_run(text, metres, "weighted", 1, {"choice.fallback=none", "choice.repeat=allow"});
    EXPECT_LE(worst.mean, kPromised);
    EXPECT_LE(worst.variance, kPromised);
    EXPECT_GT(worst.condition, 1e8) << "this test is about an ill-conditioned matrix";
  }
}

INSTANTIATE_TEST_SUITE_P(Runs, OracleTest,
                         ::testing::Combine(::testing::Values("weighted", "uncertainty"), ::testing::Values(1, 7, 11)),
                         [](const auto& one) {
                           return std::string(std::get<0>(one.param)) + "Seed" + std::to_string(std::get<1>(one.param));
                         });

}  // namespace
}  // namespace palpate::test
