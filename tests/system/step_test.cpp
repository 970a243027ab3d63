// SPDX-License-Identifier: MIT
// `--step`: a person at a terminal is asked before every tap, and the program of the backend is asked after that.
#include "support/programs.hpp"
#include "support/terminal.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <functional>
#include <memory>

namespace palpate {
namespace {

using test::Terminal;

constexpr const char* kQuestion = "Enter taps, q ends: ";

class StepRun : public Shell {
 protected:
  StepRun() {
    write("program.py", test::python("open('asked', 'w')\nfor ask in asks():\n"
                                     "    tell(ask, outcome='contact', height=ask['x'] / 2, force=8, seconds=1)"));
  }

  /// Four taps of a program that is taken for a robot, two of them of the initial design.
  static Words robot(const Words& more = {}) {
    return set_by({"run", config("process.yaml"), "backend.command=python3 -SE program.py", "backend.repeatable=false",
                   "taps=4", "initial.count=2"},
                  more);
  }

  std::unique_ptr<Terminal> at_terminal(const Words& words) const {
    return std::make_unique<Terminal>(Words{test::program_file()} + words + "--step", here());
  }
  /// Types at each of the next questions.
  static void answer(Terminal& terminal, const std::vector<std::string>& keys) {
    int asked = 0;
    for (const std::string& key : keys) {
      ASSERT_TRUE(terminal.shows(kQuestion, ++asked)) << terminal.screen();
      terminal.type(key);
    }
  }

