// SPDX-License-Identifier: MIT
// Programs that move something: who ends the run, who is started again, and what becomes of taps when all is killed.
// PALPATE_KILLS says how many kills (tests/stress.sh: a hundred).
#include "record/fields.hpp"
#include "record/json.hpp"
#include "support/lasting.hpp"
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <palpate/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <map>
#include <thread>

namespace palpate {
namespace {

using test::eventually;

/// A program that notes its start and end and each tap that it is asked for, before anything else, in notes.txt.
constexpr const char* kNotes = R"(
notes = os.open("notes.txt", os.O_WRONLY | os.O_CREAT | os.O_APPEND)

def note(text):
    os.write(notes, (text + "\n").encode())

parent = os.getppid()
note("begin")
)";

class ARobotsRun : public Shell {
 protected:
  /// The words of a run on a program of this body, behind kNotes, whose taps cannot be repeated.
  Words robots(const std::string& body, const Words& more = {}) const {
    const std::string program = write("program.py", test::python(kNotes + body)).string();
    return set_by({"run", config("process.yaml"), "backend.command=python3 -SE '" + program + "'",
                   "backend.repeatable=false", "--quiet"},
                  more);
  }
  Ended retry() const { return resume(directory(), "--retry-failed"); }

  std::string notes() const {
    const fs::path file = here() / "notes.txt";
    return fs::exists(file) ? text_of(file) : "";
  }

  /// How often each line is in the notes.
  std::map<std::string, int> noted() const {
    std::map<std::string, int> out;
    for (const std::string& line : lines_of(notes())) ++out[line];
    return out;
  }
};

TEST_F(ARobotsRun, EndsWithTheProgramsReasonAndGoesOnBehindTheRecordedTaps) {
  const Ended ended = palpate(robots(R"(
for ask in asks():
    note(f"tap {ask['tap']}")
    if ask["tap"] == 4 and not os.path.exists("cleared"):
        tell(ask, outcome="aborted", seconds=2, ends_run=True, reason="protective stop:\nfree the arm")
    else:
        contact(ask)
)",
                                     "taps=7"));
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, "backend/process: protective stop: free the arm\n");
  EXPECT_EQ(notes(), "begin\ntap 1\ntap 2\ntap 3\ntap 4\n") << "it is asked for no other tap";
  const std::string before = part_of(directory(), "tap");
  EXPECT_THAT(before, HasSubstr(R"("outcome": "aborted", "reason": "protective stop: free the arm")"));
  EXPECT_THAT(text_of(directory() / "summary.json"), HasSubstr("\"status\": \"failed\""));

  EXPECT_EQ(palpate({"resume", directory()}).status, 1) << "somebody has to say so";
  write("cleared", "");
  const Ended resumed = retry();
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(part_of(directory(), "tap"), StartsWith(before));
  EXPECT_EQ(notes(), "begin\ntap 1\ntap 2\ntap 3\ntap 4\nbegin\ntap 5\ntap 6\ntap 7\n");
  const std::vector<std::string> expected{"contact", "contact", "contact", "aborted", "contact", "contact", "contact"};
  EXPECT_EQ(outcomes(directory()), expected);
}

TEST_F(ARobotsRun, EndsWhenItsProgramIsKilledWithoutStartingAnother) {
  const std::string body = R"(
for ask in asks():
    note(f"tap {ask['tap']}")
    if ask["tap"] == 3 and not os.path.exists("cleared"): os.kill(os.getpid(), 9)
    contact(ask)
)";
  const Ended ended = palpate(robots(body, "taps=5"));
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, StartsWith("backend/process: the program was ended by signal 9 (Killed); check the robot"));
  EXPECT_EQ(notes(), "begin\ntap 1\ntap 2\ntap 3\n");
  write("cleared", "");
  EXPECT_EQ(retry().status, 0);
  EXPECT_EQ(notes(), "begin\ntap 1\ntap 2\ntap 3\nbegin\ntap 4\ntap 5\n");
}

