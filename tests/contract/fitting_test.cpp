// SPDX-License-Identifier: MIT
// The laws of fitting.hpp, over every fitting found: no exception for numerical reasons, nothing changed when it says
// so, and the same answer to the same question.
#include "support/testing.hpp"

#include <palpate/fitting.hpp>

#include <cstring>

namespace palpate::test {
namespace {

struct Data {
  std::string name;
  Points points;
  Eigen::MatrixXd targets;  ///< an output a column
  double mean_ratio = 0.0;
};

/// Data that make a covariance singular, a likelihood flat or a sum overflow, and some that are well behaved.
std::vector<Data> data() {
  constexpr Eigen::Index kCount = 12;
  Random random(1, "contract/fitting");
  Points points(kCount, 2);
  Eigen::VectorXd wave(kCount);
  for (Eigen::Index i = 0; i < kCount; ++i) {
    points.row(i) << 0.23 * random.uniform(), 0.23 * random.uniform();
    wave(i) = 0.05 * std::sin(60 * points(i, 0));
  }
  const Points same = points.row(0).replicate(kCount, 1);
  std::vector<Data> out;
  out.push_back({"well behaved", points, wave});
  out.push_back({"one point", points.topRows(1), wave.head(1)});
  out.push_back({"constant", points, Eigen::VectorXd::Constant(kCount, 0.05)});
  out.push_back({"zero", points, Eigen::VectorXd::Zero(kCount)});
  out.push_back({"duplicates that agree", same, Eigen::VectorXd::Constant(kCount, 0.05)});
  out.push_back({"duplicates that differ", same, wave});
  out.push_back({"huge", points, 1e160 * wave});
  out.push_back({"tiny", points, 1e-200 * wave});
  out.push_back({"far apart", 1e150 * points, wave});
  out.push_back({"free level", points, wave, 10.0});
  out.push_back({"free level of one point", points.topRows(1), wave.head(1), 10.0});
  Eigen::MatrixXd both(kCount, 2);
  both << wave, (wave.array() > 0.0).cast<double>();
  out.push_back({"heights and labels together", points, both});
  both.col(1).setOnes();
  out.push_back({"labels that are all alike", points, both});
  return out;
}

/// Everything that a fit may change.
struct State {
  std::shared_ptr<Kernel> kernel = make<Kernel>(contract_host(), "rbf");
  double noise_ratio = 1e-4;
  std::vector<double> signals;
  std::vector<double> means;

  std::vector<double> numbers() const {
    std::vector<double> out{noise_ratio};
    out.insert(out.end(), signals.begin(), signals.end());
    out.insert(out.end(), means.begin(), means.end());
    for (const KernelParameter& parameter : kernel->parameters()) out.push_back(parameter.value);
    return out;
  }
};

bool same_parameters(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

FitSummary fit(const Fitting& fitting, const Data& data, State& state) {
  const auto outputs = static_cast<std::size_t>(data.targets.cols());
  state.signals.assign(outputs, 1.0);
  state.means.assign(outputs, 0.0);
  FitProblem problem{data.points, *state.kernel, state.noise_ratio, data.mean_ratio, {}};
  for (std::size_t i = 0; i < outputs; ++i) {
    problem.outputs.push_back({data.targets.col(static_cast<Eigen::Index>(i)), state.signals[i], state.means[i]});
  }
  Random random(7, "contract/fitting");
  return fitting.fit(problem, random);
}

class FittingContract : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override { fitting_ = make<Fitting>(contract_host(), GetParam()); }

  std::shared_ptr<Fitting> fitting_;
};

TEST_P(FittingContract, NeverThrowsAndLeavesSoundNumbers) {
  for (const Data& one : data()) {
    State state;
    FitSummary summary;
    EXPECT_NO_THROW(summary = fit(*fitting_, one, state)) << one.name;
    EXPECT_FALSE(summary.reason.empty()) << one.name;
    EXPECT_EQ(summary.reason.find('\n'), std::string::npos) << one.name;
    EXPECT_TRUE(std::isfinite(summary.objective)) << one.name;
    EXPECT_GE(summary.evaluations, 0) << one.name;
    for (const double number : state.numbers()) EXPECT_TRUE(std::isfinite(number)) << one.name;
    for (const KernelParameter& parameter : state.kernel->parameters()) EXPECT_GT(parameter.value, 0.0) << one.name;
    for (const double signal : state.signals) EXPECT_GT(signal, 0.0) << one.name;
    EXPECT_GE(state.noise_ratio, 0.0) << one.name;
    EXPECT_FALSE(summary.changed && summary.failed) << one.name;
  }
}

TEST_P(FittingContract, ChangesNothingUnlessItSaysSo) {
  for (const Data& one : data()) {
    State state;
    State before;
    const FitSummary summary = fit(*fitting_, one, state);
    if (summary.changed) continue;
    const auto outputs = static_cast<std::size_t>(one.targets.cols());
    before.signals.assign(outputs, 1.0);
    before.means.assign(outputs, 0.0);
    EXPECT_TRUE(same_parameters(state.numbers(), before.numbers())) << one.name;
  }
}

TEST_P(FittingContract, GivesTheSameAnswerToTheSameQuestion) {
  for (const Data& one : data()) {
    State first;
    State second;
    const FitSummary a = fit(*fitting_, one, first);
    const FitSummary b = fit(*make<Fitting>(contract_host(), GetParam()), one, second);
    EXPECT_EQ(a.changed, b.changed) << one.name;
    EXPECT_EQ(a.evaluations, b.evaluations) << one.name;
    EXPECT_TRUE(same_parameters(first.numbers(), second.numbers())) << one.name;
  }
}

TEST_P(FittingContract, ObjectsInOneLineIfAtAll) {
  for (const char* kernel : {"rbf", "matern12", "rational_quadratic"}) {
    const std::string objection = fitting_->objection(*make<Kernel>(contract_host(), kernel));
    EXPECT_EQ(objection.find('\n'), std::string::npos) << objection;
    EXPECT_EQ(objection, fitting_->objection(*make<Kernel>(contract_host(), kernel)));
  }
}

TEST_P(FittingContract, IsDueByTheNumberOfTapsAlone) {
  const std::shared_ptr<Fitting> other = make<Fitting>(contract_host(), GetParam());
  std::vector<bool> due;
  for (int taps = 0; taps <= 100; ++taps) due.push_back(fitting_->due(taps));
  State state;
  fit(*fitting_, data().front(), state);
  for (int taps = 100; taps >= 0; --taps) {
    EXPECT_EQ(fitting_->due(taps), due[static_cast<std::size_t>(taps)]) << taps;
    EXPECT_EQ(other->due(taps), due[static_cast<std::size_t>(taps)]) << taps;
  }
}

INSTANTIATE_TEST_SUITE_P(Every, FittingContract, testing::ValuesIn(plugins_under_contract("fitting")),
                         [](const auto& one) { return test_name(one.param); });

}  // namespace
}  // namespace palpate::test
