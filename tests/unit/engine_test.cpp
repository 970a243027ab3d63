// SPDX-License-Identifier: MIT
// The posterior engines: the same answers as the formulas with the whole matrix, for any grid, on any number of threads
// and on any instruction set.
#include "gp/process.hpp"
#include "support/plugins.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace palpate {
namespace {

using Kind = PosteriorSettings::Kind;
using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

struct Data {
  Points places;
  Eigen::MatrixXd values;  ///< two outputs
};

Data draw(int taps, std::uint64_t seed = 5) {
  Random random(seed, "engine_test");
  Data data{Points(taps, 2), Eigen::MatrixXd(taps, 2)};
  for (int i = 0; i < taps; ++i) {
    data.places.row(i) << 0.2 * random.uniform(), 0.2 * random.uniform();
    data.values.row(i) << random.uniform() - 0.5, random.uniform() < 0.5 ? 0.0 : 1.0;
  }
  return data;
}

/// Irregular in both directions.
Candidates grid(int columns, int rows) {
  Random random(9, "engine_test/grid");
  Eigen::VectorXd xs(columns);
  Eigen::VectorXd ys(rows);
  for (double& x : xs) x = 0.2 * random.uniform();
  for (double& y : ys) y = 0.2 * random.uniform();
  return product_grid(xs, ys);
}

/// What configs have: regular, its own mirror image.
Candidates regular(int columns, int rows) {
  return product_grid(Eigen::VectorXd::LinSpaced(columns, 0.0, 0.2), Eigen::VectorXd::LinSpaced(rows, 0.0, 0.2));
}

std::shared_ptr<Kernel> rbf(const std::string& options = "{length_scale: 3 cm, length_scale_y: 5 cm}") {
  return test::make<Kernel>(test::shared_host(), "rbf", options);
}

const std::vector<ProcessSettings> kOutputs{{2.0, 0.1, 0.25, 0.0}, {0.5, 0.025, 0.5, 0.0}};

PosteriorSettings settings_of(Kind kind) {
  PosteriorSettings out;
  out.engine = kind;
  out.score = simd::Score::weighted;
  return out;
}

Process processed(const Data& data, const Candidates& candidates, const PosteriorSettings& settings,
                  const std::shared_ptr<Kernel>& kernel = rbf()) {
  Process process(kernel, kOutputs, candidates, settings);
  process.show(2);
  for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
    process.add({data.places(i, 0), data.places(i, 1)}, data.values.row(i).transpose());
  }
  return process;
}

/// Algorithm 2.1 of Rasmussen and Williams in long double, by the whole matrix.
struct Textbook {
  Textbook(const Kernel& kernel, const Data& data, const Candidates& candidates, const ProcessSettings& output,
           int column) {
    const auto covariance = [&](const Points& a, const Points& b) {
      Eigen::MatrixXd out(a.rows(), b.rows());
      kernel.covariance(a, b, out);
      return LongMatrix(out.cast<long double>() * output.signal * output.signal);
    };
    LongMatrix k = covariance(data.places, data.places);
    k.diagonal().array() += static_cast<long double>(output.noise) * output.noise;
    const LongMatrix cross = covariance(data.places, candidates.points);
    const Eigen::LLT<LongMatrix> factor(k);
    const LongMatrix targets = (data.values.col(column).array() - output.mean).matrix().cast<long double>();
    mean = ((cross.transpose() * factor.solve(targets)).array() + output.mean).cast<double>();
    const LongMatrix v = factor.matrixL().solve(cross);
    Eigen::VectorXd own(candidates.size());
    kernel.variance(candidates.points, own);
    variance = (own.cast<long double>().array() * output.signal * output.signal -
                v.colwise().squaredNorm().transpose().array())
                   .cast<double>();
  }
  Eigen::VectorXd mean;
  Eigen::VectorXd variance;
};

double apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

