// SPDX-License-Identifier: MIT
// Whole runs on plugins/backends/process/ur.py over a stand-in for ur_rtde (tests/ur_rtde), whose arm moves over a dome
// of 6 cm in the middle of the area.
#include "children/arm_lock.hpp"
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <optional>

#include <unistd.h>

namespace palpate {
namespace {

using test::eventually;

class UrArm : public Shell {
 protected:
  UrArm() { fault(""); }

  static Words words(const std::string& python = "python3") {
    const std::string program = (test::source_folder() / "plugins/backends/process/ur.py").string();
    return Words{"run", config("process.yaml")} + "backend=ur initial.count=4 taps=8 --quiet" +
           Words{"backend.command=" + python + " '" + program + "' " + host() + " --corner 0.4 -0.1 0.05"};
  }
  /// An address of this process alone: arms are locked for the whole machine.
  static std::string host() { return "stub-" + std::to_string(::getpid()); }
  void fault(const std::string& what) {
    environment_ = {"PYTHONPATH=" + (test::source_folder() / "tests/ur_rtde").string(), "PYTHONDONTWRITEBYTECODE=1",
                    "UR_LOG=" + log_file().string(), "UR_FAULT=" + what};
  }
  Ended run_with(const std::string& what) {
    fault(what);
    return palpate(words());
  }

  fs::path log_file() const { return here() / "arm.txt"; }
  std::string log() const { return fs::exists(log_file()) ? text_of(log_file()) : ""; }
  std::string record() const { return part_of(directory(), "tap"); }
  std::vector<Cells> taps() const { return csv_rows(text_of(directory() / "taps.csv")); }

  int noted(const std::string& what) const {
    const std::vector<std::string> all = lines_of(log());
    return static_cast<int>(std::count(all.begin(), all.end(), what));
  }

  /// That a tap is what the dome gives it, within what the step of the stand-in, 40 um, makes of its stiffness.
  static void expect_on_the_dome(const Cells& tap) {
    const double x = std::stod(tap.at("x"));
    const double away = std::hypot(x - 0.115, std::stod(tap.at("y")) - 0.115);
    if (x >= 0.95 * 0.23) {
      EXPECT_EQ(tap.at("outcome"), "unreachable");
      return;
    }
    ASSERT_EQ(tap.at("outcome"), "contact");
    EXPECT_NEAR(std::stod(tap.at("height")), std::sqrt(std::max(0.0, 0.0036 - away * away)), 1e-4);
    EXPECT_NEAR(std::stod(tap.at("force")), 8.0, 0.3);
  }
};

TEST_F(UrArm, TapsTheDomeAndLeavesTheRobotInOrder) {
  const Ended ended = run_with("");
  ASSERT_EQ(ended.status, 0) << ended.err;
  ASSERT_EQ(taps().size(), 8U);
  for (const Cells& tap : taps()) expect_on_the_dome(tap);
  EXPECT_THAT(log(), StartsWith("connected\ndown\nstop\ndown\nstop\n"));
  EXPECT_THAT(log(), EndsWith("script stopped\ndisconnected\nreceive disconnected\n"));
  EXPECT_EQ(text_of(directory() / "process.stderr.txt"),
            "as ur_rtde does, this prints on stdout\n"
            "the TCP is at 0.0, 0.0, 150.0 mm from the flange; the speed slider stands at 100 %\n");
}

TEST_F(UrArm, ThatAnotherProcessHasInHandIsNotMoved) {
  std::optional<ArmLock> other;
  other.emplace("backend", "UR " + host());
  const Ended ended = run_with("");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err,
              StartsWith("backend/process: the arm UR " + host() + " is used by process " + std::to_string(::getpid()) +
                         "; wait until that process has ended, or end it, then run 'palpate resume"));
  EXPECT_EQ(log(), "") << "nobody has even connected";
  other.reset();
  EXPECT_EQ(palpate({"resume", directory().string(), "--retry-failed", "--quiet"}).status, 0);
}

TEST_F(UrArm, NoisySamplesOfItsSpeedDoNotKeepItFromComingToRest) {
  const Ended ended = run_with("noisy");
  ASSERT_EQ(ended.status, 0) << ended.err;
  for (const Cells& tap : taps()) expect_on_the_dome(tap);
}

TEST_F(UrArm, WhoseTcpIsItsFlangeIsNotMoved) {
  const Ended ended = run_with("flange");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, StartsWith("backend/process: the robot's TCP is its flange: set that of the tool"));
  EXPECT_EQ(log(), "connected\nscript stopped\ndisconnected\nreceive disconnected\n");
}

TEST_F(UrArm, ThatStandsHighAboveTheAreaMakesItsFirstWayNoFasterThanADescent) {
  ASSERT_EQ(run_with("high").status, 0);
  EXPECT_EQ(noted("fast approach"), 0);
  for (const Cells& tap : taps()) expect_on_the_dome(tap);
}

TEST_F(UrArm, MovesNeverWithoutAWatchdogThoughUrRtdeReconnectsByItself) {
  ASSERT_EQ(run_with("reconnect@2").status, 0);
  EXPECT_EQ(noted("reconnected"), 1);
  EXPECT_EQ(noted("unguarded move"), 0);
  EXPECT_EQ(taps()[1].at("outcome"), "timeout");
  EXPECT_THAT(record(), HasSubstr("no contact within 60 s; the speed slider stands at 100 %, the arm was raised"));
}

