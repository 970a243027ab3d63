// SPDX-License-Identifier: MIT
#include "experiment/experiment.hpp"

#include "record/json.hpp"
#include "record/run.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <cmath>
#include <set>

namespace palpate::test {
namespace {

TapResult failure(Outcome outcome) { return tap_without_contact(outcome, 1.0, "because the test says so"); }

TEST(Experiment, WeightedScoreIsTheProductOfUncertaintyAndWeight) {
  const Finished run("paper/object_i_right.yaml", {"seed=6"});
  int by_score = 0;
  for (const TapRecord& tap : run.taps) {
    if (tap.request.source != Source::acquisition) continue;
    ++by_score;
    const double uncertainty = number_of(tap.state, "u").value();
    EXPECT_DOUBLE_EQ(*tap.score, uncertainty * number_of(tap.state, "w").value());
    EXPECT_GE(uncertainty, 0.0);
    EXPECT_LE(uncertainty, 1.0);
  }
  EXPECT_EQ(by_score, 14);
}

TEST(Experiment, ADeadStartFallsBackToUncertaintyAndSaysSo) {
  Finished run("paper/object_i.yaml", {}, scripted());
  for (std::size_t i = 3; i < run.taps.size(); ++i) {
    EXPECT_EQ(run.taps[i].request.source, Source::fallback);
    EXPECT_EQ(run.taps[i].why, "no score is positive");
  }
  EXPECT_EQ(run.experiment.result().state.diagnostics.at("fallback"), 14);
}

TEST(Experiment, ForbiddenRepeatsTapEveryCandidateAtMostOnceAndStopWhenNoneIsLeft) {
  Finished run("paper/object_i.yaml", {"candidates.count=3", "taps=17"});
  std::set<int> tapped;
  for (const TapRecord& tap : run.taps) tapped.insert(tap.candidate);
  EXPECT_EQ(run.taps.size(), 9U);
  EXPECT_EQ(tapped.size(), 9U);
  EXPECT_EQ(run.experiment.result().stop_reason, "no candidate is left");
}

TEST(Experiment, FailedTapsAreRecordedButReachNoModel) {
  Finished run("paper/object_i.yaml", {"taps=6", "choice.repeat=allow"},
               scripted({contact_at(0.09), failure(Outcome::unreachable), failure(Outcome::timeout),
                         failure(Outcome::no_contact), failure(Outcome::aborted), contact_at(0.0)}));
  const RunResult result = run.experiment.result();
  EXPECT_EQ(result.taps, 6);
  EXPECT_EQ(result.object_taps, 1);
  EXPECT_EQ(result.desk_taps, 1);
  EXPECT_EQ(result.failed_taps, 4);
  run.read({quantity::kHeightMean});
  EXPECT_EQ(run.models().gps().height.process->size(), 2);
  std::set<int> places;
  for (const TapRecord& tap : run.taps) places.insert(tap.candidate);
  EXPECT_EQ(places.size(), 6U) << "a place that failed is not tried again, even where repeats are allowed";
}

TEST(Experiment, AScoreThatIsNotANumberEndsTheRunInWords) {
  class Broken final : public Acquisition {
   public:
    QuantitySet reads() const override { return {}; }
    void score(const BeliefView&, VectorOut out) const override { out.setConstant(std::nan("")); }
    double prior_scale() const override { return 1.0; }
  };
  const Instead<Acquisition> broken(std::make_shared<Broken>());
  Prepared prepared("paper/object_i.yaml", {}, nullptr, broken);
  EXPECT_EQ(error_of([&] { prepared.run(); }), "acquisition/weighted: returned a score that is not a finite number");
  EXPECT_EQ(prepared.taps.size(), 3U) << "the taps before stay recorded";
}

TEST(Experiment, GivesAnAcquisitionTheTapsSoFarAndWhereTheArmIs) {
  // Taps what lies nearest to the last contact, and takes down what it was given.
  struct Nearest final : Acquisition {
    mutable TapsSoFar taps;
    QuantitySet reads() const override { return {quantity::kDeskPosition}; }
    void score(const BeliefView& belief, VectorOut out) const override {
      taps = belief.taps();
      const Eigen::RowVector2d last = taps.readings.back().position.head<2>();
      out = 1.0 / (1.0 + (belief.candidates().starts.leftCols<2>().rowwise() - last).rowwise().norm().array());
    }
    double prior_scale() const override { return 1.0; }
  };
  const auto nearest = std::make_shared<Nearest>();
  const Instead<Acquisition> plugins(nearest);
  const TapResult missed = tap_without_contact(Outcome::no_contact, 1.0, "nothing there");
  const auto backend = scripted({contact_at(0.05), contact_at(0.0), contact_at(0.0), missed, contact_at(0.05)});
  const Finished run("paper/object_i.yaml", {"taps=6"}, backend, plugins);
  ASSERT_EQ(run.taps.size(), 6U);
  const Points places = run.grid().points;
  const double step = (places.row(1) - places.row(0)).norm();
  const std::size_t last_contacts[] = {2, 2, 4};  // before taps 4, 5 and 6, from 0
  for (std::size_t i = 3; i < 6; ++i) {
    const Target here = run.taps[last_contacts[i - 3]].target();
    const Target next = run.taps[i].target();
    EXPECT_NEAR(std::hypot(next.x - here.x, next.y - here.y), step, 1e-9) << "tap " << i + 1;
  }
  EXPECT_EQ(nearest->taps.count, 5);
  EXPECT_EQ(nearest->taps.initial, 3);
  const std::vector<TapReading>& readings = nearest->taps.readings;
  ASSERT_EQ(readings.size(), 4U) << "the one that met nothing is no contact";
  const int numbers[] = {1, 2, 3, 5};
  for (std::size_t i = 0; i < 4; ++i) {
    const Target target = run.taps[static_cast<std::size_t>(numbers[i]) - 1].target();
    EXPECT_EQ(readings[i].tap, numbers[i]);
    EXPECT_TRUE(readings[i].is_contact);
    EXPECT_EQ(readings[i].position.x(), target.x);
    EXPECT_EQ(readings[i].position.y(), target.y);
  }
  EXPECT_TRUE(readings.front().on_object);
  EXPECT_FALSE(readings[1].on_object);
  EXPECT_EQ(readings.back().position.z(), 0.05);
}

TEST(Experiment, StopsWhenTheRobotHasBeenBusyLongEnough) {
  Finished run("paper/object_i.yaml", {"stop.robot_time=5 s"}, scripted());
  EXPECT_EQ(run.taps.size(), 5U) << "each scripted tap takes a second";
  EXPECT_EQ(run.experiment.result().stop_reason, "robot_time");
}

TEST(Experiment, StopsWhenNoCandidateIsUncertainAnyMore) {
  Finished run("paper/object_i.yaml", {"acquisition=uncertainty", "kernel.length_scale=13 cm", "taps=100",
                                       "stop.max_standard_deviation=10 cm"});
  EXPECT_EQ(run.experiment.result().stop_reason, "max_standard_deviation");
  EXPECT_LE(std::sqrt(run.models().height_variance().maxCoeff()), 0.1);
  EXPECT_GT(number_of(run.taps.back().state, "max_standard_deviation").value(), 0.1)
      << "it stopped as soon as it could";
}

TEST(Experiment, AnInterruptionStopsItAfterTheTapUnderWay) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml");
  std::atomic<bool> interrupted{false};
  Experiment experiment(config.options, {shared_host(), &interrupted});
  Collector collector;
  collector.announcing = [&](const TapRecord& tap) { interrupted = tap.number() == 5; };
  experiment.run(collector);
  EXPECT_EQ(experiment.result().taps, 5);
  EXPECT_TRUE(experiment.result().interrupted);
}

TEST(Experiment, ATapThatWasBrokenOffAndCanBeRepeatedIsNotRecorded) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml");
  for (const bool wished : {true, false}) {
    std::atomic<bool> interrupted{false};
    // Its second tap is broken off, or fails by itself.
    Experiment experiment(config.options,
                          {shared_host(), &interrupted, scripted({contact_at(0.0), failure(Outcome::aborted)})});
    Collector collector;
    collector.announcing = [&](const TapRecord& tap) { interrupted = wished && tap.number() == 2; };
    experiment.run(collector);
    EXPECT_EQ(collector.taps.size(), wished ? 1U : 17U);
    EXPECT_EQ(experiment.counts().taps, wished ? 1 : 17);
    EXPECT_EQ(experiment.counts().failed_taps, wished ? 0 : 1);
    EXPECT_EQ(experiment.result().interrupted, wished);
  }
}

