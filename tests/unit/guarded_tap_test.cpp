// SPDX-License-Identifier: MIT
#include "tapping/guarded_tap.hpp"
#include "tapping_bench.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace palpate::tapping {
namespace {

constexpr double kPeriod = GuardedTap::kPeriod;

MotionOptions motion(const std::string& yaml) { return test::filled<MotionOptions>(yaml); }

/// What happened in one period.
struct Moment {
  double set_point, height, force;
};

/// An arm that is where it is told, over a spring, with what `force` adds in period i at a height.
struct Trial {
  std::vector<Moment> moments;
  GuardedTap tap;

  Trial(
      const MotionOptions& options, const Descent& descent, double surface, double stiffness,
      const std::function<double(int, double)>& extra = [](int, double) { return 0.0; },
      GuardedTap::Arm arm = GuardedTap::Arm::simulated)
      : tap(options, descent, arm) {
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
    const MotionOptions options = motion(yaml);
    for (int i = 0; i < 50; ++i) {
      const double surface = 0.134 * random.uniform();
      const std::optional<Prediction> guess{{surface - 0.03 + 0.08 * random.uniform(), 0.005}};
      const Descent descent = plan_descent(options, 0.0, guess);
      // A start within three periods of the surface may be reached before the contact on the way is certain.
      if (std::abs(descent.start - surface) < 0.005) continue;
      const Trial run(options, descent, surface, 1e7);
      ASSERT_EQ(run.tap.outcome(), Outcome::contact) << yaml;
      // Until three periods are above the threshold the set-point goes on by that much.
      const double most = 5 * kPeriod * std::max(options.speed, 0.1);
      EXPECT_NEAR(run.tap.height(), surface, options.type == MotionOptions::Type::continuous ? 1e-3 : most) << yaml;
      // Each stage is rounded up to whole periods, and takes three more to be sure.
      const double step_more = options.type == MotionOptions::Type::paper ? options.pause : 0.0;
      const double closed = ideal_seconds(options, descent, surface);
      EXPECT_GT(run.tap.seconds(), closed - 0.05) << yaml << " at " << surface;
      EXPECT_LT(run.tap.seconds(), closed + 0.25 + step_more) << yaml << " at " << surface;
    }
  }
}

TEST(GuardedTap, NeverCommandsFasterThanItsSpeedsNorBelowItsFloor) {
  for (const char* yaml : kMotions) {
    const MotionOptions options = motion(yaml);
    const Descent descent = plan_descent(options, 0.1, Prediction{0.12, 0.01});
    const Trial run(options, descent, 0.13, 1500.0);
    double last = descent.hover;
    for (const Moment& one : run.moments) {
      EXPECT_GE(one.set_point, descent.floor);
      EXPECT_LE(one.set_point, descent.hover);
      EXPECT_GE(one.set_point - last, -std::max(options.speed, 0.1) * kPeriod - 1e-12) << yaml;
      last = one.set_point;
    }
  }
}

TEST(GuardedTap, NeverBacksOffAboveItsHover) {
  const MotionOptions options = motion("{type: two_stage, back_off: 10 cm}");
  const Descent descent = plan_descent(options, 0.0, {});
  const Trial run(options, descent, 0.1, 1500.0);
  for (const Moment& one : run.moments) EXPECT_LE(one.set_point, descent.hover);
  EXPECT_EQ(run.tap.outcome(), Outcome::contact);
}

TEST(GuardedTap, KeepsItsResultWhateverItIsToldAfterwards) {
  const MotionOptions options = motion("{type: continuous}");
  Trial run(options, plan_descent(options, 0.0, {}), 0.08, 1500.0);
  const double height = run.tap.height();
  const double seconds = run.tap.seconds();
  for (int i = 0; i < 10'000; ++i) run.tap.next(0.13, 100.0);
  EXPECT_EQ(run.tap.outcome(), Outcome::contact);
  EXPECT_EQ(run.tap.height(), height);
  EXPECT_EQ(run.tap.seconds(), seconds);
}

TEST(GuardedTap, DoesNotTakeTwoLoudPeriodsForAContact) {
  const MotionOptions options = motion("{type: continuous}");
  const Descent descent = plan_descent(options, 0.0, {});
  const auto loud = [](int i, double) { return i % 5 < 2 && i > 30 ? 100.0 : 0.0; };
  const Trial run(options, descent, -1.0, 0.0, loud);
  EXPECT_EQ(run.tap.outcome(), Outcome::no_contact);
}

TEST(GuardedTap, TakesOneReadingForOneHoweverOftenItIsTold) {
  const MotionOptions options = motion("{type: continuous}");
  GuardedTap tap(options, plan_descent(options, 0.0, {}));
  double height = options.hover;
  for (int i = 0; !tap.done() && i < 100'000; ++i) {
    const bool loud = i > 60 && (i / 6) % 2 == 0;  // one reading of two, each told for six periods
    height = tap.next(height, loud ? 50.0 : 0.0, i % 6 == 0);
  }
  EXPECT_EQ(tap.outcome(), Outcome::no_contact);
}

TEST(GuardedTap, TaresNewReadingsAlone) {
  const MotionOptions options = motion("{type: continuous, tare: 200 ms}");
  GuardedTap tap(options, plan_descent(options, 0.0, {}));
  double height = options.hover;
  for (int i = 0; !tap.done() && i < 100'000; ++i) {
    // 2 N in every new reading, 30 N whenever nothing new came.
    height = tap.next(height, i % 2 == 0 ? 2.0 + (height < 0.05 ? 20.0 : 0.0) : 30.0, i % 2 == 0);
  }
  EXPECT_EQ(tap.outcome(), Outcome::contact);
  EXPECT_NEAR(tap.peak_force(), 20.0, 1e-9);
}

TEST(GuardedTap, TaresTheZeroOfTheForceAway) {
  for (const char* yaml : {"{type: paper}", "{type: two_stage}", "{type: continuous}"}) {
    const MotionOptions options = motion(yaml);
    const Descent descent = plan_descent(options, 0.0, {});
    const Trial plain(options, descent, 0.05, 1500.0);
    const Trial biased(options, descent, 0.05, 1500.0, [](int, double) { return 25.0; });
    EXPECT_NEAR(biased.tap.height(), plain.tap.height(), 1e-9) << yaml;
    EXPECT_EQ(biased.tap.seconds(), plain.tap.seconds()) << yaml;
    EXPECT_NEAR(biased.tap.peak_force(), plain.tap.peak_force(), 1e-9) << yaml;
  }
}

TEST(GuardedTap, OfARealArmTaresInEveryPauseOfThePaper) {
  const MotionOptions options = motion("{type: paper, threshold: 10 N}");
  const Descent descent = plan_descent(options, 0.0, {});
  // 13.5 N from the height of travel to the desk, 3 N a step.
  const auto wanders = [&](int, double height) { return 100.0 * (descent.hover - height); };
  const Trial simulated(options, descent, 0.0, 1500.0, wanders);
  EXPECT_GT(simulated.tap.height(), 0.02) << "a contact in the air";
  const Trial real(options, descent, 0.0, 1500.0, wanders, GuardedTap::Arm::real);
  EXPECT_EQ(real.tap.outcome(), Outcome::contact);
  EXPECT_LT(real.tap.height(), 0.0);
  EXPECT_GT(real.tap.height(), -0.01);
}

TEST(GuardedTap, OfARealArmDoesNotTareAContactAwayThatBeginsInAPause) {
  const MotionOptions options = motion("{type: paper, threshold: 10 N, step: 3 cm, hover: 13.5 cm}");
  const Descent descent = plan_descent(options, 0.0, {});
  // The second step ends at 7.5 cm and presses with 8 N: less than the threshold, more than half of it.
  const double surface = 0.075 + 8.0 / 1500.0;
  const Trial real(
      options, descent, surface, 1500.0, [](int, double) { return 0.0; }, GuardedTap::Arm::real);
  EXPECT_EQ(real.tap.outcome(), Outcome::contact);
  EXPECT_LT(real.tap.peak_force(), 10.0 + 4 * 0.024 * kPeriod * 1500.0) << "as if the pause had not been";
}

TEST(GuardedTap, OfARealArmPutsItsSetPointWhereTheArmIsInThePapersMotionToo) {
  const MotionOptions options = motion("{type: paper}");
  GuardedTap tap(options, plan_descent(options, 0.0, {}), GuardedTap::Arm::real);
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
    const MotionOptions options = motion(yaml);
    const Descent descent = plan_descent(options, 0.0, {});
    const Trial run(options, descent, -1.0, 1500.0);
    EXPECT_EQ(run.tap.outcome(), Outcome::no_contact) << yaml;
    EXPECT_DOUBLE_EQ(run.moments.back().set_point, -options.overrun) << yaml;
  }
}

TEST(GuardedTap, GivesUpAfterItsTimeout) {
  const MotionOptions options = motion("{type: paper, pause: 20 s, timeout: 30 s}");
  const Trial run(options, plan_descent(options, 0.0, {}), 0.0, 1500.0);
  EXPECT_EQ(run.tap.outcome(), Outcome::timeout);
  EXPECT_NEAR(run.tap.seconds(), 30.0, 0.02);
}

TEST(GuardedTap, OfThePaperHoldsItsSetPointAndReadsAfterThePause) {
  const MotionOptions options = motion("{type: paper, pause: 500 ms}");
  const Trial run(options, plan_descent(options, 0.0, {}), 0.05, 1500.0);
  std::size_t since = run.moments.size();
  while (since > 0 && run.moments[since - 1].set_point == run.moments.back().set_point) --since;
  EXPECT_NEAR(static_cast<double>(run.moments.size() - since) * kPeriod, 0.5, 0.03);
  EXPECT_DOUBLE_EQ(run.tap.height(), run.moments.back().height);
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
    const MotionOptions options = motion(yaml);
    const Descent descent = plan_descent(options, 0.0, {});
    // A zero that has wandered by 60 % of the threshold in the air, and noise on it that goes three times too far.
    int loud = 0;
    const auto wandered = [&](int, double position) {
      if (position > 0.101) return 0.0;
      return loud++ < 3 ? 1.2 * options.threshold : 0.6 * options.threshold;
    };
    const Trial run(options, descent, 0.03, 1e6, wandered, GuardedTap::Arm::real);
    EXPECT_EQ(run.tap.outcome(), Outcome::contact) << yaml;
    EXPECT_NEAR(run.tap.height(), 0.03, 0.002) << yaml;
  }
}

