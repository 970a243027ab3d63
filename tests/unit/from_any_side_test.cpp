// SPDX-License-Identifier: MIT
// The loop of taps from any side: what of a backend's answers it takes, what it counts, and against which truth.
#include "space/from_any_side.hpp"
#include "support/runs.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  explicit Answering(std::function<Contact(const TapRequest&)> answer) : answer_(std::move(answer)) {}
  Contact tap(const TapRequest& request) override { return answer_(request); }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return true; }
  bool reaches(const Approach&) const override { return true; }

 private:
  std::function<Contact(const TapRequest&)> answer_;
};

struct Touching {
  explicit Touching(const std::vector<std::string>& more, std::function<Contact(const TapRequest&)> answer = nullptr)
      : config(shipped_config("any_side.yaml", words(more))),
        experiment(config.options, shared_host(), nullptr,
                   answer ? std::make_shared<Answering>(std::move(answer)) : nullptr) {}
  static std::vector<std::string> words(std::vector<std::string> more) {
    more.insert(more.begin(),
                {"scene=object_i", "scene.touch=any", "space.approaches=50", "space.moves=20", "space.particles=4"});
    return more;
  }

  ResolvedConfig config;
  FromAnySide experiment;
  test::Collector journal;
};

Contact met_nothing(std::optional<double> along = std::nullopt) {
  Contact out{Outcome::no_contact, 0.0, 0.0, 1.0, "nothing there"};
  out.along = along;
  return out;
}

TEST(FromAnySide, AnArmWhoseToolMeetsNothingIsWellAndOneThatStopsMidwayIsNot) {
  Touching missing({"taps=6", "stop.failed_in_a_row=3"}, [](const TapRequest&) { return met_nothing(); });
  EXPECT_NO_THROW(missing.experiment.run(missing.journal));
  EXPECT_EQ(missing.experiment.counts().no_contact_taps, 6);
  EXPECT_EQ(missing.experiment.counts().failed_taps, 0);

  // Two that fail, one that tells something, and three that fail.
  Touching failing({"taps=9", "stop.failed_in_a_row=3"}, [](const TapRequest& request) {
    return request.number == 3 ? met_nothing() : Contact{Outcome::timeout, 0.0, 0.0, 1.0, "too long"};
  });
  EXPECT_THROW(failing.experiment.run(failing.journal), Error);
  EXPECT_EQ(failing.experiment.counts().taps, 6);
  EXPECT_EQ(failing.experiment.counts().no_contact_taps, 1);
  EXPECT_EQ(failing.experiment.counts().failed_taps, 5);
}

TEST(FromAnySide, AnEndThatIsNotOnTheWayOfTheToolIsRefusedAndCounted) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const auto contact = [](double height, std::optional<double> along) {
    Contact out{Outcome::contact, height, 8.0, 1.0, {}};
    out.along = along;
    return out;
  };
  const std::vector<std::pair<Contact, const char*>> answers{{contact(0.1, std::nullopt), kAlongRefused},
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
    EXPECT_EQ(run.journal.taps[i].contact.reason, answers[i].second) << i;
    const bool refused = i < 6;
    EXPECT_EQ(run.journal.taps[i].contact.outcome == Outcome::aborted, refused) << i;
  }
  EXPECT_EQ(run.experiment.counts().diagnostics.at("heights_rejected"), 6);
  EXPECT_EQ(run.experiment.counts().failed_taps, 6);
  EXPECT_EQ(run.experiment.counts().no_contact_taps, 2);
}

TEST(FromAnySide, BeforeAnObjectIsKnownThereIsNoSurfaceAndAllOfTheTrueOneIsMissing) {
  Touching run({"taps=3"}, [](const TapRequest&) { return met_nothing(); });
  run.experiment.run(run.journal);
  EXPECT_FALSE(run.experiment.knows_object());
  const Errors errors = run.experiment.result().errors;
  constexpr double kRounding = 1e-12;  // of a mean of thousands of equal numbers
  for (const std::optional<double>& one : {errors.surface_distance, errors.rms_surface_distance, errors.rmse_object})
    EXPECT_NEAR(one.value(), 0.1, kRounding);
  EXPECT_EQ(errors.f_score, 0.0);
  EXPECT_EQ(errors.volume_iou, 0.0);
  EXPECT_EQ(errors.coverage, std::nullopt);
  EXPECT_TRUE(run.experiment.crossings(kFineSide).vertices.empty());
  EXPECT_THAT(run.experiment.surface_ply(),
              testing::AllOf(testing::HasSubstr("element vertex 0\n"), testing::HasSubstr("element face 0\n"),
                             testing::EndsWith("end_header\n")));
}

TEST(FromAnySide, AnObjectAtTheEndOfALongAreaIsLookedForAndCompared) {
  Touching run({"taps=25", "space.approaches=1000", "scene.area={width: 60 cm, depth: 20 cm}",
                "scene.objects=[{type: block, length: 6 cm, width: 6 cm, height: 8 cm, at: [8 cm, 10 cm]}]"});
  int aimed = 0;
  for (const Approach& approach : run.experiment.belief().approaches()) {
    aimed += run.experiment.scene().first_intersection(approach.line) < kNoHit ? 1 : 0;
  }
  EXPECT_GT(aimed, 0) << "of lines anywhere through the region";
  EXPECT_FALSE(run.experiment.truth().cloud.empty());
  EXPECT_EQ(run.experiment.errors().volume_iou, 0.0) << "of an object that nobody has touched yet";
}

TEST(FromAnySide, OfWhatIsThinnerThanACubeNoVolumesAreCompared) {
  Touching run({"taps=5",
                "scene.objects=[{type: block, length: 6 cm, width: 6 cm, height: 1.5 mm, at: [12 cm, 12 cm]}]",
                "scene.min_object_height=1 mm"});
  EXPECT_FALSE(run.experiment.truth().cloud.empty());
  EXPECT_EQ(run.experiment.errors().volume_iou, std::nullopt);
}

Eigen::Vector3d middle_of(const Cloud& cloud) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : cloud) sum += point;
  return sum / static_cast<double>(cloud.size());
}

TEST(FromAnySide, TheTruthIsTheSceneAsItStandsAfterWhatWasPushed) {
  // A push as long as this one is not cut short by the rim of the area.
  Touching run({"taps=9", "scene.effects={push: {after: 4, distance: 3 cm, turn: 0 deg}}"});
  const FromAnySide::TrueSurface before = run.experiment.truth();
  run.experiment.run(run.journal, 4);
  const Eigen::Vector3d moved = middle_of(run.experiment.truth().cloud) - middle_of(before.cloud);
  // The lines are 6 mm apart, and where they meet a surface shifts with it by as much at most.
  EXPECT_NEAR(moved.head(2).norm(), 0.03, 0.006);
  EXPECT_NEAR(moved.z(), 0.0, 0.006);
  EXPECT_LT(intersection_over_union(run.experiment.truth().cubes, before.cubes), 0.8);
  run.experiment.run(run.journal);
  int on = 0;
  for (const TapRecord& tap : run.journal.taps) {
    if (tap.contact.outcome != Outcome::contact) continue;
    EXPECT_EQ(tap.on_object, tap.true_on_object) << tap.number;
    on += *tap.on_object ? 1 : 0;
  }
  EXPECT_GT(on, 1);
}

}  // namespace
}  // namespace palpate
