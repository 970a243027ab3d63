// SPDX-License-Identifier: MIT
// What an experiment hands to a fitting, and what it makes of the answer.
#include "experiment/experiment.hpp"
#include "record/fields.hpp"
#include "record/tap_row.hpp"
#include "support/runs.hpp"

#include <palpate/error.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

using test::Collector;
using test::shipped_config;

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

/// Gives out one fitting for all; every other plugin comes from the host.
class Factory final : public PluginFactory {
 public:
  std::shared_ptr<Stretching> fitting = std::make_shared<Stretching>();
  std::shared_ptr<void> create(const PluginChoice& choice, const Context& context) const override {
    if (choice.kind == Fitting::kKind) return std::shared_ptr<Fitting>(fitting);
    return test::shared_host().create(choice, context);
  }
};

const std::string kConfig = "paper/object_i_right.yaml";

TEST(Fit, IsHandedHeightsAndLabelsTogetherWhenTheyShare) {
  const ResolvedConfig config = shipped_config(kConfig, {"seed=3", "weight.hyperparameters=shared", "weight.signal=3"});
  const Factory factory;
  Experiment experiment(config.options, factory, nullptr);
  Collector collector;
  experiment.run(collector);
  experiment.result();
  ASSERT_EQ(factory.fitting->calls.size(), 3U) << "at 5, 10 and 15 of 17 contacts";
  for (std::size_t i = 0; i < 3; ++i) {
    const Call& call = factory.fitting->calls[i];
    const auto taps = static_cast<Eigen::Index>(5 * (i + 1));
    EXPECT_EQ(call.points, taps);
    EXPECT_EQ(call.mean_ratio, 0.0);
    ASSERT_EQ(call.targets.size(), 2U);
    ASSERT_EQ(call.targets[0].size(), taps);
    ASSERT_EQ(call.targets[1].size(), taps);
    for (Eigen::Index tap = 0; tap < taps; ++tap) {
      const TapRecord& record = collector.taps[static_cast<std::size_t>(tap)];
      EXPECT_EQ(call.targets[0](tap), record.contact.height);
      EXPECT_EQ(call.targets[1](tap), *record.on_surface ? 1.0 : 0.0);
    }
  }
  const Process& height = *experiment.belief().height_process().process;
  const TapBelief::Output label = experiment.belief().weight_process();
  const ProcessSettings& weight = label.process->settings(label.output);
  EXPECT_EQ(&height, label.process) << "two outputs of one process";
  EXPECT_EQ(height.settings().signal, 0.25);
  EXPECT_EQ(height.settings().mean, 0.125);
  EXPECT_EQ(height.settings().noise, 0.25 * 2e-3);
  EXPECT_EQ(weight.signal, 0.5) << "signals stay apart";
  EXPECT_EQ(weight.mean, 0.25);
  EXPECT_EQ(weight.noise, 0.5 * 2e-3) << "the ratio of noise to signal is shared";
}

TEST(Fit, IsHandedOneQuantityAtATimeWhenEachHasItsOwn) {
  const ResolvedConfig config = shipped_config(kConfig, {"seed=3", "surface=two_part"});
  const Factory factory;
  Experiment experiment(config.options, factory, nullptr);
  Collector collector;
  experiment.run(collector);
  const RunResult result = experiment.result();
  int of_surface = 0;
  for (const Call& call : factory.fitting->calls) {
    EXPECT_EQ(call.targets.size(), 1U);
    if (call.mean_ratio == 0.0) continue;
    ++of_surface;
    EXPECT_EQ(call.mean_ratio, 1000.0) << "the level of the object is free";
    EXPECT_GT(call.targets[0].minCoeff(), 0.0) << "no tap on the desk";
  }
  EXPECT_EQ(of_surface, result.on_surface_taps / 5);
  EXPECT_GT(of_surface, 0);
  EXPECT_EQ(factory.fitting->calls.size(), static_cast<std::size_t>(3 + 3 + of_surface));
  EXPECT_NE(&experiment.belief().height_process().process->kernel(),
            &experiment.belief().weight_process().process->kernel());
  EXPECT_NE(&experiment.belief().height_process().process->kernel(),
            &experiment.belief().surface_process().process->kernel());
}

TEST(Fit, OfTheSurfaceIsItsOwnEvenWhereLabelsShareWithHeights) {
  const ResolvedConfig config =
      shipped_config(kConfig, {"seed=3", "surface=two_part", "weight.hyperparameters=shared"});
  const Factory factory;
  Experiment experiment(config.options, factory, nullptr);
  Collector collector;
  experiment.run(collector);
  experiment.result();
  for (const Call& call : factory.fitting->calls) EXPECT_EQ(call.targets.size(), call.mean_ratio > 0.0 ? 1U : 2U);
}

TEST(Fit, IsInTheRecordOfTheTapAfterIt) {
  const ResolvedConfig config = shipped_config(kConfig, {"seed=3"});
  const Factory factory;
  Experiment experiment(config.options, factory, nullptr);
  Collector collector;
  experiment.run(collector);
  for (const TapRecord& tap : collector.taps) {
    const bool after_fit = tap.number == 6 || tap.number == 11 || tap.number == 16;
    const Row row = tap_row(tap);
    EXPECT_EQ(row.find("height_process.fit.reason") != nullptr, after_fit) << tap.number;
    EXPECT_EQ(row.find("weight_process.fit.reason") != nullptr, after_fit) << tap.number;
    if (!after_fit) continue;
    EXPECT_EQ(*row.find("height_process.fit.changed"), Scalar{true});
    EXPECT_EQ(*row.find("height_process.fit.objective"), Scalar{-1.5});
    EXPECT_EQ(*row.find("height_process.fit.evaluations"), Scalar{std::int64_t{4}});
    EXPECT_EQ(*row.find("height_process.fit.reason"), Scalar{std::string("stretched")});
  }
}

