// SPDX-License-Identifier: MIT
// What ./palpate does before it hands over, with programs in the place of dpkg, CMake and ninja that only tell.
#include "support/programs.hpp"
#include "support/terminal.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace palpate {
namespace {

using test::Child;
using test::eventually;
using test::Terminal;

/// A source tree of nothing but the scripts, and a PATH of nothing but what they use.
class SetUp : public Shell {
 protected:
  SetUp() {
    const fs::path tree = test::source_folder();
    fs::create_directories(here() / ".ci");
    fs::create_directories(here() / "bin");
    for (const char* script : {"palpate", "check"}) fs::copy(tree / script, here() / script);
    fs::copy(tree / ".ci" / "setup.sh", here() / ".ci" / "setup.sh");
    write("tests/habits.sh", "exit 0\n");
    write("packages.txt", "# a list\n\n[core]\none   # a word on it\n\n[ros]\ntwo\nthree\n");
    for (const char* tool : {"sh", "sed", "grep", "tr", "cat", "mkdir", "flock", "readlink", "dirname", "id", "tail",
                             "chmod", "sleep", "awk", "env"}) {
      for (const char* place : {"/usr/bin", "/bin"}) {
        if (fs::exists(fs::path(place) / tool) && !fs::exists(here() / "bin" / tool)) {
          fs::create_symlink(fs::path(place) / tool, here() / "bin" / tool);
        }
      }
    }
    program("dpkg-query", "for p in $(cat '" + here().string() + "/installed'); do echo \"ii $p\"; done");
    program("cmake", R"(mkdir -p "$4/build/$2"; : >"$4/build/$2/build.ninja"; echo configured >>"$4/told")");
    program("ninja", R"(printf '#!/bin/sh\n[ "$1" = --needs ] || echo "handed over to $*"\n' >"$2/palpate"
                        chmod +x "$2/palpate")");
    installed("one");
  }

  void program(const std::string& name, const std::string& text) const {
    fs::remove(here() / "bin" / name);  // may be a link to the real one, which must not be written to
    fs::permissions(write("bin/" + name, "#!/bin/sh\n" + text + "\n"), fs::perms::owner_all);
  }
  void installed(const std::string& packages) const { write("installed", packages + "\n"); }
  Words script(const std::string& name, const Words& more = {}) const { return Words{"/bin/sh", here() / name} + more; }
  std::vector<std::string> environment() const { return {"PATH=" + (here() / "bin").string()}; }
  Ended script_ended(const std::string& name, const Words& more = {}) const {
    return test::run_program(script(name, more), here(), environment());
  }
  Ended call() const {
    Ended ended = script_ended("palpate", "--no-install status");
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.out, "handed over to status\n");
    return ended;
  }
  /// A program that tells that it began, and goes on when a file `go` is there, or after ten minutes, which only what
  /// hangs takes.
  void waiting_program(const std::string& name, const std::string& says) const {
    program(name, says + "\n: >'" + here().string() + "/began'\nn=0\nuntil [ -e '" + here().string() +
                      "/go' ] || [ $n = 60000 ]; do n=$((n + 1)); /bin/sleep 0.01; done");
  }
  int configured() const { return fs::exists(here() / "told") ? lines(text_of(here() / "told")) : 0; }
};

TEST_F(SetUp, ConfiguresOnceAndNotAgain) {
  EXPECT_THAT(call().err, HasSubstr("no package is missing\nbuilding preset release"));
  EXPECT_EQ(call().err, "no package is missing\n");
  EXPECT_EQ(configured(), 1);
}

TEST_F(SetUp, ConfiguresAgainWhenAPackageCameWhoeverInstalledIt) {
  call();
  installed("one two");
  EXPECT_EQ(call().err, "no package is missing\n") << "what it builds then takes no minutes";
  EXPECT_EQ(configured(), 2) << "of any heading, since what is built may depend on it";
  call();
  EXPECT_EQ(configured(), 2);
}

TEST_F(SetUp, ConfiguresAgainWhenThatFailedTheLastTime) {
  call();
  installed("one two three");
  const std::string sound = text_of(here() / "bin" / "cmake");
  program("cmake", "exit 1");
  const Ended ended = script_ended("palpate", "status");
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, "configuring failed, see build/release.log\n");
  program("cmake", sound);
  call();
  EXPECT_EQ(configured(), 2);
}

TEST_F(SetUp, BuildsWhatTheCommandTakesAndThenWhatThatNames) {
  program("ninja", "[ \"$3\" = -n ] || echo \"$3 $4 $5\" >>'" + here().string() + "/built'");
  const std::string asked = "[ \"$*\" = '--needs run a.yaml' ] || exit 0; grep -q sum '" + here().string() +
                            "/built' && echo palpate_kernel_rbf; echo palpate_kernel_sum";
  write("build/release/palpate", "#!/bin/sh\n" + asked + "\n");
  fs::permissions(here() / "build/release/palpate", fs::perms::owner_all);
  const Ended ended = script_ended("palpate", "run a.yaml");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(text_of(here() / "built"),
            "palpate palpate_build_stamp \npalpate_kernel_sum  \npalpate_kernel_rbf "
            "palpate_kernel_sum \n");
}

