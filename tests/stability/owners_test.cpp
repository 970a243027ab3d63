// SPDX-License-Identifier: MIT
// The rows of the stability matrix that are not the default's: one per owner of a factorisation, over noise, length
// scale and taps, with places apart, repeated and nearly repeated. The sum over outliers and the default have theirs in
// matrix_test.cpp. PALPATE_LONG=1 adds the cells of 1000 taps, half an hour; of the residual GP they have 100.
#include "objective.hpp"
#include "solids/expected_reduction.hpp"
#include "solids/residual_gp.hpp"
#include "stability/check.hpp"
#include "stability/oracle.hpp"
#include "stability/reference.hpp"
#include "support/sanitizers.hpp"
#include "support/shape_laws.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <fmt/format.h>
#include <Eigen/Cholesky>

#include <cmath>
#include <cstdlib>

namespace palpate::stability {
namespace {

using Eigen::Vector3d;

enum class Places { apart, repeated, nearly_repeated };

/// A cell of each row, but for the noise, which is looped over.
struct Cell {
  Places places;
  int taps;
  double length_scale;  ///< metres
};

constexpr double kNoises[] = {0.0, 1e-12, 1e-9, 1e-6, 1e-4, 6e-3, 5e-2};
constexpr double kNear = 1e-12;  // metres

std::string name_of(const Cell& cell) {
  const char* const places[] = {"Apart", "Repeated", "NearlyRepeated"};
  return fmt::format("{}_{}Taps_{:g}mm", places[static_cast<int>(cell.places)], cell.taps, 1e3 * cell.length_scale);
}

void PrintTo(const Cell& cell, std::ostream* out) { *out << name_of(cell); }

class Owners : public ::testing::TestWithParam<Cell> {
 protected:
  /// Whether tap `i` is one more at the place of the one before.
  bool again(int i) const { return GetParam().places != Places::apart && i % 2 == 1; }
  double gap() const { return GetParam().places == Places::nearly_repeated ? kNear : 0.0; }
  std::string kernel() const { return fmt::format("{{length_scale: {} m}}", GetParam().length_scale); }
};

/// How far the exact mean goes at some probe, in the unit of Row::mean_error, where each covariance changes by one unit
/// in the last place of a double: what no computation in double precision can know.
double moved_by_last_digits(const Case& one) {
  const Problem problem(one);
  double out = 0.0;
  double scale = 1.0;
  for (Eigen::Index i = 0; i < problem.probes.rows(); ++i) {
    Oracle oracle(one, problem.places, problem.values);
    if (!oracle.factorise(0.0)) return 0.0;
    const double x = problem.probes(i, 0), y = problem.probes(i, 1);
    const Real exact = oracle.at(x, y).mean;
    for (const Real& target : oracle.targets()) scale = std::max(scale, std::abs(static_cast<double>(target)));
    scale = std::max(scale, std::abs(static_cast<double>(exact)));
    oracle.nudge_covariances(x, y);
    // The changed matrix is not positive definite: any mean within the largest value is possible.
    if (!oracle.factorise(0.0)) return std::max(1.0, out / scale);
    out = std::max(out, std::abs(static_cast<double>(Real(oracle.at(x, y).mean - exact))));
  }
  return out / scale;
}

// Against the oracle with 100 digits, by the bounds of check.hpp, but where the last digits of the covariances alone
// move the mean farther.
TEST_P(Owners, ProcessIsThatOfTheOracle) {
  Case one;
  one.points = GetParam().taps;
  one.length = GetParam().length_scale / kSide;
  one.layout = GetParam().places == Places::apart      ? Layout::scattered
               : GetParam().places == Places::repeated ? Layout::duplicates
                                                       : Layout::pairs;
  one.gap = kNear;
  one.signal = one.height = 0.1;
  for (const double noise : kNoises) {
    one.name = fmt::format("noise {:g} m", noise);
    one.noise_variance = noise * noise;
    for (const Row& row : check(one)) {
      if (row.trouble == "mean") {
        EXPECT_GT(moved_by_last_digits(one), row.mean_error) << header() << '\n' << text(row);
      } else {
        EXPECT_EQ(row.trouble, "") << header() << '\n' << text(row);
      }
    }
  }
}

TEST_P(Owners, ClassifierGivesProbabilitiesThatAgreeWithLabelsAlike) {
  const std::string options =
      fmt::format("{{kernel: {{type: rbf, length_scale: {} m}}, signal: ", GetParam().length_scale);
  for (const char* const signal : {"0.01", "2", "100"}) {
    for (const bool contradictory : {false, true}) {
      const auto footprint = test::make<Footprint>(test::shared_host(), "gp_classifier", options + signal + "}");
      std::vector<Touch> touches = test::alike_touches(GetParam().taps, true);
      for (std::size_t i = 1; i < touches.size(); i += 2) {
        if (again(1)) touches[i].place = {touches[i - 1].place.x + gap(), touches[i - 1].place.y};
        if (contradictory) touches[i].on = false;
      }
      Points places(GetParam().taps, 2);
      for (Eigen::Index i = 0; i < places.rows(); ++i) {
        const Touch& touch = touches[static_cast<std::size_t>(i)];
        places.row(i) << touch.place.x, touch.place.y;
        footprint->add(touch);
      }
      const Eigen::VectorXd p = test::probability_of(*footprint, places);
      EXPECT_TRUE(p.allFinite() && p.minCoeff() >= 0.0 && p.maxCoeff() <= 1.0) << signal;
      const Eigen::VectorXd far = test::probability_of(*footprint, Points{{1e3, 1e3}});
      // Labels all alike raise the probability everywhere above that of the prior.
      if (!contradictory) {
        EXPECT_GE(p.minCoeff(), far(0) - 1e-9) << signal;
      }
      for (const FootprintNumber& number : footprint->numbers())
        EXPECT_TRUE(std::isfinite(number.value)) << number.name;
    }
  }
}

// The value against a factorisation with 64 bits of the very matrix, which has the least noise that a fit allows.
TEST_P(Owners, CeresObjectiveIsTheDensityAndItsGradientThatOfDifferences) {
  using namespace fitting;
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const auto n = static_cast<Eigen::Index>(GetParam().taps);
  const auto rbf = test::make<Kernel>(test::shared_host(), "rbf", kernel());
  Random random(5, "owners objective");
  FitModel model{Points(n, 2),
                 Eigen::MatrixXd(n, 1),
                 Eigen::VectorXd::Zero(1),
                 Eigen::VectorXd::Ones(1),
                 *rbf,
                 0.0,
                 Eigen::VectorXd::Zero(1),
                 false,
                 {}};
  for (int i = 0; i < n; ++i) {
    model.points.row(i) << kSide * random.uniform(), kSide * random.uniform();
    if (again(i)) model.points.row(i) << model.points(i - 1, 0) + gap(), model.points(i - 1, 1);
    model.targets(i, 0) = std::sin(30.0 * model.points(i, 0)) + 0.5 * model.points(i, 1);
  }
  Eigen::MatrixXd k(n, n);
  rbf->covariance(model.points, model.points, k);
  constexpr double kEps = 2.220446049250313e-16;
  for (const double noise : kNoises) {
    const double ratio = std::max(noise, 1e-12) / 0.1;
    const std::vector<double> x{std::log(GetParam().length_scale), 2.0 * std::log(ratio), 0.0};
    std::vector<fitting::HyperPrior> expectations;
    for (const double one : x) expectations.push_back({one, 0.7, one - 50.0, one + 50.0});
    Objective objective(model, Measure::log_marginal_likelihood, expectations, false);
    double value = 0.0;
    std::vector<double> gradient(x.size());
    ASSERT_TRUE(objective.evaluate(x.data(), &value, gradient.data())) << noise;
    ASSERT_TRUE(std::isfinite(value)) << noise;
    Wide c = k.cast<long double>();
    const double least = ratio * ratio + 10.0 * static_cast<double>(n) * kEps * k(0, 0);
    c.diagonal().array() += static_cast<long double>(least);
    const Eigen::LDLT<Wide> ldlt(c);
    const Wide y = model.targets.cast<long double>();
    const long double fit = (y.transpose() * ldlt.solve(y))(0, 0);
    const long double determinant = ldlt.vectorD().array().log().sum();
    const auto truth = static_cast<double>(
        -0.5L * (fit + determinant + static_cast<long double>(n) * 1.837877066409345483560659472811235279723L) / n);
    // A backward error of n eps |K| moves the form by that over the least eigenvalue.
    const double off = std::min(0.5, static_cast<double>(n * n) * kEps / least);
    const double size = std::abs(truth) + static_cast<double>(fit) / static_cast<double>(n);
    EXPECT_NEAR(value, truth, (1e-9 + off) * size) << noise;
    for (std::size_t i = 0; i < x.size(); ++i) {
      ASSERT_TRUE(std::isfinite(gradient[i])) << noise;
      if (off > 1e-9) continue;  // differences of values have no digit
      const auto at = [&](double step) {
        std::vector<double> moved = x;
        moved[i] += step;
        double out = 0.0;
        EXPECT_TRUE(objective.evaluate(moved.data(), &out, nullptr));
        return out;
      };
      constexpr double kStep = 1e-3;
      const double slope = (8.0 * (at(kStep) - at(-kStep)) - (at(2 * kStep) - at(-2 * kStep))) / (12.0 * kStep);
      EXPECT_NEAR(gradient[i], slope, 1e-5 * std::max(1.0, size)) << noise << " parameter " << i;
    }
  }
}

const Primitive kBox{Primitive::Form::box, {0.13, 0.13, 0.03}, Eigen::Matrix3d::Identity(), {0.05, 0.03, 0.03}, 0.0};

constexpr double kMicrometres = 1e-5;  // metres; of objects that are off by millimetres

/// The means at the rows that entered, by a factorisation with 64 bits of the very matrix, jitter included.
LongVector means_of(const ResidualGp& residual_gp) {
  using Wide = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const Wide k = residual_gp.covariance(residual_gp.rows()).cast<long double>();
  Wide noisy = k;
  LongVector targets(k.rows());
  for (Eigen::Index i = 0; i < k.rows(); ++i) {
    const ResidualGp::ResidualDatum& row = residual_gp.rows()[static_cast<std::size_t>(i)];
    targets(i) = row.target;
    noisy(i, i) += static_cast<long double>(row.free ? 0.0 : residual_gp.report().jitter) * k(i, i) +
                   static_cast<long double>(row.noise) * row.noise;
  }
  return k * Eigen::LDLT<Wide>(noisy).solve(targets);
}

// Finite, no variance beyond that before any touch, and at its rows the surface of the same model by other means.
TEST_P(Owners, ResidualGpAndItsExpectedReductionsAreFiniteAndWithinThePrior) {
  Random random(6, "owners skin");
  AssemblySampler solids({0.26, 0.26}, {6, 20}, Random(9, "solids"));
  std::vector<SurfaceTouch> all;
  // With more, a cell of the long form takes minutes.
  while (static_cast<int>(all.size()) < std::min(GetParam().taps, 100)) {
    if (!all.empty() && again(static_cast<int>(all.size()))) {
      all.push_back(all.back());
      all.back().length += gap();
      continue;
    }
    Vector3d direction = test::random_direction(random);
    direction.z() = -std::abs(direction.z());
    const Line line{kBox.centre - 0.3 * direction, direction};
    all.push_back({line, kBox.first_intersection(line), true, false});
  }
  solids.add(all);
  ResidualGp::Places places;
  for (const SurfaceTouch& touch : all) places.push_back({touch.end(), solids.best().normal(touch.end())});
  for (const double noise : kNoises) {
    ResidualGp residual_gp(test::make<Kernel>(test::shared_host(), "matern32", kernel()), {0.006, noise});
    residual_gp.fit(solids.best(), all);
    const ResidualGp::Posterior posterior = residual_gp.posterior(places);
    ASSERT_TRUE(posterior.mean.allFinite() && posterior.variance.allFinite()) << noise;
    EXPECT_GE(posterior.variance.minCoeff(), 0.0) << noise;
    EXPECT_LE(posterior.variance.maxCoeff(), residual_gp.deviation() * residual_gp.deviation() * (1.0 + 1e-9)) << noise;
    const LongVector means = means_of(residual_gp);
    for (std::size_t i = 0; i < residual_gp.rows().size(); ++i)
      EXPECT_NEAR(residual_gp.mean(residual_gp.rows()[i].place),
                  static_cast<double>(means(static_cast<Eigen::Index>(i))), kMicrometres)
          << noise;
    FactorReport report;
    const Eigen::VectorXd reductions = expected_reductions(solids, residual_gp, places, &report);
    ASSERT_TRUE(reductions.allFinite() && std::isfinite(report.jitter)) << noise;
    EXPECT_GE(reductions.minCoeff(), 0.0) << noise;
    // No contact takes off more than all of the deviation, that of the solids included.
    EXPECT_LE(reductions.maxCoeff(), residual_gp.deviation() + 0.02) << noise;
  }
}

std::vector<Cell> cells() {
  std::vector<int> taps{3, 25};
  if (!test::brief()) taps.push_back(100);
  if (!test::brief() && std::getenv("PALPATE_LONG") != nullptr) taps.push_back(1000);
  std::vector<Cell> out;
  for (const Places places : {Places::apart, Places::repeated, Places::nearly_repeated}) {
    for (const int count : taps)
      for (const double length : {0.001, 0.03, 0.5, 20.0}) out.push_back({places, count, length});
  }
  return out;
}

INSTANTIATE_TEST_SUITE_P(StabilityMatrix, Owners, ::testing::ValuesIn(cells()),
                         [](const auto& one) { return name_of(one.param); });

}  // namespace
}  // namespace palpate::stability
