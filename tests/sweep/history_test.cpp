// SPDX-License-Identifier: MIT
// A run lived through again says at every tap what the run said then, and at its end what its summary says.
#include "report/history.hpp"

#include "record/fields.hpp"
#include "record/run.hpp"
#include "report/curves.hpp"
#include "report/page/run_page.hpp"
#include "report/page/warnings.hpp"
#include "support/parts.hpp"
#include "support/runs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace palpate {
namespace {

namespace fs = std::filesystem;

using test::TemporaryFolder;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

/// A run that was made in this process.
class Recorded {
 public:
  Recorded(const std::string& base, const std::vector<std::string>& words) {
    const ResolvedConfig config = test::shipped_config(base, words);
    directory = start_run(environment, config, folder_.path() / "run", {}).directory;
  }

  RecordedRun recording() const { return read_recorded_run(environment.host, directory); }
  History history() const {
    return make_history(environment, recording(), [](int, int) {});
  }

 private:
  TemporaryFolder folder_;
  Installation installation_;

 public:
  RunEnvironment environment{test::shared_host(), installation_, {}, nullptr};
  fs::path directory;
};

std::string cell(const Row& row, const char* name) {
  const Scalar* value = row.find(name);
  return value != nullptr ? csv_cell(*value) : "absent";
}

/// A shipped config, and words behind it.
class RunHistory : public ::testing::TestWithParam<std::vector<std::string>> {};

TEST_P(RunHistory, SaysAtEveryTapWhatTheRunSaidAndAtItsEndWhatTheSummarySays) {
  const Recorded run(GetParam().front(), {GetParam().begin() + 1, GetParam().end()});
  const RecordedRun recording = run.recording();
  const History history = run.history();
  ASSERT_EQ(history.moments.size(), recording.rows.size() + 1);
  int compared = 0;
  int compared_footprint = 0;
  for (std::size_t made = 0; made < recording.rows.size(); ++made) {
    const Row& row = recording.rows[made];
    const RunAtTap& moment = history.moments[made];
    ASSERT_TRUE(moment.next.has_value());
    const Row next = tap_row(*moment.next);
    for (const char* field : {"x", "y", "source", "score", "ties", "runner_up.x"}) {
      EXPECT_EQ(cell(next, field), cell(row, field)) << field << " of tap " << made + 1;
    }
    for (const auto& [name, value] : row.fields) {
      const bool of_footprint = name == "p" || name == "footprint_iou" || name.compare(0, 10, "footprint.") == 0;
      if (!of_footprint || csv_cell(value).empty()) continue;
      // Errors are of the state that the tap was chosen from, whatever the next choice would build beyond it.
      const std::string now =
          name == "footprint_iou" ? csv_cell(*moment.result.errors.footprint_iou) : cell(next, name.c_str());
      EXPECT_EQ(now, csv_cell(value)) << name << " of tap " << made + 1;
      compared_footprint += name == "p" ? 1 : 0;
    }
    if (cell(row, "rmse_m").empty()) continue;
    ++compared;
    EXPECT_EQ(cell(row, "rmse_m"), csv_cell(*moment.result.errors.rmse));
    if (cell(row, "max_standard_deviation").empty()) continue;
    EXPECT_EQ(cell(row, "max_standard_deviation"), csv_cell(moment.largest_deviation));
  }
  const ExperimentOptions& options = recording.config.options;
  const bool reads_surface =
      (options.acquisition.type != "random" && belief_option(options, "surface") == "single") ||
      (recording.taps.front().request.predicted &&
       belief_option(options, "height.outlier_probability").empty());  // else a height is predicted without its map
  EXPECT_EQ(compared > 0, reads_surface);
  EXPECT_EQ(compared_footprint > 10, belief_option(options, "footprint.type") != "gp_regression");
  RunResult last = history.moments.back().result;
  last.stop_reason = cell(*recording.summary, "stop_reason");
  for (const auto& [name, value] : summary_list().row({last, recording.config, "", {}, {}, {}, {}}).fields) {
    if (!depends_on_machine(name)) {
      EXPECT_EQ(csv_cell(value), cell(*recording.summary, name.c_str())) << name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryKind, RunHistory,
    ::testing::Values(std::vector<std::string>{"paper/object_i.yaml"},
                      std::vector<std::string>{"paper/object_i.yaml", "acquisition=uncertainty", "seed=4"},
                      std::vector<std::string>{"paper/object_i.yaml", "belief.surface=two_part", "fitting=ceres",
                                               "fitting.every=4", "seed=4"},
                      std::vector<std::string>{"paper/object_i.yaml", "acquisition=random", "belief.label.clip=true",
                                               "belief.engine.type=dense"},
                      std::vector<std::string>{"paper/object_i.yaml", "motion=continuous",
                                               "scene.effects={missed_contacts: {probability: 0.3}}"},
                      std::vector<std::string>{"default.yaml"},
                      std::vector<std::string>{"default.yaml", "belief.footprint.max_contradictions=0.01", "seed=2"},
                      std::vector<std::string>{"default.yaml", "belief.footprint=gp_classifier", "scene=object_ii"}));

TEST(History, KeepsAScoreOfItsOwnOnlyWhereItIsNeitherUNorE) {
  const auto names = [](const std::vector<std::string>& words) {
    std::vector<std::string> out;
    for (const MapSeries& one : Recorded("paper/object_i.yaml", words).history().maps) out.push_back(one.name);
    return out;
  };
  using ::testing::ElementsAre;
  EXPECT_THAT(names({"taps=6"}), ElementsAre("height", "deviation", "u", "w", "truth"));
  EXPECT_THAT(names({"taps=6", "acquisition=uncertainty"}), ElementsAre("height", "deviation", "u", "w", "truth"));
  EXPECT_THAT(names({"taps=6", "acquisition=random"}), ElementsAre("height", "deviation", "u", "w", "score", "truth"));
}

TEST(History, HasTheProbabilityOfTheFootprintInPlaceOfTheWeight) {
  const Recorded run("default.yaml", {"taps=12"});
  const History history = run.history();
  std::vector<std::string> names;
  for (const MapSeries& one : history.maps) names.push_back(one.name);
  EXPECT_THAT(names, ::testing::ElementsAre("height", "deviation", "u", "p", "score", "truth"));
  const RecordedRun recording = run.recording();
  RunReplay last(run.environment, recording, page_readers(recording));
  last.advance_to(12);
  last.experiment().look();
  const Belief& belief = last.experiment().belief();
  EXPECT_EQ(history.maps.at(3).frames.back(),
            Eigen::VectorXf(belief.values(quantity::kObjectProbability).cast<float>()));
  EXPECT_FALSE(history.moments.back().least_weight.has_value());
  EXPECT_EQ(belief.available().count(quantity::kLabelMean), 0U) << "nothing reads it";
}

TEST(History, ShowsNoDeviationBeyondWhatTheHeightsHave) {
  // Before an object is touched its level is free, and so a thousand signals uncertain.
  const Recorded run("paper/object_i.yaml", {"belief.surface=two_part", "taps=12"});
  const History history = run.history();
  for (const Eigen::VectorXf& frame : history.maps.at(1).frames) EXPECT_LE(frame.maxCoeff(), 1.0F);
  const RecordedRun recording = run.recording();
  RunReplay last(run.environment, recording, page_readers(recording));
  last.advance_to(12);
  last.experiment().look();
  const Eigen::VectorXd deviation = last.experiment().belief().values(quantity::kHeightStd);
  for (Eigen::Index i = 0; i < deviation.size(); ++i)
    EXPECT_NEAR(static_cast<double>(history.maps.at(1).frames.back()(i)), std::min(deviation(i), 1.0), 1e-6);
}

TEST(History, TakesOnlySomeCellsOfFineMaps) {
  const Recorded run("paper/object_i.yaml", {"taps=4", "candidates.count=150"});
  const History history = run.history();
  EXPECT_EQ(history.x.size(), 75);
  EXPECT_EQ(history.y.size(), 75);
  EXPECT_EQ(history.maps.front().frames.front().size(), 75 * 75);
  EXPECT_NEAR(history.x(1) - history.x(0), 2 * 0.23 / 150, 1e-12);
}

TEST(History, OfARunFromAnySideHasASurfaceForEachMomentAfterTheFirstHit) {
  const Recorded run("any_side.yaml", {"scene=object_i", "taps=9", "candidates.count=200", "belief.moves=100"});
  const RecordedRun recording = run.recording();
  const History history = run.history();
  ASSERT_EQ(history.surfaces.size(), 10U);
  EXPECT_TRUE(history.maps.empty());
  EXPECT_GT(history.true_contours.size(), 10U);
  const auto hit = static_cast<int>(recording.summary.value().number("first_hit_tap").value());
  EXPECT_LE(hit, 9);
  for (int taps = 0; taps <= 9; ++taps) {
    const RunAtTap& moment = history.moments[static_cast<std::size_t>(taps)];
    EXPECT_EQ(history.surfaces[static_cast<std::size_t>(taps)].vertices.empty(), taps < hit);
    ASSERT_TRUE(moment.next && moment.next_along);
    EXPECT_LE(*moment.next_along, moment.next->request.line.length);
    if (taps == 9) continue;
    EXPECT_EQ(moment.next->request.line.start, recording.taps[static_cast<std::size_t>(taps)].request.line.start);
  }
  EXPECT_EQ(history.moments.back().result.errors.surface_distance, recording.summary->number("surface_distance_m"));

  // A page that has all moments is told of the end without any surface, and keeps its plots.
  HistoryBuilder builder(run.environment, recording);
  while (builder.taps() < 9) builder.advance();
  const auto titles = [&](const History& of) {
    std::vector<std::string> out;
    for (const CurvePanel& panel : curves_of(recording, of).panels) out.push_back(panel.title);
    return out;
  };
  EXPECT_TRUE(builder.since(10).surfaces.empty());
  EXPECT_EQ(titles(builder.since(10)), titles(history));
}

TEST(RunPage, IsSmallEnoughToMailHoweverLongTheRunAndFineTheGrid) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{}, {"taps=60"}, {"taps=200"}, {"taps=40", "candidates.count=128"}}) {
    const Recorded run("paper/object_i.yaml", words);
    const std::string page = run_page(run.recording(), run.history(), [](int, int) {});
    EXPECT_LE(page.size(), kMostPageBytes);
    EXPECT_GT(page.size(), 1'900'000U);  // plotly is in it
  }
}