bool same_bytes(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

class EveryEngine : public testing::TestWithParam<Kind> {};

TEST_P(EveryEngine, EqualsTheTextbookFormulasOnGridsOfAnyShape) {
  const Data data = draw(40);
  std::vector<Candidates> grids;
  for (const auto& [columns, rows] : {std::pair{1, 1}, {1, 9}, {9, 1}, {7, 5}, {8, 8}, {24, 8}, {25, 9}, {47, 33}}) {
    grids.push_back(grid(columns, rows));
    grids.push_back(regular(columns, rows));
  }
  grids.push_back(regular(48, 7));
  grids.push_back(regular(100, 3));
  for (const Candidates& candidates : grids) {
    const std::string columns = fmt::format("{} x {} at x = {}", candidates.columns, candidates.rows, candidates.xs(0));
    const auto kernel = rbf();
    const Process process = processed(data, candidates, settings_of(GetParam()), kernel);
    for (int output = 0; output < 2; ++output) {
      const Textbook book(*kernel, data, candidates, kOutputs[static_cast<std::size_t>(output)], output);
      // The taps lie between the places of the grid, where `lowrank` knows less, and says so.
      const double signal = kOutputs[static_cast<std::size_t>(output)].signal;
      const double more = process.error_bound();
      EXPECT_LT(apart(process.mean(output), book.mean), 2e-11 + signal * more) << columns;
      EXPECT_LT(apart(process.variance(output), book.variance), 2e-12 + signal * signal * more) << columns;
    }
  }
}

TEST_P(EveryEngine, ServesEverySeparableKernel) {
  const Data data = draw(25);
  const Candidates candidates = grid(12, 15);
  for (const char* options :
       {"{kernels: [{type: rbf, length_scale: 2 cm}, {type: rbf, length_scale: 9 cm, length_scale_y: 4 cm}]}",
        "{kernels: [{type: scale, factor: 3, kernel: {type: rbf, length_scale: 4 cm}}]}"}) {
    const auto kernel = test::make<Kernel>(test::shared_host(), "product", options);
    ASSERT_TRUE(kernel->separable());
    const Process process = processed(data, candidates, settings_of(GetParam()), kernel);
    const Textbook book(*kernel, data, candidates, kOutputs[0], 0);
    EXPECT_LT(apart(process.mean(0), book.mean), 1e-11) << options;
    EXPECT_LT(apart(process.variance(0), book.variance), 1e-11) << options;
  }
}

TEST_P(EveryEngine, HasTheSameBytesOnAnyNumberOfThreads) {
  const Data data = draw(30);
  const Candidates candidates = regular(90, 70);
  const Process alone = processed(data, candidates, settings_of(GetParam()));
  for (const int threads : {2, 3}) {
    PosteriorSettings settings = settings_of(GetParam());
    settings.machine.workers = std::make_shared<Workers>(threads);
    const Process together = processed(data, candidates, settings);
    EXPECT_TRUE(same_bytes(alone.mean(0), together.mean(0))) << threads;
    EXPECT_TRUE(same_bytes(alone.mean(1), together.mean(1))) << threads;
    EXPECT_TRUE(same_bytes(alone.variance(), together.variance())) << threads;
    for (int piece = 0; piece < alone.pieces(); ++piece) EXPECT_EQ(alone.bound(piece), together.bound(piece));
  }
}

TEST_P(EveryEngine, IsTheSameWithinRoundingOnEveryInstructionSet) {
  const Data data = draw(30);
  const Candidates candidates = regular(91, 70);
  PosteriorSettings baseline = settings_of(GetParam());
  baseline.machine.loops = &simd::kSse2;
  const Process slow = processed(data, candidates, baseline);
  for (const simd::Table* table : {&simd::kAvx2, &simd::kAvx512}) {
    if (!simd::runs(*table)) continue;
    PosteriorSettings settings = settings_of(GetParam());
    settings.machine.loops = table;
    const Process fast = processed(data, candidates, settings);
    EXPECT_LT(apart(slow.mean(0), fast.mean(0)), 1e-11) << table->name;
    EXPECT_LT(apart(slow.relative_variance(), fast.relative_variance()), 1e-12) << table->name;
  }
}

TEST_P(EveryEngine, TellsScoresAndBoundsThatHold) {
  const Data data = draw(30);
  const Candidates candidates = regular(51, 30);
  for (const auto& kernel : {rbf(), test::make<Kernel>(test::shared_host(), "scale",
                                                       "{factor: 7, kernel: {type: rbf, length_scale: 3 cm}}")}) {
    for (const simd::Score score : {simd::Score::variance, simd::Score::weighted, simd::Score::weighted_clipped}) {
      PosteriorSettings settings = settings_of(GetParam());
      settings.score = score;
      const Process process = processed(data, candidates, settings, kernel);
      Eigen::VectorXd weight = process.mean(1);
      if (score == simd::Score::weighted_clipped) weight = weight.cwiseMax(0.0).cwiseMin(1.0);
      if (score == simd::Score::variance) weight.setOnes();
      const Eigen::VectorXd expected = process.relative_variance().cwiseProduct(weight);
      std::vector<int> seen(static_cast<std::size_t>(candidates.size()), 0);
      std::array<ScoredCell, kMostCells> cells;
      for (int piece = 0; piece < process.pieces(); ++piece) {
        const int count = process.read(piece, cells.data());
        double best = -std::numeric_limits<double>::infinity();
        for (int i = 0; i < count; ++i) {
          const ScoredCell& cell = cells[static_cast<std::size_t>(i)];
          ++seen[static_cast<std::size_t>(cell.candidate)];
          EXPECT_NEAR(cell.score, expected(cell.candidate), 1e-15);
          best = std::max(best, cell.score);
        }
        EXPECT_GE(process.bound(piece), best - 1e-15) << "a bound is no less than what it bounds";
        const bool padded = count % simd::kStripRows != 0 || count < simd::kStripRows;
        if (!padded && best > 0.0) {
          EXPECT_LE(process.bound(piece), best + 1e-12) << "and nothing else";
        }
      }
      EXPECT_EQ(seen, std::vector<int>(seen.size(), 1)) << "every candidate is in one piece";
    }
  }
}

/// How far the scores of any piece are above its bound.
double above_bounds(const Process& process) {
  double worst = -std::numeric_limits<double>::infinity();
  std::array<ScoredCell, kMostCells> cells;
  for (int piece = 0; piece < process.pieces(); ++piece) {
    const int count = process.read(piece, cells.data());
    for (int i = 0; i < count; ++i) {
      worst = std::max(worst, cells[static_cast<std::size_t>(i)].score - process.bound(piece));
    }
  }
  return worst;
}

TEST_P(EveryEngine, HasBoundsThatNoScoreExceedsByALastDigit) {
  const Candidates candidates = regular(60, 40);
  const Data data = draw(30);
  for (const char* kernel : {"{factor: 1, kernel: {type: rbf}}", "{factor: 7, kernel: {type: rbf}}"}) {
    for (const bool single : {false, true}) {
      if (single && GetParam() != Kind::lowrank) continue;
      for (const double shift : {0.0, 0.3, -0.5}) {
        PosteriorSettings settings = settings_of(GetParam());
        settings.single = single;
        Process process(test::make<Kernel>(test::shared_host(), "scale", kernel),
                        {{1.0, 1e-2, 0.0, 0.0}, {1.0, 1e-2, shift, 0.0}}, candidates, settings);
        process.show(2);
        for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
          process.add({data.places(i, 0), data.places(i, 1)}, data.values.row(i).transpose());
          EXPECT_LE(above_bounds(process), 0.0) << kernel << ", single " << single << ", " << i + 1 << " taps";
        }
      }
    }
  }
}

