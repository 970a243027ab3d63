// SPDX-License-Identifier: MIT
// A motion for each tap: by what it tells in its time, and by what its taps have shown.
#include "experiment/pace.hpp"

#include "record/tap_row.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <set>

namespace palpate::test {
namespace {

/// Motions whose taps take as long, and err as far, wherever they are made.
class Given final : public Motions {
 public:
  struct One {
    double seconds, deviation;
  };
  explicit Given(std::vector<One> motions) : motions_(std::move(motions)) {}
  int count() const override { return static_cast<int>(motions_.size()); }
  double seconds(const TapRequest& request, double) const override { return of(request.motion).seconds; }
  double deviation(int motion) const override { return of(motion).deviation; }

 private:
  const One& of(int motion) const { return motions_[static_cast<std::size_t>(motion)]; }
  std::vector<One> motions_;
};

/// What is believed of the scene of configs/default.yaml after a hit in its middle and the desk in a corner.
struct Believed {
  Believed()
      : config(shipped_config("default.yaml", {"height.offset=none"})),
        scene(build_scene(config.options.scene, 1, shared_host())),
        context{shared_host(), *scene, 1, nullptr},
        candidates(grid_by_count(scene->area(), 21)),
        belief(config.options, candidates, context, clock) {
    belief.ask(Pace::kReads);
    belief.observe({0.115, 0.115}, contact_at(0.05));
    belief.observe({0.01, 0.01}, contact_at(0.0));
    belief.update();
  }
  int nearest(double x, double y) const { return candidates.nearest(x, y, scene->area()); }
  Pace::Choice choose(const Pace& pace, double x, double y) const {
    return pace.choose(belief, nearest(x, y), candidates.target(nearest(x, y)), std::nullopt);
  }

