// SPDX-License-Identifier: MIT
// Two launchers at one sweep, and kill -9 at random moments on them and on their jobs: every job is done, none runs to
// its end twice, no tap is made twice. PALPATE_KILLS says how many kills (tests/stress.sh: a thousand).
#include "record/fields.hpp"
#include "record/json.hpp"
#include "support/lasting.hpp"
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <palpate/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <set>
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

std::int64_t whole(const Row& row, const char* name) { return std::get<std::int64_t>(*row.find(name)); }

/// A sweep that two launchers work at, each begun again when it is killed.
class Stress : public Shell, public testing::WithParamInterface<const char*> {
 protected:
  void SetUp() override {
    kills_ = test::wanted_kills(60, 24);
    jobs_ = std::max(8, kills_ / 4);
    words_ = Words{"sweep", config("process.yaml")} + "--quiet -j 2 --attempts 1000000" +
             ("taps=" + std::to_string(kTaps)) + ("seed=range(0," + std::to_string(jobs_) + ")");
    if (on_a_program()) {
      // It notes every tap that it makes, whatever becomes of the answer.
      const fs::path program = write("program.py", test::python(R"(
for ask in asks():
    with open("made.txt", "a") as made:
        made.write(f"{ask['seed']} {ask['tap']}\n")
    time.sleep(0.004)
    contact(ask)
)"));
      words_ = words_ + Words{"backend.command=python3 -SE '" + program.string() + "'", "backend.repeatable=false"};
    } else {
      // So slow that killing, not the sweep, comes to its end first, on a busy machine, too.
      words_ = words_ + "backend=simulator scene=object_i backend.pace=0.01";
    }
  }

  bool on_a_program() const { return std::string(GetParam()) == "program"; }
  std::unique_ptr<test::Child> launcher() const { return begin(words_); }

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

  /// The one that was published: launchers that are killed early leave others, which have no name.
  fs::path directory() const {
    const std::vector<fs::path> found{fs::directory_iterator(here() / "runs" / "process"), fs::directory_iterator()};
    EXPECT_EQ(found.size(), 1U);
    return found.at(0);
  }

  int kills_ = 0;
  int jobs_ = 0;
  Words words_;
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
  int begun = 0, unknown = 0;
  for (const fs::path& job : jobs_of(directory())) {
    EXPECT_THAT(text_of(job / "summary.json"), testing::HasSubstr("\"status\": \"done\""));
    begun += lines(part_of(job, "attempt"));
    EXPECT_EQ(lines(part_of(job, "end")), 1) << job << " ran to its end more than once";
    std::int64_t next = 1;
    for (const Row& row : rows_of(job, "tap")) {
      EXPECT_EQ(whole(row, "tap"), next++) << job;
      unknown += row.text("outcome") == "unknown" ? 1 : 0;
    }
    EXPECT_EQ(next, kTaps + 1) << job;
  }
  RecordProperty("begun", begun);
  EXPECT_GE(begun, jobs_);

  if (on_a_program()) {
    std::set<std::string> taps;
    for (const std::string& tap : lines_of(text_of(here() / "made.txt")))
      EXPECT_TRUE(taps.insert(tap).second) << tap << " was made twice";
    EXPECT_GE(static_cast<int>(taps.size()), jobs_ * kTaps - std::min(unknown, 2 * killed)) << "lost";
  } else {
    ASSERT_EQ(palpate(words_ + "--runs unbroken").status, 0);
    const fs::path other = only_run(here() / "unbroken");
    for (const fs::path& job : jobs_of(directory())) {
      EXPECT_TRUE(text_of(job / "taps.csv") == text_of(other / "jobs" / job.filename() / "taps.csv"))
          << job << " differs from the unbroken run";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Stress, testing::Values("simulator", "program"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace palpate