TEST_P(EveryEngine, ShowsAnOutputThatIsReadLateAsItWouldHaveBeen) {
  const Data data = draw(20);
  const Candidates candidates = grid(20, 20);
  const Process early = processed(data, candidates, settings_of(GetParam()));
  Process late(rbf(), kOutputs, candidates, settings_of(GetParam()));
  for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
    late.add({data.places(i, 0), data.places(i, 1)}, data.values.row(i).transpose());
  }
  late.show(2);
  EXPECT_TRUE(same_bytes(early.mean(0), late.mean(0)));
  EXPECT_TRUE(same_bytes(early.mean(1), late.mean(1)));
  EXPECT_TRUE(same_bytes(early.variance(), late.variance()));
}

class Stretching final : public Fitting {
 public:
  bool due(int) const override { return true; }
  FitSummary fit(FitProblem& problem, Random&) const override {
    problem.kernel.set_parameters(Eigen::Vector2d(0.04, 0.02));
    for (FitOutput& output : problem.outputs) output.signal *= 2.0;
    FitSummary summary;
    summary.changed = true;
    return summary;
  }
};

TEST_P(EveryEngine, IsAfterAFitWhatItWouldBeIfItHadBegunSo) {
  const Data data = draw(20);
  const Candidates candidates = grid(20, 31);
  Process fitted = processed(data, candidates, settings_of(GetParam()));
  Random random(1, "engine_test");
  fitted.fit(Stretching(), random);
  Process fresh(rbf("{length_scale: 4 cm, length_scale_y: 2 cm}"), {{4.0, 0.2, 0.25, 0.0}, {1.0, 0.05, 0.5, 0.0}},
                candidates, settings_of(GetParam()));
  fresh.show(2);
  for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
    fresh.add({data.places(i, 0), data.places(i, 1)}, data.values.row(i).transpose());
  }
  EXPECT_TRUE(same_bytes(fitted.mean(0), fresh.mean(0)));
  EXPECT_TRUE(same_bytes(fitted.mean(1), fresh.mean(1)));
  EXPECT_TRUE(same_bytes(fitted.variance(), fresh.variance()));
  EXPECT_EQ(fitted.bound(0), fresh.bound(0));
}

