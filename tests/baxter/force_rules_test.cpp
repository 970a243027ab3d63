// SPDX-License-Identifier: MIT
// Rules that count readings of the force: rate of renewal, frozen force, caught tool. Each test defines the messages of
// a robot with known forces.
#include "baxter/guard_bench.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace palpate::baxter {
namespace {

using test::IsFault;
using test::IsNothing;
using test::kZero;
using test::Rules;
using testing::AllOf;
using testing::HasSubstr;
using AllowedAction = Fault::AllowedAction;

/// A robot that sends `messages` forces per period of 10 ms, of which the driver sees the last.
class Sender {
 public:
  explicit Sender(int messages = 1) : messages_(messages) {}

  /// Simulates one period with force `force(number)` along z in each message. Returns the fault, if any.
  std::optional<Fault> send(Rules& rules, const std::function<double(long)>& force) {
    for (int i = 0; i < messages_; ++i) {
      EndpointReading next = *test::sound(now_, test::pose()).endpoint;
      next.force = {0.0, 0.0, force(sent_++)};
      count_after(latest_, next);
      latest_ = next;
    }
    const std::optional<Fault> fault = rules.at(now_, [&](Snapshot& seen) { seen.endpoint = latest_; });
    now_ += 0.01;
    return fault;
  }
  /// Simulates up to `periods` periods, until a fault.
  std::optional<Fault> send(Rules& rules, int periods, const std::function<double(long)>& force) {
    std::optional<Fault> fault;
    for (taken_ = 0; taken_ < periods && !fault; ++taken_) fault = send(rules, force);
    return fault;
  }
  int taken() const { return taken_; }  ///< periods of the last send()
  long sent() const { return sent_; }