  /// Announcements and results.
  int logged() const { return lines(test::lasting_part_of(directory())); }
  bool program_asked() const { return fs::exists(here() / "asked"); }
};

TEST_F(StepRun, ShowsEveryTapBeforeItIsAnnouncedMakesItAtEnterAndLeavesTheRecordAsItIs) {
  const std::unique_ptr<Terminal> terminal = at_terminal(robot());
  for (int tap = 1; tap <= 4; ++tap) {
    ASSERT_TRUE(terminal->shows(kQuestion, tap)) << terminal->screen();
    EXPECT_EQ(logged(), 2 * (tap - 1)) << "nothing of this tap is in the log";
    EXPECT_EQ(program_asked(), tap > 1);
    terminal->type("\n");
  }
  EXPECT_EQ(terminal->wait(), 0);
  EXPECT_THAT(terminal->screen(),
              AllOf(HasSubstr("tap 1 of 4 at ("),
                    HasSubstr(") cm, one of the initial taps\r\n"
                              "      start 'python3 -SE program.py', which has 120 s, for this motion:\r\n"
                              "      travel to ("),
                    HasSubstr("      ask 'python3 -SE program.py', which has 90 s, for this motion:\r\n"
                              "      travel from ("),
                    HasSubstr(") cm at 13.5 cm above the desk, 30.0 cm/s\r\n"
                              "      descend at 2.4 cm/s in steps of 3.0 cm to at most 3.0 cm below the desk\r\n"
                              "      stop at 10.0 N above the tare: a contact\r\n"
                              "      Enter taps, q ends: "),
                    HasSubstr("tap 4 of 4 at ("), HasSubstr(") cm, chosen by the acquisition; expected height ")));
  const fs::path stepped = directory();
  ASSERT_EQ(palpate(robot("--force --quiet --runs others")).status, 0);
  EXPECT_EQ(part_of(stepped, "tap"), part_of(directory("others"), "tap"));
}

TEST_F(StepRun, EndsAtQWithoutATraceOfTheTapAndResumeCarriesOn) {
  std::unique_ptr<Terminal> terminal = at_terminal(robot());
  answer(*terminal, {"\n", "q\n"});
  EXPECT_EQ(terminal->wait(), 130);
  EXPECT_THAT(terminal->screen(), HasSubstr("interrupted after 1 taps"));
  EXPECT_EQ(logged(), 2);
  EXPECT_THAT(status_of(directory()).out, HasSubstr("unfinished"));

  terminal = at_terminal({"resume", directory()});
  answer(*terminal, {"\n", "\n", "\n"});
  EXPECT_EQ(terminal->wait(), 0);
  EXPECT_THAT(terminal->screen(), HasSubstr("tap 2 of 4 at ("));
  EXPECT_EQ(outcomes(directory()), std::vector<std::string>(4, "contact"));
}

TEST_F(StepRun, EndsInTheSameWayAtControlCControlDSigtermAndAClosedTerminal) {
  const auto type = [](char key) { return [key](Terminal& terminal) { terminal.type(std::string(1, key)); }; };
  const std::vector<std::pair<std::string, std::function<void(Terminal&)>>> ways{
      {"Ctrl-C", type(Terminal::kControlC)},
      {"Ctrl-D", type(Terminal::kControlD)},
      {"SIGTERM", [](Terminal& terminal) { terminal.signal(SIGTERM); }},
      {"closed", [](Terminal& terminal) { terminal.close(); }}};
  for (const auto& [name, way] : ways) {
    const std::unique_ptr<Terminal> terminal = at_terminal(robot());
    ASSERT_TRUE(terminal->shows(kQuestion));
    way(*terminal);
    EXPECT_EQ(terminal->wait(), 130) << name;
    EXPECT_EQ(logged(), 0) << name;
    EXPECT_FALSE(program_asked()) << name;
    fs::remove_all(here() / "runs");
  }
}

TEST_F(StepRun, KilledAtTheQuestionLeavesNoTapInDoubt) {
  const std::unique_ptr<Terminal> terminal = at_terminal(robot());
  answer(*terminal, {"\n"});
  ASSERT_TRUE(terminal->shows(kQuestion, 2));
  terminal->signal(SIGKILL);
  EXPECT_EQ(terminal->wait(), 128 + SIGKILL);
  const Ended resumed = resume(directory());
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(outcomes(directory()), std::vector<std::string>(4, "contact"));
}

TEST_F(StepRun, TakesNothingForAnAnswerThatWasTypedBeforeTheQuestion) {
  const std::unique_ptr<Terminal> terminal = at_terminal(robot());
  answer(*terminal, {"\n\n", "q\n"});
  EXPECT_EQ(terminal->wait(), 130);
  EXPECT_EQ(outcomes(directory()), std::vector<std::string>{"contact"})
      << "the second Enter came while the first tap was made";
}

TEST_F(StepRun, AsksAgainAfterAnythingElse) {
  const std::unique_ptr<Terminal> terminal = at_terminal(robot());
  answer(*terminal, {"yes\n", "q\n"});
  EXPECT_EQ(terminal->wait(), 130);
  EXPECT_EQ(logged(), 0);
}

TEST_F(StepRun, IsRefusedWithoutATerminalBeforeAnythingStarts) {
  EXPECT_EQ(refused(robot("--step")),
            "command line: --step: needs a terminal to show each tap and to wait for Enter, connect stdin and stderr "
            "to a terminal\n");
  EXPECT_FALSE(program_asked());
  EXPECT_TRUE(left_nothing());
  ASSERT_EQ(palpate(robot("--quiet")).status, 0);
  EXPECT_THAT(refused({"resume", directory(), "--step"}), HasSubstr("needs a terminal"));
}

TEST_F(StepRun, IsRefusedWhereTapsCanBeRepeated) {
  for (const Words& words : {robot("backend.repeatable=true"), Words{"run", paper()}}) {
    const std::unique_ptr<Terminal> terminal = at_terminal(words);
    EXPECT_EQ(terminal->wait(), 2);
    EXPECT_THAT(terminal->screen(), HasSubstr("can be repeated and need no confirmation, leave it out\r\n"));
    EXPECT_EQ(lines(terminal->screen()), 1);
    EXPECT_TRUE(left_nothing());
  }
  EXPECT_FALSE(program_asked());
}

TEST_F(StepRun, IsRefusedForASweepAndWhereNothingIsShown) {
  const std::unique_ptr<Terminal> terminal = at_terminal({"resume", swept("seed=range(0,2) taps=3 initial.count=3")});
  EXPECT_EQ(terminal->wait(), 2);
  EXPECT_THAT(terminal->screen(), EndsWith("is a sweep of many runs, leave it out\r\n"));
  EXPECT_EQ(palpate(robot("--quiet --step")).status, 2);
}

}  // namespace
}  // namespace palpate