TEST_F(SetUp, ACompletionNeitherWaitsNorBuilds) {
  const Ended before = script_ended("palpate", {"--complete", ""});
  EXPECT_EQ(before.status, 0);
  EXPECT_EQ(before.out + before.err, "");
  EXPECT_FALSE(fs::exists(here() / "build"));
  call();
  program("ninja", ": >'" + here().string() + "/built'");
  EXPECT_EQ(script_ended("palpate", {"--complete", "ru"}).out, "handed over to --complete ru\n");
  EXPECT_FALSE(fs::exists(here() / "built"));
}

TEST_F(SetUp, SaysWhatIsMissingAndGoesOnAlsoWhereThereIsNoDpkg) {
  installed("three");
  const std::string told =
      "packages are missing; install them as root with: apt-get update && apt-get install --no-install-recommends one "
      "\n";
  EXPECT_THAT(call().err, HasSubstr(told));
  fs::remove(here() / "bin" / "dpkg-query");
  EXPECT_THAT(call().err, HasSubstr(told));
  const int before = configured();
  call();
  EXPECT_EQ(configured(), before);
}

using BuildStamp = Shell;

TEST_F(BuildStamp, TakesForAChangeOnlyWhatGitWasToldOf) {
  write("tree/main.cpp", "int main() {}\n");
  const auto done = [&](const Words& words) {
    const Ended ended = test::run_program(words, here());
    EXPECT_EQ(ended.status, 0) << ended.err;
  };
  const auto stamp = [&] {
    done({"cmake", "-DSOURCE=" + (here() / "tree").string(), "-DOUTPUT=build.json", "-P",
          test::source_folder() / "framework/cmake/BuildStamp.cmake"});
    return text_of(here() / "build.json");
  };
  for (const char* words : {"init --quiet", "add main.cpp", "commit --quiet -m first"})
    done(Words("git -C tree -c user.name=a -c user.email=a@b") + words);
  EXPECT_THAT(stamp(), HasSubstr("\"dirty\": false"));
  write("tree/notes.txt", "to do\n");
  EXPECT_THAT(stamp(), HasSubstr("\"dirty\": false"));
  write("tree/main.cpp", "int main() { return 1; }\n");
  EXPECT_THAT(stamp(), HasSubstr("\"dirty\": true"));
}

TEST_F(SetUp, SaysThatItWaitsForAnotherSetUp) {
  const std::string ninja = text_of(here() / "bin" / "ninja");
  waiting_program("ninja", ninja);
  const Child first(script("palpate"), here(), environment());
  ASSERT_TRUE(eventually([&] { return fs::exists(here() / "began"); }));
  Child second(script("palpate"), here(), environment());
  const std::string told = "waiting for another set-up of this folder\n";
  EXPECT_TRUE(eventually([&] { return second.err() == told; })) << second.err();
  EXPECT_TRUE(second.running());
  write("go", "");
  EXPECT_EQ(second.wait().status, 0);
}

TEST_F(SetUp, TestsNothingWhereHabitsAreBroken) {
  program("nproc", "echo 2");
  program("ctest", ": >'" + here().string() + "/tested'");
  write("tests/habits.sh", "echo 'a.cpp: is not as it should be' >&2\nexit 1\n");
  const Ended ended = script_ended("check", "--no-install");
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("\na.cpp: is not as it should be\nthese coding rules are broken"));
  EXPECT_FALSE(fs::exists(here() / "tested"));
}

TEST_F(SetUp, IsNotHeldUpByTestsThatRun) {
  program("nproc", "echo 2");
  program("ctest", "PATH=/usr/bin:/bin flock -n '" + here().string() + "/build/setup.lock' echo free >>'" +
                       here().string() + "/lock'");
  const Ended ended = script_ended("check", "--no-install");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(text_of(here() / "lock"), "free\n");
}

TEST_F(SetUp, WithoutSudoItSaysWhatToPaste) {
  installed("three");
  program("id", "echo 1000");
  program("apt-get", "echo apt-get >>'" + here().string() + "/apt'");
  const Ended ended = script_ended("palpate");
  EXPECT_EQ(ended.status, 0);
  EXPECT_THAT(ended.err, HasSubstr("  apt-get update && apt-get install --no-install-recommends one \n"));
  EXPECT_FALSE(fs::exists(here() / "apt")) << "it may not";
}

