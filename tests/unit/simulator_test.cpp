// SPDX-License-Identifier: MIT
// What each effect of a scene does to taps, against closed forms.
#include "simulator/arm.hpp"
#include "tapping_bench.hpp"

namespace palpate::test {
namespace {

constexpr const char* kLikeBaxter =
    "{stiffness: {object: 1500 N/m}, joint_lag: {delay: 350 ms}, force_noise: {deviation: 1.5 N}}";

TEST(Simulator, IsExactInASceneWithoutEffectsAndLosesNothingToALagAloneWhereTheSurfaceIsRigid) {
  for (const char* motion : {"{type: paper}", "{type: two_stage}", "{type: continuous}"}) {
    const TapStatistics taps = statistics_of(TappingBench(kObjectI, "{}", motion).taps(200));
    EXPECT_EQ(taps.rms, 0.0) << motion;
    EXPECT_EQ(taps.failed, 0) << motion;
    const TapStatistics late = statistics_of(TappingBench(kObjectI, "{joint_lag: {delay: 350 ms}}", motion).taps(100));
    EXPECT_LT(late.rms, 0.0005) << motion;
    EXPECT_EQ(late.failed, 0) << motion;
  }
}

TEST(Simulator, FindsTheOnsetWhereThePapersMotionSinksIn) {
  const TapStatistics paper = statistics_of(TappingBench(kObjectI, kLikeBaxter, "{type: paper}").taps(400));
  EXPECT_NEAR(paper.rms, 0.013, 0.0015);
  EXPECT_LT(paper.bias, -0.010) << "overtravel: too low";
  const TapStatistics fast =
      statistics_of(TappingBench(kObjectI, kLikeBaxter, "{type: continuous, speed: 6 cm/s}").taps(400));
  EXPECT_LT(fast.rms, 0.001);
  EXPECT_LT(std::abs(fast.bias), 0.0002);
  EXPECT_LT(fast.seconds, 0.5 * paper.seconds);
}

TEST(Simulator, IsAsExactWhereAWrongPredictionLetsATrailingArmHitTheSurface) {
  // The arm still presses when its set-point is clear again: it has to be waited for.
  const TappingBench bench(kObjectI, kLikeBaxter, "{type: continuous, speed: 6 cm/s, adaptive_hover: {}}");
  for (int i = 1; i <= 50; ++i) {
    TapRequest request = request_at({0.115, 0.05 + 0.0025 * i}, i);
    request.predicted = Prediction{0.0, 0.0};
    EXPECT_NEAR(bench.backend().tap(request).height(), bench.scene().height(0.115, 0.05 + 0.0025 * i), 0.0035) << i;
  }
}

TEST(Simulator, SinksInByTheFineThresholdOverTheStiffnessAndBacksOffUntilTheTipIsClear) {
  const TappingBench bench(kBare, "{stiffness: {object: 1000 N/m}}",
                           "{type: two_stage, fine_speed: 1 mm/s, fine_threshold: 5 N}");
  // Three periods at 1 mm/s are 0.03 mm.
  EXPECT_NEAR(bench.tap(0.1, 0.1).height(), -0.005, 0.00005);
  const TappingBench soft(kBare, "{stiffness: {object: 300 N/m}, joint_lag: {}}",
                          "{type: two_stage, fine_speed: 5 mm/s, overrun: 8 cm}");
  EXPECT_NEAR(soft.tap(0.1, 0.1).height(), -6.0 / 300.0, 0.001);
}

TEST(Simulator, FindsTheOnsetOfSoftObjectsHoweverDeepTheTipSinksIn) {
  for (const char* stiffness : {"200 N/m", "300 N/m", "500 N/m"}) {
    const TappingBench bench(kObjectI, std::string("{stiffness: {object: ") + stiffness + "}, joint_lag: {}}",
                             "{type: continuous, speed: 6 cm/s, overrun: 8 cm}");
    for (const auto& one : bench.taps(20)) {
      ASSERT_EQ(one.contact.outcome, Outcome::contact) << stiffness;
      EXPECT_NEAR(one.contact.height(), one.truth, 1e-5) << stiffness;
    }
  }
}

TEST(Simulator, FindsTheOnsetThoughTheZeroOfTheForceWanders) {
  const TappingBench bench(kBare, "{stiffness: {}, joint_lag: {}, force_drift: {per_metre: 20 N/m}}",
                           "{type: continuous, speed: 3 cm/s}");
  const TapStatistics taps = statistics_of(bench.taps(200));
  // 2.8 N over the whole descent, but only 0.4 N over what tells of the onset.
  EXPECT_LT(taps.rms, 0.0005);
}

TEST(Simulator, WaitsForAnArmThatTrailsByWholeSeconds) {
  const TappingBench bench(kObjectI, "{joint_lag: {delay: 5 s}}", "{type: continuous, speed: 6 cm/s}");
  for (const auto& one : bench.taps(20)) EXPECT_EQ(one.contact.outcome, Outcome::contact) << one.contact.reason;
}

TEST(Simulator, SeesTheArmsOwnStiffnessInTheForceAndNotInTheHeight) {
  const TappingBench bench(kBare, "{stiffness: {object: 1e7 N/m, arm: 1000 N/m}}", "{type: paper, step: 1 cm}");
  const TapResult contact = bench.tap(0.1, 0.1);
  EXPECT_NEAR(contact.height(), 0.0, 1e-5);
  EXPECT_GT(contact.force, 10.0);
}

TEST(Simulator, AnswersAlikeWhateverWasTappedBefore) {
  const std::string all =
      "{stiffness: {}, joint_lag: {}, force_noise: {}, force_drift: {}, tip_radius: {}, pose_noise: {}, "
      "missed_contacts: {probability: 0.2}, false_contacts: {probability: 0.2}, reach: {}, shaft: {}}";
  const TappingBench bench(kObjectI, all, "{type: continuous}");
  const TappingBench other(kObjectI, all, "{type: continuous}");
  const auto first = bench.taps(50);
  for (int i = 50; i-- > 0;) {
    const auto& known = first[static_cast<std::size_t>(i)];
    TapRequest request = request_at(known.place, i + 1);
    if (i > 0) request.previous = line_from_above(first[static_cast<std::size_t>(i - 1)].place);
    const TapResult again = other.backend().tap(request);
    expect_same(again, known.contact);
  }
}

TEST(Simulator, DrawsOtherNoiseFromAnotherSeed) {
  const char* noisy = "{pose_noise: {}}";
  EXPECT_NE(TappingBench(kBare, noisy, "{type: paper}", 1).tap(0.1, 0.1).height(),
            TappingBench(kBare, noisy, "{type: paper}", 2).tap(0.1, 0.1).height());
}

TEST(Simulator, NoiseOfThePoseHasTheDeviationsOfTheConfig) {
  // On a slope of 6 cm over 17 cm a lateral error shows as a height, too.
  const TappingBench bench("[{type: slope, length: 20 cm, width: 20 cm, low: 2 cm, high: 8 cm}]",
                           "{pose_noise: {lateral: 3 mm, vertical: 1 mm}}", "{type: paper}");
  double squares = 0.0;
  constexpr int kTaps = 4000;
  for (int i = 0; i < kTaps; ++i) {
    const double error = bench.tap(0.115, 0.115, i + 1).height() - 0.05;
    squares += error * error / kTaps;
  }
  const double expected = std::hypot(0.001, 0.003 * 0.06 / 0.20);
  EXPECT_NEAR(std::sqrt(squares), expected, 5.0 * expected / std::sqrt(2.0 * kTaps));
}

TEST(Simulator, MissesContactsAsOftenAsTheConfigSaysAndSaysSo) {
  const auto taps = TappingBench(kObjectI, "{missed_contacts: {probability: 0.3}}", "{type: continuous}").taps(500);
  int missed = 0;
  for (const auto& one : taps) {
    if (one.contact.outcome == Outcome::contact) continue;
    EXPECT_EQ(one.contact.outcome, Outcome::no_contact);
    EXPECT_NE(one.contact.reason.find("without a contact"), std::string::npos);
    ++missed;
  }
  EXPECT_NEAR(missed, 150, 5 * std::sqrt(500 * 0.3 * 0.7));
}

TEST(Simulator, FeelsFalseContactsAboveTheSurfaceUnlessTheMotionMakesSure) {
  const char* jerks = "{false_contacts: {probability: 0.3}}";
  const auto high = [](const std::vector<TappingBench::Tapped>& taps) {
    return std::count_if(taps.begin(), taps.end(), [](const auto& one) {
      return one.contact.outcome == Outcome::contact && one.contact.height() > one.truth + 0.002;
    });
  };
  const auto fooled = high(TappingBench(kObjectI, jerks, "{type: paper}").taps(500));
  EXPECT_NEAR(static_cast<double>(fooled), 150, 5 * std::sqrt(500 * 0.3 * 0.7));
  EXPECT_EQ(high(TappingBench(kObjectI, jerks, "{type: two_stage}").taps(500)), 0);
}

TEST(Simulator, HearsTheForceLateAndFindsTheOnsetLowerByTheTimeTimesTheSpeed) {
  const double deviation = 0.02;
  for (const double speed : {0.03, 0.06}) {
    const std::string motion = "{type: continuous, speed: " + std::to_string(speed) + " m/s}";
    const TapStatistics taps =
        statistics_of(TappingBench(kBare, "{stiffness: {}, latency: {deviation: 20 ms}}", motion).taps(400));
    // The mean of the absolute value of a normal number, and the root of its mean square.
    const double mean = std::sqrt(2.0 / 3.14159265358979323846) * deviation * speed;
    // What is still heard once the arm stands moves the kink by up to a third more.
    EXPECT_LT(taps.bias, -0.9 * mean) << speed;
    EXPECT_GT(taps.bias, -1.4 * mean) << speed;
    EXPECT_GT(taps.rms, 0.9 * deviation * speed) << speed;
    EXPECT_LT(taps.rms, 1.5 * deviation * speed) << speed;
  }
}

TEST(Simulator, AddsAnOffsetAndADriftOverTheArmsTimeToEveryHeight) {
  const TappingBench bench(kBare, "{height_offset: {constant: 8 mm, drift: 1 mm/min}}", "{type: paper}");
  TapRequest request = request_at({0.1, 0.1});
  EXPECT_NEAR(bench.backend().tap(request).height(), 0.008, 1e-12);
  request.elapsed = 90.0;
  EXPECT_NEAR(bench.backend().tap(request).height(), 0.008 + 0.0015, 1e-12);
}

TEST(Simulator, HasTheDeskAsSoftAsTheConfigSaysWhateverObjectsAre) {
  const char* soft_desk = "{stiffness: {object: 5000 N/m, desk: 1000 N/m}}";
  const char* motion = "{type: two_stage, fine_speed: 1 mm/s, fine_threshold: 5 N}";
  EXPECT_NEAR(TappingBench(kBare, soft_desk, motion).tap(0.1, 0.1).height(), -0.005, 0.0001);
  const TappingBench block("[{type: block, length: 20 cm, width: 20 cm, height: 5 cm}]", soft_desk, motion);
  EXPECT_NEAR(block.tap(0.115, 0.115).height(), 0.05 - 0.001, 0.0001);
}

TEST(Simulator, MeetsThingsThatAreNotOfTheSceneOnAShareOfTheSquaresAndAlikeAtEveryTouch) {
  const TappingBench bench(kBare, "{foreign_objects: {probability: 0.1, height: 2 cm, size: 1 cm}}", "{type: paper}");
  int met = 0;
  constexpr int kSide = 22;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 0; column < kSide; ++column) {
      const double x = 0.01 * column;
      const double y = 0.01 * row;
      const double height = bench.tap(x + 0.002, y + 0.002, 1).height();
      EXPECT_EQ(height, bench.tap(x + 0.007, y + 0.004, 2).height()) << "the same square, another tap";
      EXPECT_LE(height, 0.02);
      EXPECT_GE(height, 0.0);
      met += height > 0.0 ? 1 : 0;
    }
  }
  const double squares = kSide * kSide;
  EXPECT_NEAR(met, 0.1 * squares, 5.0 * std::sqrt(squares * 0.1 * 0.9));
}

