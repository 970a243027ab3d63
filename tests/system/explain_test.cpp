// SPDX-License-Identifier: MIT
// `palpate explain`: every tap of many kinds of runs, in words that are complete and numbers that are the record's.
#include "support/sanitizers.hpp"
#include "support/support.hpp"
#include "system/shipped.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace palpate {
namespace {

using nlohmann::json;

std::string printed(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value + 0.0);  // which takes the sign from a zero
  return text;
}

std::string place(const json& at) {
  return "x " + printed("%.2f", 100 * at["x"].get<double>()) + " cm, y " +
         printed("%.2f", 100 * at["y"].get<double>()) + " cm";
}

/// The text with lines joined that were broken to fit.
std::string joined(std::string text) {
  const std::string broken = "\n    ";
  for (auto at = text.find(broken); at != std::string::npos; at = text.find(broken))
    text.replace(at, broken.size(), " ");
  return text;
}

class Explain : public ::testing::Test {
 protected:
  fs::path run(const std::vector<std::string>& words, const std::string& file = paper()) {
    const std::string runs = std::to_string(++made_);
    const Ended ended = palpate(test::plus({"run", file, "--quiet", "--runs", runs}, words));
    EXPECT_EQ(ended.err, "");
    return only_run(folder_.path() / runs);
  }

  Ended palpate(const std::vector<std::string>& words) const {
    return test::palpate(words, folder_.path(),
                         {"PALPATE_PLUGIN_PATH=" + test::bad_plugin_folder("cannot_go_on").string()});
  }

  std::string explain(const fs::path& directory, int tap) const {
    const Ended ended = palpate({"explain", directory.string(), std::to_string(tap)});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.err, "");
    return joined(ended.out);
  }

  static std::vector<json> taps_of(const fs::path& directory) {
    std::vector<json> out;
    std::istringstream lines(text_of(directory / "taps.jsonl"));
    for (std::string line; std::getline(lines, line);) {
      json row = json::parse(line);
      if (!row.contains("intent")) out.push_back(std::move(row));
    }
    return out;
  }

  static void expect_score(const std::string& text, const json& tap) {
    EXPECT_THAT(text, HasSubstr("Its score there is " + printed("%.6g", tap["score"]) +
                                (tap["ties"] == 1 ? ", the best of " : ". ")));
    if (tap["ties"] > 1) {
      EXPECT_THAT(text, ContainsRegex("\\. (" + std::to_string(tap["ties"].get<int>()) + "|All) of [0-9]+ candidates"));
    }
    EXPECT_THAT(text, HasSubstr("Runner-up: " + place(tap["runner_up"]) + " with a score of " +
                                printed("%.6g", tap["runner_up"]["score"]) + ", "));
  }

  static void expect_source(const std::string& text, const json& tap) {
    if (tap["source"] == "initial") {
      EXPECT_THAT(text, ContainsRegex("It is (initial )?tap " + std::to_string(tap["tap"].get<int>()) + " of "));
      EXPECT_THAT(text, Not(HasSubstr("Its score")));
      return;
    }
    expect_score(text, tap);
    if (tap["source"] == "fallback") {
      EXPECT_THAT(text, HasSubstr("nothing to go by: " + tap["why"].get<std::string>() + "."));
    } else {
      EXPECT_THAT(text, HasSubstr("The acquisition chose it: "));
    }
  }

  static void expect_outcome(const std::string& text, const json& tap) {
    if (tap["outcome"] != "contact") {
      EXPECT_THAT(text, HasSubstr("the tap failed: " + tap["outcome"].get<std::string>()));
      if (!tap["reason"].is_null()) {
        EXPECT_THAT(text, HasSubstr(tap["reason"].get<std::string>()));
      }
      return;
    }
    EXPECT_THAT(text, HasSubstr("Found: contact at "));
    EXPECT_THAT(text, HasSubstr(tap["on_surface"] == true ? ", on an object" : ", on the desk"));
  }

  /// u, w and e of the record, or u and p where a footprint is named, are said as they are, and what the record has
  /// not is marked.
  static void expect_maps(const std::string& text, const json& tap, const std::string& footprint) {
    if (!footprint.empty()) {
      EXPECT_THAT(text, HasSubstr("(the probability that an object is there, by footprint/" + footprint + ")"));
      EXPECT_THAT(text, HasSubstr("Footprint: " + footprint));
      EXPECT_THAT(text, Not(HasSubstr("Weight process")));
    }
    for (const char* name : {"u", "w", "e", "p"}) {
      if (*name != 'u' && (*name == 'p') == footprint.empty()) continue;
      const std::string begin = *name == 'e' ? "e = u w = " : name + std::string(" = ");
      if (!tap.contains(name) || tap[name].is_null()) {
        EXPECT_THAT(text, ContainsRegex(begin + "[-0-9.e]+\\*"));
      } else {
        EXPECT_THAT(text, HasSubstr(begin + printed("%.6g", tap[name]) + (*name == 'e' ? "." : " ")));
      }
    }
  }

  static void expect_whole_words(const std::string& text) {
    static const std::regex hole("\\b(nan|inf|null|true_|std)\\b|[{}]|  [a-z]| [,.;:)]|\\(\\)|: \\.");
    std::smatch found;
    EXPECT_FALSE(std::regex_search(text, found, hole)) << found.str() << " in\n" << text;
    EXPECT_EQ(text.find('*') != std::string::npos, text.find("\n* computed now") != std::string::npos) << text;
  }

  /// Every tap of a run; under the sanitizers, some.
  void expect_explained(const fs::path& directory, const std::string& footprint = "") {
    const std::vector<json> taps = taps_of(directory);
    for (std::size_t i = 0; i < taps.size(); i += test::kSanitized ? 5 : 1) {
      SCOPED_TRACE(directory.string() + " tap " + std::to_string(i + 1));
      const std::string text = explain(directory, static_cast<int>(i) + 1);
      EXPECT_THAT(text, HasSubstr("Tap " + std::to_string(i + 1) + " of " + std::to_string(taps.size())));
      EXPECT_THAT(text.substr(0, text.find('\n')), HasSubstr("): " + place(taps[i])));
      EXPECT_THAT(text, Not(HasSubstr("would choose"))) << "it is this build that made the run";
      expect_source(text, taps[i]);
      expect_outcome(text, taps[i]);
      expect_maps(text, taps[i], footprint);
      expect_whole_words(text);
    }
  }

  TemporaryFolder folder_;

 private:
  int made_ = 0;
};

