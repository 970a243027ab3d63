// SPDX-License-Identifier: MIT
// What becomes of a run when its program is gone, or when one of an earlier attempt is still there.
#include "unit/process_backend.hpp"

#include <csignal>
#include <thread>

namespace palpate::test {
namespace {

constexpr const char* kSeeToIt = "; check the robot, then run 'palpate resume --retry-failed'";

/// What a program does for its second tap, so that nobody knows what its arm does, and what is said of it.
struct Gone {
  const char* name;
  std::string odd;
  std::string reason;
  std::string deadline = "90 s";
  Outcome outcome = Outcome::aborted;
};

class ProgramThatIsGone : public ProcessBackend, public testing::WithParamInterface<Gone> {
 protected:
  /// Two taps of a program that notes each of its starts.
  TapResult second_tap_of(const std::string& more) {
    backend_ = plain(command("print('begin', file=sys.stderr, flush=True)\n"
                             "for ask in asks():\n    if ask['tap'] != 2: contact(ask)\n    else:\n        " +
                             GetParam().odd),
                     ", deadline: " + GetParam().deadline + more);
    const TapResult first = tap(*backend_, 1);
    expect_contact(first);
    TapResult second = tap(*backend_, 2);
    EXPECT_FALSE(running(pid_in(first.force)));
    return second;
  }

  std::shared_ptr<Backend> backend_;
};

TEST_P(ProgramThatIsGone, EndsARunWhoseTapsCannotBeRepeated) {
  const TapResult contact = second_tap_of("");
  EXPECT_TRUE(contact.ends_run);
  expect_failure(contact, GetParam().outcome, GetParam().reason + kSeeToIt);
  EXPECT_EQ(diary(), "begin\n");
}

TEST_P(ProgramThatIsGone, IsStartedAgainIfTheConfigSaysSo) {
  for (const char* more : {", restart: true", ", repeatable: true"}) {
    fs::remove(folder_.path() / "record" / "process.stderr.txt");
    const TapResult contact = second_tap_of(more);
    EXPECT_FALSE(contact.ends_run);
    expect_failure(contact, GetParam().outcome, GetParam().reason);
    expect_contact(tap(*backend_, 3));
    EXPECT_EQ(diary(), "begin\nbegin\n");
  }
}

INSTANTIATE_TEST_SUITE_P(
    By, ProgramThatIsGone,
    testing::Values(
        Gone{"Exit", "os._exit(3)", "the program ended with exit status 3, its last output: 'begin'"},
        Gone{"Signal", "os.kill(os.getpid(), 9)",
             "the program was ended by signal 9 (Killed), its last output: 'begin'"},
        Gone{"Crash", "os.kill(os.getpid(), 11)",
             "the program was ended by signal 11 (Segmentation fault), its last output: 'begin'"},
        Gone{"Silence", "time.sleep(60)", "the program did not answer in time", "1 s", Outcome::timeout},
        // Nor is its answer taken for one to the next tap.
        Gone{"LateAnswer", "time.sleep(1); contact(ask)", "the program did not answer in time", "500 ms",
             Outcome::timeout},
        Gone{"HalfAnAnswer", "os.write(1, b'{\"tap\": 2,'); time.sleep(60)",
             "the program sent an incomplete answer until the deadline: '{\"tap\": 2,'", "500 ms", Outcome::timeout},
        Gone{"Stubbornness", "import signal; signal.signal(15, signal.SIG_IGN); time.sleep(60)",
             "the program did not answer in time", "500 ms", Outcome::timeout},
        Gone{"ClosedStdout", "os.close(1); time.sleep(60)", "the program closed its stdin or stdout"},
        Gone{"Garbage", "print('moving', flush=True)", "the answer is not JSON: 'moving'"},
        Gone{"AnotherTap", "print('{\"tap\": 7}', flush=True)", "the answer does not belong to tap 2: '{\"tap\": 7}'"}),
    [](const auto& one) { return one.param.name; });

class ProgramLeftBehind : public ProcessBackend {
 protected:
  /// A program of an earlier attempt that does not care about the end of its stdin: once it runs, its run is gone.
  std::unique_ptr<Child> leave_behind() {
    const fs::path program = folder_.write("stubborn.py", R"(import fcntl, os, time
lock = open("record/process.lock", "w")
fcntl.flock(lock, fcntl.LOCK_EX)
print(os.getpid(), file=lock, flush=True)
print("held", flush=True)
time.sleep(60)
)");
    auto child =
        std::make_unique<Child>(std::vector<std::string>{"/usr/bin/python3", program.string()}, folder_.path());
    EXPECT_TRUE(eventually([&] { return child->out() == "held\n"; }));
    return child;
  }

  static constexpr const char* kBody = "print('begin', file=sys.stderr, flush=True)\nfor ask in asks(): contact(ask)";
};

TEST_F(ProgramLeftBehind, KeepsTheNextOneFromBeingStarted) {
  const auto other = leave_behind();
  for (const char* more : {", start: 200 ms", ", start: 200 ms, restart: true"}) {
    const TapResult contact = tap(*plain(command(kBody), more), 1);
    EXPECT_TRUE(contact.ends_run);
    expect_failure(contact, Outcome::aborted,
                   "the program of an earlier attempt, process " + std::to_string(other->pid()) +
                       ", is still running: end it" + kSeeToIt);
  }
  EXPECT_FALSE(fs::exists(folder_.path() / "record" / "process.stderr.txt")) << "nothing was started";
}

TEST_F(ProgramLeftBehind, IsWaitedForAndThenTheNextOneIsStarted) {
  const auto other = leave_behind();
  const auto backend = plain(command(kBody), ", start: 60 s");
  std::thread end([&] { other->signal(SIGKILL); });
  const TapResult contact = tap(*backend, 1);
  end.join();
  expect_contact(contact);
  EXPECT_EQ(text_of(folder_.path() / "record" / "process.lock"), std::to_string(pid_in(contact.force)) + "\n");
}

TEST_F(ProgramLeftBehind, DoesNotDisturbOneWhoseTapsAreRepeatable) {
  const auto other = leave_behind();
  expect_contact(tap(*plain(command(kBody), ", start: 200 ms, repeatable: true"), 1));
}

TEST_F(ProgramLeftBehind, IsNoLongerWaitedForWhenTheUserWantsToStop) {
  const auto other = leave_behind();
  interrupted_ = true;
  const TapResult contact = tap(*plain(command(kBody), ", start: 60 s"), 1);
  expect_failure(contact, Outcome::aborted, "interrupted");
  EXPECT_FALSE(contact.ends_run);
}

}  // namespace
}  // namespace palpate::test
