// SPDX-License-Identifier: MIT
// Records descents of the robot of the tests under what is dangerous, with the verdict that follows from the truth;
// with PALPATE_WRITE_TRACES=FOLDER into files there, as tests/data/guarded_taps holds them.
#include "support/tap_trace.hpp"
#include "baxter/body_bench.hpp"
#include "baxter/campaign.hpp"
#include "support/filled.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace palpate::baxter {
namespace {

using fake_baxter::FaultKind;
using palpate::test::TapTrace;

struct Case {
  const char* name;
  const char* what;
  double stiffness;  ///< of the object, N/m
  std::vector<fake_baxter::Fault> faults;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"hard", "something hard, 50 kN/m", 50000, {}},
      {"soft", "something soft, 1 kN/m: a set-point put where the arm is relaxes its springs", 1000, {}},
      {"late_and_filtered",
       "messages take 40 ms, the force is filtered with 100 ms",
       20000,
       {{FaultKind::delay, 0.04, {}}, {FaultKind::wrench_filter, 0.1, {}}}},
      {"jitter", "messages take up to 70 ms", 20000, {{FaultKind::jitter, 0.07, {}}}},
      {"zero_rises",
       "the zero of the force rises by 50 N/m on the way down",
       20000,
       {{FaultKind::force_drift, 50.0, {}}}},
      {"zero_falls",
       "the zero of the force falls by 50 N/m on the way down",
       20000,
       {{FaultKind::force_drift, -50.0, {}}}},
      {"spikes",
       "of the readings of the force one in a hundred is 9 N too high",
       20000,
       {{FaultKind::spikes, 0.01, {}}}},
  };
  return all;
}

constexpr Target kPlace{0.03, 0.03};  // of the bare desk
constexpr double kTared = 0.6;        // s of rest before the descent that are kept
constexpr double kAfter = 0.5;        // s after the stop
constexpr double kGoesOn = 0.07;      // s for which joints that are stopped go on
constexpr double kLimit = 16.0;       // N

/// The second tap on the bare desk at a place: the first shows the driver what robot it has.
TapTrace record(const Case& one) {
  const auto scene =
      palpate::test::scene_of(palpate::test::kBare, fmt::format("{{stiffness: {{object: {} N/m}}}}", one.stiffness));
  const BaxterOptions& options = test::shipped_options();
  test::BodyOptions body = test::body_options(options);
  body.mechanics.type = fake_baxter::MechanicsOptions::Type::springs;
  test::BodyRobot robot(*scene, body);
  for (const fake_baxter::Fault& fault : one.faults) robot.body.inject(fault);
  Tapper tapper(options, *scene, robot, nullptr, [](const std::string&) {});
  const Arm arm(Eigen::Map<const Eigen::Vector3d>(options.tool.tip));
  const Eigen::Isometry3d to_scene = options.place.frame().inverse();
  std::vector<TapTrace::Row> rows;
  double touched = -1.0;
  robot.every_period = [&] {
    const Snapshot seen = robot.read();
    const double height = (to_scene * arm.tip(seen.joints->position).position).z();
    rows.push_back({robot.body.now(), height, -seen.endpoint->force.z()});
    if (touched < 0.0 && robot.body.pressing() > 0.0) touched = robot.body.now();
  };
  TapRequest request;
  for (request.number = 1; request.number <= 2; ++request.number) {
    request.previous = request.target = Target{kPlace.x + 0.03 * (2 - request.number), kPlace.y};
    rows.clear();
    touched = -1.0;
    EXPECT_EQ(tapper.tap(request).outcome, Outcome::contact) << one.name;
  }
  // The descent ends where the arm was lowest; before it the arm rested.
  const auto lower = [](const TapTrace::Row& a, const TapTrace::Row& b) { return a.height < b.height; };
  const auto lowest = std::min_element(rows.begin(), rows.end(), lower);
  const double top = options.motion.hover;
  auto begin = lowest;
  while (begin != rows.begin() && begin->height < top - 0.0002) --begin;
  const double sank = begin->time;
  while (begin != rows.begin() && begin->time > sank - kTared) --begin;
  TapTrace out;
  out.what = one.what;
  out.not_before = touched - begin->time;
  for (auto it = begin; it != rows.end() && it->time < lowest->time + kAfter; ++it) {
    out.rows.push_back({it->time - begin->time, it->height, it->force});
  }
  // As fast as it came down in the second before the touch.
  const auto at = [&](double time) {
    return std::find_if(rows.begin(), rows.end(), [=](const auto& row) { return row.time >= time; })->height;
  };
  const double speed = at(touched - 1.0) - at(touched);
  const double springs = arm.vertical_stiffness(robot.body.joints());
  const double stiffness = springs * one.stiffness / (springs + one.stiffness);
  const double delay = one.faults.empty() || one.faults[0].kind != FaultKind::delay ? 0.0 : one.faults[0].amount;
  out.by = out.not_before + kLimit / (stiffness * speed) - 2.0 * delay - kGoesOn;
  out.motion = fmt::format("{{type: continuous, speed: {:.1f} mm/s, threshold: 5 N, tare: 500 ms, hover: 13.5 cm}}",
                           1e3 * speed);
  out.height = 0.0;
  out.tolerance = 0.003;
  return out;
}

TEST(TapTraces, OfTheRobotOfTheTestsAreDecidedAsTheTruthSays) {
  for (const Case& one : cases()) {
    const TapTrace trace = record(one);
    if (const char* folder = std::getenv("PALPATE_WRITE_TRACES")) {
      write_trace(trace, std::filesystem::path(folder) / (std::string(one.name) + ".csv"));
    }
    SCOPED_TRACE(one.what);
    const auto motion = palpate::test::filled<tapping::MotionOptions>(trace.motion);
    tapping::GuardedTap tap(motion, tapping::plan_descent(motion, 0.0, {}), tapping::GuardedTap::Arm::real);
    double stopped = -1.0;
    for (const TapTrace::Row& row : trace.rows) {
      if (tap.done()) break;
      const int before = tap.noticed();
      tap.next(row.height, row.force);
      if (tap.noticed() > before) stopped = row.time;
    }
    EXPECT_EQ(tap.result().outcome, Outcome::contact) << tap.result().reason;
    EXPECT_GE(stopped, trace.not_before);
    EXPECT_LE(stopped, trace.by);
    EXPECT_NEAR(tap.result().height, trace.height, trace.tolerance);
  }
}

}  // namespace
}  // namespace palpate::baxter