TEST_F(Explain, TellsEveryTapOfEveryAcquisition) {
  for (const char* acquisition : {"weighted", "uncertainty", "random", "grid"})
    expect_explained(run({"acquisition=" + std::string(acquisition), "seed=3"}));
}

TEST_F(Explain, TellsEveryTapOfFitsAndOfASurfaceOfTwoParts) {
  expect_explained(run({"fitting=ceres", "height.signal=5cm", "surface=two_part", "fitting.every=3"}));
  expect_explained(run({"fitting=ceres", "height.signal=5cm", "weight.hyperparameters=shared", "kernel=matern52"}));
  expect_explained(run({"kernel=swell_and_texture", "weight.clip=true", "initial.design=sobol"}));
}

TEST_F(Explain, TellsEveryTapOfAFootprintByItsProbability) {
  expect_explained(run({}, config("default.yaml")), "shape");
  expect_explained(run({"footprint=classifier", "acquisition=random", "taps=6"}), "classifier");
}

TEST_F(Explain, TellsWhatTheFootprintRemarks) {
  const fs::path directory = run({"footprint.contradictions=0.01", "taps=20"}, config("default.yaml"));
  const json last = taps_of(directory).back();
  ASSERT_TRUE(last["footprint"]["remark"].is_string());
  EXPECT_THAT(explain(directory, 20), HasSubstr("Its remark: " + last["footprint"]["remark"].get<std::string>() + "."));
  EXPECT_THAT(explain(directory, 1), Not(HasSubstr("Its remark")));
}

