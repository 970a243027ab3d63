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

/// What the robot says, period by period, during one tap on the bare, hard desk with this fault; the truth beside it.
struct Watched {
  std::vector<TapTrace::Row> rows;
  std::vector<double> pressing;  ///< N, true; negative where something pulls
  std::vector<bool> faulty;      ///< whether the fault has begun
  Contact contact;
};

Watched watch_tap(const fake_baxter::Fault& fault, const fake_baxter::Trigger& trigger) {
  const auto scene = palpate::test::scene_of(palpate::test::kBare, "{stiffness: {object: 20000 N/m}}");
  const BaxterOptions& options = test::shipped_options();
  test::BodyOptions body = test::body_options(options);
  body.mechanics.type = fake_baxter::MechanicsOptions::Type::springs;
  test::BodyRobot robot(*scene, body);
  robot.body.inject(fault, trigger);
  Tapper tapper(options, *scene, robot, nullptr, [](const std::string&) {});
  const Arm arm(Eigen::Map<const Eigen::Vector3d>(options.tool.tip));
  const Eigen::Isometry3d to_scene = options.place.frame().inverse();
  Watched out;
  robot.every_period = [&] {
    const Snapshot seen = robot.read();
    const double height = (to_scene * arm.tip(seen.joints->position).position).z();
    out.rows.push_back({robot.body.now(), height, -seen.endpoint->force.z()});
    out.pressing.push_back(robot.body.pressing());
    out.faulty.push_back(robot.body.active(fault.kind) != nullptr);
  };
  TapRequest request;
  request.number = 1;
  request.target = kPlace;
  out.contact = tapper.tap(request);
  return out;
}

/// The rows from `before` seconds before row `begin` to `after` seconds after row `end`, their times from 0 on.
std::size_t cut(TapTrace& trace, const Watched& watched, std::size_t begin, double before, std::size_t end,
                double after) {
  const auto period = tapping::GuardedTap::kPeriod;
  const std::size_t first = begin - std::min(begin, static_cast<std::size_t>(before / period));
  const std::size_t last = std::min(watched.rows.size(), end + static_cast<std::size_t>(after / period));
  for (std::size_t i = first; i < last; ++i) {
    const TapTrace::Row& row = watched.rows[i];
    trace.rows.push_back({row.time - watched.rows[first].time, row.height, row.force});
  }
  return first;
}

/// The force stays the same to the last digit, though messages go on, from just above a hard desk on.
TapTrace record_frozen() {
  const Watched watched = watch_tap({FaultKind::freeze_endpoint, 0.0, {}}, {1, 0.0002});
  EXPECT_EQ(watched.contact.outcome, Outcome::aborted) << watched.contact.reason;
  TapTrace out;
  out.what = "the force is frozen just above a hard desk, its messages go on";
  out.verdict = TapTrace::Verdict::fault;
  const auto frozen =
      static_cast<std::size_t>(std::find(watched.faulty.begin(), watched.faulty.end(), true) - watched.faulty.begin());
  const std::size_t first = cut(out, watched, frozen, 2.0, frozen, 0.5);
  out.not_before = watched.rows[frozen].time - watched.rows[first].time;
  out.by = out.not_before + 0.15;
  return out;
}

/// The tool hangs on to what it touched, and the arm goes up.
TapTrace record_caught() {
  const Watched watched = watch_tap({FaultKind::caught, 3000.0, {}}, {});
  EXPECT_EQ(watched.contact.outcome, Outcome::aborted) << watched.contact.reason;
  TapTrace out;
  out.what = "the tool hangs on to what it touched by a spring of 3 kN/m while the arm goes up";
  out.verdict = TapTrace::Verdict::fault;
  const auto pulls = [&](double force) {
    const auto found =
        std::find_if(watched.pressing.begin(), watched.pressing.end(), [=](double one) { return one < -force; });
    return static_cast<std::size_t>(found - watched.pressing.begin());
  };
  const std::size_t begins = pulls(0.0);
  const std::size_t grows = pulls(4.0);
  const std::size_t first = cut(out, watched, begins, 3.0, grows, 0.7);
  const double rate = 4.0 / (watched.rows[grows].time - watched.rows[begins].time);  // N/s
  out.not_before = watched.rows[begins].time - watched.rows[first].time;
  out.by = out.not_before + kLimit / rate;
  return out;
}

/// When the rules of the driver stop a motion that goes as the rows say, s; nothing if they do not.
std::optional<double> stopped_by_rules(const TapTrace& trace) {
  Watch watch({0.23, 0.23, -0.05, 0.5}, test::shipped_options().force_stop);
  const Joints joints = test::PlannerBench().at(0.1, 0.1, 0.1);
  std::optional<EndpointReading> latest;
  double zero = 0.0;
  constexpr int kRest = 50;
  for (int i = 0; i < kRest; ++i) zero -= trace.rows[static_cast<std::size_t>(i)].force / kRest;
  watch.set_tare({0.0, 0.0, zero});
  double lowest = 1.0;
  bool rises = false;
  for (const TapTrace::Row& row : trace.rows) {
    lowest = std::min(lowest, row.height);
    if (!rises && row.height > lowest + 0.0005) {
      rises = true;
      watch.forget_tare();
      watch.expect_rise(Watch::Rise{zero, -1.0, 6.0});
    }
    Snapshot seen = test::sound(100.0 + row.time, joints);
    EndpointReading reading = *seen.endpoint;
    reading.force = {0.0, 0.0, -row.force};
    count_after(latest, reading);
    seen.endpoint = latest = reading;
    if (watch.look(seen, {0.1, 0.1, 0.1})) return row.time;
  }
  return std::nullopt;
}

void save(const TapTrace& trace, const std::string& name) {
  if (const char* folder = std::getenv("PALPATE_WRITE_TRACES")) {
    write_trace(trace, std::filesystem::path(folder) / (name + ".csv"));
  }
}

TEST(TapTraces, WithAFaultAreStoppedByTheRulesInTime) {
  save(record_frozen(), "frozen");
  save(record_caught(), "caught");
  int faults = 0;
  for (const std::filesystem::path& file : palpate::test::recorded_traces()) {
    const TapTrace trace = palpate::test::read_trace(file);
    if (trace.verdict != TapTrace::Verdict::fault) continue;
    ++faults;
    SCOPED_TRACE(file.filename().string() + ": " + trace.what);
    const std::optional<double> stopped = stopped_by_rules(trace);
    ASSERT_TRUE(stopped) << "nothing stops it";
    EXPECT_GE(*stopped, trace.not_before);
    EXPECT_LE(*stopped, trace.by);
  }
  EXPECT_EQ(faults, 2);
}

TEST(TapTraces, OfTheRobotOfTheTestsAreDecidedAsTheTruthSays) {
  for (const Case& one : cases()) {
    const TapTrace trace = record(one);
    save(trace, one.name);
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
