// SPDX-License-Identifier: MIT
// The loop of taps from any side: what of a backend's answers it takes, what it counts, and against which truth.
#include "experiment/experiment.hpp"
#include "record/run_replay.hpp"
#include "record/surface_files.hpp"
#include "solids/candidate_lines.hpp"
#include "solids/solids_belief.hpp"
#include "support/runs.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

namespace palpate {
namespace {

using test::shared_host;
using test::shipped_config;

/// Reaches everything and answers as the test says.
class Answering final : public Backend {
 public:
  explicit Answering(std::function<TapResult(const TapRequest&)> answer) : answer_(std::move(answer)) {}
  TapResult tap(const TapRequest& request) override { return answer_(request); }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return true; }
  bool taps_any_line() const override { return true; }

 private:
  std::function<TapResult(const TapRequest&)> answer_;
};

/// Creates the belief itself, not behind the checks that a plugin has.
class OwnSolids final : public PluginFactory {
 public:
  std::shared_ptr<void> create(const PluginChoice& choice, const Context& context) const override {
    if (choice.kind != Belief::kKind) return shared_host().create(choice, context);
    SolidsOptions options;
    fill(*choice.options, shared_host(), "belief", [&](Fields& fields) { options.list(fields); });
    return std::shared_ptr<Belief>(std::make_shared<SolidsBelief>(options, context));
  }
};

const PluginFactory& own_solids() {
  static const OwnSolids out;
  return out;
}

struct Touching {
  explicit Touching(const std::vector<std::string>& more, std::function<TapResult(const TapRequest&)> answer = nullptr)
      : config(shipped_config("any_side.yaml", words(more))),
        experiment(config.options,
                   {own_solids(), nullptr, answer ? std::make_shared<Answering>(std::move(answer)) : nullptr}) {}
  static std::vector<std::string> words(std::vector<std::string> more) {
    more.insert(more.begin(), {"scene=object_i", "candidates.count=50", "belief.moves=20", "belief.particles=4"});
    return more;
  }

  /// Returns the errors against the true scene as it stands now.
  Errors errors() {
    experiment.truth();
    return experiment.belief().errors(ErrorsFor::display)->errors;
  }

  ResolvedConfig config;
  Experiment experiment;
  test::Collector journal;
};

TapResult met_nothing(std::optional<double> distance = std::nullopt) {
  TapResult out = tap_without_contact(Outcome::no_contact, 1.0, "nothing there");
  out.distance = distance;
  return out;
}

TEST(FromAnySide, AnArmWhoseToolMeetsNothingIsWellAndOneThatStopsMidwayIsNot) {
  Touching missing({"taps=6", "stop.failed_in_a_row=3"}, [](const TapRequest&) { return met_nothing(); });
  EXPECT_NO_THROW(missing.experiment.run(missing.journal));
  EXPECT_EQ(missing.experiment.counts().no_contact_taps, 6);
  EXPECT_EQ(missing.experiment.counts().failed_taps, 0);

  // Two that fail, one that tells something, and three that fail.
  Touching failing({"taps=9", "stop.failed_in_a_row=3"}, [](const TapRequest& request) {
    return request.number == 3 ? met_nothing() : tap_without_contact(Outcome::timeout, 1.0, "too long");
  });
  EXPECT_THROW(failing.experiment.run(failing.journal), Error);
  EXPECT_EQ(failing.experiment.counts().taps, 6);
  EXPECT_EQ(failing.experiment.counts().no_contact_taps, 1);
  EXPECT_EQ(failing.experiment.counts().failed_taps, 5);
}

TEST(FromAnySide, AnEndThatIsNotOnTheWayOfTheToolIsRefusedAndCounted) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto contact = [](double height, std::optional<double> distance) {
    TapResult out = test::contact_at(height);
    out.distance = distance;
    return out;
  };
  const std::vector<std::pair<TapResult, const char*>> answers{{contact(0.1, std::nullopt), kAlongRefused},
                                                               {contact(0.1, kNan), kAlongRefused},
                                                               {contact(0.1, -1e-6), kAlongRefused},
                                                               {contact(0.1, 1e3), kAlongRefused},
                                                               {met_nothing(kNan), kAlongRefused},
                                                               {contact(kNan, 0.1), kHeightRefused},
                                                               {met_nothing(), "nothing there"},
                                                               {contact(0.1, 0.1), ""},
                                                               {met_nothing(0.1), "nothing there"}};
  Touching run({"taps=" + std::to_string(answers.size())},
               [&](const TapRequest& request) { return answers[static_cast<std::size_t>(request.number - 1)].first; });
  run.experiment.run(run.journal);
  ASSERT_EQ(run.journal.taps.size(), answers.size());
  for (std::size_t i = 0; i < answers.size(); ++i) {
    EXPECT_EQ(run.journal.taps[i].result.reason, answers[i].second) << i;
    const bool refused = i < 6;
    EXPECT_EQ(run.journal.taps[i].result.outcome == Outcome::aborted, refused) << i;
  }
  EXPECT_EQ(run.experiment.counts().state.diagnostics.at("heights_rejected"), 6);
  EXPECT_EQ(run.experiment.counts().failed_taps, 6);
  EXPECT_EQ(run.experiment.counts().no_contact_taps, 2);
}