TEST(Simulator, KnowsTheTruePeakOfTheForceOfATapThatFailedToo) {
  const TappingBench blind(kBare, "{stiffness: {object: 1000 N/m}, missed_contacts: {probability: 1}}",
                           "{type: continuous, overrun: 3 cm}");
  const TapResult missed = blind.tap(0.1, 0.1);
  EXPECT_EQ(missed.outcome, Outcome::no_contact);
  EXPECT_NEAR(missed.peak_force.value(), 30.0, 0.1) << "3 cm at 1000 N/m";
  EXPECT_FALSE(TappingBench(kBare, "{}", "{type: paper}").tap(0.1, 0.1).peak_force) << "no force is simulated";
}

TEST(Simulator, StopsByItselfShortOfTheLimitWhateverIsFelt) {
  const TappingBench blind(kBare, "{stiffness: {object: 1000 N/m}, missed_contacts: {probability: 1}}",
                           "{type: continuous, overrun: 3 cm, force_limit: 16 N}");
  const TapResult stopped = blind.tap(0.1, 0.1);
  EXPECT_EQ(stopped.outcome, Outcome::aborted);
  EXPECT_NE(stopped.reason.find("stopped by itself"), std::string::npos);
  EXPECT_GT(stopped.peak_force.value(), 12.0);
  EXPECT_LT(stopped.peak_force.value(), 16.0);
}

