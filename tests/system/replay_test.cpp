// SPDX-License-Identifier: MIT
// `palpate replay`: recorded taps through the same models, every number compared.
#include "record/json.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace palpate {
namespace {

class Replay : public Shell {
 protected:
  /// A run, of which replay must find every number equal.
  fs::path replayed(const Words& more, const std::string& file = paper()) const {
    fs::path directory = ran(more, file);
    const Ended ended = palpate({"replay", directory});
    EXPECT_EQ(ended.status, 0) << ended.out << ended.err;
    const int taps = lines(text_of(directory / "taps.csv")) - 1;
    EXPECT_THAT(ended.out, MatchesRegex(std::to_string(taps) + " taps, [0-9]+ numbers, all equal\n"));
    return directory;
  }
};

TEST_F(Replay, FindsEveryNumberEqualAndFollowsEveryFit) {
  for (const char* acquisition : {"weighted", "uncertainty", "random"})
    replayed(std::string("acquisition=") + acquisition);
  for (const char* extra : {"belief.surface=two_part", "belief.label.hyperparameters=shared", "fitting.every=5"})
    replayed(Words("fitting=ceres belief.height.signal=5cm") + extra);
}

TEST_F(Replay, SearchesAgainWhereTheRunDid) {
  replayed({"initial.design=search", "scene.placement=random",
            "scene.objects=[{type: block, length: 4 cm, width: 4 cm, height: 4 cm}]"},
           config("paper/object_ii.yaml"));
}

TEST_F(Replay, NoticesANumberThatWasTamperedWithAndAFieldThatNoReplayHas) {
  const fs::path directory = ran("seed=3", config("paper/object_i_right.yaml"));
  const std::string taps = part_of(directory, "tap");
  const auto tampered = [&](const std::string& text) {
    test::write_part(directory, "tap", text);
    const Ended ended = palpate({"replay", directory});
    EXPECT_EQ(ended.status, 1);
    return ended.out;
  };
  // The last digit of one score.
  std::string digit = taps;
  char& last = digit[taps.rfind("\"score\": 0.", taps.rfind("\"u\": ")) + 13];
  last = last == '5' ? '6' : '5';
  EXPECT_THAT(tampered(digit), HasSubstr("tap 17: score: recorded 0."));
  std::string field = taps;
  field.insert(taps.rfind("\"robot_seconds\": "), "\"invented\": 1, ");
  EXPECT_THAT(tampered(field), HasSubstr("tap 17: invented: recorded 1, "));
}

TEST_F(Replay, NamesTheInstructionsOfARunThatUsedOthers) {
  const fs::path directory = ran("seed=3");
  const auto differing = [&](const std::string& part, const std::string& before, const std::string& after) {
    std::string text = part_of(directory, part);
    text.replace(text.find(before), before.size(), after);
    test::write_part(directory, part, text);
    return palpate({"replay", directory}).out;
  };
  EXPECT_THAT(differing("tap", "\"robot_seconds\": ", "\"invented\": 1, \"robot_seconds\": "),
              Not(HasSubstr("instruction set")));
  EXPECT_THAT(differing("manifest", "\"instruction_path\": \"", "\"instruction_path\": \"old "),
              HasSubstr("the run began with the instruction set old "));
}

TEST_F(Replay, OfARunThatEndedEarlyTakesTheEngineOfItsWholeBudget) {
  const fs::path directory = replayed({"taps=300", "stop.robot_time=100 s", "kernel.length_scale=6 cm"});
  EXPECT_THAT(text_of(directory / "summary.json"),
              AllOf(HasSubstr("\"engine\": \"lowrank\""), HasSubstr("\"stop_reason\": \"robot_time\"")));
}

TEST_F(Replay, OfASearchThatFoundNothingAgrees) {
  const fs::path directory = replayed("scene.objects=[] taps=60 candidates.count=5", config("default.yaml"));
  EXPECT_THAT(text_of(directory / "summary.json"), HasSubstr("\"stop_reason\": \"no candidate is left\""));
}

TEST_F(Replay, KnowsWhatABackendReadWhoeverChoseTheSecondTap) {
  // This backend is shown the height after each tap, and knows no truth.
  environment_ = {test::with_plugin("cannot_go_on")};
  for (const char* initial : {"initial.count=1", "initial.count=3"}) {
    const fs::path run = replayed(Words("backend.type=cannot_go_on taps=4 acquisition=random") + initial);
    const std::string taps = part_of(run, "tap");
    EXPECT_THAT(taps.substr(taps.find('\n')), HasSubstr("\"height_gp\": {\"kernel\"")) << "it is recorded";
  }
}

TEST_F(Replay, KnowsWhatWasReadByARunThatStoppedAtItsFirstLook) {
  for (const char* reads :
       {"belief.footprint=primitives acquisition=footprint_entropy", "belief.footprint=primitives acquisition=weighted",
        "belief.surface=two_part acquisition=weighted"}) {
    const fs::path run =
        replayed(Words(reads) + "choice.fallback=none stop.max_standard_deviation=10m", config("process.yaml"));
    EXPECT_THAT(text_of(run / "summary.json"), HasSubstr("\"max_standard_deviation\"")) << reads;
  }
}

TEST_F(Replay, AgreesWhereAForecastReadsNothingBeforeTheFirstHit) {
  const std::string taps = part_of(replayed("belief.surface=two_part stop.expected_rmse=1mm"), "tap");
  EXPECT_THAT(taps.substr(0, taps.find("{\"tap\": 7")), Not(HasSubstr("surface_gp"))) << "the first hit is tap 8";
  EXPECT_THAT(taps, HasSubstr("surface_gp"));
}

using Earlier = Shell;

TEST_F(Earlier, SummariesHaveTheModelsThatABackendReadsWhereNoTruthIsKnown) {
  const fs::path directory =
      swept("motion.adaptive_hover={} name=early acquisition=random,grid taps=8", config("process.yaml"));
  EXPECT_EQ(palpate(Words{"compare", directory} + "--by acquisition --at 5 --metric robot_seconds").status, 0);
  for (int job : {0, 1})
    EXPECT_THAT(to_json_line(json_rows(job_of(directory, job) / "summaries.jsonl").at(4)),
                ContainsRegex("\"signal\": [0-9]"));
}

}  // namespace
}  // namespace palpate