TEST_F(Explain, ExpectsOfTheSurfaceOfAnObjectNothingBeforeOneIsTouchedNorOfTheDesk) {
  const fs::path directory = run({"scene=l", "taps=12"}, config("default.yaml"));
  bool hit = false;
  int compared = 0;
  int on_the_desk = 0;
  for (const json& tap : taps_of(directory)) {
    const std::string text = explain(directory, tap["tap"]);
    SCOPED_TRACE(text);
    EXPECT_EQ(text.find("Expected: nothing, no tap has been on an object yet.") != std::string::npos, !hit);
    EXPECT_EQ(text.find("Expected: a height of ") != std::string::npos, hit);
    const bool on = tap["on_surface"];
    if (!on || !hit) {
      EXPECT_THAT(text, Not(HasSubstr("than expected")));
    }
    compared += text.find("than expected") != std::string::npos ? 1 : 0;
    on_the_desk += hit && !on ? 1 : 0;
    hit = hit || on;
  }
  EXPECT_GT(compared, 0) << "else this tests nothing";
  EXPECT_GT(on_the_desk, 0) << "else this tests nothing";
}

TEST_F(Explain, TellsEveryTapOfARuleThatStallsOrMayRepeatItself) {
  expect_explained(run({"fallback=none", "repeat=allow"}));
  expect_explained(run({"fallback=none", "initial.design=grid"}));
  expect_explained(run({"fallback=none", "initial.design=search", "scene.placement=random"}));
  expect_explained(run({"repeat=allow", "height.noise=0mm", "weight.noise=0", "candidates.count=6", "taps=40"}));
}

TEST_F(Explain, TellsEveryTapOfRunsWithFailedTapsOrPredictions) {
  expect_explained(run({"scene.effects={missed_contacts: {probability: 0.3}, reach: {}}", "seed=2"}));
  expect_explained(run({"backend=adaptive"}));
}

TEST_F(Explain, SaysWhyTheFallbackHadToChoose) {
  const std::string text = explain(run({}), 8);
  EXPECT_THAT(text, HasSubstr("The acquisition, weighted (tap where "));
  EXPECT_THAT(text, HasSubstr("No tap has hit an object yet: every label is 0"));
  EXPECT_THAT(text, HasSubstr("503 of 2202 candidates are tied: within 2e-08 of the best (tie_tolerance)"));
  EXPECT_THAT(text, HasSubstr("- 7 candidates are left out, because tapped before (repeat: forbid)."));
}

TEST_F(Explain, SaysThatAStalledRuleTapsTheSamePlaceForEver) {
  const std::string text = explain(run({"fallback=none", "repeat=allow"}), 7);
  EXPECT_THAT(text, HasSubstr("All of 2209 candidates are tied"));
  EXPECT_THAT(text, HasSubstr("No score is positive: such scores tell nothing, but the config has the rule stand"));
  EXPECT_THAT(text, HasSubstr("This place was tapped before: taps 4, 5, 6."));
  EXPECT_THAT(text, HasSubstr("No candidate is left out."));
}

TEST_F(Explain, SaysThatTheFallbackDidNotStepInWhereScoresAreAsGoodAsZeroButPositive) {
  // Where an object may be, all is tapped, and u there is the noise, 1e-12; elsewhere w, and so the score, is below 0.
  const fs::path directory =
      run({"repeat=allow", "height.noise=0.001mm", "weight.noise=1e-6", "candidates.count=6", "taps=40"});
  int found = 0;
  for (const json& tap : taps_of(directory)) {
    if (tap["source"] != "acquisition" || tap["score"] > 1e-9) continue;
    ++found;
    EXPECT_LE(tap["score"], 1e-12);
    const std::string text = explain(directory, tap["tap"]);
    EXPECT_THAT(text, HasSubstr(", is as good as 0, but it is positive: so no fallback stepped in."));
    EXPECT_THAT(text, Not(HasSubstr("fallback: none")));
  }
  EXPECT_GT(found, 0);
}

TEST_F(Explain, TellsTheLastCandidateAndARunThatOnlyFailed) {
  const std::string last = explain(run({"candidates.count=2", "taps=4"}), 4);
  EXPECT_THAT(last, HasSubstr("Its score there is 1; no other candidate is left."));
  EXPECT_THAT(last, HasSubstr("There is no runner-up."));
  expect_whole_words(last);
  expect_explained(run({"scene.effects.missed_contacts={probability: 1}", "surface=two_part", "taps=6"}));
}

