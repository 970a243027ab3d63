// SPDX-License-Identifier: MIT
// A run that is killed at any moment loses no recorded tap, repeats none, and ends as the unbroken one does.
#include "record/json.hpp"
#include "support/support.hpp"

#include <palpate/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>

#include <unistd.h>

namespace palpate {
namespace {

using test::Ended;
using test::TemporaryFolder;
using test::text_of;

namespace fs = std::filesystem;

std::string paper() { return (test::source_folder() / "configs/paper/object_i.yaml").string(); }

// 85 s of robot time pass in about a third of a second.
constexpr const char* kPace = "backend.pace=0.004";
constexpr int kMicroseconds = 340'000;

/// The only directory of a run, or nothing if the program was killed before it made one.
fs::path run_in(const fs::path& runs) {
  std::error_code none;
  for (const auto& name : fs::directory_iterator(runs, none)) {
    for (const auto& id : fs::directory_iterator(name.path(), none)) return id.path();
  }
  return {};
}

/// Starts the program and kills it after a while.
void run_and_kill(const std::vector<std::string>& words, const fs::path& folder, int microseconds) {
  std::vector<std::string> all{test::program_file().string()};
  all.insert(all.end(), words.begin(), words.end());
  test::Child child(all, folder);
  // The very subject of the test is a kill at a moment that nothing announces.
  ::usleep(static_cast<useconds_t>(microseconds));
  child.signal(SIGKILL);
  child.wait();
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

class Kill : public ::testing::TestWithParam<int> {};

TEST_P(Kill, ResumedItEndsAsTheUnbrokenRunByteForByte) {
  const TemporaryFolder folder;
  const std::vector<std::string> run{"run", paper(), kPace, "--quiet"};
  const TemporaryFolder whole_folder;
  ASSERT_EQ(test::palpate({"run", paper(), kPace, "--quiet"}, whole_folder.path()).status, 0);
  const std::string whole = text_of(test::only_run(whole_folder.path() / "runs") / "taps.csv");

  Random random(20, "kill_test", static_cast<std::uint64_t>(GetParam()));
  const auto moment = [&](double share) { return static_cast<int>(random.uniform() * share * kMicroseconds); };
  run_and_kill(run, folder.path(), moment(1.0));
  const std::string first = complete_lines(folder.path() / "runs");
  // The second kill meets a run that is being carried on.
  run_and_kill(next_words(run, folder.path()), folder.path(), moment(0.5));
  const std::string recorded = complete_lines(folder.path() / "runs");
  EXPECT_EQ(recorded.substr(0, first.size()), first) << "what was recorded stays, line by line";
  const Ended last = test::palpate(next_words(run, folder.path()), folder.path());
  EXPECT_EQ(last.status, 0) << last.err;
  const fs::path done = test::only_run(folder.path() / "runs");
  EXPECT_EQ(text_of(done / "taps.csv"), whole);
  EXPECT_EQ(text_of(done / "taps.jsonl").substr(0, recorded.size()), recorded);
  EXPECT_EQ(read_json_lines(done / "taps.jsonl").rows.size(), 17U) << "no tap twice";
  RecordProperty("recorded_before_the_last_resume",
                 static_cast<int>(std::count(recorded.begin(), recorded.end(), '\n')));
}

INSTANTIATE_TEST_SUITE_P(AtRandomMoments, Kill, ::testing::Range(0, 20));

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
