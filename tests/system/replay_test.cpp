// SPDX-License-Identifier: MIT
// `palpate replay`: recorded taps through the same models, every number compared.
#include "support/support.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace palpate {
namespace {

TEST(Replay, FindsEveryNumberEqual) {
  const TemporaryFolder folder;
  for (const char* acquisition : {"weighted", "uncertainty", "random"}) {
    test::palpate({"run", paper(), "--quiet", "--runs", acquisition, std::string("acquisition=") + acquisition},
                  folder.path());
    const Ended ended = test::palpate({"replay", only_run(folder.path() / acquisition).string()}, folder.path());
    EXPECT_EQ(ended.status, 0) << ended.out;
    EXPECT_THAT(ended.out, ::testing::MatchesRegex("17 taps, [0-9]+ numbers, all equal\n"));
  }
}

TEST(Replay, SearchesAgainWhereTheRunDid) {
  const TemporaryFolder folder;
  test::palpate({"run", config("paper/object_ii.yaml"), "--quiet", "initial.design=search", "scene.placement=random",
                 "scene.objects=[{type: block, length: 4 cm, width: 4 cm, height: 4 cm}]"},
                folder.path());
  const Ended ended = test::palpate({"replay", only_run(folder.path() / "runs").string()}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.out;
  EXPECT_THAT(ended.out, HasSubstr(" numbers, all equal"));
}

TEST(Replay, NoticesANumberThatWasTamperedWith) {
  const TemporaryFolder folder;
  test::palpate({"run", config("paper/object_i_right.yaml"), "seed=3", "--quiet"}, folder.path());
  const fs::path directory = only_run(folder.path() / "runs");
  std::string taps = text_of(directory / "taps.jsonl");
  // The last digit of one score.
  const auto at = taps.rfind("\"score\": 0.", taps.rfind("\"u\": ")) + 13;
  taps[at] = taps[at] == '5' ? '6' : '5';
  std::ofstream(directory / "taps.jsonl") << taps;
  const Ended ended = test::palpate({"replay", directory.string()}, folder.path());
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out, HasSubstr("tap 17: score: recorded 0."));
}

TEST(Replay, NoticesAFieldThatNoReplayHas) {
  const TemporaryFolder folder;
  test::palpate({"run", paper(), "--quiet"}, folder.path());
  const fs::path directory = only_run(folder.path() / "runs");
  std::string taps = text_of(directory / "taps.jsonl");
  taps.insert(taps.rfind("\"robot_seconds\": "), "\"invented\": 1, ");
  std::ofstream(directory / "taps.jsonl") << taps;
  const Ended ended = test::palpate({"replay", directory.string()}, folder.path());
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out, HasSubstr("tap 17: invented: recorded 1, "));
}

