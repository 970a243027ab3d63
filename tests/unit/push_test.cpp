// SPDX-License-Identifier: MIT
// Pushes: positions of objects afterwards, errors of the run, and the probability of a push by the sampler.
#include "hypothesis_bench.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "tapping_bench.hpp"

#include <cmath>

namespace palpate::footprints {
namespace {

using test::TappingBench;

constexpr Area kPushArea{0.23, 0.23};
constexpr const char* kCylinder = "[{type: cylinder, diameter: 6 cm, height: 5 cm}]";

/// The centre of the objects.
Target middle(const Scene& scene) {
  constexpr int kSide = 230;
  Eigen::Vector2d sum(0.0, 0.0);
  int on = 0;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      const Eigen::Vector2d at(kPushArea.width * (i + 0.5) / kSide, kPushArea.depth * (j + 0.5) / kSide);
      if (!scene.on_object(scene.height(at(0), at(1)))) continue;
      sum += at;
      ++on;
    }
  }
  sum /= on;
  return {sum(0), sum(1)};
}

TEST(Push, MovesAnObjectOnceByItsDistanceAfterTheTapOfTheConfig) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const TappingBench bench(kCylinder, "{push: {after: 15, distance: 1.5 cm}}", "{type: paper}", seed);
    EXPECT_EQ(bench.scene().after(14), nullptr);
    const auto after = bench.scene().after(15);
    ASSERT_NE(after, nullptr);
    const Target here = middle(bench.scene());
    const Target there = middle(*after);
    EXPECT_NEAR(std::hypot(there.x - here.x, there.y - here.y), 0.015, 3e-4);
    const Target later = middle(*bench.scene().after(400));
    EXPECT_EQ(later.x, there.x);
    EXPECT_EQ(later.y, there.y);
  }
}

TEST(Push, HappensWithItsProbabilityAndKeepsObjectsApartAndOnTheArea) {
  const char* const blocks =
      "[{type: block, length: 8 cm, width: 4 cm, height: 5 cm, at: [6 cm, 6 cm]}, "
      "{type: block, length: 6 cm, width: 3 cm, height: 7 cm, at: [16 cm, 15 cm]}]";
  const TappingBench bench(blocks, "{push: {probability: 0.2, distance: 1 cm, turn: 20deg}}", "{type: paper}", 3);
  constexpr int kTaps = 150;
  const auto volume = [](const Scene& scene) {
    double sum = 0.0;
    for (int i = 0; i < 230; ++i) {
      for (int j = 0; j < 230; ++j) sum += scene.height(0.001 * (i + 0.5), 0.001 * (j + 0.5));
    }
    return sum * 1e-6;
  };
  int pushes = 0;
  Target before = middle(bench.scene());
  for (int tap = 1; tap <= kTaps; ++tap) {
    const auto scene = bench.scene().after(tap);
    if (!scene) continue;
    const Target now = middle(*scene);
    pushes += std::hypot(now.x - before.x, now.y - before.y) > 1e-3 ? 1 : 0;
    before = now;
    if (tap % 50 == 0) {
      EXPECT_NEAR(volume(*scene), 0.08 * 0.04 * 0.05 + 0.06 * 0.03 * 0.07, 4e-6) << "after tap " << tap;
    }
  }
  EXPECT_NEAR(pushes, 0.2 * kTaps, 5.0 * std::sqrt(0.2 * 0.8 * kTaps));
}

TEST(Push, ChangesTheNextTapsAndTheErrorsOfTheRun) {
  // The push is farther than the object is wide: the position of tap 15 is bare from tap 16 on.
  const TappingBench bench(kCylinder, "{push: {after: 15, distance: 7 cm}}", "{type: paper}");
  EXPECT_GT(bench.tap(0.115, 0.115, 15).height(), 0.04);
  EXPECT_EQ(bench.tap(0.115, 0.115, 16).height(), 0.0);
  test::Prepared run("default.yaml",
                     {"scene=cylinder", "taps=17", "scene.effects={push: {after: 15, distance: 2 cm, turn: 0deg}}"});
  std::vector<Eigen::VectorXd> truths;
  const auto truth = [&] { return truth_at(run.grid(), *run.experiment.truth()).height; };
  run.journal.announcing = [&](const TapRecord&) { truths.push_back(truth()); };
  run.run();
  EXPECT_EQ(truths[0], truths[14]);
  EXPECT_NE(truths[14], truths[15]) << "errors after tap 15 refer to the new position";
  EXPECT_EQ(truths[15], truth());
}

/// Taps of a bar that stood at y = 0.09 for the first four and stands at 0.12 for the others.
const std::vector<Touch> kLabels{{{0.08, 0.09}, 0.0, true},  {{0.15, 0.09}, 0.0, true},  {{0.11, 0.11}, 0.0, false},
                                 {{0.11, 0.07}, 0.0, false}, {{0.08, 0.12}, 0.0, true},  {{0.14, 0.12}, 0.0, true},
                                 {{0.11, 0.10}, 0.0, false}, {{0.10, 0.14}, 0.0, false}, {{0.12, 0.118}, 0.0, true}};

