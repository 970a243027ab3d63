// SPDX-License-Identifier: MIT
// What ./palpate does before it hands over, with programs in the place of dpkg, CMake and ninja that only tell.
#include "support/support.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::Ended;
using test::text_of;
using ::testing::HasSubstr;

/// A source tree of nothing but the scripts, and a PATH of nothing but what they use.
class SetUp : public ::testing::Test {
 protected:
  SetUp() {
    const fs::path tree = test::source_folder();
    fs::create_directories(here() / ".ci");
    fs::create_directories(here() / "bin");
    fs::copy(tree / "palpate", here() / "palpate");
    fs::copy(tree / ".ci" / "setup.sh", here() / ".ci" / "setup.sh");
    folder_.write("packages.txt", "# a list\n\n[core]\none   # a word on it\n\n[ros]\ntwo\nthree\n");
    for (const char* tool :
         {"sh", "sed", "grep", "tr", "cat", "mkdir", "flock", "readlink", "dirname", "id", "tail", "chmod"}) {
      for (const char* place : {"/usr/bin", "/bin"}) {
        if (fs::exists(fs::path(place) / tool) && !fs::exists(here() / "bin" / tool)) {
          fs::create_symlink(fs::path(place) / tool, here() / "bin" / tool);
        }
      }
    }
    program("dpkg-query", "for p in $(cat '" + here().string() + "/installed'); do echo \"ii $p\"; done");
    program("cmake", R"(mkdir -p "$4/build/release"; : >"$4/build/release/build.ninja"; echo configured >>"$4/told")");
    program("ninja", R"(printf '#!/bin/sh\necho "handed over to $*"\n' >"$2/palpate"; chmod +x "$2/palpate")");
    installed("one");
  }

  fs::path here() const { return folder_.path(); }
  void program(const std::string& name, const std::string& text) const {
    fs::permissions(folder_.write("bin/" + name, "#!/bin/sh\n" + text + "\n"), fs::perms::owner_all);
  }
  void installed(const std::string& packages) const { folder_.write("installed", packages + "\n"); }
  Ended call() const {
    const Ended ended = test::run_program({"/bin/sh", (here() / "palpate").string(), "--no-install", "status"}, here(),
                                          {"PATH=" + (here() / "bin").string()});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.out, "handed over to status\n");
    return ended;
  }
  int configured() const { return fs::exists(here() / "told") ? test::lines(text_of(here() / "told")) : 0; }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(SetUp, ConfiguresOnceAndNotAgain) {
  EXPECT_THAT(call().err, HasSubstr("no package is missing\nbuilding preset release"));
  EXPECT_EQ(call().err, "no package is missing\n");
  EXPECT_EQ(configured(), 1);
}

TEST_F(SetUp, ConfiguresAgainWhenAPackageCameWhoeverInstalledIt) {
  call();
  installed("one two");
  call();
  EXPECT_EQ(configured(), 2) << "of any heading, since what is built may depend on it";
  call();
  EXPECT_EQ(configured(), 2);
}

TEST_F(SetUp, ConfiguresAgainWhenThatFailedTheLastTime) {
  call();
  installed("one two three");
  const std::string sound = text_of(here() / "bin" / "cmake");
  program("cmake", "exit 1");
  const Ended ended = test::run_program({"/bin/sh", (here() / "palpate").string(), "status"}, here(),
                                        {"PATH=" + (here() / "bin").string()});
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, "configuring failed, the whole story is in build/release.log\n");
  program("cmake", sound);
  call();
  EXPECT_EQ(configured(), 2);
}

TEST_F(SetUp, SaysWhatIsMissing) {
  installed("three");
  EXPECT_THAT(call().err, HasSubstr("missing packages: one \n"));
}

TEST_F(SetUp, GoesOnWhereThereIsNoDpkg) {
  fs::remove(here() / "bin" / "dpkg-query");
  EXPECT_THAT(call().err, HasSubstr("missing packages: one \n"));
  call();
  EXPECT_EQ(configured(), 1);
}

}  // namespace
}  // namespace palpate