TEST(Experiment, ATapThatIsNotPermittedIsNeitherAnnouncedNorMade) {
  const auto backend = scripted();
  Prepared prepared("paper/object_i.yaml", {}, backend);
  std::vector<int> announced;
  prepared.journal.permitting = [](const TapRecord& tap) { return tap.number() < 3; };
  prepared.journal.announcing = [&](const TapRecord& tap) { announced.push_back(tap.number()); };
  prepared.run();
  EXPECT_EQ(announced, (std::vector<int>{1, 2}));
  ASSERT_EQ(prepared.taps.size(), 2U);
  EXPECT_EQ(prepared.taps.back().number(), 2);
  EXPECT_EQ(backend->requests.size(), 2U);
  EXPECT_TRUE(prepared.experiment.result().interrupted);
}

TEST(Experiment, StrategiesWithEqualSeedsStartAlike) {
  std::vector<std::vector<int>> starts;
  for (const char* acquisition : {"random", "grid", "uncertainty", "weighted"}) {
    const Finished run("paper/object_i.yaml", {std::string("acquisition=") + acquisition, "seed=42"});
    starts.push_back({run.taps[0].candidate, run.taps[1].candidate, run.taps[2].candidate});
  }
  EXPECT_THAT(starts, testing::Each(starts.front()));
}

