// SPDX-License-Identifier: MIT
// The backend `process` against programs that behave and programs that do not.
#include "unit/process_backend.hpp"

#include <csignal>

#include <fcntl.h>
#include <unistd.h>

namespace palpate::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST_F(ProcessBackend, AsksInOneLineThatHoldsAllThatAProgramNeeds) {
  const auto backend = open("for line in sys.stdin:\n    sys.stderr.write(line)\n    contact(json.loads(line))",
                            ", motion: {pause: 250 ms, adaptive_hover: {clearance: 2 cm}}");
  EXPECT_EQ(backend->predicts(), (QuantitySet{quantity::kHeightMean, quantity::kHeightStd}));
  const TapResult contact = tap(*backend, 1);
  expect_contact(contact);
  TapRequest second = request(2);
  second.previous = line_from_above({0.05, 0.125});
  second.predicted = Prediction{0.03, 0.5};
  expect_contact(backend->tap(second));
  const std::string same =
      R"("area":{"width":0.23,"depth":0.23},"desk":0.0,"seed":1,"motion":{"type":"paper","step":0.03,"pause":0.25,)"
      R"("speed":0.024,"threshold":10.0,"hover":0.135,"adaptive_hover":{"deviations":2.0,"clearance":0.02,"speed":0.1,)"
      R"("certainty":null},)"
      R"("travel_speed":0.3,"retreat_speed":0.3,"tare":0.2,"overrun":0.03,"timeout":60.0,"force_limit":null}})"
      "\n";
  EXPECT_EQ(diary(), R"({"palpate":1,"tap":1,"x":0.1,"y":0.2,"previous":null,"predicted":null,)" + same +
                         R"({"palpate":1,"tap":2,"x":0.1,"y":0.2,"previous":{"x":0.05,"y":0.125},)" +
                         R"("predicted":{"height":0.03,"standard_deviation":0.5},)" + same);
}

TEST_F(ProcessBackend, SaysWhatItIsTold) {
  const auto careful = start("true");
  EXPECT_FALSE(careful->repeatable());
  EXPECT_FALSE(careful->scene_is_truth());
  EXPECT_EQ(careful->predicts(), QuantitySet());
  const auto bold = start("true", ", repeatable: true, scene_is_truth: true");
  EXPECT_TRUE(bold->repeatable());
  EXPECT_TRUE(bold->scene_is_truth());
}

TEST_F(ProcessBackend, EveryFailureOfTheProgramsOwnKeepsItsOutcomeAndReason) {
  const auto backend = open(
      "for ask in asks():\n"
      "    outcome = ['no_contact', 'unreachable', 'timeout', 'aborted'][ask['tap'] - 1]\n"
      "    tell(ask, outcome=outcome, height=None, reason='h\\u00f6her ' + outcome, seconds=2)");
  int number = 0;
  for (const auto& [outcome, name] :
       {std::pair(Outcome::no_contact, "no_contact"), std::pair(Outcome::unreachable, "unreachable"),
        std::pair(Outcome::timeout, "timeout"), std::pair(Outcome::aborted, "aborted")}) {
    const TapResult contact = tap(*backend, ++number);
    expect_failure(contact, outcome, std::string("h\u00f6her ") + name);
    EXPECT_EQ(contact.seconds, 2.0);
  }
}

TEST_F(ProcessBackend, AProgramEndsTheRunWithAReasonWhateverBecameOfItsTap) {
  const auto backend = open(
      "for ask in asks():\n"
      "    if ask['tap'] == 1: contact(ask, ends_run=False)\n"
      "    elif ask['tap'] == 2: contact(ask, ends_run=None)\n"
      "    elif ask['tap'] == 3: contact(ask, ends_run=True, reason='it\\nholds')\n"
      "    else: tell(ask, outcome='unreachable', reason='it holds', seconds=2, ends_run=True)");
  expect_contact(tap(*backend, 1));
  expect_contact(tap(*backend, 2));
  const TapResult touched = tap(*backend, 3);
  EXPECT_TRUE(touched.ends_run);
  EXPECT_EQ(touched.outcome, Outcome::contact);
  EXPECT_EQ(touched.height(), 0.07);
  EXPECT_EQ(touched.reason, "it holds");
  const TapResult failed = tap(*backend, 4);
  EXPECT_TRUE(failed.ends_run);
  expect_failure(failed, Outcome::unreachable, "it holds");
  EXPECT_EQ(failed.seconds, 2.0);
}

