// SPDX-License-Identifier: MIT
// What an experiment hands to a fitting, and what it makes of the answer.
#include "experiment/experiment.hpp"
#include "record/fields.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

/// What one call of a fit was given.
struct Call {
  Eigen::Index points;
  std::vector<Eigen::VectorXd> targets;
  double mean_ratio;
  const Kernel* kernel;
};

/// Stretches the kernel at every fifth contact, as far as the taps say so: the same answer to the same question.
class Stretching final : public Fitting {
 public:
  bool fails = false;
  std::string complaint;
  mutable std::vector<Call> calls;

  bool due(int taps) const override { return taps % 5 == 0; }
  std::string objection(const Kernel&) const override { return complaint; }
  FitSummary fit(FitProblem& problem, Random&) const override {
    calls.push_back({problem.points.rows(), {}, problem.mean_ratio, &problem.kernel});
    for (const FitOutput& one : problem.outputs) calls.back().targets.emplace_back(one.targets);
    if (fails) return {false, true, 0.0, 3, "on purpose"};
    Eigen::VectorXd values(1);
    values << 0.01 + 1e-3 * static_cast<double>(problem.points.rows()) + 0.01 * problem.outputs[0].targets.mean();
    problem.kernel.set_parameters(values);
    problem.noise_ratio = 2e-3;
    for (std::size_t i = 0; i < problem.outputs.size(); ++i) {
      problem.outputs[i].signal = 0.25 * static_cast<double>(i + 1);
      problem.outputs[i].mean = 0.125 * static_cast<double>(i + 1);
    }
    return {true, false, -1.5, 4, "stretched"};
  }
};

const std::string kConfig = "paper/object_i_right.yaml";

class Fit : public testing::Test {
 protected:
  /// A run of all taps with `fitting_`.
  std::unique_ptr<Finished> run(std::vector<std::string> overrides = {}) const {
    overrides.emplace_back("seed=3");
    return std::make_unique<Finished>(kConfig, overrides, nullptr, plugins_);
  }

  const std::shared_ptr<Stretching> fitting_ = std::make_shared<Stretching>();
  const Instead<Fitting> plugins_{fitting_};
};

TEST_F(Fit, IsHandedHeightsAndLabelsTogetherWhenTheyShare) {
  const auto shared = run({"belief.label.hyperparameters=shared", "belief.label.signal=3"});
  shared->experiment.result();
  ASSERT_EQ(fitting_->calls.size(), 3U) << "at 5, 10 and 15 of 17 contacts";
  for (std::size_t i = 0; i < 3; ++i) {
    const Call& call = fitting_->calls[i];
    const auto taps = static_cast<Eigen::Index>(5 * (i + 1));
    EXPECT_EQ(call.points, taps);
    EXPECT_EQ(call.mean_ratio, 0.0);
    ASSERT_EQ(call.targets.size(), 2U);
    ASSERT_EQ(call.targets[0].size(), taps);
    ASSERT_EQ(call.targets[1].size(), taps);
    for (Eigen::Index tap = 0; tap < taps; ++tap) {
      const TapRecord& record = shared->taps[static_cast<std::size_t>(tap)];
      EXPECT_EQ(call.targets[0](tap), record.result.height());
      EXPECT_EQ(call.targets[1](tap), record.reading->on_object ? 1.0 : 0.0);
    }
  }
  const auto& height = *shared->models().gps().height.process;
  const HeightModels::Output label = shared->models().gps().label;
  const GpSettings& weight = label.process->settings(label.output);
  EXPECT_EQ(&height, label.process) << "two outputs of one process";
  EXPECT_EQ(height.settings().signal, 0.25);
  EXPECT_EQ(height.settings().mean, 0.125);
  EXPECT_EQ(height.settings().noise, 0.25 * 2e-3);
  EXPECT_EQ(weight.signal, 0.5) << "signals stay apart";
  EXPECT_EQ(weight.mean, 0.25);
  EXPECT_EQ(weight.noise, 0.5 * 2e-3) << "the ratio of noise to signal is shared";
}

TEST_F(Fit, IsHandedOneQuantityAtATimeWhenEachHasItsOwn) {
  const auto own = run({"belief.surface=two_part"});
  const RunResult result = own->experiment.result();
  int of_surface = 0;
  for (const Call& call : fitting_->calls) {
    EXPECT_EQ(call.targets.size(), 1U);
    if (call.mean_ratio == 0.0) continue;
    ++of_surface;
    EXPECT_EQ(call.mean_ratio, 1000.0) << "the level of the object is free";
    EXPECT_GT(call.targets[0].minCoeff(), 0.0) << "no tap on the desk";
  }
  EXPECT_EQ(of_surface, result.object_taps / 5);
  EXPECT_GT(of_surface, 0);
  EXPECT_EQ(fitting_->calls.size(), static_cast<std::size_t>(3 + 3 + of_surface));
  const HeightModels& models = own->models();
  EXPECT_NE(&models.gps().height.process->kernel(), &models.gps().label.process->kernel());
  EXPECT_NE(&models.gps().height.process->kernel(), &models.gps().surface.process->kernel());
}

