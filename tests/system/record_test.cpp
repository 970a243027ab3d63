// SPDX-License-Identifier: MIT
// What a run leaves is read by every command, however large it is; what was damaged is said in one line.
#include "support/lasting.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

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

using Record = Shell;

TEST_F(Record, OfVeryManyObjectsIsReadByEveryCommand) {
  // Each value is recorded with the file that it is from.
  const std::string file = std::string(200, 'x') + ".yaml";
  write(file, many_objects(1000));
  const fs::path directory = ran({}, file);
  EXPECT_GT(fs::file_size(directory / "manifest.json"), 1U << 20) << "more than configs may have";
  const std::string taps = text_of(directory / "taps.csv");
  for (const char* command : {"status", "replay", "report", "resume"}) {
    const Ended ended = palpate({command, directory});
    EXPECT_EQ(ended.status, 0) << command << ": " << ended.err;
  }
  EXPECT_THAT(run({}, file).out, HasSubstr("already done"));
  fs::remove(directory / "summary.json");
  const Ended resumed = resume(directory);
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(text_of(directory / "taps.csv"), taps);
  EXPECT_THAT(text_of(directory / "manifest.json"), HasSubstr("\"after_tap\": 3"));
}

TEST_F(Record, ThatCouldNotBeReadAgainIsNotBegun) {
  write("many.yaml", many_objects(7000));
  EXPECT_EQ(refused("run many.yaml"),
            "many.yaml:1:1: too large with all that it leaves to defaults, at most 1 MiB and 100000 values in "
            "config.yaml\n");
  EXPECT_TRUE(left_nothing());
}

TEST_F(Record, WithAStrayByteBehindItsManifestIsRefusedInOneLine) {
  const fs::path directory = ran("taps=4");
  const std::string manifest = text_of(directory / "manifest.json");
  write(directory / "manifest.json", manifest + ",");
  fs::remove(directory / "summary.json");
  for (const char* command : {"report", "resume"}) {
    EXPECT_EQ(refused({command, directory}),
              (directory / "manifest.json").string() + ":" + std::to_string(lines(manifest) + 1) +
                  ":1: is not valid JSON, the file is damaged: put it back as it was, or remove it\n");
  }
}

TEST_F(Record, OfWhichTapsWereCutOffIsNotTakenForTheWholeRun) {
  const fs::path directory = ran();
  const std::string whole = text_of(directory / "taps.jsonl");
  std::size_t end = 0;
  for (int i = 0; i < 8; ++i) end = whole.find('\n', end) + 1;
  for (const std::size_t cut : {end, end + 10}) {
    fs::resize_file(directory / "taps.jsonl", cut);
    for (const char* command : {"status", "resume", "replay", "report"}) {
      EXPECT_EQ(refused({command, directory}),
                (directory / "taps.jsonl").string() +
                    ": holds 8 of the 17 taps that were made, the file was cut: put it back, or remove "
                    "summary.json, and 'palpate resume' makes the others again\n");
    }
    fs::remove(directory / "summary.json");
    EXPECT_EQ(resume(directory).status, 0);
    EXPECT_EQ(text_of(directory / "taps.jsonl"), whole);
  }
}

class KilledBeforeItsSummary : public Shell, public testing::WithParamInterface<std::pair<std::string, Words>> {};

TEST_P(KilledBeforeItsSummary, ARunIsSummedUpAsTheUnbrokenOneByteForByte) {
  const fs::path directory = ran(GetParam().second, config(GetParam().first));
  const auto whole = test::lasting_files(directory);
  for (int kill = 0; kill < 2; ++kill) {
    fs::remove(directory / "summary.json");
    fs::remove(directory / "surface.csv");
    const Ended resumed = resume(directory);
    EXPECT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_EQ(test::lasting_files(directory), whole);
  }
  const Ended replayed = palpate({"replay", directory});
  EXPECT_EQ(replayed.status, 0) << replayed.out;
}

const std::string kDefault = "default.yaml";
const std::string kPaper = "paper/object_i.yaml";

INSTANTIATE_TEST_SUITE_P(OfEveryKind, KilledBeforeItsSummary,
                         testing::ValuesIn(std::vector<std::pair<std::string, Words>>{
                             {kDefault, "taps=12"},
                             {kDefault, "scene.objects=[] taps=60 candidates.count=5"},
                             {kDefault, {"scene=ring", "taps=30", "stop.expected_rmse=8 mm"}},
                             {kPaper, ""},
                             {kPaper, "acquisition=uncertainty"},
                             {kPaper, "acquisition=random"},
                             {kPaper, "taps=3"},
                             {kPaper, "fitting=ceres height.signal=5cm fitting.every=4"},
                             {kPaper, "fitting=ceres height.signal=5cm surface=two_part"},
                             {kPaper, "weight.hyperparameters=shared"},
                             {kPaper, "acquisition=random footprint=classifier"},
                             {kPaper, {"stop.robot_time=60 s", "taps=100"}},
                             {kPaper,
                              {"acquisition=random", "stop.max_standard_deviation=90 cm", "kernel.length_scale=5 cm"}},
                             {kPaper, {"posterior=lowrank", "kernel.length_scale=6 cm"}}}));

}  // namespace
}  // namespace palpate
