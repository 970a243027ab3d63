// SPDX-License-Identifier: MIT
#include "tapping/guarded_tap.hpp"

#include "tapping_bench.hpp"

#include <functional>

namespace palpate::tapping {
namespace {

constexpr double kPeriod = GuardedTap::kPeriod;

MotionOptions motion(const std::string& yaml) { return test::filled<MotionOptions>(yaml); }

/// What happened in one period.
struct Moment {
  double set_point, height, force;
};

/// What else presses in period i at a height.
using Extra = std::function<double(int, double)>;

const Extra kNothing = [](int, double) { return 0.0; };

/// An arm that is where it is told, in a motion as YAML over a spring, with what `extra` adds; the desk lies at 0.
struct Trial {
  MotionOptions options;
  Descent descent;
  std::vector<Moment> moments;
  GuardedTap tap;

  Trial(const std::string& yaml, double surface, double stiffness, const Extra& extra = kNothing,
        GuardedTap::ArmKind arm = GuardedTap::ArmKind::simulated, const std::optional<Prediction>& guess = {})
      : options(motion(yaml)), descent(plan_descent(options, 0.0, guess)), tap(options, descent, arm) {
    double position = descent.hover;
    for (int i = 0; !tap.done() && i < 100'000; ++i) {
      const double force = stiffness * std::max(0.0, surface - position) + extra(i, position);
      const double before = position;
      position = tap.next(before, force);
      moments.push_back({position, before, force});
    }
  }
};

const char* const kMotions[] = {"{type: paper}", "{type: two_stage}", "{type: continuous}",
                                "{type: continuous, adaptive_hover: {}}",
                                "{type: paper, adaptive_hover: {speed: 5 cm/s}}"};

TEST(GuardedTap, OnARigidSurfaceTakesTheTimeOfTheClosedFormAndFindsItsHeight) {
  Random random(3, "surfaces");
  for (const char* yaml : kMotions) {
    for (int i = 0; i < 50; ++i) {
      const double surface = 0.134 * random.uniform();
      const Prediction guess{surface - 0.03 + 0.08 * random.uniform(), 0.005};
      const Trial run(yaml, surface, 1e7, kNothing, GuardedTap::ArmKind::simulated, guess);
      // A start within three periods of the surface may be reached before the contact on the way is certain.
      if (std::abs(run.descent.start - surface) < 0.005) continue;
      const MotionOptions& options = run.options;
      ASSERT_EQ(run.tap.result().outcome, Outcome::contact) << yaml;
      // Until three periods are above the threshold the set-point goes on by that much.
      const bool onset = options.type == MotionOptions::Type::continuous;
      EXPECT_NEAR(run.tap.result().height, surface, onset ? 1e-3 : 5 * kPeriod * std::max(options.speed, 0.1)) << yaml;
      // Each stage is rounded up to whole periods, and takes three more to be sure.
      const double step_more = options.type == MotionOptions::Type::paper ? options.pause : 0.0;
      const double closed = ideal_seconds(options, run.descent, surface);
      EXPECT_GT(run.tap.seconds(), closed - 0.05) << yaml << " at " << surface;
      EXPECT_LT(run.tap.seconds(), closed + 0.25 + step_more) << yaml << " at " << surface;
    }
  }
}

TEST(GuardedTap, NeverCommandsFasterThanItsSpeedsNorBelowItsFloor) {
  for (const char* yaml : kMotions) {
    const Trial run(yaml, 0.03, 1500.0, kNothing, GuardedTap::ArmKind::simulated, Prediction{0.02, 0.01});
    double last = run.descent.hover;
    for (const Moment& one : run.moments) {
      EXPECT_GE(one.set_point, run.descent.floor);
      EXPECT_LE(one.set_point, run.descent.hover);
      EXPECT_GE(one.set_point - last, -std::max(run.options.speed, 0.1) * kPeriod - 1e-12) << yaml;
      last = one.set_point;
    }
  }
}

TEST(GuardedTap, NeverBacksOffAboveItsHover) {
  const Trial run("{type: two_stage, back_off: 10 cm}", 0.1, 1500.0);
  for (const Moment& one : run.moments) EXPECT_LE(one.set_point, run.descent.hover);
  EXPECT_EQ(run.tap.result().outcome, Outcome::contact);
}

TEST(GuardedTap, KeepsItsResultWhateverItIsToldAfterwards) {
  Trial run("{type: continuous}", 0.08, 1500.0);
  const double height = run.tap.result().height;
  const double seconds = run.tap.seconds();
  for (int i = 0; i < 10'000; ++i) run.tap.next(0.13, 100.0);
  EXPECT_EQ(run.tap.result().outcome, Outcome::contact);
  EXPECT_EQ(run.tap.result().height, height);
  EXPECT_EQ(run.tap.seconds(), seconds);
}

TEST(GuardedTap, DoesNotTakeTwoLoudPeriodsForAContact) {
  const Trial run("{type: continuous}", -1.0, 0.0, [](int i, double) { return i % 5 < 2 && i > 30 ? 100.0 : 0.0; });
  EXPECT_EQ(run.tap.result().outcome, Outcome::no_contact);
}

TEST(GuardedTap, TakesOneReadingForOneHoweverOftenItIsTold) {
  const MotionOptions options = motion("{type: continuous}");
  GuardedTap tap(options, plan_descent(options, 0.0, {}));
  double height = options.hover;
  for (int i = 0; !tap.done() && i < 100'000; ++i) {
    const bool loud = i > 60 && (i / 6) % 2 == 0;  // one reading of two, each told for six periods
    height = tap.next(height, loud ? 50.0 : 0.0, i % 6 == 0);
  }
  EXPECT_EQ(tap.result().outcome, Outcome::no_contact);
}

TEST(GuardedTap, TaresNewReadingsAlone) {
  const MotionOptions options = motion("{type: continuous, tare: 200 ms}");
  GuardedTap tap(options, plan_descent(options, 0.0, {}));
  double height = options.hover;
  for (int i = 0; !tap.done() && i < 100'000; ++i) {
    // 2 N in every new reading, 30 N whenever nothing new came.
    height = tap.next(height, i % 2 == 0 ? 2.0 + (height < 0.05 ? 20.0 : 0.0) : 30.0, i % 2 == 0);
  }
  EXPECT_EQ(tap.result().outcome, Outcome::contact);
  EXPECT_NEAR(tap.result().force, 20.0, 1e-9);
}

TEST(GuardedTap, TaresTheZeroOfTheForceAway) {
  for (const char* yaml : {"{type: paper}", "{type: two_stage}", "{type: continuous}"}) {
    const Trial plain(yaml, 0.05, 1500.0);
    const Trial biased(yaml, 0.05, 1500.0, [](int, double) { return 25.0; });
    EXPECT_NEAR(biased.tap.result().height, plain.tap.result().height, 1e-9) << yaml;
    EXPECT_EQ(biased.tap.seconds(), plain.tap.seconds()) << yaml;
    EXPECT_NEAR(biased.tap.result().force, plain.tap.result().force, 1e-9) << yaml;
  }
}

TEST(GuardedTap, OfARealArmTaresInEveryPauseOfThePaper) {
  const std::string yaml = "{type: paper, threshold: 10 N, hover: 13.5 cm}";
  // 13.5 N from the height of travel to the desk, 3 N a step.
  const auto wanders = [](int, double height) { return 100.0 * (0.135 - height); };
  const Trial simulated(yaml, 0.0, 1500.0, wanders);
  EXPECT_GT(simulated.tap.result().height, 0.02) << "a contact in the air";
  const Trial real(yaml, 0.0, 1500.0, wanders, GuardedTap::ArmKind::real);
  EXPECT_EQ(real.tap.result().outcome, Outcome::contact);
  EXPECT_LT(real.tap.result().height, 0.0);
  EXPECT_GT(real.tap.result().height, -0.01);
}

TEST(GuardedTap, OfARealArmDoesNotTareAContactAwayThatBeginsInAPause) {
  // The second step ends at 7.5 cm and presses with 8 N: less than the threshold, more than half of it.
  const double surface = 0.075 + 8.0 / 1500.0;
  const Trial real("{type: paper, threshold: 10 N, step: 3 cm, hover: 13.5 cm}", surface, 1500.0, kNothing,
                   GuardedTap::ArmKind::real);
  EXPECT_EQ(real.tap.result().outcome, Outcome::contact);
  EXPECT_LT(real.tap.result().force, 10.0 + 4 * 0.024 * kPeriod * 1500.0) << "as if the pause had not been";
}

TEST(GuardedTap, OfARealArmPutsItsSetPointWhereTheArmIsInThePapersMotionToo) {
  const MotionOptions options = motion("{type: paper}");
  GuardedTap tap(options, plan_descent(options, 0.0, {}), GuardedTap::ArmKind::real);
  double set_point = options.hover;
  double measured = options.hover;
  for (int i = 0; i < 1000 && !(measured < 0.06 && set_point == measured); ++i) {
    measured = i > 25 ? std::min(measured, set_point + 0.01) : options.hover;  // it trails
    set_point = tap.next(measured, measured < 0.06 ? 20.0 : 0.0);
  }
  EXPECT_EQ(set_point, measured);
  EXPECT_LT(measured, 0.06);
}

TEST(GuardedTap, EndsAtItsFloorWithoutAContact) {
  for (const char* yaml : kMotions) {
    const Trial run(yaml, -1.0, 1500.0);
    EXPECT_EQ(run.tap.result().outcome, Outcome::no_contact) << yaml;
    EXPECT_DOUBLE_EQ(run.moments.back().set_point, -run.options.overrun) << yaml;
  }
}

TEST(GuardedTap, GivesUpAfterItsTimeout) {
  const Trial run("{type: paper, pause: 20 s, timeout: 30 s}", 0.0, 1500.0);
  EXPECT_EQ(run.tap.result().outcome, Outcome::timeout);
  EXPECT_NEAR(run.tap.seconds(), 30.0, 0.02);
}

TEST(GuardedTap, OfThePaperHoldsItsSetPointAndReadsAfterThePause) {
  const Trial run("{type: paper, pause: 500 ms}", 0.05, 1500.0);
  std::size_t since = run.moments.size();
  while (since > 0 && run.moments[since - 1].set_point == run.moments.back().set_point) --since;
  EXPECT_NEAR(static_cast<double>(run.moments.size() - since) * kPeriod, 0.5, 0.03);
  EXPECT_DOUBLE_EQ(run.tap.result().height, run.moments.back().height);
}

TEST(GuardedTap, PutsItsSetPointWhereTheArmIsOnceItFeelsAContact) {
  // An arm 1 cm above its set-point: holding that would press on.
  MotionOptions options = motion("{type: continuous, speed: 5 cm/s}");
  GuardedTap tap(options, plan_descent(options, 0.0, {}));
  double set_point = options.hover;
  double measured = options.hover;
  for (int i = 0; i < 1000 && !(set_point > measured - 1e-12 && i > 30); ++i) {
    measured = set_point + (i > 25 ? 0.01 : 0.0);
    const double force = measured < 0.06 ? 20.0 : 0.0;
    set_point = tap.next(measured, force);
  }
  EXPECT_LT(measured, 0.06);
  EXPECT_DOUBLE_EQ(set_point, measured);
}

TEST(GuardedTap, OfARealArmGoesOnWhereTheForceDoesNotLast) {
  for (const char* yaml : {"{type: continuous}", "{type: paper}"}) {
    // A zero that wanders by 20 N/m, and noise on it that goes three times too far.
    const double threshold = motion(yaml).threshold;
    int loud = 0;
    const auto wandered = [&](int, double position) {
      const double zero = 20.0 * (0.135 - position);
      return position < 0.101 && loud++ < 3 ? zero + 1.2 * threshold : zero;
    };
    const Trial run(yaml, 0.03, 1e6, wandered, GuardedTap::ArmKind::real);
    EXPECT_EQ(run.tap.result().outcome, Outcome::contact) << yaml;
    EXPECT_NEAR(run.tap.result().height, 0.03, 0.002) << yaml;
  }
}

TEST(GuardedTap, OfTwoStagesGoesOnAfterAContactThatWasNone) {
  int left = 5;  // the jerk comes once
  const Trial run("{type: two_stage}", 0.03, 1e6, [&](int, double position) {
    return position < 0.101 && position > 0.099 && left-- > 0 ? 30.0 : 0.0;
  });
  EXPECT_EQ(run.tap.result().outcome, Outcome::contact);
  EXPECT_NEAR(run.tap.result().height, 0.03, 0.001);
}

TEST(GuardedTap, BacksOffWhenThePredictionLetItHitTheSurfaceFast) {
  const Trial run("{type: continuous, adaptive_hover: {clearance: 1 cm}}", 0.08, 1500.0, kNothing,
                  GuardedTap::ArmKind::simulated, Prediction{0.0, 0.001});
  EXPECT_NEAR(run.descent.start, 0.012, 1e-12);
  EXPECT_EQ(run.tap.result().outcome, Outcome::contact);
  EXPECT_NEAR(run.tap.result().height, 0.08, 1e-6);
  EXPECT_GT(run.tap.seconds(), (0.135 - 0.08) / 0.1 + 0.01 / 0.1 + 0.01 / 0.024);
}

TEST(Descent, BeginsAboveThePredictionButNeverAboveTheHover) {
  const MotionOptions options = motion("{type: paper, adaptive_hover: {deviations: 2, clearance: 1 cm}}");
  EXPECT_DOUBLE_EQ(plan_descent(options, 0.5, {}).start, 0.635) << "nothing is predicted";
  EXPECT_DOUBLE_EQ(plan_descent(options, 0.5, {}).floor, 0.5 - options.overrun);
  EXPECT_DOUBLE_EQ(plan_descent(options, 0.5, Prediction{0.55, 0.01}).start, 0.58);
  EXPECT_DOUBLE_EQ(plan_descent(options, 0.5, Prediction{0.55, 1.0}).start, 0.635) << "nothing is known";
  EXPECT_DOUBLE_EQ(plan_descent(options, 0.5, Prediction{0.2, 0.01}).start, 0.51) << "the desk is there";
  const MotionOptions plain = motion("{type: paper}");
  EXPECT_DOUBLE_EQ(plan_descent(plain, 0.5, Prediction{0.55, 0.01}).start, 0.635);
}

TEST(Descent, ReliesOnAnObjectOnlyWhereThatOrNoneIsCertain) {
  const MotionOptions options =
      motion("{type: continuous, overrun: 1 cm, adaptive_hover: {deviations: 2, clearance: 1 cm, certainty: 0.95}}");
  EXPECT_EQ(predicts(options),
            (QuantitySet{quantity::kHeightMean, quantity::kHeightStd, quantity::kObjectProbability}));
  const auto plan = [&](double probability) { return plan_descent(options, 0.5, Prediction{0.58, 0.01, probability}); };
  EXPECT_DOUBLE_EQ(plan(0.5).start, 0.61);
  EXPECT_DOUBLE_EQ(plan(0.5).floor, 0.49) << "the desk may be all there is";
  EXPECT_DOUBLE_EQ(plan(0.97).start, 0.61);
  EXPECT_DOUBLE_EQ(plan(0.97).floor, 0.54) << "three deviations and the overrun below the object";
  EXPECT_DOUBLE_EQ(plan(0.02).start, 0.51) << "just above the desk";
  EXPECT_DOUBLE_EQ(plan(0.02).floor, 0.49);
}

}  // namespace
}  // namespace palpate::tapping