std::string name_of(const testing::TestParamInfo<Kind>& one) {
  constexpr const char* kNames[] = {"Automatic", "Dense", "Grid", "Lowrank"};
  return kNames[static_cast<std::size_t>(one.param)];
}

INSTANTIATE_TEST_SUITE_P(Of, EveryEngine, testing::Values(Kind::automatic, Kind::dense, Kind::grid, Kind::lowrank),
                         name_of);

TEST(Lowrank, StaysWithinItsOwnErrorBoundForAnyTolerance) {
  const Data data = draw(60);
  const Candidates candidates = grid(40, 40);
  const Process exact = processed(data, candidates, settings_of(Kind::dense));
  for (const double tolerance : {1e-4, 1e-7, 1e-10, 1e-13}) {
    PosteriorSettings settings = settings_of(Kind::lowrank);
    settings.tolerance = tolerance;
    const Process process = processed(data, candidates, settings);
    const double rounding = 1e-12;
    const double error =
        std::max({apart(process.mean(0), exact.mean(0)) / 2.0, apart(process.mean(1), exact.mean(1)) / 0.5,
                  apart(process.relative_variance(), exact.relative_variance())});
    EXPECT_LE(error, process.error_bound() + rounding) << tolerance;
    EXPECT_GT(process.error_bound(), 0.0);
    if (tolerance > 1e-8) {
      EXPECT_GT(error, 1e-3 * process.error_bound()) << "a bound that tells something";
    }
  }
}

TEST(Lowrank, TellsItsErrorInPriorStandardDeviationsWhateverThePrior) {
  const Data data = draw(20);
  const Candidates candidates = grid(40, 40);
  PosteriorSettings settings = settings_of(Kind::lowrank);
  settings.tolerance = 1e-7;
  std::vector<double> bounds;
  for (const double factor : {1e-4, 1.0, 1e4}) {
    const std::string options = fmt::format("{{factor: {}, kernel: {{type: rbf, length_scale: 3 cm}}}}", factor);
    const auto kernel = test::make<Kernel>(test::shared_host(), "scale", options);
    const double deviation = std::sqrt(factor);
    const ProcessSettings output{1.0, 0.05 * deviation, 0.0, 0.0};
    Process exact(kernel, output, candidates, settings_of(Kind::dense));
    Process process(kernel, output, candidates, settings);
    for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
      for (Process* one : {&exact, &process}) {
        one->add({data.places(i, 0), data.places(i, 1)}, deviation * data.values(i, 0));
      }
    }
    EXPECT_LE(apart(process.mean(), exact.mean()) / deviation, process.error_bound()) << factor;
    EXPECT_LE(apart(process.variance(), exact.variance()) / factor, process.error_bound()) << factor;
    bounds.push_back(process.error_bound());
  }
  EXPECT_NEAR(bounds[0], bounds[1], 1e-3 * bounds[1]);
  EXPECT_NEAR(bounds[2], bounds[1], 1e-3 * bounds[1]);
}

TEST(Lowrank, OfTapsOnCandidatesKeepsTwelveDigits) {
  Data data = draw(60);
  const Candidates candidates = grid(40, 40);
  Random random(3, "engine_test/places");
  for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
    const Target place =
        candidates.target(static_cast<int>(random.index(static_cast<std::uint64_t>(candidates.size()))));
    data.places.row(i) << place.x, place.y;
  }
  const Process exact = processed(data, candidates, settings_of(Kind::dense));
  const Process process = processed(data, candidates, settings_of(Kind::lowrank));
  EXPECT_LT(apart(process.relative_variance(), exact.relative_variance()), 1e-12);
  EXPECT_LT(apart(process.mean(0), exact.mean(0)), 1e-10);
  EXPECT_LT(process.error_bound(), 1e-9);
}