TEST(Experiment, AResumedOneChoosesWhatTheUnbrokenOneChose) {
  // The search does not find the cube in the corner with these taps: cut anywhere, the last run is cut in its search.
  const std::vector<std::vector<std::string>> cases{
      {"acquisition=random"},
      {"acquisition=grid"},
      {"acquisition=uncertainty"},
      {"acquisition=weighted"},
      {"initial.design=search"},
      {"initial.design=search",
       "scene.objects=[{type: block, length: 2 cm, width: 2 cm, height: 2 cm, at: [2 cm, 2 cm]}]"}};
  for (const std::vector<std::string>& words : cases) {
    std::vector<std::string> overrides = words;
    overrides.emplace_back("seed=3");
    const Finished unbroken("paper/object_i_right.yaml", overrides);
    for (std::size_t cut : {1U, 3U, 9U, 16U}) {
      Prepared rest("paper/object_i_right.yaml", overrides);
      SCOPED_TRACE(words.back());
      expect_resumed(rest, unbroken, cut);
    }
  }
}

TEST(Experiment, GoesOnAfterAHundredHitsAsTheUnbrokenRunWithWhoWasDoubtedBefore) {
  // From there on nobody is judged any more: what was thought of each contact is carried along.
  if (kSanitized) GTEST_SKIP() << "./check --all makes it in release";
  const std::vector<std::string> words{"scene=large_block",
                                       "taps=150",
                                       "seed=4",
                                       "scene.effects=standard",
                                       "belief.height.outlier_probability=0.1",
                                       "acquisition={type: object_uncertainty}"};
  const Finished unbroken("default.yaml", words);
  ASSERT_GT(unbroken.experiment.counts().object_taps, 105);
  const Row last{unbroken.taps.back().state.fields};
  const Scalar* const suspected = last.find("suspected_outliers");
  ASSERT_TRUE(suspected != nullptr && std::holds_alternative<JsonList>(*suspected));
  for (const std::size_t cut : {100U, 149U}) {
    Prepared rest("default.yaml", words);
    expect_resumed(rest, unbroken, cut);
  }
}

TEST(Experiment, SendsWhoeverTapsByHandWhereTheRunWent) {
  Finished whole("paper/object_i.yaml");
  Prepared by_hand("paper/object_i.yaml", {}, no_backend(true));
  for (const TapRecord& made : whole.taps) {
    std::optional<TapRecord> chosen = by_hand.experiment.choose_next();
    ASSERT_TRUE(chosen.has_value());
    EXPECT_EQ(by_hand.experiment.choose_next()->candidate, chosen->candidate) << "it is only asked again";
    chosen->result = made.result;
    chosen->reading = made.reading;
    EXPECT_EQ(to_json_line(tap_row(*chosen)), to_json_line(tap_row(made)));
    by_hand.experiment.take_in(*chosen);
  }
  EXPECT_EQ(*by_hand.experiment.result().errors.rmse, *whole.experiment.result().errors.rmse);
  EXPECT_EQ(by_hand.experiment.result().state.diagnostics, whole.experiment.result().state.diagnostics);
}

TEST(Experiment, TheDeskMayLieAnywhere) {
  Finished low("paper/object_i_right.yaml", {"scene.desk=-30 cm", "seed=3"});
  Finished plain("paper/object_i_right.yaml", {"seed=3"});
  for (std::size_t i = 0; i < low.taps.size(); ++i) EXPECT_EQ(low.taps[i].candidate, plain.taps[i].candidate);
  EXPECT_NEAR(*low.experiment.result().errors.rmse, *plain.experiment.result().errors.rmse, 1e-12);
}

}  // namespace
}  // namespace palpate::test