TEST_F(SetUp, AtATerminalItAsksBeforeItCallsSudo) {
  program("id", "echo 1000");
  program("sudo", "echo \"$*\" >>'" + here().string() + "/asked'; [ \"$1\" = -v ] || \"$@\"");
  program("apt-get", "case \"$*\" in *' -y '*) echo 'one three' >'" + here().string() + "/installed' ;; esac");
  for (const bool yes : {false, true}) {
    installed("three");
    Terminal terminal(script("palpate", "status"), here(), environment());
    EXPECT_TRUE(terminal.shows("missing packages: one \r\ninstall them with sudo? [Y/n] ")) << terminal.screen();
    EXPECT_FALSE(fs::exists(here() / "asked"));
    terminal.type(yes ? "\n" : "n\n");
    EXPECT_EQ(terminal.wait(), 0) << terminal.screen();
    EXPECT_THAT(terminal.screen(), HasSubstr("handed over to status"));
    EXPECT_EQ(fs::exists(here() / "asked"), yes);
    EXPECT_EQ(text_of(here() / "installed"), yes ? "one three\n" : "three\n");
  }
}

TEST_F(SetUp, SaysHowLongARebuildTakesWhereBuildFilesAreLookedAtEachTime) {
  call();
  program("nproc", "echo 2");
  program("ninja", "exec /usr/bin/ninja \"$@\"");
  // As CMake writes it for globs: what is looked at always and is found unchanged.
  std::string text =
      "rule look\n  command = true\n  restat = 1\n  generator = 1\n"
      "rule compile\n  command = /usr/bin/touch $out\n  description = Building CXX object $out\n"
      "build always: phony\nbuild globs: look always\nbuild build.ninja: look globs\n"
      "build palpate_build_stamp: phony\nbuild palpate: compile";
  std::string objects;
  for (int i = 0; i < 29; ++i) {
    text += " " + std::to_string(i) + ".o";
    objects += "build " + std::to_string(i) + ".o: compile header.hpp\n";
  }
  write("build/release/header.hpp", "");
  write("build/release/globs", "");
  write("build/release/build.ninja", text + "\n" + objects);
  EXPECT_THAT(call().err, HasSubstr("building the parts that this command needs: 30 steps, about 2 minutes\n"));
  EXPECT_EQ(call().err, "no package is missing\n");
  write("build/release/header.hpp", "// changed");
  EXPECT_THAT(call().err, HasSubstr("building the parts that this command needs: 30 steps, about 2 minutes\n"));
}

TEST_F(SetUp, BuildsAllWhenItIsAskedTo) {
  program("ninja", "[ \"$3\" = -n ] || echo \"$3 $4\" >>'" + here().string() + "/built'");
  const Ended ended = script_ended("palpate", "build");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(text_of(here() / "built"), "palpate_complete palpate_build_stamp\n");
  EXPECT_EQ(ended.out, "");
}

TEST_F(SetUp, SaysWhatBuildDoesAndRejectsItsArgumentsWithoutBuilding) {
  const Ended help = script_ended("palpate", "build --help");
  EXPECT_EQ(help.status, 0) << help.err;
  EXPECT_THAT(help.out, HasSubstr("build: builds both programs, all plugins"));
  const Ended wrong = script_ended("palpate", "build kernel");
  EXPECT_EQ(wrong.status, 2);
  EXPECT_EQ(wrong.err, "palpate build: unknown argument 'kernel', it takes none\n");
  EXPECT_FALSE(fs::exists(here() / "build"));
}

TEST_F(SetUp, SaysBeforehandHowLongItWillBeAndWhatRoomItTakes) {
  installed("three");
  program("id", "echo 0");
  // Asked what it would take, apt tells; what is fetched already it counts apart.
  program("apt-get", "echo \"$*\" >>'" + here().string() + "/apt'\ncase \"$*\" in\n*--assume-no*)\n" +
                         "echo 'Need to get 12.3 MB/147 MB of archives.'\n"
                         "echo 'After this operation, 1,708 MB of additional disk space will be used.'; exit 1 ;;\n" +
                         "*' -y '*) echo 'one three' >'" + here().string() + "/installed' ;;\nesac");
  const Ended ended = script_ended("palpate", "status");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err,
            "installing one \ninstalling packages: a minute or two, 12.3 MB to fetch, 1,708 MB of disk\n"
            "building preset release: about 5 minutes the first time, 200 MB of disk\n");
  const std::string apt = text_of(here() / "apt");
  EXPECT_EQ(lines(apt), 3) << apt;
  EXPECT_THAT(apt, HasSubstr("update -q\ninstall -q -d --assume-no --no-install-recommends one\n")) << "no more";
  // What is there already takes nothing, and so nothing is said of it.
  EXPECT_EQ(script_ended("palpate", "status").err, "");
}

TEST_F(SetUp, GoesOnWhereNothingCanBeFetched) {
  installed("three");
  program("id", "echo 0");
  program("apt-get", "echo 'no such host'; exit 100");
  const Ended ended = script_ended("palpate", "status");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("no such host\ninstalling failed, see build/install.log; continuing"));
}

}  // namespace
}  // namespace palpate
