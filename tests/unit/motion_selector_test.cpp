// SPDX-License-Identifier: MIT
// A motion for each tap: by what it tells in its time, and by what its taps have shown.
#include "experiment/motion_selector.hpp"

#include "support/mocks.hpp"
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

/// The belief about the scene of configs/default.yaml after a hit in its middle and the desk in a corner.
struct Believed {
  Believed()
      : config(shipped_config("default.yaml", {"belief.height.offset=none", "candidates.count=21"})),
        scene(build_scene(config.options.scene, 1, shared_host())),
        context(belief_context(config, *scene)),
        belief(height_map_options(config.options, shared_host()), context) {
    belief.plan(Prepared::readers(MotionSelector::reads()));
    belief.begin(Stage::first_tap);
    belief.add(request_at({0.115, 0.115}, 1), contact_at(0.05));
    belief.add(request_at({0.01, 0.01}, 2), contact_at(0.0));
    belief.update();
    belief.infer();
  }
  int nearest(double x, double y) const { return grid_of(belief.candidates()).nearest(x, y, scene->area()); }
  TapRecord choose(const MotionSelector& motions, int candidate) const {
    TapRecord out;
    out.candidate = candidate;
    out.request.line = belief.candidates().line(candidate);
    motions.choose(belief, out);
    return out;
  }
  TapRecord choose(const MotionSelector& motions, double x, double y) const { return choose(motions, nearest(x, y)); }

  ResolvedConfig config;
  std::unique_ptr<const Scene> scene;
  Context context;
  HeightMapBelief belief;
};

/// A belief that has nothing but the readings that a test writes down.
class WrittenReadings final : public Belief {
 public:
  TapsSoFar written;

  const TapsSoFar& taps() const override { return written; }
  const Candidates& candidates() const override { return nothing_.lines; }
  const Eigen::VectorXd& values(std::string_view quantity) const override { return nothing_.values(quantity); }
  std::optional<double> scalar(std::string_view) const override { return std::nullopt; }
  const HypothesisSample& hypotheses() const override { return nothing_.sample; }
  std::vector<Quantity> offers() const override { return {}; }
  std::vector<PlannedModel> plan(const ReadPlan&) override { return {}; }
  void begin(Stage) override {}
  std::optional<TapReading> read(const TapRequest&, const TapResult&) const override { return std::nullopt; }
  void add(const TapRequest&, const TapResult&) override {}
  void update() override {}
  void infer() override {}
  QuantitySet available() const override { return {}; }
  BeliefState state(std::optional<Eigen::Index>) const override { return {}; }
  void set_truth(const Scene*) override {}
  std::optional<BeliefErrors> errors(ErrorsFor) override { return std::nullopt; }
  palpate::Surface surface(double) override { return {}; }

 private:
  WrittenBelief nothing_;
};

MotionSelector motions_of(std::vector<Given::One> motions) {
  return {std::make_shared<Given>(std::move(motions)), 0.0};
}

TapRecord tapped(int motion, Outcome outcome, double seconds) {
  TapRecord out;
  out.request.motion = motion;
  out.result = outcome == Outcome::contact ? contact_at(0.0) : tap_without_contact(outcome, seconds);
  out.result.seconds = seconds;
  return out;
}

TEST(MotionSelector, OfEqualMotionsTakesTheQuickerAndOfEquallyQuickOnesTheMorePrecise) {
  const Believed one;
  EXPECT_EQ(one.choose(motions_of({{3.0, 0.001}, {2.0, 0.001}}), 0.05, 0.05).request.motion, 1);
  EXPECT_EQ(one.choose(motions_of({{2.0, 0.002}, {2.0, 0.001}}), 0.115, 0.115).request.motion, 1);
  EXPECT_EQ(one.choose(motions_of({{2.0, 0.001}, {2.0, 0.001}}), 0.115, 0.115).request.motion, 0)
      << "of equals the first";
}

TEST(MotionSelector, GoesQuicklyWhereItAsksWhetherAndPreciselyWhereItAsksHowHigh) {
  const Believed one;
  const Eigen::VectorXd& p = one.belief.models().probability();
  const Eigen::VectorXd& v = one.belief.models().height_variance();
  int edge = 0;
  int inside = one.nearest(0.115, 0.115);
  for (int i = 0; i < one.belief.candidates().size(); ++i) {
    if (std::abs(p(i) - 0.5) < std::abs(p(edge) - 0.5)) edge = i;
    if (p(i) > 0.9 && v(i) > v(inside)) inside = i;
  }
  ASSERT_GT(v(inside), 9e-6);
  ASSERT_NEAR(p(edge), 0.5, 0.15);
  // Of the first motion no height is worth a word.
  EXPECT_EQ(one.choose(motions_of({{2.0, 1.0}, {3.0, 0.001}}), inside).request.motion, 1);
  const double bits = 0.5 * std::log2(1.0 + v(edge) / 1e-6);
  const MotionSelector at_edge = motions_of({{2.0, 1.0}, {2.0 * (1.0 + p(edge) * bits) + 0.1, 0.001}});
  EXPECT_EQ(one.choose(at_edge, edge).request.motion, 0) << "there the height would have to be had for less";
}