/// Answers as the letters of the file `fate` say: c a contact, u unreachable, n no contact; behind them contacts.
constexpr const char* kFated = R"(
for ask in asks():
    note(f"tap {ask['tap']}")
    fate = open("fate").read().ljust(1000, "c")[ask["tap"] - 1]
    if fate == "c": contact(ask)
    else: tell(ask, outcome={"u": "unreachable", "n": "no_contact"}[fate], seconds=120, reason="the gripper is open")
)";

TEST_F(ARobotsRun, FailsAfterThreeTapsInARowThatCameToNothingAndIsCarriedOnOnceSomebodyHasLooked) {
  write("fate", "ncnnununn");
  const Ended ended = palpate(robots(kFated, "taps=17"));
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err,
            "backend/process: 3 taps in a row failed, the last with: the gripper is open, correct the cause, then run "
            "'palpate resume --retry-failed'; stop.failed_in_a_row sets the limit\n");
  EXPECT_EQ(outcomes(directory()).size(), 6U) << "what cannot be reached neither counts nor makes up for anything";
  EXPECT_THAT(text_of(directory() / "summary.json"), HasSubstr("\"status\": \"failed\""));
  EXPECT_EQ(retry().status, 0) << "it counts anew, or the tap that failed next would have ended it";
  EXPECT_EQ(outcomes(directory()).size(), 17U);
}

TEST_F(ARobotsRun, IsGivenUpAsLateAsTheConfigSays) {
  write("fate", "ncnnnnncc");
  EXPECT_EQ(palpate(robots(kFated, {"taps=9", "stop.failed_in_a_row=6"})).status, 0);
  EXPECT_EQ(palpate(robots(kFated, {"taps=9", "stop.failed_in_a_row=5", "--runs", "others"})).status, 1);
}

TEST_F(ARobotsRun, OfTapsThatCanBeRepeatedIsNotGivenUpUnlessTheConfigSaysSo) {
  write("fate", "nnnnnnnnn");
  EXPECT_EQ(palpate(robots(kFated, {"taps=9", "backend.repeatable=true"})).status, 0);
  EXPECT_EQ(palpate(robots(kFated, {"taps=9", "backend.repeatable=true", "stop.failed_in_a_row=9"})).status, 1);
}

TEST_F(ARobotsRun, StartsNoSecondProgramBesideOneThatOutlivedItsRun) {
  const Words words = robots(R"(
note(str(os.getpid()))
try:
    for ask in asks(): contact(ask)
except BrokenPipeError:
    pass
time.sleep(60)  # and does not care that its run is gone
)",
                             "taps=100000 candidates.count=300 backend.start=2s acquisition=random");
  const auto child = begin(words);
  ASSERT_TRUE(eventually([&] { return lines(notes()) == 2; })) << child->err();
  ASSERT_TRUE(eventually([&] { return lines(part_of(directory(), "tap")) > 4; }));
  child->signal(SIGKILL);
  child->wait();
  const std::string pid = notes().substr(6, notes().size() - 7);
  ASSERT_TRUE(test::running(std::stol(pid)));
  const Ended refused = retry();
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err,
              HasSubstr("the program of an earlier attempt, process " + pid + ", is still running: end it"));
  EXPECT_EQ(noted()["begin"], 1);
  EXPECT_TRUE(test::running(std::stol(pid)));
  ::kill(static_cast<pid_t>(std::stol(pid)), SIGKILL);
}

