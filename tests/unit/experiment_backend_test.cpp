// SPDX-License-Identifier: MIT
// What passes between the loop and a backend beside plain taps: one that cannot go on, one that shows what is believed.
#include "experiment/experiment.hpp"
#include "record/row.hpp"
#include "record/tap_row.hpp"
#include "support/runs.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using test::Collector;
using test::ScriptedBackend;
using test::shipped_config;

Contact touch(double height) { return {Outcome::contact, height, 8.0, 1.0, {}}; }
Contact stopped(const std::string& reason) { return {Outcome::aborted, 0.0, 0.0, 1.0, reason, true}; }

std::shared_ptr<ScriptedBackend> scripted(std::vector<Contact> answers) {
  return std::make_shared<ScriptedBackend>(std::move(answers));
}

/// The line with which a run of these answers fails; its taps go to `collector`.
std::string failure_of(Experiment& experiment, Collector& collector) {
  try {
    experiment.run(collector);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), Error::Kind::run);
    return error.what();
  }
  return "none";
}

TEST(LastTap, IsRecordedBeforeTheRunFailsWithItsReason) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml");
  const auto backend = scripted({touch(0.0), touch(0.09), stopped("the e-stop is pressed")});
  Experiment experiment(config.options, test::shared_host(), nullptr, backend);
  Collector collector;
  EXPECT_EQ(failure_of(experiment, collector), "backend/simulator: the e-stop is pressed");
  ASSERT_EQ(collector.taps.size(), 3U);
  EXPECT_EQ(collector.taps[2].contact.outcome, Outcome::aborted);
  EXPECT_EQ(collector.taps[2].contact.reason, "the e-stop is pressed");
  EXPECT_EQ(experiment.counts().failed_taps, 1);
  EXPECT_EQ(backend->requests.size(), 3U) << "nothing is asked of it any more";
}

TEST(LastTap, ThatTouchedSomethingCountsAsAContact) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml");
  Contact last = touch(0.09);
  last.reason = "the arm stands in a collision";
  last.ends_run = true;
  Experiment experiment(config.options, test::shared_host(), nullptr, scripted({touch(0.0), last}));
  Collector collector;
  EXPECT_EQ(failure_of(experiment, collector), "backend/simulator: the arm stands in a collision");
  EXPECT_EQ(experiment.counts().on_surface_taps, 1);
  EXPECT_EQ(experiment.belief().taps(), 2);
}

TEST(LastTap, WithoutAReasonOrAHeightIsTheLastAllTheSame) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml");
  Collector collector;
  Experiment silent(config.options, test::shared_host(), nullptr, scripted({stopped("")}));
  EXPECT_EQ(failure_of(silent, collector), "backend/simulator: cannot go on, and gives no reason");
  Contact last = touch(std::nan(""));
  last.ends_run = true;
  Experiment wild(config.options, test::shared_host(), nullptr, scripted({last}));
  EXPECT_EQ(failure_of(wild, collector),
            "backend/simulator: the backend reported a height that is not a finite number");
}

TEST(LastTap, IsAPastTapLikeAnyOtherForARunThatIsCarriedOn) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml");
  Experiment first(config.options, test::shared_host(), nullptr, scripted({touch(0.0), stopped("no messages")}));
  Collector before;
  failure_of(first, before);
  std::vector<PastTap> past;
  for (const TapRecord& tap : before.taps) past.push_back({tap.target, tap.contact, tap.source});
  const auto backend = scripted({});
  Experiment second(config.options, test::shared_host(), nullptr, backend);
  second.resume(past);
  Collector after;
  second.run(after);
  EXPECT_EQ(backend->requests.front().number, 3);
  EXPECT_EQ(after.taps.size(), 15U);
  EXPECT_EQ(second.result().stop_reason, "tap budget");
}

/// The taps of a run whose backend reads with `reading`.
std::vector<TapRecord> taps_shown(const ResolvedConfig& config, Quantities read,
                                  std::function<void(const Belief&)> reading) {
  const auto backend = scripted({touch(0.0), touch(0.09), touch(0.05), touch(0.07)});
  backend->reading = std::move(reading);
  backend->read = read;
  Experiment experiment(config.options, test::shared_host(), nullptr, backend);
  Collector collector;
  experiment.run(collector);
  return collector.taps;
}

