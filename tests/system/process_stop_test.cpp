// SPDX-License-Identifier: MIT
// Programs that move something: what ends the run, and how it goes on.
#include "support/programs.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <map>
#include <sstream>

namespace palpate {
namespace {

using test::Ended;
using test::eventually;
using test::text_of;
using ::testing::HasSubstr;
using ::testing::StartsWith;

namespace fs = std::filesystem;

/// A program that notes its start and end and each tap that it is asked for, before anything else, in notes.txt.
constexpr const char* kNotes = R"(
notes = os.open("notes.txt", os.O_WRONLY | os.O_CREAT | os.O_APPEND)

def note(text):
    os.write(notes, (text + "\n").encode())

note("begin")
)";

class ARobotsRun : public testing::Test {
 protected:
  /// The words of a run on a program of this body, behind kNotes, whose taps cannot be repeated.
  std::vector<std::string> run(const std::string& body, const std::vector<std::string>& more = {}) const {
    const std::string program = folder_.write("program.py", test::python(kNotes + body)).string();
    std::vector<std::string> out{"run", test::config("process.yaml"), "backend.command=python3 -SE '" + program + "'",
                                 "backend.repeatable=false", "--quiet"};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }

  Ended palpate(const std::vector<std::string>& words) const { return test::palpate(words, folder_.path()); }
  Ended resume() const { return palpate({"resume", directory().string(), "--retry-failed", "--quiet"}); }
  fs::path directory() const { return test::only_run(folder_.path() / "runs"); }

  std::string notes() const {
    const fs::path file = folder_.path() / "notes.txt";
    return fs::exists(file) ? text_of(file) : "";
  }

  /// How often each line is in the notes.
  std::map<std::string, int> noted() const {
    std::map<std::string, int> out;
    std::istringstream in(notes());
    for (std::string line; std::getline(in, line);) ++out[line];
    return out;
  }

  std::vector<std::string> outcomes() const {
    std::vector<std::string> out;
    for (const test::Cells& row : test::csv_rows(text_of(directory() / "taps.csv"))) out.push_back(row.at("outcome"));
    return out;
  }

  test::TemporaryFolder folder_;
};

TEST_F(ARobotsRun, EndsWithTheProgramsReasonAndGoesOnBehindTheRecordedTaps) {
  const Ended ended = palpate(run(R"(
for ask in asks():
    note(f"tap {ask['tap']}")
    if ask["tap"] == 4 and not os.path.exists("cleared"):
        tell(ask, outcome="aborted", seconds=2, ends_run=True, reason="protective stop:\nfree the arm")
    else:
        contact(ask)
)",
                                  {"taps=7"}));
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.err, "backend/process: protective stop: free the arm\n");
  EXPECT_EQ(notes(), "begin\ntap 1\ntap 2\ntap 3\ntap 4\n") << "it is asked for no other tap";
  const std::string before = text_of(directory() / "taps.jsonl");
  EXPECT_THAT(before, HasSubstr(R"("outcome": "aborted", "reason": "protective stop: free the arm")"));
  EXPECT_THAT(text_of(directory() / "summary.json"), HasSubstr("\"status\": \"failed\""));

  EXPECT_EQ(palpate({"resume", directory().string()}).status, 1) << "somebody has to say so";
  folder_.write("cleared", "");
  const Ended resumed = resume();
  ASSERT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_THAT(text_of(directory() / "taps.jsonl"), StartsWith(before));
  EXPECT_EQ(notes(), "begin\ntap 1\ntap 2\ntap 3\ntap 4\nbegin\ntap 5\ntap 6\ntap 7\n");
  const std::vector<std::string> expected{"contact", "contact", "contact", "aborted", "contact", "contact", "contact"};
  EXPECT_EQ(outcomes(), expected);
}

TEST_F(ARobotsRun, EndsWhenItsProgramIsKilledWithoutStartingAnother) {
  const std::string body = R"(
for ask in asks():
    note(f"tap {ask['tap']}")
    if ask["tap"] == 3 and not os.path.exists("cleared"): os.kill(os.getpid(), 9)
    contact(ask)
)";
  const Ended ended = palpate(run(body, {"taps=5"}));
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, StartsWith("backend/process: the program was ended by signal 9 (Killed); see to the robot"));
  EXPECT_EQ(notes(), "begin\ntap 1\ntap 2\ntap 3\n");
  folder_.write("cleared", "");
  EXPECT_EQ(resume().status, 0);
  EXPECT_EQ(notes(), "begin\ntap 1\ntap 2\ntap 3\nbegin\ntap 4\ntap 5\n");
}

TEST_F(ARobotsRun, StartsNoSecondProgramBesideOneThatOutlivedItsRun) {
  std::vector<std::string> words = run(R"(
note(str(os.getpid()))
for ask in asks(): contact(ask)
time.sleep(60)  # and does not care that its stdin has ended
)",
                                       {"taps=100000", "backend.start=300ms", "acquisition=random"});
  words.insert(words.begin(), test::program_file().string());
  {
    test::Child child(words, folder_.path());
    ASSERT_TRUE(eventually([&] { return test::lines(notes()) == 2; })) << child.err();
    ASSERT_TRUE(eventually([&] { return test::lines(text_of(directory() / "taps.jsonl")) > 4; }));
    child.signal(SIGKILL);
    child.wait();
  }
  const std::string pid = notes().substr(6, notes().size() - 7);
  ASSERT_TRUE(test::running(std::stol(pid)));
  const Ended refused = resume();
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("the program of an earlier attempt, process " + pid + ", still runs: end it"));
  EXPECT_EQ(noted()["begin"], 1);
  EXPECT_TRUE(test::running(std::stol(pid)));
  ::kill(static_cast<pid_t>(std::stol(pid)), SIGKILL);
}

}  // namespace
}  // namespace palpate
