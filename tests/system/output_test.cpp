// SPDX-License-Identifier: MIT
// Standard files that are closed, full or read by nobody: no record suffers, and the exit status tells of lost words.
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>

namespace palpate {
namespace {

class Output : public Shell {
 protected:
  /// `script` of a shell, in which "$@" is palpate with `words`.
  std::vector<std::string> shell_words(const std::string& script, const Words& words) const {
    std::vector<std::string> all{"sh", "-c", script, "sh", test::program_file().string()};
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }
  Ended shell(const std::string& script, const Words& words) const {
    return test::run_program(shell_words(script, words), here());
  }
  /// The same with a pipe for stdout whose reader is gone before it begins; `script` runs "$@".
  static std::string without_reader(const std::string& script) {
    return "{ until [ -e gone ]; do sleep 0.01; done; " + script + "; } | { exec <&-; : >gone; }";
  }
  static Words run_words() { return Words{"run", paper(), "taps=5"}; }

  void expect_whole(const fs::path& run, int taps = 5) const {
    EXPECT_THAT(text_of(run / "record.jsonl"), StartsWith("{\"manifest\": 1, "));
    EXPECT_THAT(text_of(run / "record.jsonl"), Not(HasSubstr("expected mm"))) << "the printed table";
    EXPECT_EQ(lines(part_of(run, "tap")), taps);
    EXPECT_THAT(text_of(run / "summary.json"), HasSubstr("\"status\": \"done\""));
  }
};

TEST_F(Output, ThatIsClosedDoesNotGoIntoTheRecordAndFails) {
  for (const char* closed : {">&-", "<&- >&-"}) {
    const Ended ended = shell(std::string("\"$@\" ") + closed, run_words() + "--force");
    EXPECT_EQ(ended.status, 1) << closed;
    EXPECT_THAT(ended.err,
                MatchesRegex("standard output: cannot be written: Bad file descriptor; record: runs/object_i/.*\n"));
    for (const auto& run : fs::directory_iterator(here() / "runs" / "object_i")) expect_whole(run.path());
  }
}

TEST_F(Output, OfARunWithoutWordsMayBeClosedWithTheOtherStandardFiles) {
  EXPECT_EQ(shell("\"$@\" <&- >&- 2>&-", run_words() + "--quiet").status, 0);
  expect_whole(directory());
}

TEST_F(Output, ThatIsFullEndsWithStatusOneAndNamesTheRecord) {
  for (const Words& more : {Words{}, Words{"--json"}}) {  // the second time it is done already
    const Ended ended = shell("\"$@\" >/dev/full", run_words() + more);
    EXPECT_EQ(ended.status, 1);
    EXPECT_THAT(ended.err, MatchesRegex("standard output: cannot be written: No space left on device; record: "
                                        "runs/object_i/[0-9a-f]{12}\n"));
    expect_whole(directory());
  }
  const Ended status = shell("\"$@\" >/dev/full", {"status", directory()});
  EXPECT_EQ(status.status, 1);
  EXPECT_EQ(status.err, "standard output: cannot be written: No space left on device\n");
  EXPECT_EQ(shell("\"$@\" >/dev/full", {"--version"}).status, 1);
}

TEST_F(Output, OfTheBestSettingThatIsFullEndsWithStatusOne) {
  const fs::path sweep = swept("taps=[5,9] seed=range(0,3)");
  EXPECT_EQ(shell("\"$@\" >/dev/full", Words{"pareto", sweep} + "--cost taps --error rmse_m --within 20cm").status, 1);
}

TEST_F(Output, WithoutAReaderLeavesTheRunToItsEnd) {
  const Ended ended = shell(without_reader("\"$@\"; echo $? >status"), run_words());
  EXPECT_EQ(text_of(here() / "status"), "0\n");
  EXPECT_THAT(ended.err, MatchesRegex("record: runs/object_i/[0-9a-f]{12}\n"));
  expect_whole(directory());
}

TEST_F(Output, WithoutAReaderStillSaysHowAnInterruptedRunGoesOn) {
  // As Ctrl-C before `| tee`, which ends the reader, too; the shell lets only SIGTERM through.
  const test::Child child(shell_words(without_reader("\"$@\" & echo $! >pid; wait $!; echo $? >status"),
                                      Words{"run", paper(), "backend.pace=0.02"}),
                          here());
  EXPECT_TRUE(test::eventually([&] {
    const fs::path run = fs::exists(here() / "runs" / "object_i") ? directory() : fs::path();
    return !run.empty() && lines(part_of(run, "tap")) > 1;
  }));
  ASSERT_EQ(::kill(std::stoi(text_of(here() / "pid")), SIGTERM), 0);
  EXPECT_TRUE(test::eventually([&] { return text_of(here() / "status") == "130\n"; })) << text_of(here() / "status");
  EXPECT_EQ(child.err(), "resume with: palpate resume " + fs::relative(directory(), here()).string() + "\n");
}

TEST_F(Output, OfACommandThatOnlyPrintsEndsQuietlyWithItsReader) {
  const Ended ended = shell(without_reader("\"$@\"; echo $? >status"), {"schema"});
  EXPECT_EQ(text_of(here() / "status"), "141\n");
  EXPECT_EQ(ended.err, "");
}

TEST_F(Output, AFileThatMayGrowNoMoreFailsTheRunAndCanBeResumed) {
  // Of 20 kB, which the log outgrows.
  const Ended ended = shell("ulimit -f 40; exec \"$@\"", Words{"run", paper(), "taps=40", "--quiet"});
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, ContainsRegex("record.jsonl: cannot be written: File too large\n$"));
  EXPECT_EQ(lines(ended.err), 1);
  EXPECT_THAT(text_of(directory() / "record.jsonl"), EndsWith("}\n")) << "no half line";
  EXPECT_EQ(resume(directory(), {"--retry-failed"}).status, 0);
  expect_whole(directory(), 40);
}

TEST_F(Output, TemporaryFilesThatAKillLeftAreGoneAfterResume) {
  const fs::path run = ran("taps=5");
  break_off(run);
  for (const char* name : {"surface.ply", "report.html", "maps/tap_001.csv"}) {
    write(run / (std::string(name) + ".0123456789abcdef.tmp"), "half");
  }
  ASSERT_EQ(resume(run).status, 0);
  for (const auto& entry : fs::recursive_directory_iterator(run)) EXPECT_NE(entry.path().extension(), ".tmp") << entry;
}

}  // namespace
}  // namespace palpate
