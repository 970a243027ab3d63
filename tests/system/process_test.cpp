// SPDX-License-Identifier: MIT
// Whole runs on another program: the shipped example, programs that misbehave, kills and interrupts.
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <sstream>

namespace palpate {
namespace {

using test::eventually;

class ProcessRun : public Shell {
 protected:
  /// What runs `body` instead of the example.
  std::string command(const std::string& body) const {
    return "backend.command=python3 -SE '" + write("program.py", test::python(body)).string() + "'";
  }
  static Words process(const Words& more) { return Words{"run", config("process.yaml"), "--quiet"} + more; }

  std::string diary() const {
    std::string text;
    for (const auto& entry : fs::recursive_directory_iterator(here())) {
      if (entry.path().filename() == "process.stderr.txt") text += text_of(entry.path());
    }
    return text;
  }
};

TEST_F(ProcessRun, TheExampleTapsItsDomeFromTheProjectsFolder) {
  std::string first;
  for (const char* runs : {"one", "two"}) {
    const fs::path where = here() / runs;
    const Ended ended = test::palpate(process({"--runs", where}), test::source_folder());
    ASSERT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.err, "");
    const std::string taps = text_of(only_run(where) / "taps.csv");
    EXPECT_EQ(text_of(only_run(where) / "process.stderr.txt"), "");
    EXPECT_EQ(part_of(only_run(where), "intent"), "") << "it is repeatable";
    if (first.empty()) first = taps;
    EXPECT_EQ(taps, first);
  }
  int on = 0;
  for (const Cells& row : csv_rows(first)) {
    const double away = std::hypot(std::stod(row.at("x")) - 0.115, std::stod(row.at("y")) - 0.115);
    const double dome = std::sqrt(std::max(0.0, 0.06 * 0.06 - away * away));
    EXPECT_EQ(row.at("outcome"), "contact");
    EXPECT_NEAR(std::stod(row.at("height")), dome, 1e-12);
    EXPECT_EQ(row.at("force"), "10");
    on += dome > 0.01 ? 1 : 0;
  }
  EXPECT_GE(on, 5);
  EXPECT_LE(lines(text_of(test::source_folder() / "plugins/backends/process/example.py")), 20);
}

TEST_F(ProcessRun, WhatGoesWrongIsInTheRecordAndTheRunGoesOn) {
  const std::string program = command(R"(
for ask in asks():
    tap = ask["tap"]
    if tap == 2: print('{"tap": 2, "outcome": "contact", "height": NaN, "seconds": 1}', flush=True)
    elif tap == 3: sys.exit("no arm, \"not\" today")
    elif tap == 5: time.sleep(60)
    elif tap == 6: os.write(1, b'\xff\x00","outcome":"contact",\n')
    elif tap == 7: tell(ask, outcome="no_contact", seconds=3, reason='an "end",\n\x1bof way')
    elif tap == 8: tell(ask, outcome="contact", height=70, seconds=3)
    else: contact(ask)
)");
  // Only of the fifth tap, in a program under way, the deadline is to be missed: other taps have time on a busy
  // machine.
  const Ended ended = palpate(process({program, "taps=10", "backend.deadline=3s", "backend.start=60s"}));
  ASSERT_EQ(ended.status, 0) << ended.err;
  const std::vector<std::string> expected{"contact", "aborted",    "aborted", "contact", "timeout",
                                          "aborted", "no_contact", "aborted", "contact", "contact"};
  EXPECT_EQ(outcomes(directory()), expected);
  const std::string taps = part_of(directory(), "tap");
  EXPECT_THAT(taps, HasSubstr(R"(which has no NaN and no Infinity: '{\"tap\": 2)"));
  EXPECT_THAT(taps, HasSubstr(R"(its last output: 'no arm, \"not\" today')"));
  EXPECT_THAT(taps, HasSubstr(R"("reason": "an \"end\",  of way")"));
  EXPECT_EQ(diary(), "no arm, \"not\" today\n");
  const Ended replayed = palpate({"replay", directory()});
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  EXPECT_THAT(text_of(directory() / "summary.json"), HasSubstr("\"failed_taps\": 6"));
}

TEST_F(ProcessRun, InterruptedWhileItWaitsTheRunEndsAtOnceAndLeavesNoProgram) {
  const std::string program = command(
      "print(os.getpid(), file=sys.stderr, flush=True)\n"
      "for ask in asks():\n    if ask['tap'] == 2: time.sleep(60)\n    contact(ask)");
  const auto child = begin(process({program, "backend.repeatable=false"}));
  EXPECT_TRUE(
      eventually([&] { return !left_nothing() && !diary().empty() && lines(part_of(directory(), "intent")) == 2; }));
  child->signal(SIGINT);
  EXPECT_EQ(child->wait().status, 130);
  EXPECT_FALSE(test::running(std::stol(diary())));
  EXPECT_EQ(outcomes(directory()), (std::vector<std::string>{"contact", "aborted"}));
  EXPECT_THAT(part_of(directory(), "tap"), HasSubstr("\"reason\": \"interrupted\""));
}

TEST_F(ProcessRun, AMissingProgramIsOneLineAndLeavesNoRun) {
  EXPECT_EQ(palpate({"validate", config("process.yaml")}).status, 0);
  EXPECT_THAT(refused(process({"backend.command=pyhton3 x.py"})), HasSubstr("there is no program 'pyhton3'"));
  EXPECT_TRUE(left_nothing());
}

TEST_F(ProcessRun, WhatAProgramStartedIsEndedWithItWhereverItWent) {
  ran({"taps=2", "initial.count=2",
       command("import subprocess\n"
               "def start(words, **more):\n"
               "    return subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, **more).pid\n"
               "pids = [start(['sleep', '600'], start_new_session=True)]\n"
               "pids.append(start(['sleep', '600'], preexec_fn=os.setpgrp))\n"
               "pids.append(start(['env', '-i', '/bin/sleep', '600'], start_new_session=True))\n"
               "left = subprocess.run(['setsid', 'sh', '-c', 'setsid sleep 600 >/dev/null 2>&1 & echo $!'], "
               "stdout=subprocess.PIPE)\n"
               "pids.append(int(left.stdout))\n"
               "chain = subprocess.Popen(['setsid', 'sh', '-c', 'sleep 600 >/dev/null & echo $!; wait'], "
               "stdout=subprocess.PIPE)\n"
               "pids += [chain.pid, int(chain.stdout.readline())]\n"
               "print(' '.join(map(str, pids)), file=sys.stderr, flush=True)\n"
               "for ask in asks(): contact(ask)\n")},
      config("process.yaml"));
  std::istringstream pids(diary());
  int count = 0;
  for (long pid = 0; pids >> pid; ++count) {
    EXPECT_FALSE(test::running(pid)) << pid;
    if (test::running(pid)) ::kill(static_cast<pid_t>(pid), SIGKILL);
  }
  EXPECT_EQ(count, 6);
}

}  // namespace
}  // namespace palpate