/// A run that is killed again and again, begun or carried on.
class AKilledRun : public ARobotsRun {
 protected:
  /// Taps that the program makes no sooner than the test allows, so that the run cannot end before it was killed.
  static constexpr const char* kBody = R"(
import fcntl
arm = open("arm", "w")
try:
    fcntl.flock(arm, fcntl.LOCK_EX | fcntl.LOCK_NB)
except OSError:
    note("two programs at once")
for ask in asks():
    note(f"tap {ask['tap']}")
    time.sleep(0.004)
    while os.stat("allowed").st_size < ask["tap"] and os.getppid() == parent: time.sleep(0.001)
    try:
        contact(ask)
    except BrokenPipeError:
        break  # its run is gone
time.sleep(0.05)  # an arm takes time to stop
note("end")
)";

  void allow(std::size_t taps) const {
    const fs::path file = here() / "allowed";
    if (!fs::exists(file)) write(file, "");
    if (taps > fs::file_size(file)) fs::resize_file(file, taps);
  }

  std::size_t last_asked() const {
    const std::string text = notes();
    const auto place = text.rfind("tap ");
    return place == std::string::npos ? 0 : std::stoul(text.substr(place + 4));
  }

  /// The run as it is to be begun, or to be carried on if there is something to carry on.
  Words next_words(const Words& first) const {
    if (left_nothing() || !fs::exists(directory() / "config.yaml")) return first;
    return {"resume", directory(), "--quiet"};
  }
};

TEST_F(AKilledRun, AsksForNoTapTwiceAndLosesNone) {
  const int kills = test::wanted_kills(8, 8);
  constexpr int kMost = 3;  // taps that are allowed before the next kill; one more is asked for
  const int taps = (kMost + 1) * (kills + 1);
  const Words first = robots(kBody, {"taps=" + std::to_string(taps), "acquisition=random"});
  Random random(11, "process_stop_test");
  allow(0);
  for (int i = 0; i < kills; ++i) {
    const int begun = noted()["begin"];
    const std::size_t asked = last_asked();
    const auto child = begin(next_words(first));
    // A quarter of the kills comes while it starts, a quarter once its program has begun, the others once it taps.
    const double when = random.uniform();
    if (when > 0.25) {
      ASSERT_TRUE(eventually([&] { return noted()["begin"] > begun; })) << child->err();
    }
    if (when > 0.5) {
      ASSERT_TRUE(eventually([&] { return last_asked() > asked; })) << child->err();
    }
    allow(last_asked() + static_cast<std::size_t>(random.uniform() * (kMost + 1)));
    // The very subject is a kill at a moment that nothing announces.
    std::this_thread::sleep_for(std::chrono::microseconds(static_cast<int>(random.uniform() * 30'000)));
    ASSERT_TRUE(child->running()) << "it was to be killed, not to end: " << child->err();
    child->signal(SIGKILL);
    EXPECT_EQ(child->wait().status, 128 + SIGKILL);
  }
  allow(static_cast<std::size_t>(taps));
  const Ended last = palpate(next_words(first));
  ASSERT_EQ(last.status, 0) << last.err;

  std::map<std::string, int> made = noted();
  EXPECT_EQ(made["two programs at once"], 0);
  EXPECT_EQ(made["end"], made["begin"]) << "each program saw the end of its run";
  int unknown = 0;
  int contacts = 0;
  for (const Row& row : rows_of(directory(), "tap")) {
    const int number = contacts + unknown + 1;
    EXPECT_EQ(*row.find("tap"), Scalar{std::int64_t{number}}) << "none lost, none twice";
    const bool touched = *row.find("outcome") == Scalar{std::string("contact")};
    EXPECT_TRUE(touched || *row.find("outcome") == Scalar{std::string("unknown")});
    const int times = made["tap " + std::to_string(number)];
    EXPECT_LE(times, 1) << "tap " << number << " was asked for more than once";
    EXPECT_GE(times, touched ? 1 : 0) << "tap " << number << " is recorded, but nobody was asked for it";
    (touched ? contacts : unknown) += 1;
  }
  EXPECT_EQ(contacts + unknown, taps);
  EXPECT_LE(unknown, kills) << "at most one a kill";
  EXPECT_GE(unknown, 1) << "no kill came within a tap";
  RecordProperty("kills", kills);
  RecordProperty("contacts", contacts);
  RecordProperty("unknown", unknown);
  RecordProperty("programs", made["begin"]);
}

}  // namespace
}  // namespace palpate