/// The probability of no push, and of a push after each tap, by draws of the prior that are weighed by all labels.
Eigen::VectorXd pushes_by_draws(const Prior& prior, const SamplerSettings& how) {
  const auto taps = static_cast<int>(kLabels.size());
  Random random(5, "push test");
  Eigen::VectorXd out = Eigen::VectorXd::Zero(taps);
  constexpr int kDraws = 400000;  // a quarter as many give an error of 0.02
  for (int i = 0; i < kDraws; ++i) {
    const Hypothesis hypothesis = prior.draw(random);
    Push push;
    push.before = taps;
    push.origin_x = push.origin_y = 0.115;
    push.dx = 0.012 * standard_normal(random);
    push.dy = 0.012 * standard_normal(random);
    const double angle = 0.1 * standard_normal(random);
    push.cosine = std::cos(angle);
    push.sine = std::sin(angle);
    // The hypothesis is as it is after the push: it sees each tap before the push at its position now.
    const auto probabilities = [&](const std::vector<Touch>& touches) {
      std::vector<double> each;
      for (const Touch& touch : touches) {
        const bool right = hypothesis.contains(touch.place.x, touch.place.y) == touch.on;
        each.push_back(right ? 1.0 - how.label_error : how.label_error);
      }
      return each;
    };
    const std::vector<double> now = probabilities(kLabels), then = probabilities(touches_after(push, kLabels));
    for (int before = 0; before < taps; ++before) {
      double weight = before == 0 ? 1.0 : how.push_probability;
      for (int k = 0; k < taps; ++k) weight *= (k < before ? then : now)[static_cast<std::size_t>(k)];
      out(before) += weight;
    }
  }
  return out / out.sum();
}

TEST(Sampler, HasTheProbabilityOfPushesOfWeighedDraws) {
  if (test::brief()) GTEST_SKIP() << "./check --all makes it in release";
  SamplerSettings how;
  how.particles = 2000;
  how.label_error = how.false_contact = 0.05;
  how.push_probability = 0.05;
  how.moves = how.moves_apart = 160;  // pushes are found slowly: 40 moves find a twentieth less, 12 a fifth
  how.most_moves = 800;
  Prior::Settings settings = default_prior(1.0);
  settings.hole_probability = 0.05;  // few draws have the flexible hypotheses with holes that fit all labels
  const Prior prior(settings);
  const Eigen::VectorXd exact = pushes_by_draws(prior, how);
  Eigen::VectorXd found = Eigen::VectorXd::Zero(exact.size());
  double share = 0.0;
  constexpr int kRuns = 3;
  for (int run = 0; run < kRuns; ++run) {
    Sampler belief(prior, how, Random(40 + static_cast<std::uint64_t>(run), "push test"));
    for (const Touch& touch : kLabels) belief.add(touch);
    share += belief.mean_push().share / kRuns;
    for (const Particle& one : belief.particles()) found(one.hypothesis.push.before) += 1.0 / (belief.size() * kRuns);
  }
  EXPECT_LT(exact(0), 0.8) << "the labels make a push probable";
  EXPECT_NEAR(share, 1.0 - found(0), 1e-9);
  // Two runs differ by 0.01 or less.
  EXPECT_NEAR(found(0), exact(0), 0.03);
  EXPECT_LT((found - exact).cwiseAbs().maxCoeff(), 0.05) << found.transpose() << " for " << exact.transpose();
}

TEST(Sampler, MovesTapsBeforeAPushAlongWithTheObject) {
  SamplerSettings how;
  how.push_probability = 0.01;
  Sampler belief(Prior(default_prior()), how, Random(1, "push test"));
  // A lattice of taps on a disc of 6 cm, then the same lattice with the disc 1.5 cm to the right.
  std::vector<Target> places;
  for (const double shift : {0.0, 0.015}) {
    for (int row = 0; row < 5; ++row) {
      for (int column = 0; column < 5; ++column) {
        const Target place{0.055 + 0.03 * column, 0.055 + 0.03 * row};
        places.push_back(place);
        belief.add({place, 0.0, std::hypot(place.x - 0.11 - shift, place.y - 0.11) <= 0.03});
      }
    }
  }
  EXPECT_GT(belief.mean_push().share, 0.5);
  // The labels from the 15th to the 36th are the same for both positions of the disc.
  EXPECT_GE(belief.mean_push().before, 14.0);
  EXPECT_LE(belief.mean_push().before, 36.0);
  Points now(50, 2);
  for (Eigen::Index i = 0; i < 50; ++i)
    now.row(i) << places[static_cast<std::size_t>(i)].x, places[static_cast<std::size_t>(i)].y;
  belief.current_positions(now);
  const Target& middle = places[12];
  EXPECT_NEAR(now(12, 0) - middle.x, 0.015, 0.006);
  EXPECT_NEAR(now(12, 1) - middle.y, 0.0, 0.006);
  EXPECT_EQ(now(49, 0), places[49].x);
}

}  // namespace
}  // namespace palpate::footprints