TEST(Lowrank, InSinglePrecisionIsExactToFiveDigits) {
  const Data data = draw(60);
  const Candidates candidates = grid(60, 40);
  const Process exact = processed(data, candidates, settings_of(Kind::dense));
  PosteriorSettings settings = settings_of(Kind::lowrank);
  settings.single = true;
  const Process process = processed(data, candidates, settings);
  EXPECT_LT(apart(process.mean(0), exact.mean(0)), 1e-4);
  EXPECT_LT(apart(process.relative_variance(), exact.relative_variance()), 1e-5);
  EXPECT_GT(apart(process.relative_variance(), exact.relative_variance()), 1e-9) << "single precision it is";
  EXPECT_GE(process.error_bound(), apart(process.relative_variance(), exact.relative_variance()));
  EXPECT_GE(process.error_bound(), apart(process.mean(0), exact.mean(0)) / 2.0);
}

TEST(AutomaticEngine, TakesWhatServesAndSaysWhy) {
  const Candidates square = grid(30, 30);
  const Candidates any = scattered(Points::Random(20, 2));
  const auto matern = test::make<Kernel>(test::shared_host(), "matern32");
  const auto engine = [](const std::shared_ptr<Kernel>& kernel, const Candidates& candidates, int taps,
                         double accuracy) {
    PosteriorSettings settings;
    settings.taps = taps;
    settings.accuracy = accuracy;
    const Process process(kernel, kOutputs, candidates, settings);
    return std::string(process.engine()) + ": " + process.engine_reason();
  };
  EXPECT_EQ(engine(matern, square, 300, 1e-9), "dense: the kernel is not separable");
  EXPECT_EQ(engine(rbf(), any, 300, 1e-9), "dense: the candidates are no product grid");
  EXPECT_EQ(engine(rbf(), square, 300, 0.0), "dense: no error is allowed");
  EXPECT_EQ(engine(rbf(), square, 17, 1e-9), "grid: separable kernel on a grid and 17 taps");
  // Along y, there is a direction for every row.
  const auto rough = rbf("{length_scale: 1 m, length_scale_y: 0.1 mm}");
  EXPECT_EQ(engine(rough, grid(30, 400), 100, 1e-9), "grid: separable kernel of a rank that 100 taps do not reach");
  EXPECT_THAT(engine(rbf(), square, 300, 1e-9),
              testing::MatchesRegex("lowrank: separable kernel of rank .* x .* on a grid and 300 taps"));
}

TEST(AutomaticEngine, LeavesLowrankWhenItsErrorBoundIsAboveTheAccuracy) {
  const Data data = draw(30);
  const Candidates candidates = grid(30, 30);
  PosteriorSettings settings = settings_of(Kind::automatic);
  settings.taps = 300;
  settings.accuracy = 1e-13;  // some taps keep to it
  Process process(rbf(), kOutputs, candidates, settings);
  process.show(2);
  ASSERT_STREQ(process.engine(), "lowrank");
  for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
    process.add({data.places(i, 0), data.places(i, 1)}, data.values.row(i).transpose());
    EXPECT_LE(process.error_bound(), settings.accuracy);
  }
  EXPECT_STREQ(process.engine(), "grid");
  EXPECT_THAT(process.engine_reason(),
              testing::MatchesRegex("the error bound of lowrank .* is above the accuracy 1.0e-13"));
  const Process grid_from_the_start = processed(data, candidates, settings_of(Kind::grid));
  EXPECT_TRUE(same_bytes(process.mean(0), grid_from_the_start.mean(0)));
  EXPECT_TRUE(same_bytes(process.variance(), grid_from_the_start.variance()));
}

TEST(Engine, ThatCannotServeIsRefusedWithTheReason) {
  const auto matern = test::make<Kernel>(test::shared_host(), "matern32");
  const Candidates square = grid(3, 3);
  const Candidates any = scattered(Points::Random(20, 2));
  for (const Kind kind : {Kind::grid, Kind::lowrank}) {
    EXPECT_THROW(Process(matern, kOutputs, square, settings_of(kind)), Error);
    EXPECT_THROW(Process(rbf(), kOutputs, any, settings_of(kind)), Error);
    EXPECT_THAT(objection(settings_of(kind), *matern, square), testing::HasSubstr("not separable"));
    EXPECT_THAT(objection(settings_of(kind), *rbf(), any), testing::HasSubstr("product grid"));
    EXPECT_EQ(objection(settings_of(kind), *rbf(), square), "");
  }
}

}  // namespace
}  // namespace palpate
