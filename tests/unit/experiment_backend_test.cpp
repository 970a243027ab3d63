// SPDX-License-Identifier: MIT
// What passes between the loop and a backend beside plain taps: one that cannot go on, one that shows what is believed.
#include "record/row.hpp"
#include "record/tap_row.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

Contact stopped(const std::string& reason) { return {Outcome::aborted, 0.0, 0.0, 1.0, reason, true}; }

/// A contact that is the last tap of its run.
Contact last_contact(double height, const std::string& reason = {}) {
  return {Outcome::contact, height, 8.0, 1.0, reason, true};
}

/// The line with which a run fails.
std::string failure_of(Prepared& prepared) {
  return error_of([&] { prepared.run(); }, Error::Kind::run);
}

TEST(LastTap, ThatTouchedSomethingCountsAsAContact) {
  const std::string reason = "the arm stands in a collision";
  Prepared prepared("paper/object_i.yaml", {}, scripted({contact_at(0.0), last_contact(0.09, reason)}));
  EXPECT_EQ(failure_of(prepared), "backend/simulator: " + reason);
  EXPECT_EQ(prepared.experiment.counts().object_taps, 1);
  EXPECT_EQ(prepared.experiment.belief().taps(), 2);
}

TEST(LastTap, WithoutAReasonOrAHeightIsTheLastAllTheSame) {
  Prepared silent("paper/object_i.yaml", {}, scripted({stopped("")}));
  EXPECT_EQ(failure_of(silent), "backend/simulator: cannot continue and gives no reason");
  Prepared wild("paper/object_i.yaml", {}, scripted({last_contact(std::nan(""))}));
  EXPECT_EQ(failure_of(wild), "backend/simulator: the backend reported a height that is not a finite number");
}

/// Four taps that meet the desk once.
std::shared_ptr<ScriptedBackend> four_taps() {
  return scripted({contact_at(0.0), contact_at(0.09), contact_at(0.05), contact_at(0.07)});
}

TEST(ShownBelief, HasTheTapThatWasJustMade) {
  const std::vector<double> heights{0.0, 0.09, 0.05, 0.07};
  int shown = 0;
  const auto backend = four_taps();
  backend->read = Quantity::height;
  Prepared prepared("paper/object_i.yaml", {"taps=4"}, backend);
  const FromAbove& experiment = prepared.experiment;
  backend->reading = [&](const Belief& belief) {
    ++shown;
    ASSERT_EQ(belief.taps(), shown);
    const TapRequest& last = backend->requests.back();
    ASSERT_EQ(last.number, shown) << "after the tap, before the next one";
    const int place = experiment.candidates().nearest(last.target.x, last.target.y, experiment.scene().area());
    EXPECT_NEAR(belief.height_mean()(place), heights[static_cast<std::size_t>(shown) - 1], 1e-6);
    EXPECT_LT(belief.height_variance()(place), 1e-7);
  };
  prepared.run();
  EXPECT_EQ(shown, 4);
}

TEST(ShownBelief, IsTheRecordedOne) {
  const auto backend = scripted();
  Prepared prepared("paper/object_i.yaml", {"taps=4"}, backend);
  std::vector<std::size_t> recorded;
  backend->reading = [&](const Belief&) { recorded.push_back(prepared.taps.size()); };
  prepared.run();
  EXPECT_EQ(recorded, (std::vector<std::size_t>{1, 2, 3, 4})) << "whatever showing does, no tap is lost by it";
}

TEST(ShownBelief, ThatNobodyReadsBuildsNoModel) {
  const auto backend = scripted();
  backend->reading = [](const Belief& belief) { EXPECT_GT(belief.taps(), 0); };
  const Finished run("paper/object_i.yaml", {"acquisition=random"}, backend);
  EXPECT_EQ(run.experiment.belief().height_gp().process, nullptr);
  EXPECT_EQ(run.experiment.belief().label_gp().process, nullptr);
}

TEST(ShownBelief, ThatIsReadChangesNoTapAndNoNumber) {
  for (const char* acquisition : {"acquisition=random", "acquisition=uncertainty", "acquisition=weighted"}) {
    for (const char* models : {"surface=single", "surface=two_part", "label.hyperparameters=shared"}) {
      const std::vector<std::string> words{acquisition, models, "fitting=ceres", "height.signal=5 cm",
                                           "candidates.count=12"};
      const Finished quiet("paper/object_i.yaml", words, four_taps());
      const auto backend = four_taps();
      backend->read = Quantity::height | Quantity::weight | Quantity::uncertainty;
      backend->reading = [](const Belief& belief) {
        EXPECT_TRUE(belief.height_variance().allFinite() && belief.weight().allFinite());
        EXPECT_TRUE(belief.height_mean().allFinite() && belief.uncertainty().allFinite());
      };
      const Finished read("paper/object_i.yaml", words, backend);
      ASSERT_EQ(read.taps.size(), quiet.taps.size());
      EXPECT_TRUE(read.taps[1].height_gp && !quiet.taps[1].height_gp) << "what is read is recorded from then on";
      for (std::size_t i = 0; i < quiet.taps.size(); ++i) {
        const Row with = tap_row(read.taps[i]);
        for (const auto& [field, value] : tap_row(quiet.taps[i]).fields) {
          if (std::holds_alternative<std::monostate>(value)) continue;
          ASSERT_NE(with.find(field), nullptr) << field;
          EXPECT_EQ(csv_cell(*with.find(field)), csv_cell(value))
              << acquisition << " " << models << " tap " << i + 1 << " " << field;
        }
      }
    }
  }
}

/// How many taps the belief had whenever it was shown.
std::vector<int> shown_in(Prepared& prepared, ScriptedBackend& backend) {
  std::vector<int> shown;
  backend.reading = [&](const Belief& belief) { shown.push_back(belief.taps()); };
  failure_of(prepared);
  return shown;
}

TEST(ShownBelief, ComesFirstInARunThatIsCarriedOn) {
  const auto backend = scripted();
  Prepared prepared("paper/object_i.yaml", {"taps=4"}, backend);
  prepared.experiment.resume(
      {{{0.01, 0.02}, contact_at(0.09), Source::initial}, {{0.05, 0.02}, contact_at(0.0), Source::initial}});
  EXPECT_EQ(shown_in(prepared, *backend), (std::vector<int>{2, 3, 4}));
}

TEST(ShownBelief, IsNotShownByABackendThatCannotGoOn) {
  const auto backend = scripted({contact_at(0.0), stopped("the robot is disabled")});
  Prepared prepared("paper/object_i.yaml", {}, backend);
  EXPECT_EQ(shown_in(prepared, *backend), std::vector<int>{1});
}

}  // namespace
}  // namespace palpate::test