TEST_F(UrArm, AKickThatIsRefusedBetweenTwoTapsEndsTheRunBeforeTheNextMove) {
  const Ended ended = run_with("idle@3");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, StartsWith("backend/process: ur_rtde's script no longer runs on the robot"));
  EXPECT_EQ(noted("kick refused"), 1);
  EXPECT_EQ(noted("down"), 3);
  EXPECT_EQ(taps().size(), 4U);
}

TEST_F(UrArm, WhoseCableIsPulledBetweenTwoTapsIsAskedNothing) {
  const Ended ended = run_with("idle_cable@3");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, StartsWith("backend/process: no new state from the robot for 0.2 s: check the cable"));
  EXPECT_EQ(noted("waits for an answer"), 0) << "300 s, in which it hears no signal";
  EXPECT_EQ(noted("down"), 3);
  EXPECT_EQ(taps().size(), 4U);
}

TEST_F(UrArm, OneReadingThatSpikesIsNoContact) {
  ASSERT_EQ(run_with("spike@2").status, 0);
  for (const Cells& tap : taps()) expect_on_the_dome(tap);
}

TEST_F(UrArm, WithoutAContactTheFloorEndsTheWayDown) {
  ASSERT_EQ(run_with("missing@2").status, 0);
  EXPECT_EQ(taps()[1].at("outcome"), "no_contact");
  EXPECT_THAT(record(), HasSubstr("no contact down to 10 mm below the desk"));
}

TEST_F(UrArm, AContactAfterWhichTheForceStaysIsNotBelieved) {
  ASSERT_EQ(run_with("sticky@2").status, 0);
  EXPECT_EQ(taps()[1].at("outcome"), "aborted");
  EXPECT_THAT(record(), HasSubstr("5.0 N remained after the tap"));
}

TEST_F(UrArm, ThatIsNotSwitchedOnIsNotMovedNorConnectedTo) {
  const Ended ended = run_with("mode");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, StartsWith("backend/process: robot mode 3, not running: switch on"));
  EXPECT_EQ(noted("connected"), 0);
}

TEST_F(UrArm, WithoutUrRtdeSaysSo) {
  // Python that knows the standard library alone.
  EXPECT_THAT(refused(words("python3 -SE"), 1),
              StartsWith("backend/process: No module named 'rtde_control': install ur_rtde for "));
}

struct Trouble {
  const char* kind;
  const char* words;
};

class UrArmInTrouble : public UrArm, public testing::WithParamInterface<Trouble> {};

TEST_P(UrArmInTrouble, EndsTheRunWithAReasonAndResumeGoesOnBehindIt) {
  const Ended ended = run_with(std::string(GetParam().kind) + "@3");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, StartsWith("backend/process: "));
  EXPECT_THAT(ended.err, HasSubstr(GetParam().words));
  EXPECT_THAT(ended.err, HasSubstr("then run 'palpate resume --retry-failed'"));
  EXPECT_EQ(lines(ended.err), 1);
  EXPECT_EQ(noted("down"), 3);
  EXPECT_LE(noted("stop"), 3) << "a way that is stopped is not stopped again";
  EXPECT_THAT(text_of(directory() / "summary.json"), HasSubstr("\"status\": \"failed\""));
  const std::string before = record();
  const std::size_t failed = taps().size();
  EXPECT_EQ(taps().back().at("outcome"), "aborted");

  fault("");
  const Ended resumed = resume(directory(), "--retry-failed");
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(record(), StartsWith(before));
  const std::vector<Cells> all = taps();
  ASSERT_EQ(all.size(), 8U);
  int descents = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].at("tap"), std::to_string(i + 1));
    if (i + 1 != failed) expect_on_the_dome(all[i]);
    descents += all[i].at("outcome") == "unreachable" ? 0 : 1;
  }
  EXPECT_EQ(noted("down"), descents) << "each place once";
}

INSTANTIATE_TEST_SUITE_P(By, UrArmInTrouble,
                         testing::Values(Trouble{"protective", "protective stop: free the arm if it presses"},
                                         Trouble{"emergency", "emergency stop: release the button"},
                                         Trouble{"lost", "unable to get state data"},
                                         Trouble{"frozen", "no new state from the robot for 0.2 s"},
                                         Trouble{"cable", "no new state from the robot for 0.2 s"},
                                         Trouble{"restless", "the arm still moves 1 s after its stop"},
                                         Trouble{"script", "ur_rtde's script no longer runs on the robot"},
                                         Trouble{"pushed", "the arm is pushed with 50 N"}),
                         [](const auto& one) { return std::string(one.param.kind); });

class UrArmOnItsWayDown : public UrArm, public testing::WithParamInterface<int> {};

TEST_P(UrArmOnItsWayDown, IsStoppedWhenItsRunIsGone) {
  fault("slow@2");
  const auto child = begin(words());
  ASSERT_TRUE(eventually([&] { return noted("down") == 2; })) << child->err();
  child->signal(GetParam());
  EXPECT_EQ(child->wait().status, GetParam() == SIGINT ? 130 : 128 + GetParam());
  EXPECT_TRUE(eventually([&] { return noted("receive disconnected") == 1; }));
  EXPECT_THAT(log(), EndsWith("down\nstop\nscript stopped\ndisconnected\nreceive disconnected\n"));
}

INSTANTIATE_TEST_SUITE_P(By, UrArmOnItsWayDown, testing::Values(SIGKILL, SIGINT),
                         [](const auto& one) { return one.param == SIGINT ? "CtrlC" : "Kill"; });

}  // namespace
}  // namespace palpate