TEST(Simulator, TakesForAContactWhatItWasStoppedAtIfTheForceIsHeardAfterAll) {
  // Every tap is heard late, the most of them later than the arm stops by itself at 12 N.
  const char* late = "{stiffness: {object: 1500 N/m}, joint_lag: {}, latency: {deviation: 80 ms}}";
  int stopped = 0;
  for (const auto& one :
       TappingBench(kObjectI, late, "{type: continuous, speed: 6 cm/s, brake: 3 cm, force_limit: 16 N}").taps(100)) {
    if (one.contact.outcome == Outcome::aborted) continue;
    ASSERT_EQ(one.contact.outcome, Outcome::contact);
    EXPECT_LE(one.contact.peak_force.value(), 16.0);
    EXPECT_NEAR(one.contact.height(), one.truth, 0.012) << "80 ms at 6 cm/s are 5 mm";
    if (one.contact.peak_force.value() > 12.0) ++stopped;
  }
  EXPECT_GT(stopped, 30);
}

TEST(Simulator, BrakesATrailingArmSoThatItPressesLessAndFindsTheSameOnset) {
  const auto peak = [](const char* motion) {
    double most = 0.0;
    for (const auto& one : TappingBench(kObjectI, kLikeBaxter, motion).taps(100)) {
      EXPECT_EQ(one.contact.outcome, Outcome::contact);
      EXPECT_NEAR(one.contact.height(), one.truth, 0.003);
      most = std::max(most, one.contact.peak_force.value());
    }
    return most;
  };
  EXPECT_LT(peak("{type: continuous, speed: 6 cm/s, brake: 3 cm}"), 0.85 * peak("{type: continuous, speed: 6 cm/s}"));
}

