// SPDX-License-Identifier: MIT
// Models are built and recorded for those who said that they read them, and for nobody else.
#include "record/json.hpp"
#include "record/record_reader.hpp"
#include "record/run.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <set>
#include <stdexcept>

namespace palpate::test {
namespace {

using Words = std::vector<std::string>;

TEST(Experiment, UncertaintyBuildsNoWeightProcessBeforeTheLastTap) {
  Prepared prepared("paper/object_i.yaml", {"acquisition=uncertainty"});
  const HeightModels& models = prepared.models();
  int weight_seen = 0;
  int height_seen = 0;
  prepared.journal.recording = [&](const TapRecord&) {
    weight_seen += models.gps().label ? 1 : 0;
    height_seen += models.gps().height ? 1 : 0;
  };
  prepared.run();
  EXPECT_EQ(weight_seen, 0);
  EXPECT_EQ(height_seen, 14) << "of 17 taps, the 14 chosen by score need the height GP";
  prepared.experiment.result();
  EXPECT_NE(models.gps().label.process, nullptr)
      << "the truth-based metrics want the outline, once, after the last tap";
}

TEST(Experiment, RandomSearchBuildsNoModelAtAllBeforeTheLastTap) {
  const Finished run("paper/object_i.yaml", {"acquisition=random"});
  EXPECT_EQ(run.models().gps().height.process, nullptr);
  EXPECT_EQ(run.models().gps().label.process, nullptr);
  EXPECT_FALSE(number_of(run.taps.back().state, "max_standard_deviation"));
  EXPECT_FALSE(run.taps.back().errors.rmse.has_value());
}

TEST(Experiment, NamesEveryModelWithWhoReadsItBeforeAnyIsBuilt) {
  const auto readers = [](const Words& words) {
    Words out;
    const Prepared prepared("paper/object_i.yaml", words);
    for (const PlannedModel& one : prepared.experiment.plan().models) out.push_back(one.model + ": " + one.reader);
    EXPECT_FALSE(prepared.models().gps().height || prepared.models().gps().label);
    return out;
  };
  using testing::ElementsAre;
  EXPECT_THAT(readers({}), ElementsAre("height GP: acquisition weighted", "label GP: acquisition weighted",
                                       "height GP: fallback uncertainty, from its first use on"));
  EXPECT_THAT(readers({"acquisition=random", "choice.fallback=none"}), ElementsAre());
  EXPECT_THAT(readers({"acquisition=footprint_entropy", "choice.fallback=none"}),
              ElementsAre("height GP: acquisition footprint_entropy", "label GP: acquisition footprint_entropy"))
      << "two outputs of one process";
  EXPECT_THAT(readers({"acquisition=footprint_entropy", "choice.fallback=none", "belief.label.noise=1e-3"}),
              ElementsAre("label GP: acquisition footprint_entropy"));
  EXPECT_THAT(
      readers({"acquisition=footprint_entropy", "belief.footprint=primitives", "choice.fallback=none",
               "belief.surface=two_part", "stop.expected_rmse=1cm", "stop.max_standard_deviation=1cm"}),
      ElementsAre("footprint primitives: acquisition footprint_entropy", "height GP: stop.max_standard_deviation",
                  "surface GP: stop.expected_rmse", "footprint primitives: stop.expected_rmse"));
  EXPECT_THAT(readers({"acquisition=random", "choice.fallback=none", "motion.adaptive_hover={clearance: 2cm}"}),
              ElementsAre("height GP: motion paper"));
}

TEST(Experiment, RecordsTheModelsThatItNamesAndNoOthers) {
  for (const Words& words :
       std::vector<Words>{{},
                          {"acquisition=random"},
                          {"acquisition=footprint_entropy"},
                          {"acquisition=footprint_entropy", "belief.label.noise=1e-3"},
                          {"acquisition=uncertainty", "belief.surface=two_part"},
                          {"acquisition=object_uncertainty", "belief.footprint=primitives", "belief.surface=two_part"},
                          {"acquisition=random", "belief.surface=two_part", "stop.expected_rmse=1mm"},
                          {"acquisition=random", "belief.surface=two_part", "motion.adaptive_hover={}"}}) {
    Words all = words;
    all.insert(all.end(), {"choice.fallback=none", "initial.design=grid", "initial.count=9"});  // one of them hits
    Prepared prepared("paper/object_i.yaml", all);
    std::set<std::string> named;
    for (const PlannedModel& one : prepared.experiment.plan().models) named.insert(one.model);
    prepared.run();
    const auto recorded = [](const BeliefState& state) {
      std::set<std::string> out;
      if (number_of(state, "height_gp.signal")) out.insert("height GP");
      if (number_of(state, "label_gp.signal")) out.insert("label GP");
      if (number_of(state, "surface_gp.signal")) out.insert("surface GP");
      if (number_of(state, "footprint.primitives")) out.insert("footprint primitives");
      return out;
    };
    EXPECT_EQ(recorded(prepared.taps.back().state), named) << (words.empty() ? "weighted" : words.front());
  }
}

/// Follows the errors of a run.
class Follower final : public Observer {
 public:
  std::vector<Errors> errors;
  bool wants_errors() const override { return true; }
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override { errors.push_back(tap.errors); }
};

TEST(Experiment, RecordsTheSameWhoeverFollowsItsErrors) {
  const TemporaryFolder folder;
  const Installation installation;
  const RunEnvironment environment{shared_host(), installation, {}, nullptr};
  for (const auto& [acquisition, surface] : {std::pair<std::string, std::string>{"random", "two_part"},
                                             {"uncertainty", "two_part"},
                                             {"uncertainty", "single"},
                                             {"footprint_entropy", "two_part"}}) {
    const ResolvedConfig config =
        shipped_config("paper/object_i.yaml", {"acquisition=" + acquisition, "belief.surface=" + surface});
    const fs::path alone = folder.path() / (acquisition + surface + "_alone");
    const fs::path followed = folder.path() / (acquisition + surface + "_followed");
    const Row summary = start_run(environment, config, alone, {}).summary;
    Follower follower;
    const Row other = start_run(environment, config, followed, {}, {&follower}).summary;
    const std::vector<Row> taps = read_run_record(alone).taps;
    const std::vector<Row> other_taps = read_run_record(followed).taps;
    ASSERT_EQ(other_taps.size(), taps.size());
    ASSERT_EQ(follower.errors.size(), taps.size());
    for (std::size_t i = 0; i < taps.size(); ++i) {
      EXPECT_EQ(to_json_line(other_taps[i]), to_json_line(taps[i])) << acquisition;
      ASSERT_TRUE(follower.errors[i].rmse && follower.errors[i].footprint_iou) << acquisition << " tap " << i + 1;
      EXPECT_LT(*follower.errors[i].rmse, 1.0);
    }
    EXPECT_EQ(other.number("rmse_m").value(), summary.number("rmse_m").value());
    for (const auto& [name, value] : summary.fields) {
      if (name.rfind("diagnostics.", 0) != 0) continue;
      EXPECT_EQ(other.cell(name), csv_cell(value)) << name;
    }
    EXPECT_EQ(taps.back().number("rmse_m").has_value(), surface == "single") << "the strategy reads no other surface";
  }
}

TEST(Belief, ThatNobodyAskedForOrThatIsOldIsNotRead) {
  Prepared prepared("paper/object_i.yaml", {"taps=4"});
  const HeightMapBelief& belief = prepared.belief();
  const auto weight = [&] { belief.values(quantity::kLabelMean); };
  EXPECT_THROW(weight(), std::logic_error);
  prepared.read({quantity::kLabelMean});
  EXPECT_NO_THROW(weight());
  prepared.journal.recording = [&](const TapRecord&) {
    EXPECT_NO_THROW(weight()) << "a tap is recorded before it is taken in";
  };
  std::optional<TapRecord> tap = prepared.experiment.begin(prepared.journal);
  ASSERT_TRUE(tap);
  EXPECT_NO_THROW(weight());
  tap->result = contact_at(0.0);
  prepared.experiment.end(*tap, prepared.journal);
  EXPECT_THROW(weight(), std::logic_error) << "it has taken in the tap, and nobody has inferred since";
}

TEST(Experiment, APreviewTellsWhatTheModelsExpectAndBuildsNone) {
  Prepared prepared("paper/object_i.yaml", {"taps=4"}, scripted({contact_at(0.09)}));
  const HeightModels& models = prepared.models();
  std::vector<Preview> previews;
  std::vector<bool> built;
  double mean = 0.0;
  prepared.journal.permitting = [&](const TapRecord& tap) {
    built.push_back(static_cast<bool>(models.gps().height));
    previews.push_back(prepared.experiment.preview(tap));
    EXPECT_EQ(static_cast<bool>(models.gps().height), built.back());
    if (built.back()) mean = models.height_mean()(tap.candidate);
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
