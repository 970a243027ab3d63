// SPDX-License-Identifier: MIT
// What a run leaves is read by every command, however large it is; what was damaged is said in one line.
#include "record/fields.hpp"
#include "record/json.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace palpate {
namespace {

/// A config of so many objects at one place.
std::string many_objects(int count) {
  std::string text =
      "name: many\ndefaults: [{kernel: rbf}, {acquisition: weighted}, {fitting: fixed}, {backend: simulator}]\n"
      "taps: 3\ninitial: {count: 2}\ncandidates: {count: 5}\nscene:\n  area: {width: 23 cm, depth: 23 cm}\n  "
      "objects:\n";
  for (int i = 0; i < count; ++i) text += "    - {type: wave, length: 16 cm, width: 6 cm, at: [11.5 cm, 11.5 cm]}\n";
  return text;
}

TEST(Record, OfVeryManyObjectsIsReadByEveryCommand) {
  const TemporaryFolder folder;
  // Each value is recorded with the file that it is from.
  const std::string file = std::string(200, 'x') + ".yaml";
  folder.write(file, many_objects(1000));
  ASSERT_EQ(test::palpate({"run", file, "--quiet"}, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  EXPECT_GT(fs::file_size(directory / "manifest.json"), 1U << 20) << "more than configs may have";
  const std::string taps = text_of(directory / "taps.csv");
  for (const char* command : {"status", "replay", "report", "resume"}) {
    const Ended ended = test::palpate({command, directory.string()}, folder.path());
    EXPECT_EQ(ended.status, 0) << command << ": " << ended.err;
  }
  const Ended again = test::palpate({"run", file}, folder.path());
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("already done"));
  fs::remove(directory / "summary.json");
  const Ended resumed = test::palpate({"resume", directory.string(), "--quiet"}, folder.path());
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(text_of(directory / "taps.csv"), taps);
  EXPECT_THAT(text_of(directory / "manifest.json"), HasSubstr("\"after_tap\": 3"));
}

TEST(Record, ThatCouldNotBeReadAgainIsNotBegun) {
  const TemporaryFolder folder;
  folder.write("many.yaml", many_objects(7000));
  const Ended ended = test::palpate({"run", "many.yaml"}, folder.path());
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(ended.err,
            "many.yaml:1:1: too large with all that it leaves to defaults, at most 1 MiB and 100000 values in "
            "config.yaml\n");
  EXPECT_FALSE(fs::exists(folder.path() / "runs"));
}

TEST(Record, WithAStrayByteBehindItsManifestIsRefusedInOneLine) {
  const TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"run", paper(), "taps=4", "--quiet"}, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  const int end = lines(text_of(directory / "manifest.json")) + 1;
  std::ofstream(directory / "manifest.json", std::ios::app) << ",";
  fs::remove(directory / "summary.json");
  for (const char* command : {"report", "resume"}) {
    const Ended ended = test::palpate({command, directory.string()}, folder.path());
    EXPECT_EQ(ended.status, 2) << command;
    EXPECT_EQ(ended.err, (directory / "manifest.json").string() + ":" + std::to_string(end) +
                             ":1: is not valid JSON, the file is damaged: put it back as it was, or remove it\n");
  }
}

TEST(Record, OfWhichTapsWereCutOffIsNotTakenForTheWholeRun) {
  const TemporaryFolder folder;
  ASSERT_EQ(test::palpate({"run", paper(), "--quiet"}, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  const std::string whole = text_of(directory / "taps.jsonl");
  std::size_t end = 0;
  for (int i = 0; i < 8; ++i) end = whole.find('\n', end) + 1;
  for (const std::size_t cut : {end, end + 10}) {
    fs::resize_file(directory / "taps.jsonl", cut);
    for (const char* command : {"status", "resume", "replay", "report"}) {
      const Ended ended = test::palpate({command, directory.string()}, folder.path());
      EXPECT_EQ(ended.status, 2) << command;
      EXPECT_EQ(ended.err, (directory / "taps.jsonl").string() +
                               ": holds 8 of the 17 taps that were made, the file was cut: put it back, or remove "
                               "summary.json, and 'palpate resume' makes the others again\n");
    }
    fs::remove(directory / "summary.json");
    EXPECT_EQ(test::palpate({"resume", directory.string(), "--quiet"}, folder.path()).status, 0);
    EXPECT_EQ(text_of(directory / "taps.jsonl"), whole);
  }
}

/// What summary.json says of the experiment and not of the machine.
std::string without_clocks(const fs::path& summary) {
  Row kept;
  for (const auto& [name, value] : read_json_row(summary, "").fields) {
    if (!depends_on_machine(name)) kept.fields.emplace_back(name, value);
  }
  return to_json_text(kept);
}

class KilledBeforeItsSummary : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(KilledBeforeItsSummary, ARunIsSummedUpAsTheUnbrokenOneByteForByte) {
  const TemporaryFolder folder;
  std::vector<std::string> words{"run", GetParam().front(), "--quiet"};
  words.insert(words.end(), GetParam().begin() + 1, GetParam().end());
  ASSERT_EQ(test::palpate(words, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  const std::string whole = without_clocks(directory / "summary.json");
  const std::string taps = text_of(directory / "taps.jsonl");
  const std::string surface = text_of(directory / "surface.csv");
  for (int kill = 0; kill < 2; ++kill) {
    fs::remove(directory / "summary.json");
    fs::remove(directory / "surface.csv");
    const Ended resumed = test::palpate({"resume", directory.string(), "--quiet"}, folder.path());
    EXPECT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(without_clocks(directory / "summary.json"), whole);
    EXPECT_EQ(text_of(directory / "surface.csv"), surface);
    EXPECT_EQ(text_of(directory / "taps.jsonl"), taps);
  }
  const Ended replayed = test::palpate({"replay", directory.string()}, folder.path());
  EXPECT_EQ(replayed.status, 0) << replayed.out;
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryKind, KilledBeforeItsSummary,
    testing::Values(
        std::vector<std::string>{test::config("default.yaml"), "taps=12"},
        std::vector<std::string>{test::config("default.yaml"), "scene.objects=[]", "taps=60", "candidates.count=5"},
        std::vector<std::string>{test::config("default.yaml"), "scene=ring", "taps=30", "stop.expected_rmse=8 mm"},
        std::vector<std::string>{paper()}, std::vector<std::string>{paper(), "acquisition=uncertainty"},
        std::vector<std::string>{paper(), "acquisition=random"}, std::vector<std::string>{paper(), "taps=3"},
        std::vector<std::string>{paper(), "fitting=ceres", "height.signal=5cm", "fitting.every=4"},
        std::vector<std::string>{paper(), "fitting=ceres", "height.signal=5cm", "surface=two_part"},
        std::vector<std::string>{paper(), "weight.hyperparameters=shared"},
        std::vector<std::string>{paper(), "acquisition=random", "footprint=classifier"},
        std::vector<std::string>{paper(), "stop.robot_time=60 s", "taps=100"},
        std::vector<std::string>{paper(), "acquisition=random", "stop.max_standard_deviation=90 cm",
                                 "kernel.length_scale=5 cm"},
        std::vector<std::string>{paper(), "posterior=lowrank", "kernel.length_scale=6 cm"}));

}  // namespace
}  // namespace palpate