TEST_F(Explain, PrintsWhatItsPageShows) {
  const std::string text = palpate({"explain", run({"name=first"}).string(), "9"}).out;
  const std::string shown = "```\n" + text.substr(0, text.find("\nThe models"));
  EXPECT_TRUE(text_of(test::source_folder() / "framework/docs/runs.md").find(shown) != std::string::npos) << shown;
}

TEST_F(Explain, SaysHowMuchTheRunnerUpIsBehind) {
  const fs::path directory = run({});
  const json tap = taps_of(directory)[11];
  ASSERT_EQ(tap["ties"], 1);
  const double score = tap["score"];
  const double second = tap["runner_up"]["score"];
  EXPECT_THAT(explain(directory, 12), HasSubstr(", " + printed("%.3g", 100 * (score - second) / score) + " % less."));
}

TEST_F(Explain, SaysWhatJitterAndAWeightBeyondItsBoundsMean) {
  // The same candidate again and again without noise: the matrix is singular.
  const fs::path directory = run({"fallback=none", "repeat=allow", "height.noise=0mm", "weight.noise=0"});
  const std::string text = explain(directory, 17);
  ASSERT_GT(taps_of(directory)[16]["height_process"]["jitter"], 0.0);
  EXPECT_THAT(text, HasSubstr("Its matrix was singular in double precision, so jitter was added to the diagonal"));
  const fs::path live = run({"weight.clip=true"}, config("paper/object_i_right.yaml"));
  EXPECT_THAT(explain(live, 17), HasSubstr("It leaves [0, 1] because it is a regression on the labels 0 and 1"));
  EXPECT_THAT(explain(live, 17), HasSubstr("clipped to [0, 1] (weight.clip: true)."));
}

TEST_F(Explain, SaysWhatAFitDidAndWhenNoneWasDue) {
  const fs::path directory =
      run({"fitting=ceres", "height.signal=5cm", "fitting.every=4"}, config("paper/object_i_right.yaml"));
  const std::vector<json> taps = taps_of(directory);
  int fits = 0;
  for (std::size_t i = 5; i < taps.size(); ++i) {
    const json& process = taps[i]["height_process"];
    const std::string text = explain(directory, static_cast<int>(i) + 1);
    if (process.contains("fit")) {
      ++fits;
      EXPECT_THAT(text, HasSubstr("; objective " + printed("%.6g", process["fit"]["objective"]) + " after " +
                                  std::to_string(process["fit"]["evaluations"].get<int>()) + " evaluation"));
    } else {
      EXPECT_THAT(text, HasSubstr("No fit (ceres) was due after its latest tap"));
    }
    EXPECT_THAT(text, HasSubstr("length scale " +
                                printed("%.4g", 100 * process["kernel"]["length_scale"].get<double>()) + " cm"));
  }
  EXPECT_GE(fits, 2);
}

TEST_F(Explain, TakesTheErrorsAfterATapFromTheRecordOfTheNextOrOfTheEnd) {
  const fs::path directory = run({});
  const std::vector<json> taps = taps_of(directory);
  const auto words = [](const json& value) { return printed("%.4g", 100 * value.get<double>()) + " cm"; };
  EXPECT_THAT(explain(directory, 12),
              HasSubstr("over the scene from " + words(taps[11]["rmse_m"]) + " to " + words(taps[12]["rmse_m"]) + ","));
  const json summary = json::parse(text_of(directory / "summary.json"));
  EXPECT_THAT(explain(directory, 17),
              HasSubstr("over the scene from " + words(taps[16]["rmse_m"]) + " to " + words(summary["rmse_m"]) + ","));
}

