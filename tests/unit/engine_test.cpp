// SPDX-License-Identifier: MIT
// The posterior engines: the same answers as the formulas with the whole matrix, for any grid, on any number of threads
// and on any instruction set.
#include "support/instruction_sets.hpp"
#include "support/mocks.hpp"
#include "unit/engine_data.hpp"

#include <fmt/format.h>

#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace palpate::test {
namespace {

class EveryEngine : public testing::TestWithParam<Kind> {};

TEST_P(EveryEngine, EqualsTheTextbookFormulasOnGridsOfAnyShape) {
  const Data data = draw(40);
  std::vector<CandidateGrid> grids;
  for (const auto& [columns, rows] : {std::pair{1, 1}, {1, 9}, {9, 1}, {7, 5}, {8, 8}, {24, 8}, {25, 9}, {47, 33}}) {
    grids.push_back(grid(columns, rows));
    grids.push_back(regular(columns, rows));
  }
  grids.push_back(regular(48, 7));
  grids.push_back(regular(100, 3));
  for (const CandidateGrid& candidates : grids) {
    const std::string columns = fmt::format("{} x {} at x = {}", candidates.columns, candidates.rows, candidates.xs(0));
    const auto kernel = rbf();
    const GaussianProcess process = processed(data, candidates, settings_of(GetParam()), kernel);
    for (int output = 0; output < 2; ++output) {
      const GpSettings& settings = kOutputs[static_cast<std::size_t>(output)];
      const auto book = by_the_book(*kernel, data, candidates.points, settings, output);
      // The taps lie between the places of the grid, where `lowrank` knows less, and says so.
      const double signal = settings.signal;
      const double more = process.engine().error_bound;
      const Eigen::VectorXd mean = book.mean().array() + settings.mean;
      EXPECT_LT(apart(process.mean(output), mean), 2e-11 + signal * more) << columns;
      EXPECT_LT(apart(process.variance(output), book.variance()), 2e-12 + signal * signal * more) << columns;
    }
  }
}

TEST_P(EveryEngine, ServesEverySeparableKernel) {
  const Data data = draw(25);
  const CandidateGrid candidates = grid(12, 15);
  for (const char* options :
       {"{kernels: [{type: rbf, length_scale: 2 cm}, {type: rbf, length_scale: 9 cm, length_scale_y: 4 cm}]}",
        "{kernels: [{type: scale, factor: 3, kernel: {type: rbf, length_scale: 4 cm}}]}"}) {
    const auto kernel = test::make<Kernel>(test::shared_host(), "product", options);
    ASSERT_TRUE(kernel->separable());
    const GaussianProcess process = processed(data, candidates, settings_of(GetParam()), kernel);
    const auto book = by_the_book(*kernel, data, candidates.points, kOutputs[0], 0);
    const Eigen::VectorXd mean = book.mean().array() + kOutputs[0].mean;
    EXPECT_LT(apart(process.mean(0), mean), 1e-11) << options;
    EXPECT_LT(apart(process.variance(0), book.variance()), 1e-11) << options;
  }
}

TEST_P(EveryEngine, HasTheSameBytesWhetherMapsFollowEveryChangeOrAllAtOnce) {
  const Data data = draw(30);
  const CandidateGrid candidates = regular(24, 18);
  GaussianProcess followed(rbf(), kOutputs, candidates, settings_of(GetParam()));
  palpate::GaussianProcess behind(rbf(), kOutputs, candidates, settings_of(GetParam()));
  Eigen::VectorXd shares = Eigen::VectorXd::Ones(30);
  Eigen::VectorXd heights = data.values.col(0);
  Points places = data.places;
  shares(3) = 0.4;
  heights(7) += 0.1;
  places(11, 0) += 0.02;
  for (palpate::GaussianProcess* process : std::initializer_list<palpate::GaussianProcess*>{&followed, &behind}) {
    const auto follow = [&] {
      if (process == &followed) process->update_maps();
    };
    process->show(2);
    follow();
    for (Eigen::Index i = 0; i < 30; ++i) {
      process->add({data.places(i, 0), data.places(i, 1)}, data.values.row(i).transpose());
      follow();
    }
    EXPECT_TRUE(process->set_trust(shares));
    follow();
    EXPECT_TRUE(process->set_targets(heights));
    follow();
    EXPECT_TRUE(process->set_positions(places));
    follow();
    process->add({0.1, 0.1}, Eigen::Vector2d(0.2, 1.0));
  }
  Eigen::VectorXd map;
  EXPECT_THROW(behind.read_mean(0, map), std::logic_error);
  EXPECT_THROW(behind.read_variance(0, map), std::logic_error);
  EXPECT_THROW(behind.engine().error_bound, std::logic_error);
  EXPECT_EQ(behind.diagnostics().log_marginal_likelihood, followed.diagnostics().log_marginal_likelihood);
  followed.update_maps();
  behind.update_maps();
  for (const int output : {0, 1}) {
    behind.read_mean(output, map);
    EXPECT_TRUE(same_bytes(map, followed.mean(output))) << output;
  }
  behind.read_variance(0, map);
  EXPECT_TRUE(same_bytes(map, followed.variance()));
  EXPECT_EQ(behind.engine().error_bound, followed.engine().error_bound);
}

TEST_P(EveryEngine, HasTheSameBytesOnAnyNumberOfThreads) {
  const Data data = draw(30);
  const CandidateGrid candidates = regular(90, 70);
  const GaussianProcess alone = processed(data, candidates, settings_of(GetParam()));
  for (const int threads : {2, 3}) {
    EngineSettings settings = settings_of(GetParam());
    settings.workers = std::make_shared<Workers>(threads);
    const GaussianProcess together = processed(data, candidates, settings);
    expect_same_maps(alone, together);
  }
}

TEST_P(EveryEngine, IsTheSameWithinRoundingOnEveryInstructionSet) {
  const Data data = draw(30);
  const CandidateGrid candidates = regular(91, 70);
  const GaussianProcess widest = processed(data, candidates, settings_of(GetParam()));
  for (const Instructions set : math::instruction_sets()) {
    const OnInstructions on(set);
    const GaussianProcess other = processed(data, candidates, settings_of(GetParam()));
    EXPECT_LT(apart(widest.mean(0), other.mean(0)), 1e-11) << math::name_of(set);
    EXPECT_LT(apart(widest.relative_variance(), other.relative_variance()), 1e-12) << math::name_of(set);
  }
}

TEST_P(EveryEngine, ShowsAnOutputThatIsReadLateAsItWouldHaveBeen) {
  const Data data = draw(20);
  const CandidateGrid candidates = grid(20, 20);
  const GaussianProcess early = processed(data, candidates, settings_of(GetParam()));
  GaussianProcess late(rbf(), kOutputs, candidates, settings_of(GetParam()));
  add_all(late, data);
  late.show(2);
  expect_same_maps(early, late);
}

TEST_P(EveryEngine, IsAfterAFitWhatItWouldBeIfItHadBegunSo) {
  const Data data = draw(20);
  const CandidateGrid candidates = grid(20, 31);
  GaussianProcess fitted = processed(data, candidates, settings_of(GetParam()));
  Random random(1, "engine_test");
  const ChangingFit stretching([](FitProblem& problem) {
    problem.kernel.set_parameters(Eigen::Vector2d(0.04, 0.02));
    for (FitOutput& output : problem.outputs) output.signal *= 2.0;
  });
  fitted.fit(stretching, random);
  const GaussianProcess fresh =
      processed(data, candidates, settings_of(GetParam()), rbf("{length_scale: 4 cm, length_scale_y: 2 cm}"),
                {{4.0, 0.2, 0.25, 0.0}, {1.0, 0.05, 0.5, 0.0}});
  expect_same_maps(fitted, fresh);
  EXPECT_EQ(fitted.diagnostics().log_marginal_likelihood, fresh.diagnostics().log_marginal_likelihood);
}

std::string name_of(const testing::TestParamInfo<Kind>& one) {
  constexpr const char* kNames[] = {"Automatic", "Dense", "Grid", "Lowrank"};
  return kNames[static_cast<std::size_t>(one.param)];
}

INSTANTIATE_TEST_SUITE_P(Of, EveryEngine, testing::Values(Kind::automatic, Kind::dense, Kind::grid, Kind::lowrank),
                         name_of);

}  // namespace
}  // namespace palpate::test
