// SPDX-License-Identifier: MIT
// Whether a contact was with an object is read again when more is known of what the arm adds to all heights.
#include "belief/height_map.hpp"
#include "support/grids.hpp"

#include "record/json.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <algorithm>

namespace palpate::test {
namespace {

/// The models of the default, of heights to which nothing or something is added.
struct Reader {
  explicit Reader(const std::vector<std::string>& words = {})
      : config(shipped_config("default.yaml", words)),
        scene(build_scene(config.options.scene, 1, shared_host())),
        context(belief_context(config, *scene)),
        candidates(grid_by_count(scene->area(), 21)),
        models(height_map_options(config.options, shared_host()), candidates, context) {}

  /// Has models of these quantities built, and brings their arrays up to date.
  void build(const QuantitySet& quantities) {
    models.build(models.models_of(quantities));
    update();
  }
  void tap(const Target& place, double height) {
    models.add(request_at(place, models.log().taps() + 1), contact_at(height));
  }
  void update() {
    models.update();
    models.infer();
  }

  ResolvedConfig config;
  std::unique_ptr<const Scene> scene;
  Context context;
  CandidateGrid candidates;
  HeightModels models;
};

/// Six taps on a plate of 1.4 cm, then three beside it.
const std::vector<Touch>& taps_of_a_plate() {
  static const std::vector<Touch> taps{
      {{0.10, 0.10}, 0.014, true}, {{0.13, 0.10}, 0.014, true}, {{0.10, 0.13}, 0.014, true},
      {{0.13, 0.13}, 0.014, true}, {{0.10, 0.07}, 0.014, true}, {{0.07, 0.10}, 0.014, true},
      {{0.01, 0.01}, 0.0, false},  {{0.01, 0.22}, 0.0, false},  {{0.22, 0.01}, 0.0, false}};
  return taps;
}

const QuantitySet kAll{quantity::kHeightMean, quantity::kHeightStd, quantity::kObjectProbability, quantity::kLabelMean,
                       quantity::kUncertainty};

TEST(ReadAgain, APlateTakenForTheDeskIsKnownAsAnObjectOnceTheDeskWasTouched) {
  Reader one;
  one.build(kAll);
  std::vector<std::size_t> hits;
  for (const Touch& tap : taps_of_a_plate()) {
    one.tap(tap.place, tap.height);
    one.update();
    hits.push_back(one.models.log().object_contacts().size());
  }
  EXPECT_THAT(hits, testing::ElementsAre(0, 0, 0, 0, 0, 0, 0, 6, 6));
  const ContactLog& log = one.models.log();
  const auto first =
      std::find_if(log.contacts().begin(), log.contacts().end(), [](const Touch& tap) { return tap.on; });
  EXPECT_EQ(log.tap_numbers().at(static_cast<std::size_t>(first - log.contacts().begin())), 1);
  const int middle = one.candidates.nearest(0.115, 0.115, one.scene->area());
  EXPECT_GT(one.models.probability()(middle), 0.95);
  EXPECT_NEAR(one.models.height_mean()(middle), 0.014, 0.002);
}

TEST(ReadAgain, TheModelsAreThoseOfLabelsThatWereReadSoAtOnce) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{},
        {"belief.footprint=gp_regression"},
        {"belief.height.outlier_probability=none", "fitting=ceres", "belief.surface=single"}}) {
    Reader late(words);
    Reader soon(words);
    soon.build(kAll);
    for (const Touch& tap : taps_of_a_plate()) {
      for (Reader* reader : {&late, &soon}) reader->tap(tap.place, tap.height);
      soon.update();
    }
    late.build(kAll);
    EXPECT_EQ(soon.models.probability(), late.models.probability());
    EXPECT_EQ(soon.models.label_map().weight(), late.models.label_map().weight());
    if (const auto& surface = soon.models.surface(); surface && surface->outliers() != nullptr) {
      EXPECT_EQ(surface->outliers()->probabilities(), late.models.surface()->outliers()->probabilities());
    }
    if (words.size() < 3) {  // of a fit the heights, whose process is not made anew, remember what they were then
      EXPECT_LT((soon.models.height_mean() - late.models.height_mean()).cwiseAbs().maxCoeff(), 1e-12);
      EXPECT_LT((soon.models.height_variance() - late.models.height_variance()).cwiseAbs().maxCoeff(), 1e-12);
    }
  }
}

/// Contacts that read otherwise at the end than when they were made.
int flips(const Finished& run) {
  int out = 0;
  std::size_t contact = 0;
  for (const TapRecord& tap : run.taps) {
    if (!tap.reading) continue;
    out += run.belief().taps().readings[contact++].on_object != tap.reading->on_object ? 1 : 0;
  }
  return out;
}

TEST(ReadAgain, NothingFlipsWhereTheArmIsOffAndNoObjectIsLow) {
  for (const char* scene : {"object_ii", "cylinder", "large_block"}) {
    for (const char* effects : {"scene.effects=none", "scene.effects={height_offset: {constant: 8 mm}}"})
      EXPECT_EQ(flips(Finished("default.yaml", {std::string("scene=") + scene, effects})), 0) << scene << effects;
  }
}

TEST(ReadAgain, AResumedRunGoesOnAsTheUnbrokenOne) {
  const std::vector<std::string> words{"scene=plate", "scene.placement=random", "scene.effects=standard", "seed=3"};
  Finished unbroken("default.yaml", words);
  ASSERT_GT(flips(unbroken), 0);
  const RunResult result = unbroken.experiment.result();
  EXPECT_EQ(result.object_taps, static_cast<int>(unbroken.models().log().object_contacts().size()));
  EXPECT_EQ(result.object_taps + result.desk_taps + result.failed_taps, result.taps);
  for (std::size_t cut = 0; cut < unbroken.taps.size(); cut += brief() ? 13 : 3) {
    Prepared rest("default.yaml", words);
    expect_resumed(rest, unbroken, cut);
    EXPECT_EQ(rest.experiment.result().errors.rmse, result.errors.rmse);
    EXPECT_EQ(rest.experiment.counts().first_hit_tap, result.first_hit_tap);
  }
}

TEST(Outliers, KeepTheirProbabilitiesAfterAHundredContactsOnAnObjectAndLaterContactsAreTrusted) {
  Reader one({"belief.height.offset=none", "belief.footprint=gp_regression", "taps=120"});
  one.build({quantity::kHeightMean, HeightModels::kOutliers});
  // A plate of 5 cm with a contact at 10 cm among the first hundred, and another among the next twenty.
  constexpr std::size_t kEarly = 44;
  constexpr std::size_t kLate = 110;
  Eigen::VectorXd early;
  for (std::size_t i = 0; i < 120; ++i) {
    const std::size_t row = i / 12;
    const Target place{0.02 + 0.015 * static_cast<double>(i % 12), 0.02 + 0.018 * static_cast<double>(row)};
    one.tap(place, i == kEarly || i == kLate ? 0.10 : 0.05);
    if (i != 99) continue;
    one.update();
    early = one.models.surface()->outliers()->probabilities();
  }
  one.update();
  const OutlierModel& outliers = *one.models.surface()->outliers();
  EXPECT_GT(early(kEarly), 0.9);
  EXPECT_EQ(outliers.probabilities().head(100), early);
  EXPECT_EQ(outliers.probabilities()(kLate), 0.0);
  EXPECT_EQ((outliers.probabilities().array() >= OutlierModel::kRetapThreshold).count(), 1) << "the early one alone";
}

}  // namespace
}  // namespace palpate::test