TEST(FromAnySide, HalfOfTheLinesGoAnywhereHoweverManyTheBackendRejects) {
  const auto half = [](const Candidates& lines, BoolOut accepted) { accepted = lines.directions.col(0).array() > 0.0; };
  for (std::size_t count = 1; count <= 60; ++count) {
    Random random(count, "lines");
    const SampledLines drawn = sample_lines(SearchBall({0.26, 0.26}), 0.0, count, nullptr, random, half);
    EXPECT_EQ(drawn.anywhere.size(), count);
    EXPECT_GT(drawn.lines.directions.col(0).minCoeff(), 0.0);
    EXPECT_EQ(std::count(drawn.anywhere.begin(), drawn.anywhere.end(), true), (static_cast<int>(count) + 1) / 2);
  }
}

TEST(FromAnySide, ALineIsExplainedByTheNumbersThatAcquisitionsRead) {
  using namespace quantity;
  const ResolvedConfig config = shipped_config("any_side.yaml", Touching::words({"taps=8"}));
  Experiment experiment(config.options,
                        {shared_host(), nullptr, nullptr, "",
                         readers_from_first_tap("test", {kExpectedDistance, kSurfaceStd, kIncidenceCosine})});
  test::Collector journal;
  experiment.run(journal);
  experiment.choose_next();
  experiment.look();
  const Belief& belief = experiment.belief();
  int on_object = 0;
  for (Eigen::Index i = 0; i < belief.candidates().size(); ++i) {
    const LineFacts facts = belief.explain(belief.candidates().line(i));
    ASSERT_EQ(facts.particles.size(), 4U);
    const LineFacts::Particle& best = facts.particles.front();
    constexpr double kRounding = 1e-9;  // lines are explained one by one, and read together
    EXPECT_NEAR(best.distance, belief.values(kExpectedDistance)(i), kRounding);
    EXPECT_NEAR(facts.surface_std, belief.values(kSurfaceStd)(i), kRounding);
    EXPECT_NEAR(facts.incidence_cosine, belief.values(kIncidenceCosine)(i), kRounding);
    EXPECT_EQ(best.on_object, belief.values(kIncidenceCosine)(i) > 0.0);
    EXPECT_FALSE(best.solids.empty());
    on_object += best.on_object ? 1 : 0;
  }
  EXPECT_GT(on_object, 5);
  EXPECT_LT(on_object, belief.candidates().size());
}

TEST(FromAnySide, BeforeAnObjectIsKnownThereIsNoSurfaceAndAllOfTheTrueOneIsMissing) {
  Touching run({"taps=3"}, [](const TapRequest&) { return met_nothing(); });
  run.experiment.run(run.journal);
  EXPECT_FALSE(run.experiment.belief().is_ready());
  const Errors errors = run.experiment.result().errors;
  constexpr double kRounding = 1e-12;  // of a mean of thousands of equal numbers
  for (const std::optional<double>& one : {errors.surface_distance, errors.rms_surface_distance, errors.rmse_object})
    EXPECT_NEAR(one.value(), 0.1, kRounding);
  EXPECT_EQ(errors.f_score, 0.0);
  EXPECT_EQ(errors.volume_iou, 0.0);
  EXPECT_EQ(errors.coverage, std::nullopt);
  EXPECT_TRUE(run.experiment.belief().surface(kFineResolution).vertices.empty());
  EXPECT_THAT(surface_file(run.experiment).second,
              testing::AllOf(testing::HasSubstr("element vertex 0\n"), testing::HasSubstr("element face 0\n"),
                             testing::EndsWith("end_header\n")));
}