TEST(MotionSelector, LearnsWhichMotionComesToNothingHowLongItTakesAndHowFarItErrs) {
  const Believed one;
  WrittenReadings unread;
  MotionSelector failing = motions_of({{2.0, 0.001}, {2.2, 0.001}});
  EXPECT_EQ(one.choose(failing, 0.05, 0.05).request.motion, 0);
  for (int i = 0; i < 3; ++i) failing.take_in(tapped(0, Outcome::aborted, 2.0), unread);
  EXPECT_EQ(one.choose(failing, 0.05, 0.05).request.motion, 1);

  MotionSelector late = motions_of({{2.0, 0.001}, {2.2, 0.001}});
  for (int i = 0; i < 5; ++i) late.take_in(tapped(0, Outcome::contact, 4.0), unread);
  EXPECT_EQ(one.choose(late, 0.05, 0.05).request.motion, 1);
  EXPECT_NEAR(one.choose(late, 0.05, 0.05).expected_seconds.value(), 2.2, 1e-12);
  for (int i = 0; i < 5; ++i) late.take_in(tapped(1, Outcome::contact, 6.2), unread);
  EXPECT_NEAR(one.choose(late, 0.05, 0.05).expected_seconds.value(), 3.0, 1e-12)
      << "half of what it was late: ten taps in all";

  MotionSelector rough = motions_of({{2.0, 0.001}, {2.0, 0.001}});
  WrittenReadings read;
  const auto tap = [&](int motion, double height, bool on_object) {
    TapReading& reading = read.written.readings.emplace_back();
    reading.tap = static_cast<int>(read.written.readings.size());
    reading.position = {0.1, 0.1, height};
    reading.on_object = on_object;
    rough.take_in(tapped(motion, Outcome::contact, 2.0), read);
  };
  for (int i = 0; i < 15; ++i) tap(1, 0.008, false);
  EXPECT_EQ(rough.height_noise(0), 0.0);
  EXPECT_NEAR(rough.height_noise(1), std::sqrt(0.75 * (0.008 * 0.008 - 0.001 * 0.001)), 1e-12) << "15 taps and 5";
  for (const bool on : {false, true}) {
    tap(0, on ? 0.009 : 0.5, on);
    EXPECT_EQ(rough.height_noise(0), 0.0) << "neither half a metre above the desk is it, nor an object";
  }
}

TEST(MotionSelector, RefusesATapOfAMotionThatThereIsNot) {
  MotionSelector motions = motions_of({{2.0, 0.001}, {2.0, 0.001}});
  const WrittenReadings unread;
  for (const int motion : {-1, 2}) {
    EXPECT_THAT(error_of([&] { motions.take_in(tapped(motion, Outcome::contact, 2.0), unread); }),
                testing::HasSubstr("a recorded tap was made by motion"));
  }
}

TEST(MotionSelector, ARunRecordsByWhichMotionEachTapWasMadeAndGoesOnAsItWouldHave) {
  const std::vector<std::string> words{"scene=cone", "scene.effects=standard", "taps=24", "seed=1"};
  Finished whole("default.yaml", words);
  std::set<int> motions;
  double expected = 0.0;
  double taken = 0.0;
  for (const TapRecord& tap : whole.taps) {
    motions.insert(tap.request.motion);
    expected += tap.expected_seconds.value();
    taken += tap.result.seconds;
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
      EXPECT_EQ(rest.taps[i].request.motion, whole.taps[cut + i].request.motion);
      EXPECT_EQ(rest.taps[i].expected_seconds, whole.taps[cut + i].expected_seconds);
      EXPECT_EQ(rest.taps[i].result.height(), whole.taps[cut + i].result.height());
    }
  }
}

TEST(MotionSelector, ABackendWithOneMotionIsAskedForNoOtherAndItsRecordTellsOfNone) {
  Finished one("default.yaml", {"motion=gentle", "taps=8"});
  for (const TapRecord& tap : one.taps) {
    EXPECT_EQ(tap.request.motion, 0);
    EXPECT_FALSE(tap.expected_seconds);
    EXPECT_EQ(tap_row(tap).find("motion"), nullptr);
  }
}

TEST(TapSelector, ASearchLooksAgainWhereATapWasBrokenOff) {
  // The first tap of the search comes to nothing: nobody has looked there, so the next goes beside it.
  const auto second = [](TapResult first) {
    Prepared run("default.yaml", {"motion=gentle", "taps=2"}, scripted({std::move(first)}));
    run.run();
    const Target a = run.taps[0].target(), b = run.taps[1].target();
    return std::hypot(b.x - a.x, b.y - a.y);
  };
  EXPECT_LT(second(tap_without_contact(Outcome::aborted, 1.0, "stopped")), 0.02);
  EXPECT_GT(second(contact_at(0.0)), 0.03);
  EXPECT_GT(second(tap_without_contact(Outcome::unreachable, 0.0, "too far")), 0.03);
}

}  // namespace
}  // namespace palpate::test