TEST(Simulator, GoesOnWhereTheForceOfAJerkDoesNotLast) {
  const auto high = [](const char* motion) {
    int count = 0;
    const TappingBench bench(kObjectI, "{stiffness: {}, joint_lag: {}, false_contacts: {probability: 0.5}}", motion);
    for (const auto& one : bench.taps(200))
      count += one.contact.outcome == Outcome::contact && one.contact.height() > one.truth + 0.005 ? 1 : 0;
    return count;
  };
  EXPECT_GT(high("{type: continuous, brake: 3 cm}"), 60);
  EXPECT_LT(high("{type: continuous, brake: 3 cm, confirm: true}"), 10);
}

TEST(Simulator, RefusesWhatIsOutOfReachWithoutMoving) {
  const TappingBench bench(kObjectI, "{reach: {base: [-50 cm, 11.5 cm], radius: 70 cm}}", "{type: paper}");
  const TapResult far = bench.tap(0.21, 0.115);
  EXPECT_EQ(far.outcome, Outcome::unreachable);
  EXPECT_EQ(far.seconds, 0.0);
  EXPECT_EQ(bench.tap(0.19, 0.115).outcome, Outcome::contact);
}

TEST(Simulator, ForceThatDriftsShiftsATapByDriftOverStiffness) {
  // The slope of a tap is normal: with 10 N/m over 13.5 cm, 1.4 N of drift against 1500 N/m.
  const auto taps = TappingBench(kBare, "{stiffness: {object: 1500 N/m}, force_drift: {per_metre: 10 N/m}}",
                                 "{type: two_stage, fine_speed: 5 mm/s}")
                        .taps(300);
  const TapStatistics drifted = statistics_of(taps);
  // It tares again 2 cm above the onset: what is left drifts over 2.4 cm, 0.24 N, 0.16 mm.
  EXPECT_NEAR(std::sqrt(drifted.rms * drifted.rms - drifted.bias * drifted.bias), 0.00016, 0.00004);
}