TEST_F(ProcessBackend, AStopThatIsBadlyToldIsAStopAllTheSame) {
  const auto backend = open(
      "for ask in asks():\n"
      "    if ask['tap'] == 1: tell(ask, outcome='abort', seconds=1, ends_run=True, reason='a protective stop')\n"
      "    elif ask['tap'] == 2: tell(ask, outcome='aborted', seconds=1, ends_run='true', reason='a protective stop')\n"
      "    elif ask['tap'] == 3: tell({'tap': 1}, outcome='aborted', seconds=1, ends_run=True, reason='a stop')\n"
      "    elif ask['tap'] == 4: tell(ask, outcome='abort', seconds=1, ends_run=False)\n"
      "    else: tell(ask, outcome='abort', seconds=1)");
  for (int number = 1; number <= 5; ++number) {
    const TapResult contact = tap(*backend, number);
    EXPECT_EQ(contact.outcome, Outcome::aborted);
    EXPECT_THAT(contact.reason, StartsWith("the answer "));
    EXPECT_EQ(contact.ends_run, number <= 3) << contact.reason;
  }
}

TEST_F(ProcessBackend, ControlCharactersAndLengthOfAReasonDoNotReachTheRecord) {
  const TapResult contact =
      second_tap(R"(tell(ask, outcome='no_contact', reason='a\nb\x1b[2J\x7f\x9b' + '\u00e9' * 300, seconds=1))", true);
  EXPECT_EQ(contact.outcome, Outcome::no_contact);
  EXPECT_THAT(contact.reason, StartsWith("a b [2J  \u00e9\u00e9"));
  EXPECT_LT(contact.reason.size(), 210U);
  EXPECT_EQ(contact.reason.substr(contact.reason.size() - 5), "\u00e9...") << "cut between characters";
}

TEST_F(ProcessBackend, MarksThatTurnTheDirectionOfWritingDoNotReachTheRecord) {
  const TapResult contact =
      second_tap(R"(tell(ask, outcome='no_contact', reason='a\u202eb\u2066c\u200fd\u2028e \u05d0', seconds=1))", true);
  EXPECT_EQ(contact.reason, "a b c d e \u05d0");
}

TEST_F(ProcessBackend, HeightsAreTakenDownToOneCentimetreBelowTheFloorAndUpToTheHeightOfTravel) {
  const auto backend = open(
      "for ask in asks(): tell(ask, outcome='contact', seconds=1, height=-0.0199 if ask['tap'] == 1 "
      "else -0.0201 if ask['tap'] == 2 else 0.2)",
      ", motion: {type: continuous, overrun: 1 cm, hover: 20 cm}");
  EXPECT_EQ(tap(*backend, 1).height(), -0.0199);
  const TapResult below = tap(*backend, 2);
  EXPECT_EQ(below.outcome, Outcome::aborted);
  EXPECT_FALSE(below.contact);
  EXPECT_THAT(below.reason, HasSubstr("height -0.0201 m is outside -0.02 to 0.2 m"));
  EXPECT_EQ(tap(*backend, 3).height(), 0.2);
}