std::vector<std::string> warnings(const std::string& base, const std::vector<std::string>& words) {
  const Recorded run(base, words);
  return warnings_of(run.recording(), run.history());
}

TEST(RunPage, SaysOneThingOfARunThatEndsOrGoesOnWhileItIsMade) {
  const Recorded run("paper/object_i.yaml", {"taps=6"});
  const History history = run.history();
  const fs::path file = run.directory / "record.jsonl";
  const std::string whole = test::text_of(file);
  const std::string begun = test::record_until(whole, 6);
  ASSERT_LT(begun.size(), whole.size());
  const auto write = [&](const std::string& text) { std::ofstream(file, std::ios::binary) << text; };
  // The record is read in one state, and stands in the other when the page is made.
  const RecordedRun ended = run.recording();
  write(begun);
  const RecordedRun going_on = run.recording();
  EXPECT_THAT(run_news(ended, history, 7, ""),
              AllOf(HasSubstr(R"("state":"done")"), HasSubstr(R"("stop_reason":"tap budget")"),
                    Not(HasSubstr("The run has not ended"))));
  write(whole);
  EXPECT_THAT(run_news(going_on, history, 7, ""),
              AllOf(Not(HasSubstr(R"("state":"done")")), HasSubstr(R"("stop_reason":"")"),
                    HasSubstr("The run has not ended: this page shows its state after 6 taps.")));
}