TEST(Simulator, RefusesAnObjectAsHighAsItTravels) {
  EXPECT_THAT(error_of([] { TappingBench(kObjectI, "{}", "{type: paper, hover: 11 cm}"); }),
              testing::HasSubstr("motion.hover"));
}

TEST(SimulatedAxis, TrailsARampByItsDelayTimesTheSpeed) {
  for (const double overshoot : {0.0, 0.05, 0.3}) {
    backends::SimulatedAxis arm(JointLag{0.35, overshoot}, 0.01, 0.1);
    double set_point = 0.1;
    for (int i = 0; i < 1000; ++i) arm.follow(set_point -= 0.0003);
    // The set-point stands still during a period, on average half a period behind its ramp.
    EXPECT_NEAR(arm.position() - set_point, (0.35 - 0.005) * 0.03, 0.00016) << overshoot;
  }
}

TEST(SimulatedAxis, OvershootsAStepByItsShareAndNotAtAllByDefault) {
  for (const double overshoot : {0.0, 0.05, 0.3}) {
    backends::SimulatedAxis arm(JointLag{0.35, overshoot}, 0.001, 0.0);
    double highest = 0.0;
    for (int i = 0; i < 20000; ++i) {
      arm.follow(1.0);
      highest = std::max(highest, arm.position());
    }
    EXPECT_NEAR(highest, 1.0 + overshoot, 1e-4);
    EXPECT_NEAR(arm.position(), 1.0, 1e-6);
  }
}

TEST(SimulatedAxis, FollowsTheSamePathAtAnyPeriod) {
  // Exact for a constant set-point: ten short periods are one long one. An integrator of small steps agrees.
  backends::SimulatedAxis coarse(JointLag{0.35, 0.2}, 0.1, 0.0);
  backends::SimulatedAxis fine(JointLag{0.35, 0.2}, 0.01, 0.0);
  const double log_share = std::log(0.2);
  constexpr double kHalfTurn = 3.14159265358979323846;
  const double zeta = -log_share / std::hypot(kHalfTurn, log_share);
  const double omega = 2.0 * zeta / 0.35;
  double position = 0.0;
  double velocity = 0.0;
  for (int i = 0; i < 20; ++i) {
    coarse.follow(1.0);
    for (int j = 0; j < 10; ++j) fine.follow(1.0);
    for (int j = 0; j < 100000; ++j) {
      velocity += 1e-6 * (omega * omega * (1.0 - position) - 2.0 * zeta * omega * velocity);
      position += 1e-6 * velocity;
    }
    EXPECT_NEAR(coarse.position(), fine.position(), 1e-12);
    EXPECT_NEAR(coarse.position(), position, 1e-5);
  }
}

