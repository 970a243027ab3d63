// SPDX-License-Identifier: MIT
// What passes between the loop and a backend beside plain taps: one that cannot go on, one that shows what is believed.
#include "record/row.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

TapResult stopped(const std::string& reason) { return tap_without_contact(Outcome::aborted, 1.0, reason, true); }

/// A contact that is the last tap of its run.
TapResult last_contact(double height, const std::string& reason = {}) {
  TapResult out = contact_at(height);
  out.reason = reason;
  out.ends_run = true;
  return out;
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
  EXPECT_EQ(prepared.belief().taps().count, 2);
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
  backend->read = {quantity::kHeightMean, quantity::kHeightStd};
  Prepared prepared("paper/object_i.yaml", {"taps=4"}, backend);
  backend->reading = [&](const BeliefView& belief) {
    ++shown;
    ASSERT_EQ(belief.taps().count, shown);
    const TapRequest& last = backend->requests.back();
    ASSERT_EQ(last.number, shown) << "after the tap, before the next one";
    const Target target = last.line.target();
    const int place = prepared.grid().nearest(target.x, target.y, prepared.experiment.scene().area());
    const double deviation = belief.values(quantity::kHeightStd)(place);
    EXPECT_NEAR(belief.values(quantity::kHeightMean)(place), heights[static_cast<std::size_t>(shown) - 1], 1e-6);
    EXPECT_LT(deviation * deviation, 1e-7);
  };
  prepared.run();
  EXPECT_EQ(shown, 4);
}

TEST(ShownBelief, IsTheRecordedOne) {
  const auto backend = scripted();
  Prepared prepared("paper/object_i.yaml", {"taps=4"}, backend);
  std::vector<std::size_t> recorded;
  backend->reading = [&](const BeliefView&) { recorded.push_back(prepared.taps.size()); };
  prepared.run();
  EXPECT_EQ(recorded, (std::vector<std::size_t>{1, 2, 3, 4})) << "whatever showing does, no tap is lost by it";
}

TEST(ShownBelief, ThatNobodyReadsBuildsNoModel) {
  const auto backend = scripted();
  backend->reading = [](const BeliefView& belief) { EXPECT_GT(belief.taps().count, 0); };
  const Finished run("paper/object_i.yaml", {"acquisition=random"}, backend);
  EXPECT_EQ(run.models().gps().height.process, nullptr);
  EXPECT_EQ(run.models().gps().label.process, nullptr);
}

TEST(ShownBelief, ThatIsReadChangesNoTapAndNoNumber) {
  for (const char* acquisition : {"acquisition=random", "acquisition=uncertainty", "acquisition=weighted"}) {
    for (const char* models :
         {"belief.surface=single", "belief.surface=two_part", "belief.label.hyperparameters=shared"}) {
      const std::vector<std::string> words{acquisition, models, "fitting=ceres", "belief.height.signal=5 cm",
                                           "candidates.count=12"};
      const Finished quiet("paper/object_i.yaml", words, four_taps());
      const auto backend = four_taps();
      backend->read = {quantity::kHeightMean, quantity::kHeightStd, quantity::kLabelMean, quantity::kUncertainty};
      backend->reading = [&](const BeliefView& belief) {
        for (const std::string& one : backend->read) EXPECT_TRUE(belief.values(one).allFinite()) << one;
      };
      const Finished read("paper/object_i.yaml", words, backend);
      ASSERT_EQ(read.taps.size(), quiet.taps.size());
      const auto has_gp = [](const Finished& run) {
        return number_of(run.taps[1].state, "height_gp.signal").has_value();
      };
      EXPECT_TRUE(has_gp(read) && !has_gp(quiet)) << "what is read is recorded from then on";
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
  backend.reading = [&](const BeliefView& belief) { shown.push_back(belief.taps().count); };
  failure_of(prepared);
  return shown;
}

TEST(ShownBelief, ComesFirstInARunThatIsCarriedOn) {
  const auto backend = scripted();
  Prepared prepared("paper/object_i.yaml", {"taps=4"}, backend);
  const auto tapped = [](int number, const Target& target, double height) {
    TapRecord out;
    out.request = request_at(target, number);
    out.result = contact_at(height);
    return out;
  };
  prepared.experiment.resume({tapped(1, {0.01, 0.02}, 0.09), tapped(2, {0.05, 0.02}, 0.0)});
  EXPECT_EQ(shown_in(prepared, *backend), (std::vector<int>{2, 3, 4}));
}

TEST(ShownBelief, IsNotShownByABackendThatCannotGoOn) {
  const auto backend = scripted({contact_at(0.0), stopped("the robot is disabled")});
  Prepared prepared("paper/object_i.yaml", {}, backend);
  EXPECT_EQ(shown_in(prepared, *backend), std::vector<int>{1});
}

}  // namespace
}  // namespace palpate::test