TEST(ShownBelief, HasTheTapThatWasJustMade) {
  const std::vector<double> heights{0.0, 0.09, 0.05, 0.07};
  int shown = 0;
  const ResolvedConfig config = shipped_config("paper/object_i.yaml", {"taps=4"});
  const auto backend = scripted({touch(0.0), touch(0.09), touch(0.05), touch(0.07)});
  Experiment experiment(config.options, test::shared_host(), nullptr, backend);
  backend->read = Quantity::height;
  backend->reading = [&](const Belief& belief) {
    ++shown;
    ASSERT_EQ(belief.taps(), shown);
    const TapRequest& last = backend->requests.back();
    ASSERT_EQ(last.number, shown) << "after the tap, before the next one";
    const int place = experiment.candidates().nearest(last.target.x, last.target.y, experiment.scene().area());
    EXPECT_NEAR(belief.height_mean()(place), heights[static_cast<std::size_t>(shown) - 1], 1e-6);
    EXPECT_LT(belief.height_variance()(place), 1e-7);
  };
  Collector collector;
  experiment.run(collector);
  EXPECT_EQ(shown, 4);
}

TEST(ShownBelief, IsTheRecordedOne) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml", {"taps=4"});
  const auto backend = scripted({});
  Collector collector;
  std::vector<std::size_t> recorded;
  backend->reading = [&](const Belief&) { recorded.push_back(collector.taps.size()); };
  Experiment experiment(config.options, test::shared_host(), nullptr, backend);
  experiment.run(collector);
  EXPECT_EQ(recorded, (std::vector<std::size_t>{1, 2, 3, 4})) << "whatever showing does, no tap is lost by it";
}

TEST(ShownBelief, ThatNobodyReadsBuildsNoModel) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml", {"acquisition=random"});
  const auto backend = scripted({});
  backend->reading = [](const Belief& belief) { EXPECT_GT(belief.taps(), 0); };
  Experiment experiment(config.options, test::shared_host(), nullptr, backend);
  Collector collector;
  experiment.run(collector);
  EXPECT_EQ(experiment.belief().height_process().process, nullptr);
  EXPECT_EQ(experiment.belief().weight_process().process, nullptr);
}

TEST(ShownBelief, ThatIsReadChangesNoTapAndNoNumber) {
  for (const char* acquisition : {"acquisition=random", "acquisition=uncertainty", "acquisition=weighted"}) {
    for (const char* models : {"surface=single", "surface=two_part", "weight.hyperparameters=shared"}) {
      const ResolvedConfig config = shipped_config(
          "paper/object_i.yaml", {acquisition, models, "fitting=ceres", "height.signal=5 cm", "candidates.count=12"});
      const std::vector<TapRecord> quiet = taps_shown(config, {}, {});
      const Quantities all = Quantity::height | Quantity::weight | Quantity::uncertainty;
      const std::vector<TapRecord> read = taps_shown(config, all, [](const Belief& belief) {
        EXPECT_TRUE(belief.height_variance().allFinite() && belief.weight().allFinite());
        EXPECT_TRUE(belief.height_mean().allFinite() && belief.uncertainty().allFinite());
      });
      ASSERT_EQ(read.size(), quiet.size());
      EXPECT_TRUE(read[1].height_process && !quiet[1].height_process) << "what is read is recorded from then on";
      for (std::size_t i = 0; i < quiet.size(); ++i) {
        const Row with = tap_row(read[i]);
        for (const auto& [field, value] : tap_row(quiet[i]).fields) {
          if (std::holds_alternative<std::monostate>(value)) continue;
          ASSERT_NE(with.find(field), nullptr) << field;
          EXPECT_EQ(csv_cell(*with.find(field)), csv_cell(value))
              << acquisition << " " << models << " tap " << i + 1 << " " << field;
        }
      }
    }
  }
}

TEST(ShownBelief, ComesFirstInARunThatIsCarriedOn) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml", {"taps=4"});
  const auto backend = scripted({});
  std::vector<int> shown;
  backend->reading = [&](const Belief& belief) { shown.push_back(belief.taps()); };
  Experiment experiment(config.options, test::shared_host(), nullptr, backend);
  experiment.resume({{{0.01, 0.02}, touch(0.09), Source::initial}, {{0.05, 0.02}, touch(0.0), Source::initial}});
  Collector collector;
  experiment.run(collector);
  EXPECT_EQ(shown, (std::vector<int>{2, 3, 4}));
}

TEST(ShownBelief, IsNotShownByABackendThatCannotGoOn) {
  const ResolvedConfig config = shipped_config("paper/object_i.yaml");
  const auto backend = scripted({touch(0.0), stopped("the robot is disabled")});
  std::vector<int> shown;
  backend->reading = [&](const Belief& belief) { shown.push_back(belief.taps()); };
  Experiment experiment(config.options, test::shared_host(), nullptr, backend);
  Collector collector;
  failure_of(experiment, collector);
  EXPECT_EQ(shown, std::vector<int>{1});
}

}  // namespace
}  // namespace palpate
