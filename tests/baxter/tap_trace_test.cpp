// SPDX-License-Identifier: MIT
// Records descents of the simulated robot under dangerous conditions, with the verdict from the truth.
// PALPATE_WRITE_TRACES=FOLDER writes them as in tests/data/guarded_taps.
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
  double stiffness;  ///< N/m, object
  std::vector<fake_baxter::Fault> faults;
  TapTrace::Verdict verdict = TapTrace::Verdict::contact;
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
      {"nothing",
       "nothing is there down to the floor, while the zero of the force rises by 50 N/m and one reading in a hundred "
       "is "
       "9 N too high",
       20000,
       {{FaultKind::force_drift, 50.0, {}}, {FaultKind::spikes, 0.01, {}}},
       TapTrace::Verdict::no_contact},
  };
  return all;
}

constexpr Target kPlace{0.03, 0.03};  // on the bare desk
constexpr double kTared = 0.6;        // s of rest before the descent that are recorded
constexpr double kAfter = 0.5;        // s after the stop that are recorded
constexpr double kDeeper = 0.05;      // m by which the desk is lower than expected in tests without a contact
constexpr double kGoesOn = 0.07;      // s for which stopped joints move on
constexpr double kLimit = 16.0;       // N

using Rows = std::vector<TapTrace::Row>;

/// A tap of a robot, with the truth.
struct RecordedTap {
  Rows rows;
  double touched = -1.0;  ///< s, first contact force; -1 without one
  double springs = 0.0;   ///< N/m, vertical stiffness of the arm at the end
};

/// Records the second tap on the bare desk at a position, because the first shows the driver the robot's properties.
RecordedTap second_tap(const Case& one, const BaxterOptions& options, bool contact) {
  const auto scene =
      palpate::test::scene_of(palpate::test::kBare, fmt::format("{{stiffness: {{object: {} N/m}}}}", one.stiffness));
  test::BodyOptions body = test::body_options(test::shipped_options());
  body.mechanics.type = fake_baxter::MechanicsOptions::Type::springs;
  test::BodyRobot robot(*scene, body);
  for (const fake_baxter::Fault& fault : one.faults) robot.body.inject(fault);
  Tapper tapper(options, *scene, robot, nullptr, [](const std::string&) {});
  const ArmKinematics arm(Eigen::Map<const Eigen::Vector3d>(options.tool.tip));
  const Eigen::Isometry3d to_scene = options.scene_pose.frame().inverse();
  RecordedTap out;
  robot.every_period = [&] {
    const Snapshot seen = robot.read();
    const double height = (to_scene * arm.tip(seen.joints->position).position).z();
    out.rows.push_back({robot.body.now(), height, -seen.endpoint->force.z(), 0});
    if (out.touched < 0.0 && robot.body.pressing() > 0.0) out.touched = robot.body.now();
  };
  TapRequest request;
  for (request.number = 1; request.number <= 2; ++request.number) {
    request.line = line_from_above({kPlace.x + 0.03 * (2 - request.number), kPlace.y});
    request.previous = request.line;
    out.rows.clear();
    out.touched = -1.0;
    EXPECT_EQ(tapper.tap(request).outcome, contact ? Outcome::contact : Outcome::no_contact) << one.name;
  }
  out.springs = arm.vertical_stiffness(robot.body.joints());
  return out;
}

/// Returns the first row of the rest before the descent that ends at `lowest`.
Rows::const_iterator begin_of_rest(const Rows& rows, Rows::const_iterator lowest, double top) {
  auto begin = lowest;
  while (begin != rows.begin() && begin->height < top - 0.0002) --begin;
  const double sank = begin->time;
  while (begin != rows.begin() && begin->time > sank - kTared) --begin;
  return begin;
}