TEST(Replay, OfARunThatEndedEarlyTakesTheEngineOfItsWholeBudget) {
  const TemporaryFolder folder;
  test::palpate({"run", paper(), "--quiet", "taps=300", "stop.robot_time=100 s", "kernel.length_scale=6 cm"},
                folder.path());
  const fs::path directory = only_run(folder.path() / "runs");
  ASSERT_THAT(text_of(directory / "summary.json"), HasSubstr("\"engine\": \"lowrank\""));
  ASSERT_THAT(text_of(directory / "summary.json"), HasSubstr("\"stop_reason\": \"robot_time\""));
  const Ended ended = test::palpate({"replay", directory.string()}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.out;
}

TEST(Replay, OfASearchThatFoundNothingAgrees) {
  const TemporaryFolder folder;
  test::palpate({"run", test::config("default.yaml"), "scene.objects=[]", "taps=60", "candidates.count=5", "--quiet"},
                folder.path());
  const fs::path directory = only_run(folder.path() / "runs");
  ASSERT_THAT(text_of(directory / "summary.json"), HasSubstr("\"stop_reason\": \"no candidate is left\""));
  const Ended ended = test::palpate({"replay", directory.string()}, folder.path());
  EXPECT_EQ(ended.status, 0) << ended.out;
}

/// A run of these words, and what `palpate replay` says of it.
std::string replayed(const TemporaryFolder& folder, const std::string& runs, std::vector<std::string> words,
                     const std::vector<std::string>& environment = {}) {
  words.insert(words.begin(), "run");
  words.insert(words.end(), {"--quiet", "--runs", runs});
  const Ended ended = test::palpate(words, folder.path(), environment);
  EXPECT_EQ(ended.status, 0) << ended.err;
  return test::palpate({"replay", only_run(folder.path() / runs).string()}, folder.path(), environment).out;
}

TEST(Replay, KnowsWhatABackendReadWhoeverChoseTheSecondTap) {
  // This backend is shown the height after each tap, and knows no truth.
  const std::vector<std::string> with{"PALPATE_PLUGIN_PATH=" + test::bad_plugin_folder("cannot_go_on").string()};
  const TemporaryFolder folder;
  for (const char* initial : {"initial.count=1", "initial.count=3"}) {
    EXPECT_THAT(replayed(folder, initial,
                         {paper(), "backend.type=cannot_go_on", "taps=4", "acquisition=random", initial}, with),
                HasSubstr(" all equal"))
        << initial;
    const std::string taps = text_of(only_run(folder.path() / initial) / "taps.jsonl");
    EXPECT_THAT(taps.substr(taps.find('\n')), HasSubstr("\"height_process\": {\"kernel\"")) << "it is recorded";
  }
}

TEST(Replay, KnowsWhatWasReadByARunThatStoppedAtItsFirstLook) {
  const TemporaryFolder folder;
  EXPECT_THAT(replayed(folder, "runs",
                       {config("process.yaml"), "footprint=shape", "acquisition=outline", "fallback=none",
                        "stop.max_standard_deviation=10m"}),
              HasSubstr(" all equal"));
  EXPECT_THAT(text_of(only_run(folder.path() / "runs") / "summary.json"), HasSubstr("\"max_standard_deviation\""));
}

TEST(Replay, AgreesWhereAForecastReadsNothingBeforeTheFirstHit) {
  const TemporaryFolder folder;
  EXPECT_THAT(replayed(folder, "runs", {paper(), "surface=two_part", "stop.expected_rmse=1mm"}),
              HasSubstr(" all equal"));
  const std::string taps = text_of(only_run(folder.path() / "runs") / "taps.jsonl");
  const auto seventh = taps.find("{\"tap\": 7");
  EXPECT_EQ(taps.substr(0, seventh).find("surface_process"), std::string::npos) << "the first hit is tap 8";
  EXPECT_NE(taps.find("surface_process"), std::string::npos);
}

TEST(Earlier, SummariesHaveTheModelsThatABackendReadsWhereNoTruthIsKnown) {
  const TemporaryFolder folder;
  const std::vector<std::string> words{config("process.yaml"), "backend.motion.adaptive_hover={}", "name=early"};
  const std::vector<std::string> sweep =
      test::plus(test::plus({"sweep"}, words), {"acquisition=random,grid", "taps=8", "--quiet"});
  ASSERT_EQ(test::palpate(sweep, folder.path()).status, 0);
  const fs::path directory = only_run(folder.path() / "runs");
  ASSERT_EQ(
      test::palpate({"compare", directory.string(), "--by", "acquisition", "--at", "5", "--metric", "robot_seconds"},
                    folder.path())
          .status,
      0);
  int summaries = 0;
  for (const auto& job : fs::directory_iterator(directory / "jobs")) {
    ++summaries;
    EXPECT_THAT(text_of(job.path() / "summary_at_5.json"), ::testing::ContainsRegex("\"signal\": [0-9]"));
  }
  EXPECT_EQ(summaries, 2);
}

TEST(Replay, FollowsEveryFit) {
  const TemporaryFolder folder;
  for (const char* extra : {"surface=two_part", "weight.hyperparameters=shared", "fitting.every=5"}) {
    test::palpate({"run", paper(), "--quiet", "--runs", extra, "fitting=ceres", "height.signal=5cm", extra},
                  folder.path());
    const Ended ended = test::palpate({"replay", only_run(folder.path() / extra).string()}, folder.path());
    EXPECT_EQ(ended.status, 0) << extra << ended.out;
    EXPECT_THAT(ended.out, ::testing::MatchesRegex("17 taps, [0-9]+ numbers, all equal\n"));
  }
}

}  // namespace
}  // namespace palpate