 private:
  int messages_;
  double now_ = 1.0;
  long sent_ = 0;
  int taken_ = 0;
  std::optional<EndpointReading> latest_;
};

/// Returns the force of a robot that estimates it once per `every` messages; no two estimates are equal.
std::function<double(long)> renewed(int every) {
  return [every](long number) { return 0.1 * std::sin(1.0 + 1000.0 * static_cast<double>(number / every)); };
}

TEST(AFrozenForce, IsNoticedAfterTenOfTheTimesInWhichTheRobotRenewsItOrFourThatTakeATenthOfASecond) {
  for (const auto& [every, messages, periods] :
       {std::tuple{1, 1, 10}, {1, 5, 2}, {3, 2, 10}, {5, 1, 20}}) {  // 100, 500, 67 and 20 renewals per second
    Rules rules;
    Sender robot(messages);
    ASSERT_THAT(robot.send(rules, 120, renewed(every)), IsNothing()) << every;
    const double last = renewed(every)(robot.sent() - 1);
    const std::optional<Fault> fault = robot.send(rules, 100, [&](long) { return last; });
    EXPECT_THAT(fault, IsFault("exactly the same force", AllowedAction::hold));
    EXPECT_LE(robot.taken(), periods + 1) << every << " of " << messages << " a period";
    EXPECT_GE(robot.taken(), periods - every) << "the latest may have been sent again before";
  }
}

TEST(AFrozenForce, IsFoundInAForceThatIsRenewedSeldomOnlyWhereItIsFrozen) {
  for (const int every : {1, 2, 5, 10, 12}) {
    Rules rules;
    Sender robot;
    EXPECT_THAT(robot.send(rules, 1000, renewed(every)), IsNothing()) << every;
    const double last = renewed(every)(robot.sent() - 1);
    EXPECT_TRUE(robot.send(rules, 1000, [&](long) { return last; })) << every;
    EXPECT_LE(robot.taken(), 10 * every) << every;
  }
}

TEST(AForce, ThatIsRenewedSeldomEndsNoRunByOneNoisyValue) {
  for (const int every : {2, 5, 10}) {
    Rules rules;
    Sender robot;
    rules.set_tare(Eigen::Vector3d::Zero());
    const auto noisy = [every](long number) { return number < every ? 30.0 : renewed(every)(number); };
    EXPECT_THAT(robot.send(rules, 2 * every, noisy), IsNothing()) << every;
    const auto pressed = [every](long number) { return 30.0 + renewed(every)(number); };
    EXPECT_THAT(robot.send(rules, 3 * every, pressed), IsFault("more than force_stop allows", AllowedAction::retreat));
    EXPECT_GT(robot.taken(), 2 * every) << "three renewals, however often each was sent";
  }
}

TEST(AForce, ThatIsRenewedTooSeldomToBeSafeIsToldWithHowOften) {
  Rules rules;
  Sender robot;
  const std::optional<Fault> fault = robot.send(rules, 100, renewed(15));
  EXPECT_THAT(fault, IsFault("with a new force only 3 times in the last 0.5 s, 4 are needed", AllowedAction::hold));
}

TEST(AForce, ThatIsRenewedLessThanHalfAsOftenAsBeforeIsToldWithHowOften) {
  for (const auto& [before, after, needed] : {std::tuple{1, 5, 25}, {2, 5, 13}, {5, 14, 5}}) {
    Rules rules;
    Sender robot;
    ASSERT_THAT(robot.send(rules, 200, renewed(before)), IsNothing()) << before;
    const std::optional<Fault> fault = robot.send(rules, 60, renewed(after));
    EXPECT_THAT(fault, IsFault("with a new force only", AllowedAction::hold)) << before;
    EXPECT_THAT(fault, IsFault((std::to_string(needed) + " are needed").c_str(), AllowedAction::hold)) << before;
  }
}

TEST(AForce, ThatComesInBurstsIsCountedByTheMessageAndNotByTheLook) {
  // The driver sees the last of five messages that arrive at once; each has its own force.
  Rules rules;
  Sender robot(5);
  EXPECT_THAT(robot.send(rules, 300, renewed(1)), IsNothing());
}

/// Simulates an arm that rises by `step` m per period with a force `press` in newtons as a function of the period.
/// `sign`: see MotionGuard::RiseLimits.
std::optional<Fault> rising(double sign, const MotionGuard::RiseLimits& rise, const std::function<double(int)>& press,
                            double step = 0.001) {
  Rules rules;
  Sender robot;
  rules.expect_rise(rise);
  std::optional<Fault> fault;
  for (int period = 0; period < 200 && !fault; ++period) {
    rules.tip.z() = step * period;
    fault = robot.send(rules, [&](long number) { return rise.zero + sign * press(period) + renewed(1)(number); });
  }
  return fault;
}

TEST(AnArmThatGoesUp, IsHeldByWhatPullsAndByNothingElse) {
  for (const double sign : {-1.0, 1.0}) {
    const MotionGuard::RiseLimits rise{1.0, sign, 6.0};
    EXPECT_THAT(rising(sign, rise, [](int) { return 30.0; }), IsNothing()) << "it presses still";
    EXPECT_THAT(rising(sign, rise, [](int) { return -5.5; }), IsNothing()) << "its joints rub";
    EXPECT_THAT(rising(sign, rise, [](int period) { return period % 3 == 0 ? -5.0 : -9.0; }), IsNothing()) << "noise";
    EXPECT_THAT(
        rising(sign, rise, [](int period) { return 10.0 - 0.5 * period; }),
        AllOf(IsFault("the tool is caught: it is pulled with ", AllowedAction::hold),
              IsFault("at (10.0, 10.0, ", AllowedAction::hold), IsFault("free it by hand", AllowedAction::hold)));
  }
}

TEST(AnArmThatGoesUp, FollowsAZeroThatChangesWithThePoseAndNoSpring) {
  const MotionGuard::RiseLimits rise{1.0, -1.0, 6.0, MotionGuard::ZeroMode::follows};
  EXPECT_THAT(rising(-1.0, rise, [](int period) { return -0.05 * period; }), IsNothing()) << "5 N/s: 50 N/m at 10 cm/s";
  EXPECT_THAT(rising(-1.0, rise, [](int period) { return -0.5 * period; }),
              IsFault("the tool is caught", AllowedAction::hold));
  EXPECT_THAT(rising(
                  -1.0, rise, [](int period) { return -0.06 * period; }, 0.0002),
              IsFault("the tool is caught", AllowedAction::hold))
      << "300 N/m at 2 cm/s";
}

TEST(AReflex, OfAnArmThatGoesUpAndIsPulledIsToldAsThatAndHeld) {
  const auto reflex = [](double press, bool goes_up) {
    Rules rules;
    if (goes_up) rules.expect_rise(MotionGuard::RiseLimits{kZero.z(), -1.0, 14.0});
    return rules.at(1.0, [&](Snapshot& seen) {
      seen.endpoint->force.z() = kZero.z() - press;
      seen.collision->collision = true;
    });
  };
  EXPECT_THAT(reflex(-12.0, true), IsFault("the tool is caught: it is pulled with 12 N", AllowedAction::hold));
  EXPECT_TRUE(reflex(-12.0, true)->reflex);
  EXPECT_THAT(reflex(17.0, true), IsFault("the arm's own reflex", AllowedAction::retreat)) << "left pressing";
  EXPECT_THAT(reflex(-12.0, false), IsFault("the arm's own reflex", AllowedAction::retreat));
}

}  // namespace
}  // namespace palpate::baxter