TEST_F(ProcessBackend, LongAnswersInSmallPiecesToSlowReadersAreFine) {
  const auto backend = open(
      "for ask in asks():\n"
      "    time.sleep(0.01)\n"
      "    line = json.dumps({'tap': ask['tap'], 'outcome': 'contact', 'height': 0.07, 'seconds': 5.5}) + ' ' * 60000\n"
      "    for piece in (line[:1], line[1:20], line[20:50000], line[50000:], '\\r\\n'):\n"
      "        print(piece, end='', flush=True)\n"
      "        time.sleep(0.002)");
  for (int number = 1; number <= 3; ++number) expect_contact(tap(*backend, number));
}

TEST_F(ProcessBackend, ASecondLineIsRefusedAtTheNextTapBeforeTheArmMoves) {
  const auto backend = open(
      "for ask in asks():\n"
      "    print('asked', ask['tap'], file=sys.stderr, flush=True)\n"
      "    line = json.dumps({'tap': ask['tap'], 'outcome': 'contact', 'height': 0.07, 'seconds': 5.5}) + '\\n'\n"
      "    os.write(1, (line + ('well done\\n' if ask['tap'] == 1 else '')).encode())");
  expect_contact(tap(*backend, 1));
  expect_failure(tap(*backend, 2), Outcome::aborted, "the program printed more than its answer: 'well done'");
  expect_contact(tap(*backend, 3));
  EXPECT_EQ(diary(), "asked 1\nasked 3\n");
}

TEST_F(ProcessBackend, AProgramThatNeverAnsweredIsAskedWhetherItFlushes) {
  const auto backend = open("for ask in asks(): time.sleep(60)", ", deadline: 500 ms, start: 0 s");
  expect_failure(
      tap(*backend, 1), Outcome::timeout,
      "the program did not answer in time and has never answered, check that it flushes its output after each line");
}

TEST_F(ProcessBackend, StartingMayTakeLongerThanATap) {
  const auto backend = open("time.sleep(0.5)\nfor ask in asks(): contact(ask)", ", deadline: 300 ms, start: 20 s");
  expect_contact(tap(*backend, 1));
  expect_contact(tap(*backend, 2));
}

TEST_F(ProcessBackend, AnEarlyEndIsToldWithItsStatusAndItsLastWords) {
  expect_failure(second_tap("sys.exit('no arm\\x1b\\nnot today')", false), Outcome::aborted,
                 "the program ended with exit status 1, its last output: 'not today'");
  EXPECT_EQ(diary(), "no arm\x1b\nnot today\n");
}

TEST_F(ProcessBackend, AnEndBetweenTapsFailsTheNextTap) {
  const auto backend = open("for ask in asks():\n    contact(ask)\n    sys.exit(4)");
  for (int number = 1; number <= 4; ++number) {
    const TapResult contact = tap(*backend, number);
    if (number % 2 == 1) {
      expect_contact(contact);
    } else {
      expect_failure(contact, Outcome::aborted, "the program ended with exit status 4");
    }
  }
}

TEST_F(ProcessBackend, AClosedStdinFailsTheTapAndRaisesNoSigpipe) {
  const auto backend = open("ask = json.loads(sys.stdin.readline())\nos.close(0)\ncontact(ask)\ntime.sleep(60)");
  expect_contact(tap(*backend, 1));
  expect_failure(tap(*backend, 2), Outcome::aborted, "the program closed its stdin or stdout");
  sigset_t pending;
  ::sigpending(&pending);
  EXPECT_EQ(::sigismember(&pending, SIGPIPE), 0);
}

TEST_F(ProcessBackend, InterruptedWhileItWaitsTheTapIsAbortedAndTheProgramEnded) {
  const auto backend =
      plain(command("for ask in asks():\n    print(os.getpid(), file=sys.stderr, flush=True)\n    time.sleep(60)"));
  std::thread user([this] {
    eventually([this] { return !diary().empty(); });
    interrupted_ = true;
  });
  const TapResult contact = tap(*backend, 1);
  expect_failure(contact, Outcome::aborted, "interrupted");
  EXPECT_FALSE(contact.ends_run) << "the user's wish is no fault";
  user.join();
  EXPECT_FALSE(running(std::stol(diary())));
}

