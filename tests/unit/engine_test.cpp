// SPDX-License-Identifier: MIT
// The posterior engines: the same answers as the formulas with the whole matrix, for any grid, on any number of threads
// and on any instruction set.
#include "unit/engine_data.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace palpate {
namespace {

using namespace test;

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
    const Process process = processed(data, candidates, settings_of(GetParam()), kernel);
    const Eigen::VectorXd expected = process.relative_variance().cwiseProduct(process.mean(1));
    Eigen::Index highest = 0;
    expected.maxCoeff(&highest);
    EXPECT_EQ(process.best(), highest);
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
    for (const double shift : {0.0, 0.3, -0.5}) {
      Process process(test::make<Kernel>(test::shared_host(), "scale", kernel),
                      {{1.0, 1e-2, 0.0, 0.0}, {1.0, 1e-2, shift, 0.0}}, candidates, settings_of(GetParam()));
      process.show(2);
      for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
        process.add({data.places(i, 0), data.places(i, 1)}, data.values.row(i).transpose());
        EXPECT_LE(above_bounds(process), 0.0) << kernel << ", " << i + 1 << " taps";
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

}  // namespace
}  // namespace palpate
