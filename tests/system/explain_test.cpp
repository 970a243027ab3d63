// SPDX-License-Identifier: MIT
// `palpate explain`: every tap of many kinds of runs, in words that are complete and numbers that are the record's.
#include "support/sanitizers.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <regex>
#include <set>
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

class Explain : public Shell {
 protected:
  std::string explain(const fs::path& directory, int tap) const {
    const Ended ended = palpate({"explain", directory, std::to_string(tap)});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(ended.err, "");
    return joined(ended.out);
  }

  static std::vector<json> taps_of(const fs::path& directory) {
    std::vector<json> out;
    for (const std::string& line : lines_of(part_of(directory, "tap"))) {
      out.push_back(json::parse(line));
    }
    return out;
  }

  static void expect_score(const std::string& text, const json& tap) {
    EXPECT_THAT(text, HasSubstr("Its score there is " + printed("%.4g", tap["score"]) +
                                (tap["ties"] == 1 ? ", the best of " : ". ")));
    if (tap["ties"] > 1) {
      EXPECT_THAT(text, ContainsRegex("\\. (" + std::to_string(tap["ties"].get<int>()) + "|All) of [0-9]+ candidates"));
    }
    EXPECT_THAT(text, HasSubstr("Runner-up: " + place(tap["runner_up"]) + " with a score of " +
                                printed("%.4g", tap["runner_up"]["score"]) + ", "));
  }

