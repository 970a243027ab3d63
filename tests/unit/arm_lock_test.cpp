// SPDX-License-Identifier: MIT
#include "children/arm_lock.hpp"

#include "support/programs.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include <sys/wait.h>
#include <unistd.h>

namespace palpate::test {
namespace {

using ::testing::HasSubstr;

/// An arm of this process alone: locks hold for the whole machine.
std::string arm(const std::string& name) { return "of " + std::to_string(::getpid()) + ", " + name; }

std::string trouble_with(const std::string& name) {
  return error_of([&] { ArmLock("backend", name); });
}

/// What a forked child that tries to lock the arm ends with: 0 if it may.
int status_of_child(const std::string& name, uid_t user) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(::setuid(user) == 0 && trouble_with(name) == "accepted" ? 0 : 1);
  int status = -1;
  ::waitpid(child, &status, 0);
  return status;
}

TEST(ArmLocks, HoldOneArmForOneObjectAndSayWhoHasIt) {
  const std::string left = arm("left");
  std::optional<ArmLock> first;
  first.emplace("backend", left);
  EXPECT_EQ(trouble_with(left), "backend: the arm " + left + " is used by process " + std::to_string(::getpid()) +
                                    ", wait until that process has ended, or end it");
  EXPECT_EQ(trouble_with(arm("right")), "accepted") << "another arm";
  first.reset();
  EXPECT_EQ(trouble_with(left), "accepted");
}

TEST(ArmLocks, EndWithTheirProcess) {
  const std::string name = arm("arm");
  const pid_t child = ::fork();
  if (child == 0) {
    const ArmLock held("backend", name);
    ::_exit(0);  // as after kill -9: nothing is cleaned up
  }
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(trouble_with(name), "accepted");
}

TEST(ArmLocks, HoldInEveryEnvironmentAndWhateverFoldersAreRemoved) {
  const std::string name = arm("arm");
  TemporaryFolder session;
  ::setenv("XDG_RUNTIME_DIR", session.path().c_str(), 1);
  const ArmLock held("backend", name);
  std::filesystem::remove_all(session.path());  // as at the end of a user's last session
  std::filesystem::create_directory(session.path());
  EXPECT_THAT(trouble_with(name), HasSubstr("is used by"));
  ::unsetenv("XDG_RUNTIME_DIR");  // as under cron
  EXPECT_THAT(trouble_with(name), HasSubstr("is used by"));
}

TEST(ArmLocks, HoldForOtherUsersToo) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root becomes another user";
  const std::string name = arm("arm");
  constexpr uid_t kNobody = 65534;
  EXPECT_EQ(status_of_child(name, kNobody), 0);
  const ArmLock held("backend", name);
  EXPECT_NE(status_of_child(name, kNobody), 0);
}

TEST(ArmLocks, AreNotHeldByForkedChildren) {
  const std::string name = arm("arm");
  std::optional<ArmLock> held;
  held.emplace("backend", name);
  const pid_t child = ::fork();
  if (child == 0) {
    ::pause();
    ::_exit(0);
  }
  EXPECT_THAT(trouble_with(name), HasSubstr("process " + std::to_string(::getpid())));
  held.reset();
  EXPECT_TRUE(eventually([&] { return trouble_with(name) == "accepted"; })) << "while a copy of the holder runs";
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
}

TEST(ArmLocks, OfProgramsInPythonAreTheSame) {
  const std::string name = arm("arm with a long name " + std::string(100, 'x'));
  const auto hold = [&] {
    const Ended ended = run_program({"python3", "-SBc", R"(
import os, signal, sys
sys.path[0] = sys.argv[1]
from arm_lock import Held, hold_arm
try:
    lock = hold_arm(sys.argv[2])
except Held as held:
    sys.exit(str(held))
ready, say = os.pipe()
child = os.fork()
if not child:
    os.write(say, b'.')
    signal.pause()
os.read(ready, 1)
lock.close()
hold_arm(sys.argv[2])  # which the child does not hold
os.kill(child, signal.SIGKILL)
)",
                                     (source_folder() / "plugins/backends/process").string(), name},
                                    std::filesystem::temp_directory_path());
    return ended.err;
  };
  EXPECT_EQ(hold(), "");
  const ArmLock held("backend", name);
  EXPECT_EQ(hold(), "the arm " + name + " is used by process " + std::to_string(::getpid()) + "\n");
}

}  // namespace
}  // namespace palpate::test