TEST_F(Explain, ReadsARunThatIsNotDone) {
  const fs::path directory = run({});
  const std::string whole = explain(directory, 9);
  // What a kill leaves: no summary, and half a line.
  std::istringstream lines(text_of(directory / "taps.jsonl"));
  std::string kept;
  std::string line;
  for (int i = 0; i < 9 && std::getline(lines, line); ++i) kept += line + "\n";
  std::ofstream(directory / "taps.jsonl") << kept << "{\"tap\": 10, \"sou";
  fs::remove(directory / "summary.json");
  const std::string cut = explain(directory, 9);
  EXPECT_THAT(cut, HasSubstr("Tap 9 of 9 so far, run object_i ("));
  EXPECT_EQ(cut.substr(cut.find("Why there"), cut.find("What it changed") - cut.find("Why there")),
            whole.substr(whole.find("Why there"), whole.find("What it changed") - whole.find("Why there")));
  EXPECT_THAT(cut, ContainsRegex("to [0-9.]+ cm\\*")) << "no later tap has recorded it";
}

TEST_F(Explain, SaysThatARunFailedAndThatItsTruthIsNotKnown) {
  const Ended ended = palpate({"run", paper(), "backend.type=cannot_go_on", "--quiet", "--runs", "failing"});
  ASSERT_EQ(ended.status, 1);
  const fs::path directory = only_run(folder_.path() / "failing");
  const std::string text = explain(directory, 5);
  EXPECT_THAT(text, HasSubstr("the tap failed: aborted, the e-stop is pressed."));
  EXPECT_THAT(text, HasSubstr("The run failed at this tap: backend/cannot_go_on: the e-stop is pressed."));
  EXPECT_THAT(text, HasSubstr("The truth is not known"));
  EXPECT_THAT(explain(directory, 4), Not(HasSubstr("The run failed")));
  expect_whole_words(text);
}

TEST_F(Explain, SaysWhereThisBuildWouldTapIfTheRecordTellsAnotherPlace) {
  const fs::path directory = run({});
  std::vector<json> taps = taps_of(directory);
  const std::string chosen = place(taps[11]);
  taps[11]["x"] = 0.5 * 0.23 / 47;  // the first candidate of its row
  std::string text;
  for (const json& tap : taps) text += tap.dump() + "\n";
  std::ofstream(directory / "taps.jsonl") << text;
  const std::string said = explain(directory, 12);
  EXPECT_THAT(said, HasSubstr("From the same taps this build would choose " + chosen + " instead, with a score of " +
                              printed("%.6g", taps[11]["score"])));
  EXPECT_THAT(said.substr(0, said.find('\n')), HasSubstr("): x 0.24 cm, y 9.54 cm"));
  EXPECT_THAT(explain(directory, 11), Not(HasSubstr("would choose")));
}

TEST_F(Explain, RefusesInOneLineWhatItCannotExplain) {
  const fs::path directory = run({});
  const auto refused = [&](const std::vector<std::string>& words) {
    const Ended ended = palpate(words);
    EXPECT_EQ(ended.status, 2);
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(test::lines(ended.err), 1);
    return ended.err;
  };
  for (const char* tap : {"0", "18", "-1"}) {
    EXPECT_EQ(refused({"explain", directory.string(), tap}),
              "tap " + std::string(tap) + ": the run has 17 taps, ask for one of 1 to 17\n");
  }
  EXPECT_THAT(refused({"explain", directory.string(), "x"}), HasSubstr("TAP"));
  EXPECT_THAT(refused({"explain", "nowhere", "1"}), HasSubstr("nowhere: is not a run directory"));
  ASSERT_EQ(palpate({"sweep", paper(), "seed=1,2", "taps=4", "--runs", "many", "--quiet"}).status, 0);
  const fs::path sweep = only_run(folder_.path() / "many");
  EXPECT_EQ(
      refused({"explain", sweep.string(), "1"}),
      sweep.string() + ": is a sweep of many runs, give one of them: " + (sweep / "jobs" / "<id>").string() + "\n");
  EXPECT_EQ(refused({"replay", sweep.string()}), refused({"explain", sweep.string(), "1"}));
  for (const auto& job : fs::directory_iterator(sweep / "jobs"))
    EXPECT_THAT(explain(job.path(), 4), HasSubstr("Tap 4 of 4, run object_i ("));
}

}  // namespace
}  // namespace palpate