TEST(Warnings, TellOfFallbacksAndOfWeightsThatAreNoProbabilities) {
  const std::vector<std::string> said = warnings("paper/object_i.yaml", {});
  EXPECT_THAT(said, Contains(HasSubstr("5 of 17 taps were chosen by the fallback")));
  EXPECT_THAT(said,
              Contains(AllOf(HasSubstr("The weight leaves [0, 1]: from -"), HasSubstr("belief.label.clip=true"))));
  EXPECT_THAT(said, ::testing::Not(Contains(HasSubstr("elsewhere"))));
}

TEST(Warnings, TellWhatTheFootprintRemarksAndNothingOfWeights) {
  const std::vector<std::string> said = warnings("default.yaml", {"belief.footprint.max_contradictions=0.01"});
  EXPECT_THAT(
      said, Contains(AllOf(HasSubstr("Remark of the footprint primitives: "), HasSubstr("has taken over at contact"))));
  EXPECT_THAT(said, ::testing::Not(Contains(HasSubstr("weight"))));
}

TEST(Warnings, TellOfARuleThatStalls) {
  EXPECT_THAT(warnings("paper/object_i.yaml", {"choice.fallback=none", "choice.repeat=allow"}),
              Contains(HasSubstr("14 taps were chosen by the acquisition although no candidate had a positive score")));
}

