// SPDX-License-Identifier: MIT
// A run that is killed at any moment loses no recorded tap, repeats none, and ends as the unbroken one does, in every
// file. PALPATE_KILLS says how many runs (tests/stress.sh: 150), each killed twice.
#include "record/json.hpp"
#include "support/lasting.hpp"
#include "support/support.hpp"

#include <palpate/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>

#include <unistd.h>

namespace palpate {
namespace {

using test::Ended;
using test::lasting_files;
using test::run_and_kill;
using test::run_in;
using test::TemporaryFolder;
using test::text_of;

namespace fs = std::filesystem;

std::string paper() { return (test::source_folder() / "configs/paper/object_i.yaml").string(); }

/// What is killed: a config and what the command line says beside it.
struct Killed {
  const char* name;
  std::string config;
  std::vector<std::string> words;
};

// Robot time passes, a little of it, so that kills come within taps, too.
const std::vector<Killed>& cases() {
  static const std::vector<Killed> all{
      {"paper", "paper/object_i.yaml", {"backend.pace=0.004"}},
      {"default", "default.yaml", {"scene=object_i", "taps=12", "backend.pace=0.002", "log.maps=true"}},
      {"fits", "paper/object_i.yaml", {"backend.pace=0.002", "fitting=ceres", "height.signal=5cm", "fitting.every=4"}},
      {"stops",
       "paper/object_i.yaml",
       {"backend.pace=0.002", "taps=40", "surface=two_part", "acquisition=uncertainty", "stop.robot_time=120s"}},
  };
  return all;
}

/// The recorded taps: whole lines only, half a line at the end may go.
std::string complete_lines(const fs::path& runs) {
  const std::string text = text_of(run_in(runs) / "taps.jsonl");
  return text.substr(0, text.find_last_of('\n') + 1);
}

/// How to go on: `run` again if the kill came before there was anything to resume.
std::vector<std::string> next_words(const std::vector<std::string>& run, const fs::path& folder) {
  const fs::path directory = run_in(folder / "runs");
  if (directory.empty() || !fs::exists(directory / "config.yaml")) return run;
  return {"resume", directory.string(), "--quiet"};
}

int wanted_runs() {
  const char* text = std::getenv("PALPATE_KILLS");
  return text != nullptr ? std::atoi(text) : 20;
}

/// The number of a run: they take turns among the cases.
class Kill : public ::testing::TestWithParam<int> {};

TEST_P(Kill, ResumedItEndsWithEveryFileAsTheUnbrokenRunHasIt) {
  const Killed& what = cases()[static_cast<std::size_t>(GetParam()) % cases().size()];
  SCOPED_TRACE(what.name);
  std::vector<std::string> run{"run", (test::source_folder() / "configs" / what.config).string(), "--quiet"};
  run.insert(run.end(), what.words.begin(), what.words.end());
  const TemporaryFolder whole_folder;
  const auto begin = std::chrono::steady_clock::now();
  ASSERT_EQ(test::palpate(run, whole_folder.path()).status, 0);
  const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begin;
  const fs::path whole = test::only_run(whole_folder.path() / "runs");

  const TemporaryFolder folder;
  Random random(20, "kill_test", static_cast<std::uint64_t>(GetParam()));
  const auto moment = [&](double share) { return static_cast<int>(random.uniform() * share * took.count()); };
  // Every other first kill comes near the end, where the summary and the tables are written.
  run_and_kill(run, folder.path(),
               GetParam() % 2 == 0 ? moment(1.0) : static_cast<int>(0.9 * took.count()) + moment(0.1));
  const std::string first = complete_lines(folder.path() / "runs");
  // The second kill meets a run that is being carried on.
  run_and_kill(next_words(run, folder.path()), folder.path(), moment(0.5));
  const std::string recorded = complete_lines(folder.path() / "runs");
  EXPECT_EQ(recorded.substr(0, first.size()), first) << "what was recorded stays, line by line";
  const Ended last = test::palpate(next_words(run, folder.path()), folder.path());
  EXPECT_EQ(last.status, 0) << last.err;
  EXPECT_EQ(lasting_files(test::only_run(folder.path() / "runs")), lasting_files(whole));
  RecordProperty("recorded_before_the_last_resume",
                 static_cast<int>(std::count(recorded.begin(), recorded.end(), '\n')));
}

INSTANTIATE_TEST_SUITE_P(AtRandomMoments, Kill, ::testing::Range(0, wanted_runs()));

TEST(KillWithinATap, ThatCanBeRepeatedCostsNoTapHoweverTheLogIsSynced) {
  const TemporaryFolder folder;
  {
    // Each tap takes more than a second of real time: a kill after the first falls into the second.
    test::Child child({test::program_file().string(), "run", paper(), "log.sync=tap", "backend.pace=0.2", "taps=3"},
                      folder.path());
    fs::path directory;
    for (int i = 0; i < 4000 && (directory.empty() || text_of(directory / "taps.jsonl").empty()); ++i) {
      ::usleep(2000);  // looks again: another process writes the file
      directory = run_in(folder.path() / "runs");
    }
    child.signal(SIGKILL);
    child.wait();
  }
  const fs::path directory = test::only_run(folder.path() / "runs");
  EXPECT_EQ(read_json_lines(directory / "taps.jsonl").rows.size(), 1U);
  const Ended ended = test::palpate({"resume", directory.string(), "--quiet"}, folder.path());
  ASSERT_EQ(ended.status, 0) << ended.err;
  const std::vector<Row> rows = read_json_lines(directory / "taps.jsonl").rows;
  ASSERT_EQ(rows.size(), 3U);
  for (const Row& row : rows) EXPECT_EQ(*row.find("outcome"), Scalar{std::string("contact")});
}

}  // namespace
}  // namespace palpate
