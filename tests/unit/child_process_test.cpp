// SPDX-License-Identifier: MIT
// The room for processes: what is forked and what is started is heard, ends with who began it, and leaves nothing.
#include "children/child_process.hpp"

#include "support/testing.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::test {
namespace {

using Say = ChildProcess::Say;

fs::path folder_of(int pid) { return fs::path("/proc") / std::to_string(pid); }

/// What a program of the shell says.
std::string shell(const std::string& commands, std::string_view input = {}) {
  const auto child = ChildProcess::start({{"sh", "-c", commands}}, input);
  EXPECT_TRUE(child->wait());
  return child->said();
}

/// The number that `child` says in its first line.
int number_from(ChildProcess& child) {
  while (child.said().find('\n') == std::string::npos && !child.wait(0.001)) {
  }
  return std::stoi(child.said());
}

TEST(ForkedWork, IsHeardAndEndsWithTheStatusItReturns) {
  const std::string much(1'000'000, 'x');
  const auto child = ChildProcess::fork([&](const Say& say) {
    say("one ");
    say(much);
    return 3;
  });
  EXPECT_TRUE(child->wait());
  EXPECT_EQ(child->said(), "one " + much);
  EXPECT_EQ(WEXITSTATUS(child->status()), 3);
  EXPECT_TRUE(child->wait(0)) << "once more";
}

TEST(ForkedWork, ThatThrowsIsACrashAndUnwindsNothingOfItsParents) {
  const auto child = ChildProcess::fork([](const Say&) -> int {
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDERR_FILENO);
    const rlimit no_core{0, 0};
    ::setrlimit(RLIMIT_CORE, &no_core);
    throw std::runtime_error("thrown");
  });
  EXPECT_TRUE(child->wait());
  EXPECT_TRUE(WIFSIGNALED(child->status()));
  EXPECT_EQ(WTERMSIG(child->status()), SIGABRT);
}

TEST(ForkedWork, PrintsNothingThatItsParentWasAboutToPrint) {
  const test::TemporaryFolder folder;
  const std::string file = (folder.path() / "printed").string();
  std::FILE* const printed = std::fopen(file.c_str(), "w");
  std::fputs("once\n", printed);
  const auto child = ChildProcess::fork([](const Say&) -> int { std::exit(0); });
  EXPECT_TRUE(child->wait());
  std::fclose(printed);
  EXPECT_EQ(test::text_of(file), "once\n");
}

TEST(ForkedWork, DiesWithWhoForkedItAndIsInAGroupOfItsOwn) {
  const auto parent = ChildProcess::fork([](const Say& say) {
    const auto child = ChildProcess::fork([](const Say& say_inside) {
      say_inside(std::to_string(::getpid()) + "\n");
      return ::pause();
    });
    say(std::to_string(number_from(*child)) + "\n");
    return ::pause();
  });
  const int grandchild = number_from(*parent);
  EXPECT_EQ(::getpgid(grandchild), grandchild);
  parent->signal(SIGKILL);
  EXPECT_TRUE(parent->wait());
  const auto runs = [&] {
    const std::string stat = test::text_of(folder_of(grandchild) / "stat");
    return !stat.empty() && stat.find(") Z") == std::string::npos;
  };
  while (runs()) ::usleep(1000);
}

TEST(StartedProgram, IsHeardToItsEnd) {
  const auto child = ChildProcess::start({{"sh", "-c", "echo out; echo err >&2; exit 3"}});
  EXPECT_TRUE(child->wait(60));
  EXPECT_EQ(WEXITSTATUS(child->status()), 3);
  EXPECT_EQ(child->said(), "out\nerr\n");
}

TEST(StartedProgram, ReadsWhatItIsGivenHoweverMuchThatIs) {
  const std::string much(1'000'000, 'x');
  EXPECT_EQ(shell("cat", much), much);
  EXPECT_EQ(shell("cat"), "");
}

