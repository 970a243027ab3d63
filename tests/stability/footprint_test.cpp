// SPDX-License-Identifier: MIT
// The extremes of the footprints: labels all alike, labels that contradict each other at one place, labels without any
// order, a thousand of each; alone, and in whole runs.
#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <fmt/format.h>

namespace palpate::test {
namespace {

const int kTouches = brief() ? 200 : 1000;

const std::vector<std::pair<std::string, std::string>>& footprints() {
  static const std::vector<std::pair<std::string, std::string>> all{
      {"gp_classifier", "{kernel: {type: rbf, length_scale: 3 cm}}"},
      {"primitives", "{kernel: {type: rbf, length_scale: 3.5 cm}}"}};
  return all;
}

std::vector<Touch> touches_of(const std::string& labels, int count) {
  if (labels == "all on an object") return test::alike_touches(count, true);
  if (labels == "all on the desk") return test::alike_touches(count, false);
  if (labels == "contradictory at one place") return test::contradictory_touches(count);
  return test::disorderly_touches(count);
}

class FootprintExtremes : public ::testing::TestWithParam<const char*> {};

TEST_P(FootprintExtremes, AloneGiveProbabilitiesFromOneTouchToAThousand) {
  const std::vector<Touch> touches = touches_of(GetParam(), kTouches);
  for (const auto& [name, options] : footprints()) {
    const auto footprint = test::make<Footprint>(test::shared_host(), name, options);
    int taken = 0;
    for (const Touch& touch : touches) {
      footprint->add(touch);
      ++taken;
      if (taken != 1 && taken != 10 && taken != 100 && taken != kTouches) continue;
      EXPECT_TRUE(all_probabilities(test::probability_of(*footprint, test::lattice(47, 47)))) << name << taken;
      const Points touched{{touch.place.x, touch.place.y}};
      EXPECT_TRUE(all_probabilities(test::probability_of(*footprint, touched))) << name << taken;
      for (const FootprintNumber& one : footprint->numbers()) EXPECT_TRUE(std::isfinite(one.value)) << one.name;
    }
    const Eigen::VectorXd last = test::probability_of(*footprint, test::lattice(47, 47));
    const std::string labels = GetParam();
    if (labels == "all on an object") {
      EXPECT_GT(last.mean(), 0.9) << name;
    }
    if (labels == "all on the desk") {
      EXPECT_LT(last.mean(), 0.1) << name;
    }
    if (labels == "contradictory at one place") {
      EXPECT_NEAR(test::probability_of(*footprint, Points{{0.1, 0.12}})(0), 0.5, 0.1) << name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfLabels, FootprintExtremes,
                         ::testing::Values("all on an object", "all on the desk", "contradictory at one place",
                                           "without order"),
                         [](const auto& one) {
                           std::string name = one.param;
                           for (char& letter : name) letter = letter == ' ' ? '_' : letter;
                           return name;
                         });

TEST(FootprintHeights, OfAnySizeLeaveProbabilities) {
  for (const double height : {0.0, 0.05, 1e3}) {
    const auto footprint =
        test::make<Footprint>(test::shared_host(), "primitives", "{kernel: {type: rbf, length_scale: 3.5 cm}}");
    int number = 0;
    for (Touch touch : test::disorderly_touches(kTouches / 10)) {
      touch.height = ++number % 3 == 0 ? -height : height;
      footprint->add(touch);
    }
    EXPECT_TRUE(all_probabilities(test::probability_of(*footprint, test::lattice(47, 47)))) << height;
    for (const FootprintNumber& one : footprint->numbers()) EXPECT_TRUE(std::isfinite(one.value)) << one.name;
    // All alike at one place: each of the others makes the piece a hundred times as probable.
    const auto one =
        test::make<Footprint>(test::shared_host(), "primitives", "{kernel: {type: rbf, length_scale: 3.5 cm}}");
    for (int i = 0; i < kTouches / 10; ++i) one->add({{0.1, 0.12}, height, true});
    EXPECT_NEAR(test::probability_of(*one, Points{{0.1, 0.12}})(0), 1.0, 1e-6) << height;
  }
}

/// A run of the loop over such touches, every number of the footprint that it recorded checked.
void expect_sound_run(const std::string& labels, int taps, std::vector<std::string> words) {
  words.insert(words.end(), {fmt::format("taps={}", taps), "choice.repeat=allow"});
  std::vector<TapResult> answers;
  for (const Touch& touch : touches_of(labels, taps)) answers.push_back(contact_at(touch.on ? 0.05 : 0.0));
  Finished run("default.yaml", words, scripted(answers));
  ASSERT_EQ(run.taps.size(), static_cast<std::size_t>(taps));
  for (const TapRecord& tap : run.taps) {
    EXPECT_TRUE(std::isfinite(tap.score.value_or(0.0))) << tap.number();
    const std::optional<double> probability = number_of(tap.state, "p");
    if (!probability) continue;
    EXPECT_TRUE(*probability >= 0.0 && *probability <= 1.0) << tap.number();
    for (const auto& [name, value] : tap.state.fields) {
      const double* const number = name.rfind("footprint.", 0) == 0 ? std::get_if<double>(&value) : nullptr;
      EXPECT_TRUE(number == nullptr || std::isfinite(*number)) << name;
    }
  }
  run.read({quantity::kObjectProbability, quantity::kHeightMean});
  EXPECT_TRUE(all_probabilities(run.belief().values(quantity::kObjectProbability)));
  EXPECT_TRUE(run.belief().values(quantity::kHeightMean).allFinite());
}

// All taps go to one place where there is only one candidate.
const std::vector<std::pair<std::string, std::string>> kRuns{{"all on an object", "candidates.count=47"},
                                                             {"all on the desk", "candidates.count=47"},
                                                             {"without order", "candidates.count=47"},
                                                             {"contradictory at one place", "candidates.count=1"}};

class FootprintRuns : public ::testing::TestWithParam<const char*> {};

TEST_P(FootprintRuns, ThatReadItAtEveryTapRecordProbabilities) {
  for (const auto& [labels, candidates] : kRuns) {
    SCOPED_TRACE(labels);
    expect_sound_run(labels, test::brief() ? 15 : 80, {std::string("belief.footprint=") + GetParam(), candidates});
  }
}

// A thousand touches are the footprint's by itself; a run of so many takes minutes, and shows no more than this.
void expect_sound_long_run(const std::string& footprint, std::size_t which) {
  const auto& [labels, candidates] = kRuns.at(which);
  expect_sound_run(labels, brief() ? 80 : 400,
                   {"belief.footprint=" + footprint, candidates, "acquisition=uncertainty"});
}

TEST_P(FootprintRuns, OfHundredsOfTapsOnTheDeskEndWithProbabilities) { expect_sound_long_run(GetParam(), 1); }

TEST_P(FootprintRuns, OfHundredsOfContradictoryTapsAtOnePlaceEndWithProbabilities) {
  expect_sound_long_run(GetParam(), 3);
}

INSTANTIATE_TEST_SUITE_P(Of, FootprintRuns, ::testing::Values("gp_classifier", "primitives"),
                         [](const auto& one) { return std::string(one.param); });

}  // namespace
}  // namespace palpate::test
