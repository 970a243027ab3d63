// SPDX-License-Identifier: MIT
// The laws of fitting.hpp, over every fitting found: no exception for numerical reasons, nothing changed when it says
// so, and the same answer to the same question.
#include "support/plugins.hpp"

#include <palpate/fitting.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace palpate::test {
namespace {

struct Data {
  std::string name;
  Points points;
  Eigen::VectorXd targets;
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
  return out;
}

/// Everything that a fit may change.
struct State {
  std::shared_ptr<Kernel> kernel = make<Kernel>(contract_host(), "rbf");
  double signal = 1.0;
  double noise = 1e-4;

  std::vector<double> numbers() const {
    std::vector<double> out{signal, noise};
    for (const KernelParameter& parameter : kernel->parameters()) out.push_back(parameter.value);
    return out;
  }
};

bool same_bytes(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

FitSummary fit(const Fitting& fitting, const Data& data, State& state, std::uint64_t stream = 7) {
  FitProblem problem{data.points, data.targets, *state.kernel, state.signal, state.noise};
  Random random(stream, "contract/fitting");
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
    EXPECT_GT(state.signal, 0.0) << one.name;
    EXPECT_GE(state.noise, 0.0) << one.name;
  }
}

TEST_P(FittingContract, ChangesNothingUnlessItSaysSo) {
  for (const Data& one : data()) {
    State state;
    const std::vector<double> before = state.numbers();
    const FitSummary summary = fit(*fitting_, one, state);
    if (summary.changed) continue;
    EXPECT_TRUE(same_bytes(state.numbers(), before)) << one.name;
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
    EXPECT_TRUE(same_bytes(first.numbers(), second.numbers())) << one.name;
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