TEST(StartedProgram, IsKilledWithTheObjectAndNoLongerWaitedForThanIsSaid) {
  fs::path process;
  {
    const auto child = ChildProcess::start({{"sh", "-c", "echo $$; exec sleep 1000"}});
    process = folder_of(number_from(*child));
    EXPECT_TRUE(fs::exists(process));
  }
  EXPECT_FALSE(fs::exists(process));
}

TEST(StartedProgram, SeesTheEnvironmentThatItIsGiven) {
  ProgramCall program{{"sh", "-c", "echo ${PALPATE_SEEN-hidden} ${HOME-hidden}"}};
  program.environment = {"PALPATE_SEEN=yes"};
  const auto child = ChildProcess::start(program);
  child->wait();
  EXPECT_EQ(child->said(), "yes hidden\n");
}

TEST(StartedProgram, IsInAGroupOfItsOwnUnlessItIsToEndAtCtrlCWithThisProcess) {
  const std::vector<std::string> words{"sh", "-c", "echo $$; exec sleep 1000"};
  ProgramCall ours{words};
  ours.own_group = false;
  const auto own = ChildProcess::start({words});
  const auto with_us = ChildProcess::start(ours);
  const int pid = number_from(*own);
  EXPECT_EQ(::getpgid(pid), pid);
  EXPECT_EQ(::getpgid(number_from(*with_us)), ::getpgid(0));
}

TEST(StartedProgram, InAGroupOfItsOwnIgnoresNoSignalThatThisProcessIgnores) {
  const std::string ignored = "grep SigIgn /proc/self/status | cut -f 2";
  const auto before = std::signal(SIGHUP, SIG_IGN);
  ProgramCall ours{{"sh", "-c", ignored}};
  ours.own_group = false;
  const auto with_us = ChildProcess::start(ours);
  const std::string fresh = shell(ignored);
  with_us->wait();
  std::signal(SIGHUP, before);
  EXPECT_EQ(std::stoul(fresh, nullptr, 16) & 1, 0U) << fresh;
  EXPECT_EQ(std::stoul(with_us->said(), nullptr, 16) & 1, 1U) << with_us->said();
}

TEST(StartedProgram, ThatIsNotThereIsToldByErrno) {
  EXPECT_EQ(ChildProcess::start({{"no-such-program", "--version"}}), nullptr);
  EXPECT_EQ(errno, ENOENT);
}

TEST(Children, AreNotToBeHadWhereFilesRunShortAndErrnoSaysSo) {
  const auto parent = ChildProcess::fork([](const Say& say) {
    const rlimit few{5, 5};
    ::setrlimit(RLIMIT_NOFILE, &few);
    while (::open("/dev/null", O_RDONLY) >= 0) {
    }
    errno = 0;
    const bool forked = ChildProcess::fork([](const Say&) { return 0; }) != nullptr;
    say(fmt::format("{} {} ", forked, errno == EMFILE));
    errno = 0;
    const bool started = ChildProcess::start({{"true"}}) != nullptr;
    say(fmt::format("{} {}", started, errno == EMFILE));
    return 0;
  });
  parent->wait();
  EXPECT_EQ(parent->said(), "false true false true");
}

TEST(Children, AreListenedToTogether) {
  const auto quick = ChildProcess::fork([](const Say& say) {
    say("quick");
    return 0;
  });
  const auto slow = ChildProcess::fork([](const Say&) { return ::pause(); });
  while (!quick->ended()) ChildProcess::listen({slow.get(), quick.get()}, 60.0);
  EXPECT_EQ(quick->said(), "quick");
  EXPECT_FALSE(slow->ended());
  slow->signal(SIGTERM);
  ChildProcess::listen({slow.get(), quick.get()}, 60.0);
  EXPECT_TRUE(slow->ended());
  EXPECT_EQ(WTERMSIG(slow->status()), SIGTERM);
}

TEST(Children, HaveStandardFilesOfTheirOwnThoughThisProcessHasNone) {
  const auto parent = ChildProcess::fork([](const Say& say) {
    for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::close(standard);
    say(shell("cat; echo out; echo err >&2", "in "));
    return 0;
  });
  parent->wait();
  EXPECT_EQ(parent->said(), "in out\nerr\n");
}

}  // namespace
}  // namespace palpate::test