TEST(Warnings, OfARunFromAnySideSpeakOfApproachesAndTakeAFreeWayForNoFailure) {
  const Recorded run("any_side.yaml", {"scene=object_i", "acquisition=uncertainty", "taps=12", "choice.fallback=none",
                                       "candidates.count=1", "belief.moves=20"});
  ASSERT_GT(run.history().moments.back().result.no_contact_taps, 0);
  const std::vector<std::string> said = warnings_of(run.recording(), run.history());
  EXPECT_THAT(said, Contains(HasSubstr("although no approach had a positive score")));
  for (const char* const other : {"fallback", "did not reach the models", "maps"})
    EXPECT_THAT(said, ::testing::Not(Contains(HasSubstr(other))));
}

TEST(Warnings, TellOfTapsWithoutContactAndOfJitter) {
  const Recorded run("paper/object_i.yaml",
                     {"choice.repeat=allow", "choice.fallback=none", "belief.height.noise=0 mm", "belief.label.noise=0",
                      "seed=1", "scene.effects={missed_contacts: {probability: 0.3}}"});
  const RunResult last = run.history().moments.back().result;
  const std::vector<std::string> said = warnings_of(run.recording(), run.history());
  ASSERT_GT(last.failed_taps, 0);
  ASSERT_GT(last.state.diagnostics.at("jitter"), 0);
  EXPECT_THAT(said, Contains(HasSubstr(std::to_string(last.failed_taps) + " tap")));
  EXPECT_THAT(said, Contains(HasSubstr("Jitter up to ")));
}

TEST(Warnings, TellOfTheFirstTapThatThisBuildWouldHaveMadeElsewhere) {
  const Recorded run("paper/object_i.yaml", {});
  RecordedRun recording = run.recording();
  for (const std::size_t tap : {11U, 14U})
    recording.taps[tap].request.line.start.x() = 0.5 * 0.23 / 47;  // the first of its row
  const History history = make_history(run.environment, recording, [](int, int) {});
  EXPECT_THAT(warnings_of(recording, history),
              Contains(HasSubstr("this build would choose another position for tap 12")));
}

TEST(Warnings, AreNoneOfARunWithoutTrouble) {
  // One tap, on the object: w is 1 there and falls to 0 around it.
  const Recorded run("paper/object_i.yaml", {"taps=1", "initial.count=1", "initial.design=grid"});
  ASSERT_EQ(run.history().moments.back().result.object_taps, 1);
  EXPECT_THAT(warnings_of(run.recording(), run.history()), ::testing::IsEmpty());
}

}  // namespace
}  // namespace palpate