TEST_F(Fit, OfTheSurfaceIsItsOwnEvenWhereLabelsShareWithHeights) {
  run({"belief.surface=two_part", "belief.label.hyperparameters=shared"})->experiment.result();
  for (const Call& call : fitting_->calls) EXPECT_EQ(call.targets.size(), call.mean_ratio > 0.0 ? 1U : 2U);
}

TEST_F(Fit, IsInTheRecordOfTheTapAfterIt) {
  const auto own = run();
  for (const TapRecord& tap : own->taps) {
    const bool after_fit = tap.number() == 6 || tap.number() == 11 || tap.number() == 16;
    const Row row = tap_row(tap);
    EXPECT_EQ(row.find("height_gp.fit.reason") != nullptr, after_fit) << tap.number();
    EXPECT_EQ(row.find("label_gp.fit.reason") != nullptr, after_fit) << tap.number();
    if (!after_fit) continue;
    EXPECT_EQ(*row.find("height_gp.fit.changed"), Scalar{true});
    EXPECT_EQ(*row.find("height_gp.fit.objective"), Scalar{-1.5});
    EXPECT_EQ(*row.find("height_gp.fit.evaluations"), Scalar{std::int64_t{4}});
    EXPECT_EQ(*row.find("height_gp.fit.reason"), Scalar{std::string("stretched")});
  }
}

TEST_F(Fit, ThatFailsIsCountedAndChangesNothing) {
  fitting_->fails = true;
  const auto failing = run();
  const Finished unfitted(kConfig, {"seed=3"});
  for (std::size_t i = 0; i < unfitted.taps.size(); ++i) {
    EXPECT_EQ(failing->taps[i].candidate, unfitted.taps[i].candidate);
    EXPECT_EQ(failing->taps[i].score, unfitted.taps[i].score);
  }
  const RunResult result = failing->experiment.result();
  EXPECT_EQ(result.state.diagnostics.at("fit_failed"), 6) << "heights and labels, at 5, 10 and 15 contacts";
  const Row summary = summary_list().row({result, failing->config, "", {}, {}, {}, {}});
  for (const auto& [kind, count] : {std::pair("fit_failed", 6), {"pivoted", 0}, {"redundant_taps", 0}}) {
    const Scalar* value = summary.find(std::string("diagnostics.") + kind);
    ASSERT_NE(value, nullptr) << kind;
    EXPECT_EQ(*value, Scalar{std::int64_t{count}}) << kind;
  }
}

TEST_F(Fit, ThatFailsForHeightsAndLabelsTogetherIsOneFailure) {
  fitting_->fails = true;
  EXPECT_EQ(run({"belief.label.hyperparameters=shared"})->experiment.result().state.diagnostics.at("fit_failed"), 3);
}

TEST_F(Fit, OfAResumedRunIsThatOfTheUnbrokenOne) {
  for (const std::string how : {"own", "shared"}) {
    const std::vector<std::string> words{"belief.surface=two_part", "belief.label.hyperparameters=" + how, "seed=3"};
    Finished unbroken(kConfig, words, nullptr, plugins_);
    for (const std::size_t cut : {4U, 5U, 12U}) {
      Prepared rest(kConfig, words, nullptr, plugins_);
      rest.experiment.resume(unbroken.past(cut));
      rest.run();
      ASSERT_EQ(rest.taps.size(), unbroken.taps.size() - cut);
      for (std::size_t i = 0; i < rest.taps.size(); ++i) {
        EXPECT_EQ(rest.taps[i].score, unbroken.taps[cut + i].score) << how << ", cut " << cut << ", tap " << i;
      }
      EXPECT_EQ(*rest.experiment.result().errors.rmse, *unbroken.experiment.result().errors.rmse)
          << how << ", cut " << cut;
    }
  }
}

TEST_F(Fit, ThatCannotWorkWithTheKernelIsRefusedBeforeTheFirstTap) {
  fitting_->complaint = "fitting/stretching: the kernel has no slopes";
  EXPECT_EQ(error_of([&] { Prepared(kConfig, {"fitting=fixed"}, nullptr, plugins_); }),
            "command line: fitting/stretching: the kernel has no slopes");
}

TEST_F(Fit, OfLabelsThatShareConcernsTheKernelOfTheHeightsAlone) {
  // Tells kernels by the number of their parameters.
  class Choosy final : public Fitting {
   public:
    bool due(int) const override { return false; }
    std::string objection(const Kernel& kernel) const override {
      return kernel.parameters().size() == 1 ? "" : "too many parameters";
    }
    FitSummary fit(FitProblem&, Random&) const override { return {}; }
  };
  const Instead<Fitting> choosy(std::make_shared<Choosy>());
  std::vector<std::string> words{"kernel=rational_quadratic", "belief.height.kernel=matern32"};
  EXPECT_THROW(Prepared(kConfig, words, nullptr, choosy), Error);
  words.emplace_back("belief.label.hyperparameters=shared");
  EXPECT_NO_THROW(Prepared(kConfig, words, nullptr, choosy));
}

}  // namespace
}  // namespace palpate::test