  static void expect_source(const std::string& text, const json& tap) {
    if (tap["source"] == "initial") {
      EXPECT_THAT(text, ContainsRegex("It is (initial )?tap " + std::to_string(tap["tap"].get<int>()) + " of "));
      EXPECT_THAT(text, Not(HasSubstr("Its score")));
      return;
    }
    expect_score(text, tap);
    if (tap["source"] == "fallback") {
      EXPECT_THAT(text, HasSubstr("gave no usable scores: " + tap["why"].get<std::string>() + "."));
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
    EXPECT_THAT(text, HasSubstr(tap["on_object"] == true ? ", on an object" : ", on the desk"));
  }

  /// u, w and e of the record, or u and p where a footprint is named, are said as they are, what the record has not
  /// is not.
  static void expect_maps(const std::string& text, const json& tap, const std::string& footprint) {
    const auto has = [&](const char* name) { return tap.contains(name) && !tap[name].is_null(); };
    if (!footprint.empty()) {
      EXPECT_EQ(text.find("(probability of an object there, by footprint/" + footprint + ")") != std::string::npos,
                has("p"));
      EXPECT_EQ(text.find("Footprint: " + footprint) != std::string::npos, has("p"));
      EXPECT_THAT(text, Not(HasSubstr("Label GP")));
    }
    for (const char* name : {"u", "w", "e", "p"}) {
      const std::string begin = *name == 'e' ? "e = u w = " : name + std::string(" = ");
      if (has(name)) {
        EXPECT_THAT(text, HasSubstr(begin + printed("%.4g", tap[name]) + (*name == 'e' ? "." : " ")));
      } else {
        EXPECT_THAT(text, Not(ContainsRegex("[ ,]" + begin)));
      }
    }
    EXPECT_EQ(text.find("This choice used no model.") == std::string::npos,
              has("u") || has("w") || has("p") || has("max_standard_deviation"));
  }

  static void expect_whole_words(const std::string& text) {
    static const std::regex hole("\\b(nan|inf|null|true_|std)\\b|[{}]|  [a-z]| [,.;:)]|\\(\\)|: \\.");
    std::smatch found;
    EXPECT_FALSE(std::regex_search(text, found, hole)) << found.str() << " in\n" << text;
  }

  /// Every tap of a run, or every fifth.
  void expect_explained(const fs::path& directory, const std::string& footprint = "") {
    const std::vector<json> taps = taps_of(directory);
    for (std::size_t i = 0; i < taps.size(); i += test::brief() ? 5 : 1) {
      SCOPED_TRACE(directory.string() + " tap " + std::to_string(i + 1));
      const std::string text = explain(directory, static_cast<int>(i) + 1);
      EXPECT_THAT(text, HasSubstr("Tap " + std::to_string(i + 1) + " of " + std::to_string(taps.size())));
      EXPECT_THAT(text.substr(0, text.find('\n')), HasSubstr("): " + place(taps[i])));
      expect_source(text, taps[i]);
      expect_outcome(text, taps[i]);
      expect_maps(text, taps[i], footprint);
      expect_whole_words(text);
    }
  }
};

class ExplainEveryTap : public Explain, public testing::WithParamInterface<Words> {};

TEST_P(ExplainEveryTap, OfARunOfThePaper) { expect_explained(ran(GetParam())); }

INSTANTIATE_TEST_SUITE_P(
    With, ExplainEveryTap,
    testing::Values(
        // Every acquisition, fits, and a surface of two parts.
        "seed=3", "acquisition=uncertainty seed=3", "acquisition=random seed=3", "acquisition=grid seed=3",
        "fitting=ceres belief.height.signal=5cm belief.surface=two_part fitting.every=3",
        "fitting=ceres belief.height.signal=5cm belief.label.hyperparameters=shared kernel=matern52",
        "kernel=swell_and_texture belief.label.clip=true initial.design=sobol",
        // A rule that stalls or may repeat itself.
        "choice.fallback=none choice.repeat=allow", "choice.fallback=none initial.design=grid",
        "choice.fallback=none initial.design=search scene.placement=random",
        "choice.repeat=allow belief.height.noise=0mm belief.label.noise=0 candidates.count=6 taps=40",
        // Failed taps, some and all, and predictions.
        Words{"scene.effects={missed_contacts: {probability: 0.3}, reach: {}}", "seed=2"},
        Words{"scene.effects.missed_contacts={probability: 1}", "belief.surface=two_part", "taps=6"},
        "motion=adaptive"));

TEST_F(Explain, TellsEveryTapOfAFootprintByItsProbability) {
  expect_explained(ran({}, config("default.yaml")), "primitives");
  expect_explained(ran("belief.footprint=gp_classifier acquisition=random taps=6"), "gp_classifier");
}

TEST_F(Explain, TellsWhatTheFootprintRemarks) {
  const fs::path directory = ran("belief.footprint.max_contradictions=0.01 taps=20", config("default.yaml"));
  const json last = taps_of(directory).back();
  ASSERT_TRUE(last["footprint"]["remark"].is_string());
  EXPECT_THAT(explain(directory, 20), HasSubstr("Its remark: " + last["footprint"]["remark"].get<std::string>() + "."));
  EXPECT_THAT(explain(directory, 1), Not(HasSubstr("Its remark")));
}

TEST_F(Explain, NamesSuspectedOutliersSinceWhenAndWhy) {
  // Some of these taps are of the air.
  const fs::path directory =
      ran("scene=l scene.placement=random seed=112 scene.effects=standard motion=gentle motion.confirm=false "
          "taps=30",
          config("default.yaml"));
  const json summary = json::parse(text_of(directory / "summary.json"));
  ASSERT_TRUE(summary["suspected_outliers"].is_array());
  std::set<int> taps;
  int sure = 0;
  for (const json& one : summary["suspected_outliers"]) {
    const int tap = one["tap"];
    const double doubt = one["probability"];
    taps.insert(tap);
    sure += doubt >= 0.9 ? 1 : 0;
    EXPECT_THAT(explain(directory, tap), ContainsRegex("After all 30 taps, it may be an outlier: " +
                                                       printed("%.0f", 100 * doubt) + " %, by its (height|position)"));
  }
  EXPECT_GE(sure, 1) << "a lie that all others contradict";
  for (int tap = 1; tap <= 30; tap += test::brief() ? 7 : 1) {
    if (taps.count(tap) == 0) {
      EXPECT_THAT(explain(directory, tap), Not(HasSubstr("By all 30 taps it may be an outlier")));
    }
  }
}

TEST_F(Explain, ExpectsOfTheSurfaceOfAnObjectNothingBeforeOneIsTouchedNorOfTheDesk) {
  const fs::path directory = ran("scene=l taps=12", config("default.yaml"));
  bool hit = false;
  int compared = 0;
  int on_the_desk = 0;
  for (const json& tap : taps_of(directory)) {
    const std::string text = explain(directory, tap["tap"]);
    SCOPED_TRACE(text);
    EXPECT_EQ(text.find("Expected: nothing, no tap has been on an object yet.") != std::string::npos, !hit);
    EXPECT_EQ(text.find("Expected, by the taps before: a height of ") != std::string::npos, hit);
    const bool on = tap["on_object"];
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

TEST_F(Explain, SaysWhyTheFallbackHadToChoose) {
  EXPECT_THAT(explain(ran(), 8),
              AllOf(HasSubstr("The acquisition, weighted (variance of the height times the mean"),
                    HasSubstr("No tap has hit an object yet: every label is 0"),
                    HasSubstr("503 of 2202 candidates are tied: within 2e-08 of the best (tie_tolerance)"),
                    HasSubstr("- 7 candidates are left out, because tapped before (repeat: forbid).")));
}

TEST_F(Explain, SaysThatAStalledRuleTapsTheSamePlaceForEver) {
  EXPECT_THAT(
      explain(ran("choice.fallback=none choice.repeat=allow"), 7),
      AllOf(
          HasSubstr("All of 2209 candidates are tied"),
          HasSubstr("No score is positive: such scores do not distinguish candidates, but the config uses no fallback"),
          HasSubstr("This place was tapped before: taps 4, 5, 6."), HasSubstr("No candidate is left out.")));
}

TEST_F(Explain, SaysThatTheFallbackDidNotStepInWhereScoresAreAsGoodAsZeroButPositive) {
  // Where an object may be, all is tapped, and u there is the noise, 1e-12; elsewhere w, and so the score, is below 0.
  const fs::path directory =
      ran("choice.repeat=allow belief.height.noise=0.001mm belief.label.noise=1e-6 candidates.count=6 taps=40");
  int found = 0;
  for (const json& tap : taps_of(directory)) {
    if (tap["source"] != "acquisition" || tap["score"] > 1e-9) continue;
    ++found;
    EXPECT_LE(tap["score"], 1e-12);
    const std::string text = explain(directory, tap["tap"]);
    EXPECT_THAT(text, HasSubstr(", is nearly 0 but positive, so the fallback was not used."));
    EXPECT_THAT(text, Not(HasSubstr("fallback: none")));
  }
  EXPECT_GT(found, 0);
}

TEST_F(Explain, TellsTheLastCandidate) {
  const std::string last = explain(ran("candidates.count=2 taps=4"), 4);
  EXPECT_THAT(last, HasSubstr("Its score there is 1; no other candidate is left."));
  EXPECT_THAT(last, HasSubstr("There is no runner-up."));
  expect_whole_words(last);
}

TEST_F(Explain, SaysWhatJitterAndAWeightBeyondItsBoundsMean) {
  // The same candidate again and again without noise: the matrix is singular.
  const fs::path directory =
      ran("choice.fallback=none choice.repeat=allow belief.height.noise=0mm belief.label.noise=0");
  ASSERT_GT(taps_of(directory)[16]["height_gp"]["jitter"], 0.0);
  EXPECT_THAT(explain(directory, 17),
              HasSubstr("Its matrix was singular in double precision, so jitter was added to the diagonal"));
  EXPECT_THAT(explain(ran("belief.label.clip=true", config("paper/object_i_right.yaml")), 17),
              AllOf(HasSubstr("It leaves [0, 1] because it is a regression on the labels 0 and 1"),
                    HasSubstr("clipped to [0, 1] (belief.label.clip: true).")));
}

TEST_F(Explain, SaysWhatAFitDidAndWhenNoneWasDue) {
  const fs::path directory =
      ran("fitting=ceres belief.height.signal=5cm fitting.every=4", config("paper/object_i_right.yaml"));
  const std::vector<json> taps = taps_of(directory);
  int fits = 0;
  for (std::size_t i = 5; i < taps.size(); ++i) {
    const json& process = taps[i]["height_gp"];
    const std::string text = explain(directory, static_cast<int>(i) + 1);
    if (process.contains("fit")) {
      ++fits;
      EXPECT_THAT(text, HasSubstr("; objective " + printed("%.4g", process["fit"]["objective"]) + " after " +
                                  std::to_string(process["fit"]["evaluations"].get<int>()) + " evaluation"));
    } else {
      EXPECT_THAT(text, HasSubstr("No fit (ceres) was due after its latest tap"));
    }
    EXPECT_THAT(text, HasSubstr("length scale " +
                                printed("%.4g", 100 * process["kernel"]["length_scale"].get<double>()) + " cm"));
  }
  EXPECT_GE(fits, 2);
}

TEST_F(Explain, SaysHowMuchTheRunnerUpIsBehindAndTakesErrorsAfterATapFromTheNextOrFromTheEnd) {
  const fs::path directory = ran();
  const std::vector<json> taps = taps_of(directory);
  ASSERT_EQ(taps[11]["ties"], 1);
  const double score = taps[11]["score"];
  const double second = taps[11]["runner_up"]["score"];
  const auto errors = [](const json& before, const json& after) {
    const auto words = [](const json& record) {
      return printed("%.3g", 1000 * record["rmse_m"].get<double>()) + " mm";
    };
    return HasSubstr("over the scene from " + words(before) + " to " + words(after) + ",");
  };
  EXPECT_THAT(explain(directory, 12),
              AllOf(HasSubstr(", " + printed("%.3g", 100 * (score - second) / score) + " % less."),
                    errors(taps[11], taps[12])));
  EXPECT_THAT(explain(directory, 17), errors(taps[16], json::parse(text_of(directory / "summary.json"))));
}

TEST_F(Explain, ReadsARunThatIsNotDone) {
  const fs::path directory = ran();
  const std::string whole = explain(directory, 9);
  // What a kill leaves: no summary, and half a line.
  const std::string record = text_of(directory / "record.jsonl");
  write(directory / "record.jsonl", record.substr(0, record.find("{\"tap\": 10,")) + "{\"tap\": 10, \"sou");
  fs::remove(directory / "summary.json");
  const std::string cut = explain(directory, 9);
  EXPECT_THAT(cut, HasSubstr("Tap 9 of 9 so far, run object_i ("));
  EXPECT_EQ(cut.substr(cut.find("Why there"), cut.find("Effect of the tap") - cut.find("Why there")),
            whole.substr(whole.find("Why there"), whole.find("Effect of the tap") - whole.find("Why there")));
  EXPECT_THAT(cut, HasSubstr("The record has no errors from before and after it")) << "no later tap has recorded it";
}

TEST_F(Explain, SaysThatARunFailedAndThatItsTruthIsNotKnown) {
  environment_ = {test::with_plugin("cannot_go_on")};
  ASSERT_EQ(run("backend.type=cannot_go_on --quiet").status, 1);
  const std::string text = explain(directory(), 5);
  EXPECT_THAT(text,
              AllOf(HasSubstr("the tap failed: aborted, the e-stop is pressed."), HasSubstr("The truth is not known"),
                    HasSubstr("The run failed at this tap: backend/cannot_go_on: the e-stop is pressed.")));
  EXPECT_THAT(explain(directory(), 4), Not(HasSubstr("The run failed")));
  expect_whole_words(text);
}

TEST_F(Explain, RefusesInOneLineWhatItCannotExplain) {
  const fs::path directory = ran();
  for (const char* tap : {"0", "18", "-1"}) {
    EXPECT_EQ(refused({"explain", directory, tap}),
              "tap " + std::string(tap) + ": the run has 17 taps, choose one of 1 to 17\n");
  }
  EXPECT_THAT(refused({"explain", directory, "x"}), HasSubstr("TAP"));
  EXPECT_THAT(refused("explain nowhere 1"),
              HasSubstr("nowhere: is not a folder, and runs contains no run or sweep of that name"));
  const fs::path sweep = swept("seed=1,2 taps=4");
  for (const Words& words : {Words{"explain", sweep, "1"}, Words{"replay", sweep}}) {
    const std::string jobs = (sweep / "jobs").string();
    EXPECT_EQ(refused(words), sweep.string() + ": is a sweep of many runs, name one run: " + jobs +
                                  "/<id>; 'palpate list " + jobs + " --where \"seed == 3\"' finds it\n");
    EXPECT_THAT(palpate({"list", jobs, "--where", "seed == 2"}).out, HasSubstr(job_of(sweep, 1).filename().string()));
  }
  for (const fs::path& job : jobs_of(sweep)) EXPECT_THAT(explain(job, 4), HasSubstr("Tap 4 of 4, run object_i ("));
}

}  // namespace
}  // namespace palpate