/// Records a case with its verdict.
TapTrace record(const Case& one) {
  const bool contact = one.verdict == TapTrace::Verdict::contact;
  BaxterOptions options = test::shipped_options();
  if (!contact) options.scene_pose.height += kDeeper;
  const RecordedTap tap = second_tap(one, options, contact);
  const Rows& rows = tap.rows;
  // The descent ends at the lowest position of the arm.
  const auto lower = [](const TapTrace::Row& a, const TapTrace::Row& b) { return a.height < b.height; };
  const auto lowest = std::min_element(rows.begin(), rows.end(), lower);
  const auto begin = begin_of_rest(rows, lowest, options.motion.hover);
  TapTrace out;
  out.what = one.what;
  out.verdict = one.verdict;
  out.not_before = tap.touched - begin->time;
  for (auto it = begin; it != rows.end() && it->time < lowest->time + kAfter; ++it) {
    out.rows.push_back({it->time - begin->time, it->height, it->force, 0});
  }
  const auto at = [&](double time) {
    return std::find_if(rows.begin(), rows.end(), [=](const auto& row) { return row.time >= time; })->height;
  };
  // Speed in the second before the touch, or two seconds before the end.
  const double late = contact ? tap.touched : lowest->time - 2.0;
  const double speed = at(late - 1.0) - at(late);
  const double stiffness = tap.springs * one.stiffness / (tap.springs + one.stiffness);
  const double delay = one.faults.empty() || one.faults[0].kind != FaultKind::delay ? 0.0 : one.faults[0].amount;
  out.by = out.not_before + kLimit / (stiffness * speed) - 2.0 * delay - kGoesOn;
  out.motion = fmt::format(
      "{{type: continuous, speed: {:.1f} mm/s, threshold: 5 N, tare: 500 ms, hover: 13.5 cm, overrun: 2 cm}}",
      1e3 * speed);
  if (!contact) {
    // Not before the tip is within 2 mm of the floor, and before it rises.
    const double floor = -options.motion.overrun;
    const auto near = [=](const TapTrace::Row& row) { return row.height < floor + 0.002; };
    out.not_before = std::find_if(begin, rows.end(), near)->time - begin->time;
    out.by = out.rows.back().time;
  }
  out.height = 0.0;
  out.tolerance = 0.003;
  return out;
}

/// Messages of the robot per period during one tap on the bare, hard desk with this fault, and the truth.
struct Watched {
  std::vector<TapTrace::Row> rows;
  std::vector<double> published;  ///< N, published by the robot itself
  std::vector<double> pressing;   ///< N, true; negative for a pull
  std::vector<bool> faulty;       ///< whether the fault has begun
  tapping::HeightResult contact;
  double stopped = 0.0;  ///< s, time of the last new set-point
};

Watched watch_tap(const fake_baxter::Fault& fault, const fake_baxter::Trigger& trigger) {
  const auto scene = palpate::test::scene_of(palpate::test::kBare, "{stiffness: {object: 20000 N/m}}");
  const BaxterOptions& options = test::shipped_options();
  test::BodyOptions body = test::body_options(options);
  body.mechanics.type = fake_baxter::MechanicsOptions::Type::springs;
  test::BodyRobot robot(*scene, body);
  robot.body.inject(fault, trigger);
  Tapper tapper(options, *scene, robot, nullptr, [](const std::string&) {});
  const ArmKinematics arm(Eigen::Map<const Eigen::Vector3d>(options.tool.tip));
  const Eigen::Isometry3d to_scene = options.scene_pose.frame().inverse();
  Watched out;
  robot.every_period = [&] {
    const Snapshot seen = robot.read();
    const double height = (to_scene * arm.tip(seen.joints->position).position).z();
    out.rows.push_back({robot.body.now(), height, -seen.endpoint->force.z(), 0});
    out.published.push_back(-robot.body.messages().endpoint->force.z());
    out.pressing.push_back(robot.body.pressing());
    out.faulty.push_back(robot.body.active(fault.kind) != nullptr);
  };
  TapRequest request;
  request.number = 1;
  request.line = line_from_above(kPlace);
  out.contact = tapper.tap(request);
  EXPECT_EQ(out.contact.outcome, Outcome::aborted) << out.contact.reason;
  std::size_t last = robot.commands.size() - 1;
  while (last > 0 && robot.commands[last - 1] == robot.commands.back()) --last;
  out.stopped = robot.commanded[last];
  return out;
}

/// Copies the rows from `before` seconds before row `begin` to `after` seconds after row `end`, with times starting at
/// 0.
std::size_t cut(TapTrace& trace, const Watched& watched, std::size_t begin, double before, std::size_t end,
                double after) {
  const auto period = tapping::GuardedTap::kPeriod;
  const std::size_t first = begin - std::min(begin, static_cast<std::size_t>(before / period));
  const std::size_t last = std::min(watched.rows.size(), end + static_cast<std::size_t>(after / period));
  for (std::size_t i = first; i < last; ++i) {
    const TapTrace::Row& row = watched.rows[i];
    const double time = row.time - watched.rows[first].time;
    const bool second = watched.published[i] != row.force;
    trace.rows.push_back({time, row.height, watched.published[i], 0});
    if (second) trace.rows.push_back({time, row.height, row.force, 1});
  }
  return first;
}

/// Expects that the driver stopped the motion within the times of the verdict.
void expect_in_time(const TapTrace& trace, const Watched& watched, std::size_t first) {
  const double stopped = watched.stopped - watched.rows[first].time;
  EXPECT_GE(stopped, trace.not_before) << trace.what;
  EXPECT_LE(stopped, trace.by) << trace.what;
}

std::size_t begin_of(const Watched& watched) {
  const auto found = std::find(watched.faulty.begin(), watched.faulty.end(), true);
  return static_cast<std::size_t>(found - watched.faulty.begin());
}