TEST_F(ProcessBackend, NothingIsLeftOfTheProgramNorOfWhatItStarted) {
  auto backend = open(
      "import subprocess\n"
      "other = subprocess.Popen(['sleep', '60'])\n"
      "print(other.pid, file=sys.stderr, flush=True)\n"
      "for ask in asks(): contact(ask)");
  const auto pid = pid_in(tap(*backend, 1).force);
  const long other = std::stol(diary());
  EXPECT_TRUE(running(pid));
  EXPECT_TRUE(running(other));
  EXPECT_EQ(::getpgid(static_cast<pid_t>(pid)), pid) << "a process group of its own";
  backend.reset();
  EXPECT_FALSE(fs::exists("/proc/" + std::to_string(pid))) << "not even a zombie";
  EXPECT_TRUE(eventually([&] { return !running(other); }));
}

TEST_F(ProcessBackend, AnEndIsToldThoughWhatTheProgramStartedHoldsItsStdout) {
  const auto backend = open("import subprocess\nsubprocess.Popen(['sleep', '60'])\nsys.exit(5)");
  expect_failure(tap(*backend, 1), Outcome::aborted, "the program ended with exit status 5");
}

TEST_F(ProcessBackend, TwoBackendsHoldNoneOfEachOthersPipes) {
  const std::string body = "for ask in asks(): contact(ask)\nprint('end of input', file=sys.stderr)";
  // Of a record's programs that are not repeatable there would be but one.
  auto first = open(body, ", repeatable: true");
  const auto second = open(body, ", repeatable: true");
  expect_contact(tap(*first, 1));
  expect_contact(tap(*second, 1));
  first.reset();  // would have to be killed, and say nothing, if the second program held its stdin
  EXPECT_EQ(diary(), "end of input\n");
  expect_contact(tap(*second, 2));
}

TEST_F(ProcessBackend, NoOpenFileOfOursReachesTheProgramButItsLock) {
  const int ours = ::open("/dev/null", O_RDONLY);  // NOLINT: without O_CLOEXEC on purpose
  const std::string list =
      "files = [f'/proc/self/fd/{n}' for n in range(2, 10)]\n"
      "names = ' '.join(os.path.basename(os.readlink(file)) for file in files if os.path.exists(file))\n"
      "for ask in asks(): tell(ask, outcome='aborted', seconds=0, reason=names)";
  EXPECT_EQ(tap(*open(list), 1).reason, "process.stderr.txt process.lock");
  EXPECT_EQ(tap(*open(list, ", repeatable: true"), 1).reason, "process.stderr.txt");
  ::close(ours);
}

TEST_F(ProcessBackend, ArgumentsArriveAsTheyAreWrittenWithoutAShell) {
  const std::string program =
      command("for ask in asks(): tell(ask, outcome='aborted', seconds=0, reason=repr(sys.argv[1:]))");
  const auto backend =
      start(program + R"(  "two  words" '$HOME;`date` *' a"b c"d ''	$HOME > x | y & \n "it's" '"')");
  EXPECT_EQ(tap(*backend, 1).reason,
            R"(['two  words', '$HOME;`date` *', 'ab cd', '', '$HOME', '>', 'x', '|', 'y', '&', '\\n', "it's", '"'])");
}

TEST_F(ProcessBackend, AnExecutableOfAnyLanguageIsStartedByItsPath) {
  const fs::path file = folder_.write("my robot", R"(#!/bin/sh
n=0
while read -r ask; do
  n=$((n + 1))
  echo "{\"tap\": $n, \"outcome\": \"contact\", \"height\": 7e-2, \"seconds\": 5.5}"
done
)");
  fs::permissions(file, fs::perms::owner_all);
  const auto backend = start("'" + file.string() + "'");
  for (int number = 1; number <= 3; ++number) expect_contact(tap(*backend, number));
}

