// SPDX-License-Identifier: MIT
// `--step`: a person at a terminal is asked before every tap, and the program of the backend is asked after that.
#include "support/programs.hpp"
#include "support/terminal.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <memory>

namespace palpate {
namespace {

using test::Terminal;

constexpr const char* kQuestion = "Enter taps, q ends: ";

class StepRun : public testing::Test {
 protected:
  StepRun() {
    folder_.write("program.py",
                  test::python("open('asked', 'w')\nfor ask in asks():\n"
                               "    tell(ask, outcome='contact', height=ask['x'] / 2, force=8, seconds=1)"));
  }

  /// Four taps of a program that is taken for a robot, two of them of the initial design.
  std::vector<std::string> run(const std::vector<std::string>& more = {}) const {
    return test::plus({"run", config("process.yaml"), "backend.command=python3 -SE program.py",
                       "backend.repeatable=false", "taps=4", "initial.count=2"},
                      more);
  }
  std::vector<std::string> resume() const { return {"resume", directory().string()}; }

  std::unique_ptr<Terminal> at_terminal(std::vector<std::string> words) const {
    words.insert(words.begin(), test::program_file().string());
    words.emplace_back("--step");
    return std::make_unique<Terminal>(words, folder_.path());
  }

  fs::path directory() const { return only_run(folder_.path() / "runs"); }
  /// Announcements and results.
  int logged() const { return test::lines(text_of(directory() / "taps.jsonl")); }
  std::vector<std::string> outcomes() const {
    std::vector<std::string> out;
    for (const Cells& row : csv_rows(text_of(directory() / "taps.csv"))) out.push_back(row.at("outcome"));
    return out;
  }
  bool program_asked() const { return fs::exists(folder_.path() / "asked"); }

