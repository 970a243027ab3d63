// SPDX-License-Identifier: MIT
// Programs of the system, and words for a shell.
#include "launch/command.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>

namespace palpate {
namespace {

namespace fs = std::filesystem;

TEST(ShellWord, IsReadByAShellAsItWas) {
  const test::TemporaryFolder folder;
  for (const char* word : {"plain/path-1.2", "", " ", "a  b", "it's", "''", "$HOME", "`ls`", "a\nb", "\\", "~", "*",
                           "-n", "\"", "a;b", "#", "!", "\xc3\xa4"}) {
    const std::string shown =
        test::run_program({"sh", "-c", fmt::format("printf %s {}", shell_word(word))}, folder.path()).out;
    EXPECT_EQ(shown, word);
  }
  EXPECT_EQ(shell_word("/plain/path-1.2"), "/plain/path-1.2");
}

TEST(Command, CollectsWhatAProgramSaysAndHowItEnded) {
  Command command({"sh", "-c", "echo out; echo err >&2; exit 3"});
  EXPECT_TRUE(command.wait(60));
  EXPECT_EQ(command.status(), 3);
  EXPECT_EQ(command.output(), "out\nerr\n");
  EXPECT_TRUE(command.wait(0)) << "once more";
}

TEST(Command, GivesUpWaitingAndKillsWhatIsLeft) {
  fs::path process;
  {
    Command command({"sh", "-c", "echo $$; exec sleep 1000"});
    while (command.output().find('\n') == std::string::npos) ASSERT_FALSE(command.wait(0.001));
    process = fs::path("/proc") / std::to_string(std::stoi(command.output()));
    EXPECT_TRUE(fs::exists(process));
  }
  EXPECT_FALSE(fs::exists(process));
}

TEST(Command, HidesVariablesAndSaysWhatIsNotInstalled) {
  ::setenv("SQUEUE_FORMAT", "x", 1);
  Command command({"sh", "-c", "echo ${SQUEUE_FORMAT-hidden}"},
                  [](std::string_view name) { return name != "SQUEUE_FORMAT"; });
  ::unsetenv("SQUEUE_FORMAT");
  command.wait(60);
  EXPECT_EQ(command.output(), "hidden\n");
  try {
    const Command none({"no-such-program", "--version"});
    ADD_FAILURE();
  } catch (const Error& trouble) {
    EXPECT_STREQ(trouble.what(), "no-such-program: is not installed, or not on PATH");
  }
}

}  // namespace
}  // namespace palpate
