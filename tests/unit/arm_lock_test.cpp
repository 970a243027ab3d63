// SPDX-License-Identifier: MIT
#include "children/arm_lock.hpp"

#include "support/support.hpp"
#include "support/testing.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

#include <sys/wait.h>
#include <unistd.h>

namespace palpate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

namespace fs = std::filesystem;

class ArmLocks : public ::testing::Test {
 protected:
  ArmLocks() { ::setenv("XDG_RUNTIME_DIR", folder_.path().c_str(), 1); }
  ~ArmLocks() override { ::unsetenv("XDG_RUNTIME_DIR"); }

  static std::string trouble_with(const std::string& arm) {
    return error_of([&] { ArmLock("backend", arm, "runs/second"); });
  }

  TemporaryFolder folder_;
};

TEST_F(ArmLocks, HoldOneArmForOneObjectAndSayWhoHasIt) {
  std::optional<ArmLock> first;
  first.emplace("backend", "left of http://robot:11311", "runs/first/0123456789ab");
  EXPECT_EQ(trouble_with("left of http://robot:11311"),
            "backend: the arm left of http://robot:11311 is in the hands of process " + std::to_string(::getpid()) +
                ", runs/first/0123456789ab, wait until that has ended, or end it");
  EXPECT_EQ(trouble_with("right of http://robot:11311"), "accepted") << "another arm";
  first.reset();
  EXPECT_EQ(trouble_with("left of http://robot:11311"), "accepted");
}

TEST_F(ArmLocks, EndWithTheirProcess) {
  const pid_t child = ::fork();
  if (child == 0) {
    const ArmLock held("backend", "arm", "");
    ::_exit(0);  // as after kill -9: nothing is cleaned up
  }
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(trouble_with("arm"), "accepted");
}

TEST_F(ArmLocks, LieInAFolderOfTheUserAlone) {
  const ArmLock held("backend", "../arm", "");
  const fs::path own = folder_.path() / "palpate";
  EXPECT_EQ(fs::status(own).permissions(), fs::perms::owner_all);
  EXPECT_TRUE(fs::exists(own / "..%2Farm.lock"));
  fs::permissions(own, fs::perms::all);
  EXPECT_THAT(trouble_with("arm"), StartsWith(own.string() + ": is not a folder of this user alone, remove it"));
  fs::remove_all(own);
  fs::create_directory_symlink(folder_.path(), own);
  EXPECT_THAT(trouble_with("arm"), HasSubstr("is not a folder of this user alone")) << "a link";
  ::unsetenv("XDG_RUNTIME_DIR");
  EXPECT_EQ(arm_lock_folder(), fs::temp_directory_path() / ("palpate-" + std::to_string(::geteuid())));
}

}  // namespace
}  // namespace palpate::test
