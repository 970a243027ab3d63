// SPDX-License-Identifier: MIT
// Runs and sweeps whose acquisition is a program: killed, resumed, read by others; and the one to begin with.
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

namespace palpate {
namespace {

using test::eventually;

class ProgramRun : public Shell {
 protected:
  /// A program that gives back the first of its arrays, and does `more` before each answer.
  std::string echo(const std::string& reads, const std::string& more = ":") const {
    write("echo.sh", "# reads=[\"" + reads + "\"]\nwhile read -r ask; do\n" + more +
                         "\n  b=${ask##*\\\"bytes\\\":}\n  head -c \"${b%\\}}\"\ndone\n");
    return "acquisition={type: program, command: sh echo.sh}";
  }
  static Words few(const std::string& acquisition, const Words& more = {}) {
    return Words{acquisition, "taps=9"} + more;
  }
  static std::string default_config() { return (test::source_folder() / "configs/default.yaml").string(); }
};

TEST_F(ProgramRun, TapsAsThePluginWithTheSameScoresOnAnyNumberOfThreads) {
  const std::string acquisition = echo("uncertainty");
  const fs::path own = ran(few(acquisition, "name=own choice.tie_tolerance=0"));
  const fs::path plugin = ran(few("acquisition=uncertainty", "name=plugin choice.tie_tolerance=0"));
  EXPECT_EQ(text_of(own / "taps.csv"), text_of(plugin / "taps.csv"));
  const fs::path threads = ran(few(acquisition, "name=threads belief.engine.threads=2 choice.tie_tolerance=0"));
  EXPECT_EQ(text_of(own / "taps.csv"), text_of(threads / "taps.csv"));
}

TEST_F(ProgramRun, BesideARobotsProgramLeavesThatToEndByItself) {
  const std::string robot =
      write("robot.py", test::python("for ask in asks():\n    contact(ask)\nopen('parked', 'w').close()\n")).string();
  const Words words{"backend=process", "backend.command=python3 -SE '" + robot + "'", "backend.repeatable=false"};
  ran(few(echo("uncertainty"), words));
  EXPECT_TRUE(fs::exists(here() / "parked")) << "its stdin ended, and it had time to see to its arm";
}

TEST_F(ProgramRun, MayAnswerWhileItReads) {
  const fs::path own = ran(Words{echo("uncertainty"), "name=own", "candidates.count=300", "taps=4"});
  EXPECT_EQ(lines(text_of(own / "taps.csv")), 5);
}

TEST_F(ProgramRun, BeginsInTheFolderThatTheConfigNamesAndIsFoundFromElsewhere) {
  echo("uncertainty");
  write("mine/own", "#!/bin/sh\n" + text_of(here() / "echo.sh"));
  fs::permissions(here() / "mine/own", fs::perms::owner_all);
  const std::string own = "acquisition={type: program, command: ./own, folder: '" + (here() / "mine").string() + "'}";
  const fs::path run = ran(few(own));
  EXPECT_EQ(lines(text_of(run / "taps.csv")), 10);
  const fs::path cut = ran(few(own, "name=cut"));
  break_off(cut);
  const Ended resumed = test::palpate({"resume", fs::absolute(cut).string(), "--quiet"}, here() / "mine");
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(text_of(cut / "taps.csv"), text_of(run / "taps.csv"));
  EXPECT_THAT(refused(Words{"run", paper(), "acquisition={type: program, command: ./own, folder: mine}"}),
              testing::HasSubstr("folder: is not an absolute path"));
}

TEST_F(ProgramRun, WhoReadsARecordStartsNothingAndFindsTheRecordedChoices) {
  const std::string trace = (here() / "started").string();
  const std::string acquisition = echo("object_probability", "touch '" + trace + "'");
  const fs::path run = ran(few(acquisition), default_config());
  ASSERT_TRUE(fs::remove(trace)) << "it was started by the run";
  const std::string before = text_of(run / "taps.csv");
  for (const Words& words : {Words{"replay", run}, Words{"report", run}, Words{"report", run, "--figures"},
                             Words{"explain", run, "9"}, Words{"status", run}, Words{"list"},
                             Words{"report", run, run, "--to", "."}, Words{"export", run, "--to", "out"}}) {
    const Ended ended = palpate(words);
    EXPECT_EQ(ended.status, 0) << words.front() << ": " << ended.err;
    EXPECT_EQ(ended.err, "") << words.front();
  }
  EXPECT_THAT(palpate({"replay", run}).out, testing::ContainsRegex("9 taps, [0-9]+ numbers, all equal"));
  // A table that was lost is written again, a finished run is shown.
  fs::remove(run / "taps.csv");
  fs::remove(run / "surface.csv");
  EXPECT_EQ(resume(run).status, 0);
  EXPECT_EQ(text_of(run / "taps.csv"), before);
  // Nor is a config that was received: it is only looked at.
  const std::string config =
      write("strange.yaml",
            "strategy: default\nscene: object_i\nbackend: simulator\nacquisition: {type: program, command: sh "
            "echo.sh, reads: uncertainty}\n");
  EXPECT_EQ(palpate({"validate", config}).status, 0);
  EXPECT_EQ(palpate({"run", config, "--print-config"}).status, 0);
  EXPECT_FALSE(fs::exists(trace));
  fs::remove(here() / "echo.sh");
  EXPECT_EQ(palpate({"replay", run}).status, 0) << "the program need not be there";
}

TEST_F(ProgramRun, AnotherProgramIsAnotherRunAndCarriesNoneOn) {
  const fs::path first = ran(few(echo("uncertainty")));
  EXPECT_EQ(run(few(echo("uncertainty"), "acquisition.deadline=5s")).status, 0);
  EXPECT_EQ(directory(), first) << "how long it may take is not what it says";
  cut_taps(first);
  const std::string other = echo("uncertainty", "true");
  EXPECT_THAT(refused({"resume", first, "--quiet"}, 75),
              AllOf(HasSubstr("acquisition/program"), HasSubstr("restore the program that the run started with")));
  const fs::path second = ran(few(other, "--runs other"));
  EXPECT_NE(first.filename(), second.filename());
  echo("uncertainty");
  EXPECT_EQ(resume(first).status, 0);
  EXPECT_EQ(text_of(first / "taps.csv"), text_of(second / "taps.csv")) << "which scores alike";
}

TEST_F(ProgramRun, ASweepWhoseProgramIsChangedStopsAndNoJobFailsByIt) {
  const std::string acquisition = echo("uncertainty", "[ -e once ] || { touch once; echo '# changed' >> echo.sh; }");
  const std::string before = text_of(here() / "echo.sh");
  const Ended stopped = palpate(Words{"sweep", paper()} + few(acquisition, "seed=range(0,4) -j 1"));
  EXPECT_EQ(stopped.status, 1);
  EXPECT_THAT(stopped.err, AllOf(HasSubstr("job 1: "), HasSubstr("restore the program that the run started with"),
                                 testing::Not(HasSubstr("job 2: "))));
  const fs::path sweep = directory();
  const std::string last = "stopped for the reason above; correct it, then run: palpate resume ";
  EXPECT_THAT(stopped.out, AllOf(HasSubstr(last), testing::Not(HasSubstr("carry on"))));
  EXPECT_THAT(status_of(sweep).out, HasSubstr("4 jobs, 1 done, 0 running, 0 failed"));
  const Ended again = palpate({"resume", sweep, "-j", "2"});
  EXPECT_EQ(again.status, 1);
  EXPECT_THAT(again.out, HasSubstr(last)) << "which would fail again as it is";
  const auto running = again.err.rfind(" running");
  ASSERT_NE(running, std::string::npos) << again.err;
  EXPECT_EQ(again.err.substr(running - 3, 3), ", 0") << again.err;
  write("echo.sh", before);
  EXPECT_EQ(resume(sweep).status, 0) << "without --retry-failed";
  EXPECT_THAT(status_of(sweep).out, HasSubstr("4 jobs, 4 done"));
}

TEST_F(ProgramRun, AProgramThatDiesFailsTheRunInOneLineAndTheRunIsCarriedOn) {
  const std::string acquisition = echo("uncertainty", "[ -e well ] || { echo 'out of memory' >&2; exit 3; }");
  const std::string told = refused(Words{"run", paper(), "--quiet"} + few(acquisition), 1);
  EXPECT_THAT(told, testing::MatchesRegex(
                        "acquisition/program: the program ended with exit status 3, its last output: 'out of memory', "
                        "correct it, its output is in runs/.*/acquisition_[0-9a-f]{8}.stderr.txt\n"));
  EXPECT_EQ(lines(part_of(directory(), "tap")), 3) << "the initial taps are kept";
  write("well", "");
  EXPECT_EQ(resume(directory(), "--retry-failed").status, 0);
  EXPECT_EQ(outcomes(directory()).size(), 9U);
}

TEST_F(ProgramRun, AnInterruptEndsTheProgramAndLeavesARunToCarryOn) {
  const auto child = begin(Words{"run", paper(), "--quiet"} + few(echo("uncertainty", "echo $$ > pid; sleep 600")));
  EXPECT_TRUE(eventually([&] { return fs::exists(here() / "pid") && !text_of(here() / "pid").empty(); }));
  child->signal(SIGINT);
  EXPECT_EQ(child->wait().status, 130);
  EXPECT_FALSE(test::running(std::stol(text_of(here() / "pid"))));
  EXPECT_THAT(status_of(directory()).out, HasSubstr("unfinished after 3 of 9 taps"));
}

TEST_F(ProgramRun, FromAnySideAProgramScoresLinesAndIsReplayedByItsRecord) {
  const std::string config = (test::source_folder() / "configs/any_side.yaml").string();
  const Words few = "taps=9 scene=any_bowl candidates.count=200 belief.moves=100";
  const fs::path own = ran(few + Words{echo("expected_discovery"), "name=own"}, config);
  write("echo.sh", "exit 1\n");
  EXPECT_THAT(palpate({"replay", own}).out, HasSubstr("all equal"));
  EXPECT_EQ(palpate({"explain", own, "9"}).status, 0);
  EXPECT_THAT(refused(Words{"run", config, "scene=any_bowl", echo("object_probability")}),
              HasSubstr("program reads object_probability, which the belief solids does not offer"));
}

TEST_F(ProgramRun, InPythonOneFunctionIsAnAcquisitionThatIsTestedRunAndReplayed) {
  const std::string python = "/usr/bin/python3";  // Debian's own, which has NumPy
  if (test::run_program({python, "-c", "import numpy"}, here()).status != 0) GTEST_SKIP() << "NumPy is not installed";
  const Ended made = palpate({"new", "acquisition", "--python", "curious"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("python3 curious/test_curious.py\n"));
  const Ended tested = test::run_program({python, "-B", "curious/test_curious.py"}, here());
  EXPECT_EQ(tested.status, 0) << tested.err;
  const auto without = [&](const std::string& name) {
    const std::string code = "from palpate_acquisition import Belief; Belief(seed=1)." + name;
    return test::run_program({python, "-B", "-c", code}, here() / "curious").err;
  };
  EXPECT_THAT(without("hypotheses"),
              HasSubstr("this belief was made without hypotheses: add hypotheses=... to its Belief(...)"));
  EXPECT_THAT(without("random"), HasSubstr("made without random: add seed=1, tap=1 to its Belief(...)"));
  const Words run{"taps=6", "acquisition.command=" + python + " -B curious/curious.py"};
  const fs::path own = ran(run, (here() / "curious/curious.yaml").string());
  EXPECT_THAT(text_of(own / "config.yaml"), HasSubstr("reads: \"uncertainty, object_probability\""));
  EXPECT_EQ(palpate({"replay", own}).status, 0);
  EXPECT_THAT(text_of(own / "config.yaml"), HasSubstr("placement: random")) << "else 30 seeds are one place";
  EXPECT_EQ(refused({"new", "kernel", "--python", "mine"}),
            "command line: --python: a plugin of the kind kernel cannot be a function of Python, leave --python out; "
            "only an acquisition can be one\n");
  EXPECT_THAT(refused({"new", "acquisition", "--python", "a-b"}), HasSubstr("is not a valid name of a Python module"));
}

TEST_F(ProgramRun, InPythonWhatGoesWrongIsTold) {
  const std::string python = "/usr/bin/python3";
  if (test::run_program({python, "-c", "import numpy"}, here()).status != 0) GTEST_SKIP() << "NumPy is not installed";
  const auto trouble = [&](const std::string& body, const std::string& more = "") {
    write("mine.py",
          "import numpy\nfrom palpate_acquisition import acquisition\n\n@acquisition(reads=['uncertainty'])\n"
          "def score(belief):\n    " +
              body + "\n");
    return refused(Words{"run", paper(), "--quiet", "taps=5",
                         "acquisition={type: program, command: " + python + " -B mine.py" + more + "}"},
                   1);
  };
  EXPECT_THAT(trouble("return belief.uncertainty[1:]"),
              HasSubstr("score returned an array of shape (2208,), not (2209,)"));
  EXPECT_THAT(trouble("return belief.height_mean"),
              HasSubstr("AttributeError: the belief has no height_mean: add it to reads=[...]"));
  EXPECT_THAT(trouble("return belief.uncertainty", ", reads: height_mean"),
              HasSubstr("the config has 'reads: height_mean', but score has reads=['uncertainty']"));
  EXPECT_THAT(trouble("print('hello'); return belief.uncertainty / 0"), HasSubstr("which is not a finite number"));
}

}  // namespace
}  // namespace palpate
