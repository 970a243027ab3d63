// SPDX-License-Identifier: MIT
// Models are built and recorded for those who said that they read them, and for nobody else.
#include "record/json.hpp"
#include "record/tap_row.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <set>
#include <stdexcept>

namespace palpate::test {
namespace {

using Words = std::vector<std::string>;

TEST(Experiment, UncertaintyBuildsNoWeightProcessBeforeTheLastTap) {
  Prepared prepared("paper/object_i.yaml", {"acquisition=uncertainty"});
  const TapBelief& belief = prepared.experiment.belief();
  int weight_seen = 0;
  int height_seen = 0;
  prepared.journal.recording = [&](const TapRecord&) {
    weight_seen += belief.label_gp() ? 1 : 0;
    height_seen += belief.height_gp() ? 1 : 0;
  };
  prepared.run();
  EXPECT_EQ(weight_seen, 0);
  EXPECT_EQ(height_seen, 14) << "of 17 taps, the 14 chosen by score need the height GP";
  prepared.experiment.result();
  EXPECT_NE(belief.label_gp().process, nullptr) << "the truth-based metrics want the outline, once, after the last tap";
}

TEST(Experiment, RandomSearchBuildsNoModelAtAllBeforeTheLastTap) {
  const Finished run("paper/object_i.yaml", {"acquisition=random"});
  EXPECT_EQ(run.experiment.belief().height_gp().process, nullptr);
  EXPECT_EQ(run.experiment.belief().label_gp().process, nullptr);
  EXPECT_FALSE(run.taps.back().max_standard_deviation.has_value());
  EXPECT_FALSE(run.taps.back().errors.rmse.has_value());
}

TEST(Experiment, NamesEveryModelWithWhoReadsItBeforeAnyIsBuilt) {
  const auto readers = [](const Words& words) {
    Words out;
    const Prepared prepared("paper/object_i.yaml", words);
    for (const ModelReader& one : prepared.experiment.readers()) out.push_back(one.model + ": " + one.who);
    const TapBelief& belief = prepared.experiment.belief();
    EXPECT_FALSE(belief.height_gp() || belief.label_gp());
    return out;
  };
  using testing::ElementsAre;
  EXPECT_THAT(readers({}), ElementsAre("height GP: acquisition weighted", "label GP: acquisition weighted",
                                       "height GP: fallback uncertainty, from its first use on"));
  EXPECT_THAT(readers({"acquisition=random", "fallback=none"}), ElementsAre());
  EXPECT_THAT(readers({"acquisition=footprint_entropy", "fallback=none"}),
              ElementsAre("height GP: acquisition footprint_entropy", "label GP: acquisition footprint_entropy"))
      << "two outputs of one process";
  EXPECT_THAT(readers({"acquisition=footprint_entropy", "fallback=none", "label.noise=1e-3"}),
              ElementsAre("label GP: acquisition footprint_entropy"));
  EXPECT_THAT(
      readers({"acquisition=footprint_entropy", "footprint=primitives", "fallback=none", "surface=two_part",
               "stop.expected_rmse=1cm", "stop.max_standard_deviation=1cm"}),
      ElementsAre("footprint primitives: acquisition footprint_entropy", "height GP: stop.max_standard_deviation",
                  "surface GP: stop.expected_rmse", "footprint primitives: stop.expected_rmse"));
  EXPECT_THAT(readers({"acquisition=random", "fallback=none", "motion.adaptive_hover={clearance: 2cm}"}),
              ElementsAre("height GP: backend simulator"));
}

TEST(Experiment, RecordsTheModelsThatItNamesAndNoOthers) {
  for (const Words& words :
       std::vector<Words>{{},
                          {"acquisition=random"},
                          {"acquisition=footprint_entropy"},
                          {"acquisition=footprint_entropy", "label.noise=1e-3"},
                          {"acquisition=uncertainty", "surface=two_part"},
                          {"acquisition=object_uncertainty", "footprint=primitives", "surface=two_part"},
                          {"acquisition=random", "surface=two_part", "stop.expected_rmse=1mm"},
                          {"acquisition=random", "surface=two_part", "motion.adaptive_hover={}"}}) {
    Words all = words;
    all.insert(all.end(), {"fallback=none", "initial.design=grid", "initial.count=9"});  // one of them hits
    Prepared prepared("paper/object_i.yaml", all);
    std::set<std::string> named;
    for (const ModelReader& one : prepared.experiment.readers()) named.insert(one.model);
    prepared.run();
    const TapRecord& last = prepared.taps.back();
    std::set<std::string> recorded;
    if (last.height_gp) recorded.insert("height GP");
    if (last.label_gp) recorded.insert("label GP");
    if (last.surface_gp) recorded.insert("surface GP");
    if (last.footprint) recorded.insert("footprint primitives");
    EXPECT_EQ(recorded, named) << (words.empty() ? "weighted" : words.front());
  }
}

TEST(Experiment, RecordsTheSameWhoeverFollowsItsErrors) {
  for (const char* acquisition : {"acquisition=random", "acquisition=uncertainty", "acquisition=footprint_entropy"}) {
    const Words words{acquisition, "surface=two_part"};
    Finished alone("paper/object_i.yaml", words);
    Prepared followed("paper/object_i.yaml", words);
    std::vector<Errors> errors;
    followed.journal.announcing = [&](const TapRecord&) { errors.push_back(followed.experiment.errors()); };
    followed.run();
    ASSERT_EQ(followed.taps.size(), alone.taps.size());
    for (std::size_t i = 0; i < alone.taps.size(); ++i) {
      EXPECT_EQ(to_json_line(tap_row(followed.taps[i])), to_json_line(tap_row(alone.taps[i]))) << acquisition;
      ASSERT_TRUE(errors[i].rmse && errors[i].footprint_iou);
      EXPECT_LT(*errors[i].rmse, 1.0);
    }
    const RunResult result = followed.experiment.result();
    EXPECT_EQ(*result.errors.rmse, *alone.experiment.result().errors.rmse);
    EXPECT_EQ(result.diagnostics, alone.experiment.result().diagnostics);
    EXPECT_FALSE(alone.taps.back().errors.rmse.has_value()) << "nobody reads the surface for the strategy";
  }
}

TEST(Belief, ThatNobodyAskedForOrThatIsOldIsNotRead) {
  Prepared prepared("paper/object_i.yaml", {"taps=4"});
  const TapBelief& belief = prepared.experiment.belief();
  EXPECT_THROW(belief.weight(), std::logic_error);
  prepared.experiment.ask(Quantity::weight);
  EXPECT_NO_THROW(belief.weight());
  prepared.journal.recording = [&](const TapRecord&) {
    EXPECT_NO_THROW(belief.weight()) << "a tap is recorded before it is taken in";
  };
  std::optional<TapRecord> tap = prepared.experiment.begin(prepared.journal);
  ASSERT_TRUE(tap);
  EXPECT_NO_THROW(belief.weight());
  tap->contact = contact_at(0.0);
  prepared.experiment.end(*tap, prepared.journal);
  EXPECT_THROW(belief.weight(), std::logic_error) << "it has taken in the tap, and nobody has inferred since";
}

TEST(Experiment, APreviewTellsWhatTheModelsExpectAndBuildsNone) {
  Prepared prepared("paper/object_i.yaml", {"taps=4"}, scripted({contact_at(0.09)}));
  const TapBelief& belief = prepared.experiment.belief();
  std::vector<Preview> previews;
  std::vector<bool> built;
  double mean = 0.0;
  prepared.journal.permitting = [&](const TapRecord& tap) {
    built.push_back(static_cast<bool>(belief.height_gp()));
    previews.push_back(prepared.experiment.preview(tap));
    EXPECT_EQ(static_cast<bool>(belief.height_gp()), built.back());
    if (built.back()) mean = belief.height_mean()(tap.candidate);
    return true;
  };
  prepared.run();
  ASSERT_EQ(built, (std::vector<bool>{false, false, false, true})) << "three initial taps need no model";
  EXPECT_FALSE(previews[2].expected.has_value());
  ASSERT_TRUE(previews[3].expected.has_value());
  EXPECT_EQ(previews[3].expected->height, mean);
  EXPECT_GT(previews[3].expected->standard_deviation, 0.0);
}

}  // namespace
}  // namespace palpate::test