  ResolvedConfig config;
  std::unique_ptr<const Scene> scene;
  Context context;
  Candidates candidates;
  PhaseClock clock;
  TapBelief belief;
};

Pace pace_of(std::vector<Given::One> motions) { return {std::make_shared<Given>(std::move(motions)), 0.0}; }

PastTap tapped(int motion, Outcome outcome, double seconds, double height = 0.0) {
  PastTap out;
  out.motion = motion;
  out.contact = {outcome, height, 8.0, seconds, {}};
  return out;
}

TEST(Pace, OfEqualMotionsTakesTheQuickerAndOfEquallyQuickOnesTheMorePrecise) {
  const Believed one;
  EXPECT_EQ(one.choose(pace_of({{3.0, 0.001}, {2.0, 0.001}}), 0.05, 0.05).motion, 1);
  EXPECT_EQ(one.choose(pace_of({{2.0, 0.002}, {2.0, 0.001}}), 0.115, 0.115).motion, 1);
  EXPECT_EQ(one.choose(pace_of({{2.0, 0.001}, {2.0, 0.001}}), 0.115, 0.115).motion, 0) << "of equals the first";
}

TEST(Pace, GoesQuicklyWhereItAsksWhetherAndPreciselyWhereItAsksHowHigh) {
  const Believed one;
  const Eigen::VectorXd& p = one.belief.probability();
  const Eigen::VectorXd& v = one.belief.height_variance();
  int edge = 0;
  int inside = one.nearest(0.115, 0.115);
  for (int i = 0; i < one.candidates.size(); ++i) {
    if (std::abs(p(i) - 0.5) < std::abs(p(edge) - 0.5)) edge = i;
    if (p(i) > 0.9 && v(i) > v(inside)) inside = i;
  }
  ASSERT_GT(v(inside), 9e-6);
  ASSERT_NEAR(p(edge), 0.5, 0.15);
  // Of the first motion no height is worth a word.
  const Pace pace = pace_of({{2.0, 1.0}, {3.0, 0.001}});
  EXPECT_EQ(pace.choose(one.belief, inside, one.candidates.target(inside), std::nullopt).motion, 1);
  const double bits = 0.5 * std::log2(1.0 + v(edge) / 1e-6);
  const Pace at_edge = pace_of({{2.0, 1.0}, {2.0 * (1.0 + p(edge) * bits) + 0.1, 0.001}});
  EXPECT_EQ(at_edge.choose(one.belief, edge, one.candidates.target(edge), std::nullopt).motion, 0)
      << "there the height would have to be had for less";
}

TEST(Pace, LearnsWhichMotionComesToNothingHowLongItTakesAndHowFarItErrs) {
  const Believed one;
  Pace failing = pace_of({{2.0, 0.001}, {2.2, 0.001}});
  EXPECT_EQ(one.choose(failing, 0.05, 0.05).motion, 0);
  for (int i = 0; i < 3; ++i) failing.observe(tapped(0, Outcome::aborted, 2.0), std::nullopt);
  EXPECT_EQ(one.choose(failing, 0.05, 0.05).motion, 1);

  Pace late = pace_of({{2.0, 0.001}, {2.2, 0.001}});
  for (int i = 0; i < 5; ++i) late.observe(tapped(0, Outcome::contact, 4.0), std::nullopt);
  EXPECT_EQ(one.choose(late, 0.05, 0.05).motion, 1);
  EXPECT_NEAR(one.choose(late, 0.05, 0.05).seconds, 2.2, 1e-12);
  for (int i = 0; i < 5; ++i) late.observe(tapped(1, Outcome::contact, 6.2), std::nullopt);
  EXPECT_NEAR(one.choose(late, 0.05, 0.05).seconds, 3.0, 1e-12) << "half of what it was late: ten taps in all";

  Pace rough = pace_of({{2.0, 0.001}, {2.0, 0.001}});
  std::vector<Touch> touches(15, {{0.1, 0.1}, 0.008, false});
  std::vector<int> motions(15, 1);
  rough.see_desk(touches, motions);
  EXPECT_EQ(rough.roughness(0), 0.0);
  EXPECT_NEAR(rough.roughness(1), std::sqrt(0.75 * (0.008 * 0.008 - 0.001 * 0.001)), 1e-12) << "15 taps and 5";
  for (const bool on : {false, true}) {
    touches.push_back({{0.1, 0.1}, on ? 0.009 : 0.5, on});
    motions.push_back(0);
    rough.see_desk(touches, motions);
    EXPECT_EQ(rough.roughness(0), 0.0) << "neither half a metre above the desk is it, nor an object";
  }
}

TEST(Pace, RefusesATapOfAMotionThatThereIsNot) {
  Pace pace = pace_of({{2.0, 0.001}, {2.0, 0.001}});
  for (const int motion : {-1, 2}) {
    EXPECT_THAT(error_of([&] { pace.observe(tapped(motion, Outcome::contact, 2.0), std::nullopt); }),
                testing::HasSubstr("a recorded tap was made by motion"));
  }
}

TEST(Pace, ARunRecordsByWhichMotionEachTapWasMadeAndGoesOnAsItWouldHave) {
  const std::vector<std::string> words{"scene=cone", "scene.effects=standard", "taps=24", "seed=1"};
  Finished whole("default.yaml", words);
  std::set<int> motions;
  double expected = 0.0;
  double taken = 0.0;
  for (const TapRecord& tap : whole.taps) {
    motions.insert(tap.motion);
    expected += tap.expected_seconds.value();
    taken += tap.contact.seconds;
  }
  EXPECT_EQ(motions, (std::set<int>{0, 1}));
  EXPECT_NEAR(expected, taken, 0.25 * taken);
  for (const std::size_t cut : {3U, 15U}) {
    Prepared rest("default.yaml", words);
    rest.experiment.resume(whole.past(cut));
    rest.run();
    ASSERT_EQ(rest.taps.size(), whole.taps.size() - cut);
    for (std::size_t i = 0; i < rest.taps.size(); ++i) {
      EXPECT_EQ(rest.taps[i].candidate, whole.taps[cut + i].candidate);
      EXPECT_EQ(rest.taps[i].motion, whole.taps[cut + i].motion);
      EXPECT_EQ(rest.taps[i].expected_seconds, whole.taps[cut + i].expected_seconds);
      EXPECT_EQ(rest.taps[i].contact.height, whole.taps[cut + i].contact.height);
    }
  }
}

TEST(Pace, ABackendWithOneMotionIsAskedForNoOtherAndItsRecordTellsOfNone) {
  Finished one("default.yaml", {"motion=gentle", "taps=8"});
  for (const TapRecord& tap : one.taps) {
    EXPECT_EQ(tap.motion, 0);
    EXPECT_FALSE(tap.expected_seconds);
    EXPECT_EQ(tap_row(tap).find("motion"), nullptr);
  }
}

TEST(Chooser, ASearchLooksAgainWhereATapWasBrokenOff) {
  // The first tap of the search comes to nothing: nobody has looked there, so the next goes beside it.
  const auto second = [](Contact first) {
    Prepared run("default.yaml", {"motion=gentle", "taps=2"}, scripted({std::move(first)}));
    run.run();
    return std::hypot(run.taps[1].target.x - run.taps[0].target.x, run.taps[1].target.y - run.taps[0].target.y);
  };
  EXPECT_LT(second({Outcome::aborted, 0.0, 0.0, 1.0, "stopped"}), 0.02);
  EXPECT_GT(second(contact_at(0.0)), 0.03);
  EXPECT_GT(second({Outcome::unreachable, 0.0, 0.0, 0.0, "too far"}), 0.03);
}

}  // namespace
}  // namespace palpate::test
