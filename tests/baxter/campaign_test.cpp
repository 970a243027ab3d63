// SPDX-License-Identifier: MIT
// What the driver promises with its shipped settings, on every arm of the tests: no contact that is none, none of a
// hundred lost, no more than the arm's own reflex allows. PALPATE_CAMPAIGN=TAPS taps so often on each arm instead of
// the few times of every day: tests/robot_campaign.sh.
#include "baxter/campaign.hpp"
#include "fake_baxter/mujoco.hpp"
#include "support/sanitizers.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace palpate::baxter {
namespace {

using fake_baxter::MechanicsOptions;
using test::campaign;
using test::Condition;
using test::Tally;
using Type = MechanicsOptions::Type;

constexpr double kStiffnesses[] = {1500, 10000, 20000, 100000};  // N/m
constexpr double kMostFriction = 0.4;                            // Nm
constexpr double kMostForce = 16.0;                              // N

std::string name_of(Type arm) {
  if (arm == Type::lagged) return "Lagged";
  return arm == Type::springs ? "Springs" : "Mujoco";
}

/// N/m from which on a tap must end safely, and no more. Joints without masses and springs press on by all of their
/// lag, however hard that is.
double hard_from(Type arm) { return arm == Type::lagged ? 5000 : 50000; }

/// The campaign's taps on an arm, or `daily`.
int taps_of(Type arm, int daily) {
  if (const char* taps = std::getenv("PALPATE_CAMPAIGN")) return std::atoi(taps);
  if (palpate::test::kSanitized) daily = std::max(6, daily / 8);
  return arm == Type::mujoco ? daily / 6 : daily;  // which takes seconds a tap
}

void report(const std::string& what, const Tally& tally) {
  fmt::print("{}: {}\n", what, test::in_words(tally));
  for (const auto& [reason, count] : tally.reasons) fmt::print("    {} times: {}\n", count, reason);
  std::fflush(stdout);
}

std::string name_of(const Condition& condition) {
  return fmt::format("{}, {:g} kN/m, {:.2f} Nm{}{}", name_of(condition.arm.type), condition.stiffness / 1000,
                     condition.arm.friction, condition.spikes ? ", spikes" : "", condition.stalls ? ", stalls" : "");
}

class Campaign : public testing::TestWithParam<Type> {
 protected:
  void SetUp() override {
    if (GetParam() == Type::mujoco && !fake_baxter::has_mujoco()) {
      GTEST_SKIP() << "MuJoCo is not installed: heading physics of packages.txt";
    }
  }
};

TEST_P(Campaign, HasNoPhantomsLosesNoContactsAndStaysBelowTheReflex) {
  // Each quarter of the taps on another object, each quarter of those without trouble, with either and with both;
  // friction goes around once more slowly.
  constexpr int kCells = 16;
  const int taps = std::max(1, (taps_of(GetParam(), 48) + kCells - 1) / kCells);
  Tally yielding;
  Tally hard;
  for (int cell = 0; cell < kCells; ++cell) {
    Condition condition;
    condition.arm.type = GetParam();
    condition.arm.friction = GetParam() == Type::lagged ? 0.0 : kMostFriction * ((cell * 7) % 5) / 4;
    condition.stiffness = kStiffnesses[cell / 4];
    condition.spikes = cell % 2 == 1;
    condition.stalls = cell % 4 >= 2;
    const Tally one = campaign(condition, taps, static_cast<std::uint64_t>(cell + 1));
    report(name_of(condition), one);
    (condition.stiffness > hard_from(GetParam()) ? hard : yielding).add(one);
  }
  report(name_of(GetParam()) + ", yielding", yielding);
  report(name_of(GetParam()) + ", hard", hard);
  EXPECT_EQ(yielding.phantoms, 0);
  EXPECT_LE(yielding.rejection(), 0.01);
  EXPECT_LE(yielding.peak, kMostForce);
  EXPECT_EQ(yielding.pressing, 0);
  EXPECT_EQ(hard.phantoms, 0);
  EXPECT_EQ(hard.pressing, 0) << "whatever ends a tap must end off the object";
  EXPECT_GT(yielding.touched, yielding.taps / 2);
}

TEST_P(Campaign, RunsThirtyTapsOnSoftAndOnHardThings) {
  const int taps = std::min(30, taps_of(GetParam(), 30));
  for (const double stiffness : kStiffnesses) {
    Condition condition;
    condition.arm.type = GetParam();
    condition.arm.friction = GetParam() == Type::lagged ? 0.0 : kMostFriction / 2;
    condition.stiffness = stiffness;
    const Tally tally = campaign(condition, taps, 100);
    report(name_of(condition), tally);
    EXPECT_EQ(tally.phantoms, 0);
    EXPECT_EQ(tally.pressing, 0);
    if (stiffness > hard_from(GetParam())) continue;
    EXPECT_EQ(tally.contacts, tally.taps);
    EXPECT_LE(tally.peak, kMostForce);
    EXPECT_LT(tally.error, 0.005);
  }
}

INSTANTIATE_TEST_SUITE_P(OnTheArm, Campaign, testing::Values(Type::lagged, Type::springs, Type::mujoco),
                         [](const auto& arm) { return name_of(arm.param); });

}  // namespace
}  // namespace palpate::baxter