TEST(GuardedTap, OfTwoStagesGoesOnAfterAContactThatWasNone) {
  const MotionOptions options = motion("{type: two_stage}");
  const Descent descent = plan_descent(options, 0.0, {});
  const auto jerk = [](int, double position) { return position < 0.101 && position > 0.099 ? 30.0 : 0.0; };
  int left = 5;  // the jerk comes once
  const Trial run(options, descent, 0.03, 1e6, [&](int i, double position) {
    const double force = jerk(i, position);
    return force > 0.0 && left-- > 0 ? force : 0.0;
  });
  EXPECT_EQ(run.tap.outcome(), Outcome::contact);
  EXPECT_NEAR(run.tap.height(), 0.03, 0.001);
}

TEST(GuardedTap, BacksOffWhenThePredictionLetItHitTheSurfaceFast) {
  const MotionOptions options = motion("{type: continuous, adaptive_hover: {clearance: 1 cm}}");
  const Descent descent = plan_descent(options, 0.0, Prediction{0.0, 0.001});
  EXPECT_NEAR(descent.start, 0.012, 1e-12);
  const Trial run(options, descent, 0.08, 1500.0);
  EXPECT_EQ(run.tap.outcome(), Outcome::contact);
  EXPECT_NEAR(run.tap.height(), 0.08, 1e-6);
  EXPECT_GT(run.tap.seconds(), (0.135 - 0.08) / 0.1 + 0.01 / 0.1 + 0.01 / 0.024);
}

TEST(Descent, BeginsAboveThePredictionButNeverAboveTheHover) {
  const MotionOptions options = motion("{type: paper, adaptive_hover: {deviations: 2, clearance: 1 cm}}");
  EXPECT_DOUBLE_EQ(plan_descent(options, 0.5, {}).start, 0.635) << "nothing is predicted";
  EXPECT_DOUBLE_EQ(plan_descent(options, 0.5, Prediction{0.55, 0.01}).start, 0.58);
  EXPECT_DOUBLE_EQ(plan_descent(options, 0.5, Prediction{0.55, 1.0}).start, 0.635) << "nothing is known";
  EXPECT_DOUBLE_EQ(plan_descent(options, 0.5, Prediction{0.2, 0.01}).start, 0.51) << "the desk is there";
  const MotionOptions plain = motion("{type: paper}");
  EXPECT_DOUBLE_EQ(plan_descent(plain, 0.5, Prediction{0.55, 0.01}).start, 0.635);
}

}  // namespace
}  // namespace palpate::tapping