TEST_F(ProcessBackend, IsTheSameWhileItsProgramIsWhateverItsOtherFilesHold) {
  const auto checksum = [](const std::string& command) {
    return choose(shared_host(), "backend", "process", "{command: " + yaml_quoted(command) + "}")
        .options->find("checksum")
        ->text;
  };
  const std::string arguments = " --log '" + (folder_.path() / "arm.log").string() + "'";
  const std::string file = folder_.write("arm.py", "first").string();
  const auto is_seen = [&](const std::string& command, bool program) {
    folder_.write("arm.py", "first");
    std::filesystem::remove(folder_.path() / "arm.log");
    const std::string before = checksum(command + arguments);
    folder_.write("arm.log", "tap 1");
    EXPECT_EQ(checksum(command + arguments), before) << command;
    folder_.write("arm.py", "second");
    EXPECT_EQ(checksum(command + arguments) != before, program) << command;
  };
  is_seen("python3 -S '" + file + "'", true);
  is_seen("/usr/bin/python3 '" + file + "'", true);
  is_seen("'" + file + "'", true);
  is_seen("python3 -m arm", false);
}

TEST_F(ProcessBackend, WhatItWritesToStderrIsKeptOverRestartsAndFillsNeitherMemoryNorDisk) {
  const auto backend = open("sys.stderr.write('x' * 999999 + '\\n')\nfor ask in asks():\n    contact(ask)\n    break");
  EXPECT_FALSE(fs::exists(folder_.path() / "record" / "process.stderr.txt")) << "nothing starts before the first tap";
  for (int number = 1; number <= 3; ++number) tap(*backend, number);
  EXPECT_GT(diary().size(), 500'000U);
  EXPECT_LT(diary().size(), 800'000U) << "of 2 MB";
}

TEST_F(ProcessBackend, WithoutARecordStderrIsDropped) {
  context_.directory.clear();
  const auto backend = open("sys.exit('unheard')");
  expect_failure(tap(*backend, 1), Outcome::aborted, "the program ended with exit status 1");
}

TEST_F(ProcessBackend, WhatCannotBeStartedIsRefusedWhenItIsBuilt) {
  EXPECT_THAT(refusal("pyhton3 x.py"), HasSubstr("command: there is no program 'pyhton3', names are searched in PATH"));
  EXPECT_THAT(refusal("./nowhere"), HasSubstr("command: there is no program './nowhere'"));
  EXPECT_THAT(refusal(folder_.path().string()), HasSubstr("there is no program"));
  EXPECT_THAT(refusal(folder_.write("plain", "x").string()), HasSubstr("there is no program"));
  for (const char* text : {"", "  ", "''", "python3 'open", "\"open"}) {
    EXPECT_THAT(refusal(text), HasSubstr("command: names no program, or has an unclosed quote")) << text;
  }
}

TEST_F(ProcessBackend, AFileThatIsNoProgramIsNotGivenToAShell) {
  const fs::path file = folder_.write("script", "touch " + (folder_.path() / "touched").string() + "\n");
  fs::permissions(file, fs::perms::owner_all);
  EXPECT_THAT(refusal(file.string()), HasSubstr("command: cannot start '" + file.string() + "': Exec format error"));
  EXPECT_FALSE(fs::exists(folder_.path() / "touched"));
}

TEST_F(ProcessBackend, AThousandTapsAreQuick) {
  const auto backend = open("for ask in asks(): contact(ask)");
  tap(*backend, 1);
  const auto begin = std::chrono::steady_clock::now();
  for (int number = 2; number <= 1001; ++number) expect_contact(tap(*backend, number));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  RecordProperty("taps_per_second", static_cast<int>(1000 / seconds));
  // About 0.05 s; a wait that slept instead of being woken would take 20.
  EXPECT_LT(seconds, 10.0);
}

}  // namespace
}  // namespace palpate::test