/// Records a fault that begins just above a hard desk and must be noticed within `noticed` seconds.
TapTrace record_fault(const Watched& watched, const char* what, double noticed) {
  TapTrace out;
  out.what = what;
  out.verdict = TapTrace::Verdict::fault;
  const std::size_t begins = begin_of(watched);
  const std::size_t first = cut(out, watched, begins, 2.0, begins, 0.7);
  out.not_before = watched.rows[begins].time - watched.rows[first].time;
  out.by = out.not_before + noticed;
  expect_in_time(out, watched, first);
  return out;
}

/// Records a force that is constant to the last digit from just above a hard desk on, while messages continue.
TapTrace record_frozen() {
  return record_fault(watch_tap({FaultKind::freeze_endpoint, 0.0, {}}, {1, 0.0002}),
                      "the force is frozen just above a hard desk, its messages go on", 0.15);
}

/// Records a second node without forces that sends after each message of the robot.
TapTrace record_second_sender() {
  return record_fault(watch_tap({FaultKind::second_sender, 0.0, "endpoint"}, {1, 0.0002}),
                      "from just above a hard desk on another node sends a calm force after each message of the robot",
                      0.5);
}

/// Records a rise while the tool is caught.
TapTrace record_caught() {
  const Watched watched = watch_tap({FaultKind::caught, 3000.0, {}}, {});
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
  expect_in_time(out, watched, first);
  return out;
}

/// Expects that the stored file equals the recorded trace to its precision. With PALPATE_WRITE_TRACES it is written.
void expect_stored(const TapTrace& trace, const std::string& name) {
  if (const char* folder = std::getenv("PALPATE_WRITE_TRACES")) {
    return write_trace(trace, std::filesystem::path(folder) / (name + ".csv"));
  }
  SCOPED_TRACE(name + ".csv, to be recorded again if the robot of the tests has changed");
  const TapTrace stored =
      palpate::test::read_trace(palpate::test::source_folder() / "tests/data/guarded_taps" / (name + ".csv"));
  EXPECT_EQ(stored.verdict, trace.verdict);
  EXPECT_NEAR(stored.not_before, trace.not_before, 0.011);
  EXPECT_NEAR(stored.by, trace.by, 0.011);
  ASSERT_EQ(stored.rows.size(), trace.rows.size());
  for (std::size_t i = 0; i < trace.rows.size(); ++i) {
    ASSERT_NEAR(stored.rows[i].height, trace.rows[i].height, 2e-5) << "row " << i;
    ASSERT_NEAR(stored.rows[i].force, trace.rows[i].force, 0.02) << "row " << i;
    ASSERT_EQ(stored.rows[i].sender, trace.rows[i].sender) << "row " << i;
  }
}

TEST(TapTraces, WithAFaultAreStoppedByTheDriverInTime) {
  expect_stored(record_frozen(), "frozen");
  expect_stored(record_second_sender(), "second_sender");
  expect_stored(record_caught(), "caught");
  int faults = 0;
  for (const std::filesystem::path& file : palpate::test::recorded_traces()) {
    const TapTrace trace = palpate::test::read_trace(file);
    if (trace.verdict != TapTrace::Verdict::fault) continue;
    ++faults;
    EXPECT_GT(trace.not_before, trace.rows.front().time) << file;
    EXPECT_GT(trace.by, trace.not_before) << file;
    EXPECT_LT(trace.not_before, trace.rows.back().time) << file;
  }
  EXPECT_EQ(faults, 3);
}

TEST(TapTraces, OfTheRobotOfTheTestsAreDecidedAsTheTruthSays) {
  for (const Case& one : cases()) {
    const TapTrace trace = record(one);
    SCOPED_TRACE(one.what);
    expect_stored(trace, one.name);
    const auto motion = palpate::test::filled<tapping::MotionOptions>(trace.motion);
    tapping::GuardedTap tap(motion, tapping::plan_descent(motion, 0.0, {}), tapping::GuardedTap::ArmKind::real);
    double stopped = -1.0;
    for (const TapTrace::Row& row : trace.rows) {
      if (tap.done()) break;
      const int before = tap.noticed();
      tap.next(row.height, row.force);
      if (tap.noticed() > before || (tap.done() && one.verdict == TapTrace::Verdict::no_contact)) stopped = row.time;
    }
    const bool contact = one.verdict == TapTrace::Verdict::contact;
    EXPECT_EQ(tap.result().outcome, contact ? Outcome::contact : Outcome::no_contact) << tap.result().reason;
    EXPECT_GE(stopped, trace.not_before);
    EXPECT_LE(stopped, trace.by);
    if (contact) {
      EXPECT_NEAR(tap.result().height, trace.height, trace.tolerance);
    }
  }
}

}  // namespace
}  // namespace palpate::baxter