TEST(FromAnySide, AnObjectAtTheEndOfALongAreaIsLookedForAndCompared) {
  Touching run({"taps=25", "candidates.count=1000", "scene.area={width: 60 cm, depth: 20 cm}",
                "scene.objects=[{type: block, length: 6 cm, width: 6 cm, height: 8 cm, at: [8 cm, 10 cm]}]"});
  run.experiment.look();
  int aimed = 0;
  const Candidates& lines = run.experiment.belief().candidates();
  for (Eigen::Index i = 0; i < lines.size(); ++i)
    aimed += run.experiment.scene().first_intersection(lines.line(i).line()) < kNoHit ? 1 : 0;
  EXPECT_GT(aimed, 0) << "of lines anywhere through the region";
  EXPECT_TRUE(run.errors().surface_distance) << "the true surface is met";
  EXPECT_EQ(run.errors().volume_iou, 0.0) << "of an object that nobody has touched yet";
}

TEST(FromAnySide, OfWhatIsThinnerThanACubeNoVolumesAreCompared) {
  Touching run({"taps=5",
                "scene.objects=[{type: block, length: 6 cm, width: 6 cm, height: 1.5 mm, at: [12 cm, 12 cm]}]",
                "scene.min_object_height=1 mm"});
  EXPECT_TRUE(run.errors().surface_distance) << "the true surface is met";
  EXPECT_EQ(run.errors().volume_iou, std::nullopt);
}

/// The true surface where lines from all sides meet it, and the cubes that are solid; of a desk at height 0.
struct TrueSurface {
  TrueSurface(const Scene& scene, const SearchBall& region)
      : cubes(Cubes(region.centre, region.outside(), 0.004).of(scene)) {
    for (const Line& line : LineBundle(region.centre, region.outside(), 150, 0.006).lines) {
      const double hit = scene.first_intersection(line);
      if (hit < distance_down_to(0.0, line)) cloud.push_back(line.origin + hit * line.direction);
    }
    cloud = thinned(cloud, 0.001);
  }
  Eigen::Vector3d middle() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& point : cloud) sum += point;
    return sum / static_cast<double>(cloud.size());
  }

  Cloud cloud;
  Cubes::Held cubes;
};

/// Returns the errors of what is believed against any scene.
Errors errors_against(const Scene& scene, Belief& belief) {
  belief.set_truth(&scene);
  return belief.errors(ErrorsFor::display)->errors;
}

TEST(FromAnySide, TheTruthIsTheSceneAsItStandsAfterWhatWasPushed) {
  // A push as long as this one is not cut short by the rim of the area.
  Touching run({"taps=9", "scene.effects={push: {after: 4, distance: 3 cm, turn: 0 deg}}"});
  const SearchBall region(run.experiment.scene().area());
  const TrueSurface before(*run.experiment.truth(), region);
  run.experiment.run(run.journal, 4);
  const TrueSurface after(*run.experiment.truth(), region);
  const Eigen::Vector3d moved = after.middle() - before.middle();
  // The lines are 6 mm apart, and where they meet a surface shifts with it by as much at most.
  EXPECT_NEAR(moved.head(2).norm(), 0.03, 0.006);
  EXPECT_NEAR(moved.z(), 0.0, 0.006);
  EXPECT_LT(intersection_over_union(after.cubes, before.cubes), 0.8);
  run.experiment.belief().update();
  const Errors errors = run.errors();
  const Errors of_pushed = errors_against(*run.experiment.truth(), run.experiment.belief());
  ASSERT_TRUE(errors.surface_distance && errors.volume_iou);
  EXPECT_EQ(errors.surface_distance, of_pushed.surface_distance);
  EXPECT_EQ(errors.volume_iou, of_pushed.volume_iou);
  EXPECT_NE(errors.surface_distance, errors_against(run.experiment.scene(), run.experiment.belief()).surface_distance);
  run.experiment.run(run.journal);
  int on = 0;
  for (const TapRecord& tap : run.journal.taps) {
    if (tap.result.outcome != Outcome::contact) continue;
    ASSERT_TRUE(tap.reading) << tap.number();
    EXPECT_EQ(tap.reading->on_object, tap.true_on_object) << tap.number();
    on += tap.reading->on_object ? 1 : 0;
  }
  EXPECT_GT(on, 1);
}

}  // namespace
}  // namespace palpate