TEST(Tool, RoundTipMeetsTheSideOfAStepByTheClosedForm) {
  // A wall of 5 cm whose edge is at x = 10 cm; the tip stands at x = 10 cm - d.
  const TappingBench bench("[{type: slope, length: 10 cm, width: 20 cm, low: 5 cm, high: 5 cm, at: [15 cm, 11.5 cm]}]",
                           "{}", "{type: paper}");
  Effects effects;
  effects.tip_radius = TipRadius{0.008};
  for (const double d : {0.0005, 0.002, 0.005, 0.0079, 0.0085, 0.02}) {
    const double expected = d < 0.008 ? 0.05 - (0.008 - std::sqrt(0.008 * 0.008 - d * d)) : 0.0;
    EXPECT_NEAR(backends::contact_height(bench.scene(), effects, 0.1 - d, 0.12), expected, 2e-7) << d;
  }
  EXPECT_NEAR(backends::contact_height(bench.scene(), effects, 0.12, 0.12), 0.05, 1e-12) << "on the top";
}

TEST(Tool, RoundTipOnASlopeTouchesUphill) {
  // On a plane of angle a the sphere's lowest point is radius * (1 / cos a - 1) above the plane below it.
  const TappingBench bench("[{type: slope, length: 20 cm, width: 20 cm, low: 2 cm, high: 10 cm}]", "{}",
                           "{type: paper}");
  Effects effects;
  effects.tip_radius = TipRadius{0.01};
  const double rise = 0.08 / 0.20;
  const double expected = 0.06 + 0.01 * (std::sqrt(1.0 + rise * rise) - 1.0);
  EXPECT_NEAR(backends::contact_height(bench.scene(), effects, 0.115, 0.115), expected, 1e-8);
}

TEST(Tool, ShaftStopsBesideATallObject) {
  const TappingBench bench(
      "[{type: slope, length: 10 cm, width: 20 cm, low: 10 cm, high: 10 cm, at: [15 cm, 11.5 cm]}]", "{}",
      "{type: paper}");
  Effects effects;
  effects.shaft = Shaft{0.015, 0.08};
  EXPECT_NEAR(backends::contact_height(bench.scene(), effects, 0.09, 0.12), 0.02, 1e-12) << "10 cm less 8 cm of tool";
  EXPECT_NEAR(backends::contact_height(bench.scene(), effects, 0.08, 0.12), 0.0, 1e-12) << "2 cm away";
  effects.shaft = Shaft{0.015, 0.12};
  EXPECT_NEAR(backends::contact_height(bench.scene(), effects, 0.09, 0.12), 0.0, 1e-12) << "a long tool";
}

TEST(Simulator, HasTheDeskAsSoftAsTheConfigSaysWhereTheSideOfARoundTipTouchesItAtASlope) {
  const TappingBench bench(kBare, "{stiffness: {object: 500 N/m, desk: 1000000 N/m}, tip_radius: {radius: 5 mm}}",
                           "{type: paper}");
  const Eigen::Vector3d direction = Eigen::Vector3d(0.6, 0.0, -0.8);
  const Line line{Eigen::Vector3d(0.01, 0.005, 0.0) - 0.1 * direction, direction};
  TapRequest request;
  request.line = {line.origin, line.direction, 0.2};
  const TapResult contact = bench.backend().tap(request);
  ASSERT_EQ(contact.outcome, Outcome::contact);
  // The foremost point is higher than the lowest by r (1 - 0.8). The arm goes on for three periods at 2.4 cm/s, 0.7 mm;
  // an object would give way by 20 mm.
  EXPECT_NEAR(contact.height(), 0.005 * (1.0 - 0.8), 0.0008);
}

TEST(Simulator, SaysOfATapAlongALineThatFeltNothingThatItCameToItsEnd) {
  const TappingBench bench(kBare, "{missed_contacts: {probability: 1}}", "{type: paper}");
  TapRequest request;
  request.line = {{0.115, 0.115, 0.2}, -Eigen::Vector3d::UnitZ(), 0.3};
  const TapResult contact = bench.backend().tap(request);
  EXPECT_EQ(contact.outcome, Outcome::no_contact);
  EXPECT_EQ(contact.distance, 0.3) << "where the object truly was, an arm that felt nothing does not know";
}

}  // namespace
}  // namespace palpate::test
