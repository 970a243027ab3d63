// SPDX-License-Identifier: MIT
// Two launchers at one sweep, and kill -9 at random moments on them and on their jobs: every job is done, none runs to
// its end twice, no tap is made twice. PALPATE_KILLS says how many kills (tests/stress.sh: a thousand).
#include "record/json.hpp"
#include "record/tap_row.hpp"
#include "support/programs.hpp"
#include "system/shipped.hpp"

#include <palpate/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <set>
#include <sstream>
#include <thread>

namespace palpate {
namespace {

constexpr int kTaps = 8;

/// The processes that `pid` has begun and that are still there.
std::vector<int> children_of(int pid) {
  std::vector<int> out;
  std::ifstream in("/proc/" + std::to_string(pid) + "/task/" + std::to_string(pid) + "/children");
  for (int child = 0; in >> child;) out.push_back(child);
  return out;
}

int wanted_kills() {
  const char* text = std::getenv("PALPATE_KILLS");
  return text != nullptr ? std::atoi(text) : 60;
}

std::vector<Row> rows_of(const fs::path& file) {
  return fs::exists(file) ? read_json_lines(file).rows : std::vector<Row>();
}

std::int64_t whole(const Row& row, const char* name) { return std::get<std::int64_t>(*row.find(name)); }

/// A sweep that two launchers work at, each begun again when it is killed.
class Stress : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    kills_ = wanted_kills();
    jobs_ = std::max(8, kills_ / 4);
    words_ = {test::program_file().string(), "sweep", test::config("process.yaml"), "--quiet", "-j", "2"};
    words_.insert(words_.end(), {"--attempts", "1000000", "taps=" + std::to_string(kTaps),
                                 "seed=range(0," + std::to_string(jobs_) + ")"});
    if (on_a_program()) {
      // It notes every tap that it makes, whatever becomes of the answer.
      const fs::path program = folder_.write("program.py", test::python(R"(
for ask in asks():
    with open("made.txt", "a") as made:
        made.write(f"{ask['seed']} {ask['tap']}\n")
    time.sleep(0.004)
    contact(ask)
)"));
      words_.push_back("backend.command=python3 -SE '" + program.string() + "'");
      words_.push_back("backend.repeatable=false");
    } else {
      words_.insert(words_.end(), {"backend=simulator", "scene=object_i", "backend.pace=0.001"});
    }
  }

  bool on_a_program() const { return std::string(GetParam()) == "program"; }
  std::unique_ptr<test::Child> launcher() const { return std::make_unique<test::Child>(words_, folder_.path()); }

  /// Kills launchers and jobs as often as wished, or until all is done.
  int kill_at_random(std::vector<std::unique_ptr<test::Child>>& launchers) const {
    Random random(7, "stress_test");
    int killed = 0;
    while (killed < kills_) {
      // The very subject is a kill at a moment that nothing announces.
      std::this_thread::sleep_for(std::chrono::microseconds(static_cast<int>(random.uniform() * 20'000)));
      std::unique_ptr<test::Child>& one = launchers[random.uniform() < 0.5 ? 0 : 1];
      if (!one->running()) {
        const test::Ended ended = one->wait();
        one = launcher();
        if (ended.status == 0) return killed;  // nothing is left to do
        EXPECT_EQ(ended.status, 128 + SIGKILL) << ended.err;
      } else if (random.uniform() < 0.15) {
        one->signal(SIGKILL);
        ++killed;
      } else if (const std::vector<int> jobs = children_of(one->pid()); !jobs.empty()) {
        const auto which = static_cast<std::size_t>(random.uniform() * static_cast<double>(jobs.size()));
        ::kill(jobs[which], SIGKILL);
        ++killed;
      }
    }
    return killed;
  }

  fs::path directory() const {
    fs::path found;
    for (const auto& entry : fs::directory_iterator(folder_.path() / "runs" / "process")) {
      EXPECT_TRUE(found.empty());
      found = entry.path();
    }
    return found;
  }

  int kills_ = 0;
  int jobs_ = 0;
  std::vector<std::string> words_;
  TemporaryFolder folder_;
};

TEST_P(Stress, EveryJobIsDoneNoneTwiceAndNoTapTwice) {
  std::vector<std::unique_ptr<test::Child>> launchers;
  for (int i = 0; i < 2; ++i) launchers.push_back(launcher());
  const int killed = kill_at_random(launchers);
  for (std::unique_ptr<test::Child>& one : launchers) {
    if (one->wait().status == 0) continue;
    one = launcher();
    EXPECT_EQ(one->wait().status, 0);
  }
  EXPECT_GE(killed, kills_ / 2) << "too few jobs for so many kills";
  RecordProperty("kills", killed);

  EXPECT_EQ(lines(text_of(directory() / "results.csv")), jobs_ + 1);
  int begun = 0;
  for (const auto& job : fs::directory_iterator(directory() / "jobs")) {
    EXPECT_THAT(text_of(job.path() / "summary.json"), testing::HasSubstr("\"status\": \"done\""));
    int ends = 0;
    for (const Row& row : rows_of(job.path() / "attempts.jsonl")) {
      begun += row.find("pid") != nullptr ? 1 : 0;
      ends += row.find("end") != nullptr ? 1 : 0;
    }
    EXPECT_LE(ends, 1) << job.path() << " ran to its end more than once";
    std::int64_t next = 1;
    for (const Row& row : rows_of(job.path() / "taps.jsonl")) {
      if (is_intent(row)) continue;
      EXPECT_EQ(whole(row, "tap"), next++) << job.path();
    }
    EXPECT_EQ(next, kTaps + 1) << job.path();
  }
  RecordProperty("begun", begun);
  EXPECT_GE(begun, jobs_);

  if (on_a_program()) {
    std::istringstream made(text_of(folder_.path() / "made.txt"));
    std::set<std::string> taps;
    for (std::string tap; std::getline(made, tap);) EXPECT_TRUE(taps.insert(tap).second) << tap << " was made twice";
    EXPECT_GE(static_cast<int>(taps.size()), jobs_ * kTaps - killed);
  } else {
    const TemporaryFolder unbroken;
    std::vector<std::string> words(words_.begin() + 1, words_.end());
    ASSERT_EQ(test::palpate(words, unbroken.path()).status, 0);
    const fs::path other = test::only_run(unbroken.path() / "runs");
    for (const auto& job : fs::directory_iterator(directory() / "jobs")) {
      EXPECT_TRUE(text_of(job.path() / "taps.csv") == text_of(other / "jobs" / job.path().filename() / "taps.csv"))
          << job.path() << " differs from the unbroken run";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Stress, testing::Values("simulator", "program"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace palpate
