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
  // With the file that each value is from, its config would be more than a config may be.
  const std::string file = std::string(200, 'x') + ".yaml";
  write(file, many_objects(1000));
  const fs::path directory = ran({}, file);
  EXPECT_EQ(text_of(directory / "config.yaml").find(file), std::string::npos) << "it is left out";
  const std::string taps = text_of(directory / "taps.csv");
  for (const char* command : {"status", "replay", "report", "resume"}) {
    const Ended ended = palpate({command, directory});
    EXPECT_EQ(ended.status, 0) << command << ": " << ended.err;
  }
  EXPECT_THAT(run({}, file).out, HasSubstr("already done"));
  test::forget_end(directory);
  const Ended resumed = resume(directory);
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(text_of(directory / "taps.csv"), taps);
  EXPECT_THAT(part_of(directory, "attempt"), HasSubstr("\"after_tap\": 3"));
}

TEST_F(Record, ThatCouldNotBeReadAgainIsNotBegun) {
  write("many.yaml", many_objects(7000));
  EXPECT_EQ(refused("run many.yaml"),
            "many.yaml:1:1: too large after the defaults are filled in, reduce config.yaml to at most 1 MiB and 100000 "
            "values\n");
  EXPECT_TRUE(left_nothing());
}

TEST_F(Record, ThatHasEndedMakesTheFilesAgainThatAPowerCutTook) {
  const fs::path directory = ran();
  const auto whole = test::lasting_files(directory);
  const std::string record = text_of(directory / "record.jsonl");
  const auto harm = [&] {
    fs::remove(directory / "summary.json");
    fs::resize_file(directory / "taps.csv", 100);
    write(directory / "surface.csv", std::string(fs::file_size(directory / "surface.csv"), '\0'));
  };
  for (const Words& words : {Words{"run", paper()}, Words{"resume", directory}}) {
    harm();
    EXPECT_THAT(status_of(directory).out, HasSubstr("done after 17 of 17 taps")) << "the record decides";
    const Ended ended = palpate(words);
    EXPECT_EQ(ended.status, 0) << ended.err;
    for (const char* name : {"taps.csv", "surface.csv", "summary.json"})
      EXPECT_THAT(ended.out, HasSubstr(std::string("rebuilt from the record: ") + name + "\n"));
    EXPECT_EQ(test::lasting_files(directory), whole);
    EXPECT_EQ(text_of(directory / "record.jsonl"), record) << "nothing is added";
  }
  EXPECT_THAT(palpate({"run", paper()}).out, Not(HasSubstr("made again")));
  // Of another build: what this one makes of the taps is not what was there.
  const std::size_t hash = record.find("\"hash\": \"", record.find("\"taps.csv\"")) + 9;
  write(directory / "record.jsonl", record.substr(0, hash) + std::string(4, 'x') + record.substr(hash + 4));
  fs::remove(directory / "taps.csv");
  EXPECT_THAT(
      palpate({"run", paper()}).out,
      HasSubstr("taps.csv is missing or damaged, and this build computes a different one from the same taps\n"));
  EXPECT_FALSE(fs::exists(directory / "taps.csv"));
}

TEST_F(Record, ThatIsDamagedIsMovedAsideAsItsErrorSays) {
  const fs::path directory = ran();
  std::string record = text_of(directory / "record.jsonl");
  fs::resize_file(directory / "record.jsonl", record.find("{\"tap\": 9,"));
  const Ended cut = status_of(directory);
  EXPECT_THAT(cut.out, HasSubstr("unfinished after 8 of 17 taps"));
  EXPECT_THAT(cut.err, HasSubstr("record.jsonl: was cut short, because summary.json says that the run had ended"));
  const std::size_t line = record.find("{\"tap\": 5,");
  record.erase(line, record.find('\n', line) + 1 - line);
  write(directory / "record.jsonl", record);
  const Ended refused = palpate({"run", paper()});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("or start again with 'palpate run --force'"));
  const Ended anew = palpate({"run", paper(), "--force"});
  EXPECT_EQ(anew.status, 0) << anew.err;
  EXPECT_THAT(status_of(directory).out, HasSubstr("done after 17 of 17 taps"));
  EXPECT_EQ(text_of(directory.string() + ".old-1/record.jsonl"), record);
}

TEST_F(Record, InAFolderWithTheIdOfAnotherSaysThatAndNotThatItWasChanged) {
  const fs::path directory = ran();
  const fs::path other = directory.parent_path() / "000000000000";
  fs::copy(directory, other, fs::copy_options::recursive);
  EXPECT_EQ(palpate({"replay", other}).err, other.string() + ": contains the run " + directory.filename().string() +
                                                ", but has the name of another run, rename the folder\n");
}

class KilledBeforeItsSummary : public Shell, public testing::WithParamInterface<std::pair<std::string, Words>> {};

TEST_P(KilledBeforeItsSummary, ARunIsSummedUpAsTheUnbrokenOneByteForByte) {
  const fs::path directory = ran(GetParam().second, config(GetParam().first));
  const auto whole = test::lasting_files(directory);
  for (int kill = 0; kill < 2; ++kill) {
    test::forget_end(directory);
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
                             {kPaper, "fitting=ceres belief.height.signal=5cm fitting.every=4"},
                             {kPaper, "fitting=ceres belief.height.signal=5cm belief.surface=two_part"},
                             {kPaper, "belief.label.hyperparameters=shared"},
                             {kPaper, "acquisition=random belief.footprint=gp_classifier"},
                             {kPaper, {"stop.robot_time=60 s", "taps=100"}},
                             {kPaper,
                              {"acquisition=random", "stop.max_standard_deviation=90 cm", "kernel.length_scale=5 cm"}},
                             {kPaper, {"belief.engine.type=lowrank", "kernel.length_scale=6 cm"}}}));

}  // namespace
}  // namespace palpate