TEST(Fit, ThatFailsIsCountedAndChangesNothing) {
  const ResolvedConfig config = shipped_config(kConfig, {"seed=3"});
  const Factory failing;
  failing.fitting->fails = true;
  Experiment experiment(config.options, failing, nullptr);
  Experiment unfitted(config.options, test::shared_host(), nullptr);
  Collector collector;
  Collector expected;
  experiment.run(collector);
  unfitted.run(expected);
  for (std::size_t i = 0; i < expected.taps.size(); ++i) {
    EXPECT_EQ(collector.taps[i].candidate, expected.taps[i].candidate);
    EXPECT_EQ(collector.taps[i].score, expected.taps[i].score);
  }
  const RunResult result = experiment.result();
  EXPECT_EQ(result.interventions.at("fit_failed"), 6) << "heights and labels, at 5, 10 and 15 contacts";
  const Row summary = summary_list().row({config, result, "", {}, {}, {}, {}});
  ASSERT_NE(summary.find("interventions.fit_failed"), nullptr);
  EXPECT_EQ(*summary.find("interventions.fit_failed"), Scalar{std::int64_t{6}});
  for (const char* kind : {"pivoted", "set_aside"}) {
    const Scalar* value = summary.find(std::string("interventions.") + kind);
    ASSERT_NE(value, nullptr) << kind;
    EXPECT_EQ(*value, Scalar{std::int64_t{0}}) << kind;
  }
}

TEST(Fit, ThatFailsForHeightsAndLabelsTogetherIsOneFailure) {
  const ResolvedConfig config = shipped_config(kConfig, {"seed=3", "weight.hyperparameters=shared"});
  const Factory failing;
  failing.fitting->fails = true;
  Experiment experiment(config.options, failing, nullptr);
  Collector collector;
  experiment.run(collector);
  EXPECT_EQ(experiment.result().interventions.at("fit_failed"), 3);
}

TEST(Fit, OfAResumedRunIsThatOfTheUnbrokenOne) {
  for (const std::string how : {"own", "shared"}) {
    const ResolvedConfig config =
        shipped_config(kConfig, {"seed=3", "surface=two_part", "weight.hyperparameters=" + how});
    const Factory factory;
    Experiment whole(config.options, factory, nullptr);
    Collector unbroken;
    whole.run(unbroken);
    for (const std::size_t cut : {4U, 5U, 12U}) {
      std::vector<PastTap> past;
      for (std::size_t i = 0; i < cut; ++i) {
        past.push_back({unbroken.taps[i].target, unbroken.taps[i].contact, unbroken.taps[i].source});
      }
      Experiment second(config.options, factory, nullptr);
      second.resume(past);
      Collector rest;
      second.run(rest);
      ASSERT_EQ(rest.taps.size(), unbroken.taps.size() - cut);
      for (std::size_t i = 0; i < rest.taps.size(); ++i) {
        EXPECT_EQ(rest.taps[i].score, unbroken.taps[cut + i].score) << how << ", cut " << cut << ", tap " << i;
      }
      EXPECT_EQ(*second.result().errors.rmse, *whole.result().errors.rmse) << how << ", cut " << cut;
    }
  }
}

TEST(Fit, ThatCannotWorkWithTheKernelIsRefusedBeforeTheFirstTap) {
  const ResolvedConfig config = shipped_config(kConfig, {"fitting=fixed"});
  const Factory objecting;
  objecting.fitting->complaint = "fitting/stretching: the kernel has no slopes";
  try {
    Experiment(config.options, objecting, nullptr);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "command line: fitting/stretching: the kernel has no slopes");
  }
}

TEST(Fit, OfLabelsThatShareConcernsTheKernelOfTheHeightsAlone) {
  // Tells kernels by the number of their parameters.
  class Choosy final : public Fitting {
   public:
    bool due(int) const override { return false; }
    std::string objection(const Kernel& kernel) const override {
      return kernel.parameters().size() == 1 ? "" : "too many parameters";
    }
    FitSummary fit(FitProblem&, Random&) const override { return {}; }
  };
  class Choosing final : public PluginFactory {
   public:
    std::shared_ptr<void> create(const PluginChoice& choice, const Context& context) const override {
      if (choice.kind == Fitting::kKind) return std::shared_ptr<Fitting>(std::make_shared<Choosy>());
      return test::shared_host().create(choice, context);
    }
  };
  const Choosing factory;
  const std::vector<std::string> overrides{"kernel=rational_quadratic", "height.kernel=matern32"};
  std::vector<std::string> shared = overrides;
  shared.emplace_back("weight.hyperparameters=shared");
  EXPECT_THROW(Experiment(shipped_config(kConfig, overrides).options, factory, nullptr), Error);
  EXPECT_NO_THROW(Experiment(shipped_config(kConfig, shared).options, factory, nullptr));
}

}  // namespace
}  // namespace palpate