  test::TemporaryFolder folder_;
};

TEST_F(StepRun, ShowsEveryTapBeforeItIsAnnouncedAndMakesItAtEnter) {
  const std::unique_ptr<Terminal> terminal = at_terminal(run());
  for (int tap = 1; tap <= 4; ++tap) {
    ASSERT_TRUE(terminal->shows(kQuestion, tap)) << terminal->screen();
    EXPECT_EQ(logged(), 2 * (tap - 1)) << "nothing of this tap is in the log";
    EXPECT_EQ(program_asked(), tap > 1);
    terminal->type("\n");
  }
  EXPECT_EQ(terminal->wait(), 0);
  const std::string& screen = terminal->screen();
  EXPECT_THAT(screen, HasSubstr("tap 1 of 4 at ("));
  EXPECT_THAT(screen, HasSubstr(") cm, one of the initial taps\r\n"
                                "      start 'python3 -SE program.py', which has 120 s, for this motion:\r\n"
                                "      travel to ("));
  EXPECT_THAT(screen, HasSubstr("      ask 'python3 -SE program.py', which has 90 s, for this motion:\r\n"
                                "      travel from ("));
  EXPECT_THAT(screen, HasSubstr(") cm at 13.5 cm above the desk, 30.0 cm/s\r\n"
                                "      descend at 2.4 cm/s in steps of 3.0 cm to at most 3.0 cm below the desk\r\n"
                                "      stop at 10.0 N above the tare: a contact\r\n"
                                "      Enter taps, q ends: "));
  EXPECT_THAT(screen, HasSubstr("tap 4 of 4 at ("));
  EXPECT_THAT(screen, HasSubstr(") cm, chosen by the acquisition; expected height "));
}

TEST_F(StepRun, LeavesTheTapsAndTheirRecordAsTheyAre) {
  const std::unique_ptr<Terminal> terminal = at_terminal(run());
  for (int tap = 1; tap <= 4; ++tap) {
    ASSERT_TRUE(terminal->shows(kQuestion, tap));
    terminal->type("\n");
  }
  EXPECT_EQ(terminal->wait(), 0);
  const std::string stepped = text_of(directory() / "taps.jsonl");
  ASSERT_EQ(test::palpate(run({"--force", "--quiet", "--runs", "others"}), folder_.path()).status, 0);
  EXPECT_EQ(stepped, text_of(only_run(folder_.path() / "others") / "taps.jsonl"));
}

TEST_F(StepRun, EndsAtQWithoutATraceOfTheTapAndResumeCarriesOn) {
  std::unique_ptr<Terminal> terminal = at_terminal(run());
  ASSERT_TRUE(terminal->shows(kQuestion));
  terminal->type("\n");
  ASSERT_TRUE(terminal->shows(kQuestion, 2));
  terminal->type("q\n");
  EXPECT_EQ(terminal->wait(), 130);
  EXPECT_THAT(terminal->screen(), HasSubstr("interrupted after 1 taps"));
  EXPECT_EQ(logged(), 2);
  EXPECT_THAT(test::palpate({"status", directory().string()}, folder_.path()).out, HasSubstr("unfinished"));

  terminal = at_terminal(resume());
  for (int question = 1; question <= 3; ++question) {
    ASSERT_TRUE(terminal->shows(kQuestion, question)) << terminal->screen();
    terminal->type("\n");
  }
  EXPECT_EQ(terminal->wait(), 0);
  EXPECT_THAT(terminal->screen(), HasSubstr("tap 2 of 4 at ("));
  EXPECT_EQ(outcomes(), std::vector<std::string>(4, "contact"));
}

TEST_F(StepRun, EndsInTheSameWayAtControlCControlDSigtermAndAClosedTerminal) {
  const auto type = [](char key) { return [key](Terminal& terminal) { terminal.type(std::string(1, key)); }; };
  const std::vector<std::pair<std::string, std::function<void(Terminal&)>>> ways{
      {"Ctrl-C", type(Terminal::kControlC)},
      {"Ctrl-D", type(Terminal::kControlD)},
      {"SIGTERM", [](Terminal& terminal) { terminal.signal(SIGTERM); }},
      {"closed", [](Terminal& terminal) { terminal.close(); }}};
  for (const auto& [name, way] : ways) {
    const std::unique_ptr<Terminal> terminal = at_terminal(run());
    ASSERT_TRUE(terminal->shows(kQuestion));
    way(*terminal);
    EXPECT_EQ(terminal->wait(), 130) << name;
    EXPECT_EQ(logged(), 0) << name;
    EXPECT_FALSE(program_asked()) << name;
    fs::remove_all(folder_.path() / "runs");
  }
}

TEST_F(StepRun, KilledAtTheQuestionLeavesNoTapInDoubt) {
  const std::unique_ptr<Terminal> terminal = at_terminal(run());
  ASSERT_TRUE(terminal->shows(kQuestion));
  terminal->type("\n");
  ASSERT_TRUE(terminal->shows(kQuestion, 2));
  terminal->signal(SIGKILL);
  EXPECT_EQ(terminal->wait(), 128 + SIGKILL);
  const Ended resumed = test::palpate({"resume", directory().string(), "--quiet"}, folder_.path());
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(outcomes(), std::vector<std::string>(4, "contact"));
}

TEST_F(StepRun, TakesNothingForAnAnswerThatWasTypedBeforeTheQuestion) {
  const std::unique_ptr<Terminal> terminal = at_terminal(run());
  ASSERT_TRUE(terminal->shows(kQuestion));
  terminal->type("\n\n");
  ASSERT_TRUE(terminal->shows(kQuestion, 2));
  terminal->type("q\n");
  EXPECT_EQ(terminal->wait(), 130);
  EXPECT_EQ(outcomes(), std::vector<std::string>{"contact"}) << "the second Enter came while the first tap was made";
}

TEST_F(StepRun, AsksAgainAfterAnythingElse) {
  const std::unique_ptr<Terminal> terminal = at_terminal(run());
  ASSERT_TRUE(terminal->shows(kQuestion));
  terminal->type("yes\n");
  ASSERT_TRUE(terminal->shows(kQuestion, 2));
  EXPECT_EQ(logged(), 0);
  terminal->type("q\n");
  EXPECT_EQ(terminal->wait(), 130);
}

TEST_F(StepRun, IsRefusedWithoutATerminalBeforeAnythingStarts) {
  const Ended ended = test::palpate(run({"--step"}), folder_.path());
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(ended.err,
            "command line: --step: there is no terminal to show a tap and to ask whether it may be made, stdin and "
            "stderr must be one\n");
  EXPECT_FALSE(program_asked());
  EXPECT_FALSE(fs::exists(folder_.path() / "runs"));
}

TEST_F(StepRun, IsRefusedForResumeWithoutATerminal) {
  ASSERT_EQ(test::palpate(run({"--quiet"}), folder_.path()).status, 0);
  const Ended ended = test::palpate({"resume", directory().string(), "--step"}, folder_.path());
  EXPECT_EQ(ended.status, 2);
  EXPECT_THAT(ended.err, HasSubstr("there is no terminal"));
}

TEST_F(StepRun, IsRefusedWhereTapsCanBeRepeated) {
  for (const std::vector<std::string>& words :
       {run({"backend.repeatable=true"}), std::vector<std::string>{"run", test::paper()}}) {
    const std::unique_ptr<Terminal> terminal = at_terminal(words);
    EXPECT_EQ(terminal->wait(), 2);
    EXPECT_THAT(terminal->screen(), HasSubstr("can be repeated, there is nothing to confirm, leave it out\r\n"));
    EXPECT_EQ(test::lines(terminal->screen()), 1);
    EXPECT_FALSE(fs::exists(folder_.path() / "runs"));
  }
  EXPECT_FALSE(program_asked());
}

TEST_F(StepRun, IsRefusedForASweepAndWhereNothingIsShown) {
  const Ended swept = test::palpate({"sweep", test::paper(), "seed=range(0,2)", "taps=3", "initial.count=3", "--quiet"},
                                    folder_.path());
  ASSERT_EQ(swept.status, 0) << swept.err;
  const std::unique_ptr<Terminal> terminal = at_terminal(resume());
  EXPECT_EQ(terminal->wait(), 2);
  EXPECT_THAT(terminal->screen(), EndsWith("is a sweep of many runs, leave it out\r\n"));
  EXPECT_EQ(test::palpate(run({"--quiet", "--step"}), folder_.path()).status, 2);
}

}  // namespace
}  // namespace palpate
