// SPDX-License-Identifier: MIT
// Updates of the sampler: number and weights of particles, their likelihood, and equal bytes for equal seeds.
#include "primitives/sampler.hpp"

#include "hypothesis_bench.hpp"
#include "support/instruction_sets.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <array>
#include <utility>

namespace palpate::footprints {
namespace {

std::vector<Hypothesis> hypotheses(const Sampler& belief) {
  std::vector<Hypothesis> out;
  for (const Particle& particle : belief.particles()) out.push_back(particle.hypothesis);
  return out;
}

bool equal_forms(const Form& one, const Form& other) {
  return one.family == other.family && one.x == other.x && one.y == other.y && one.a == other.a && one.b == other.b &&
         one.cosine == other.cosine && one.sine == other.sine;
}

bool equal_hypotheses(const Hypothesis& one, const Hypothesis& other) {
  const auto equal = [](const Primitive& a, const Primitive& b) {
    return equal_forms(a.form, b.form) && a.hollow == b.hollow && (!a.hollow || equal_forms(a.hole, b.hole));
  };
  return one.noisy == other.noisy && one.push.before == other.push.before && one.push.dx == other.push.dx &&
         std::equal(one.primitives.begin(), one.primitives.end(), other.primitives.begin(), other.primitives.end(),
                    equal);
}

TEST(Sampler, DoublesItsParticlesForTenTapsAfterAFind) {
  Sampler belief = sampler_of(100, 1.0, 0.02, 3);
  const auto add = [&](double x, double y, bool on) {
    belief.add(test::touch_at(x, y, on));
    return belief.size();
  };
  EXPECT_EQ(add(0.02, 0.02, false), 100) << "no object";
  EXPECT_EQ(add(0.11, 0.12, true), 200);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(add(0.11 + 0.001 * i, 0.12, true), 200) << "a known object";
  for (int i = 0; i < 5; ++i) EXPECT_EQ(add(0.15, 0.08 + 0.02 * i, false), 200);
  EXPECT_EQ(add(0.02, 0.02, false), 100);
  EXPECT_EQ(add(0.19, 0.12, true), 200) << "another object";
}

TEST(Sampler, DrawsParticlesByTheirWeights) {
  constexpr std::size_t kCount = 100;
  const int seeds = test::brief() ? 40 : 400;
  constexpr double kWrong = 0.2;
  const std::array<std::size_t, 3> looked_at{0, kCount / 2, kCount - 1};
  constexpr int kLooks = 12;  // after ten of them the number is halved
  std::array<double, 3> excess{};
  std::array<int, 3> times{};
  for (int seed = 1; seed <= seeds; ++seed) {
    Sampler belief = sampler_of(static_cast<int>(kCount), 0.0, kWrong, static_cast<std::uint64_t>(seed));  // no moves
    belief.add(test::touch_at(0.11, 0.12, true));  // each particle draws its own primitive
    Random random(static_cast<std::uint64_t>(seed), "particles test: places");
    for (int touch = 0; touch < kLooks; ++touch) {
      const Target place{0.23 * random.uniform(), 0.23 * random.uniform()};
      const std::vector<Hypothesis> before = hypotheses(belief);
      const double evidence = belief.add({place, 0.0, false});
      const std::vector<Hypothesis> after = hypotheses(belief);
      // The evidence is the mean weight; the probability of an undiscovered primitive at the position follows.
      const auto weight = [&](const Hypothesis& one) { return one.contains(place.x, place.y) ? kWrong : 1.0 - kWrong; };
      double mean = 0.0;
      for (const Hypothesis& one : before) mean += weight(one) / static_cast<double>(before.size());
      if (mean < kWrong + 1e-9) continue;  // all contain it
      const double p_new = (mean - evidence) / (mean - kWrong);
      ASSERT_GE(p_new, -1e-9);
      ASSERT_LT(p_new, 0.9);
      for (std::size_t k = 0; k < looked_at.size(); ++k) {
        const Hypothesis& one = before[looked_at[k]];
        const auto equal = [&](const Hypothesis& other) { return equal_hypotheses(other, one); };
        const auto alike = static_cast<double>(std::count_if(before.begin(), before.end(), equal));
        const auto copies = static_cast<double>(std::count_if(after.begin(), after.end(), equal));
        const double expected = ((1.0 - p_new) * weight(one) + p_new * kWrong) / evidence *
                                static_cast<double>(after.size()) / static_cast<double>(before.size());
        ASSERT_LT(std::abs(copies - alike * expected), alike + 1e-9);
        if (alike > 1.0) continue;
        excess[k] += copies - expected;
        ++times[k];
      }
    }
  }
  // A count that is one of two neighbours has a standard deviation of at most 1/2.
  for (std::size_t k = 0; k < excess.size(); ++k) {
    EXPECT_LT(std::abs(excess[k]) / times[k], 5.0 * 0.5 / std::sqrt(times[k])) << k;
    EXPECT_GT(times[k], seeds / 2) << k;
  }
}

// Position noise makes a tap of the desk on a known object far less improbable, so most of the halved number are noisy.
TEST(Sampler, DrawsNoisyParticlesByTheirWeightsWhenTheirNumberIsHalved) {
  constexpr double kWrong = 0.01;
  constexpr double kNoise = 0.03;
  constexpr int kSeeds = 40;
  const Touch found = test::touch_at(0.11, 0.12, true);
  double excess = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Sampler belief = sampler_of(100, 0.0, kWrong, seed, kNoise);
    belief.add(found);
    for (int tap = 0; tap < 9; ++tap) belief.add(test::touch_at(0.01, 0.01, false));
    ASSERT_EQ(belief.size(), 200);
    double noisy = 0.0, sum = 0.0;
    for (const Hypothesis& one : hypotheses(belief)) {
      double depth = -1.0;
      for (const Primitive& primitive : one.primitives)
        depth = std::max(depth, primitive.depth(found.place.x, found.place.y));
      const double inside = probability_inside(depth, one.noisy ? kNoise : 0.0);
      const double weight = inside * kWrong + (1.0 - inside) * (1.0 - kWrong);
      noisy += one.noisy ? weight : 0.0;
      sum += weight;
    }
    belief.add({found.place, 0.0, false});
    const std::vector<Hypothesis> after = hypotheses(belief);
    ASSERT_EQ(after.size(), 100U);
    excess +=
        static_cast<double>(std::count_if(after.begin(), after.end(), [](const auto& one) { return one.noisy; })) -
        100.0 * noisy / sum;
  }
  // The standard deviation of a sum of rounded counts is at most half of the square root of their number.
  EXPECT_NEAR(excess / kSeeds, 0.0, 5.0 * 0.5 * std::sqrt(100.0 / kSeeds));
}

TEST(Sampler, IsTheSameForOneSeedOnEveryInstructionSet) {
  const Points positions = test::lattice(31, 29);
  const auto after = [&](Instructions set, std::uint64_t seed) {
    const test::OnInstructions on(set);
    SamplerSettings how;
    how.position_noise = 0.003;
    how.push_probability = 0.05;
    Sampler belief(Prior(default_prior()), how, Random(seed, "sampler test: instructions"));
    for (const Touch& touch : test::disc_touches(12)) belief.add(touch);
    std::pair<std::vector<Hypothesis>, HypothesisSample> out(hypotheses(belief), {});
    belief.sample(positions, 256, out.second);
    return out;
  };
  const auto [some, sample] = after(Instructions::baseline, 8);
  for (const Instructions set : math::instruction_sets()) {
    const auto [others, other_sample] = after(set, 8);
    EXPECT_TRUE(std::equal(some.begin(), some.end(), others.begin(), others.end(), equal_hypotheses));
    EXPECT_EQ(sample.holds, other_sample.holds);
    EXPECT_EQ(sample.expected_discovery_area, other_sample.expected_discovery_area);
  }
  EXPECT_NE(sample.expected_discovery_area, after(Instructions::baseline, 9).second.expected_discovery_area);
}

TEST(Sampler, HasFewLabelErrorsIfAHypothesisExplainsTheLabels) {
  Sampler belief = sampler_of(1000, 4, 0.02, 9);
  for (const Touch& touch : test::disc_touches(25)) belief.add(touch);
  EXPECT_LT(belief.mean_label_errors(), 0.7);
  // Object and desk in turn at one position: half of the labels are wrong in any hypothesis.
  Sampler puzzled = sampler_of(1000, 4, 0.02, 9);
  for (const Touch& touch : test::contradictory_touches(24)) puzzled.add(touch);
  EXPECT_NEAR(puzzled.mean_label_errors(), 12.0, 1e-9);
}

TEST(LabelModel, HasTheProbabilitiesOfTheDepthInTheMiddleOfEachStep) {
  constexpr double kLabelError = 0.03;
  constexpr double kFalseContact = 0.08;
  for (const double noise : {0.0, 0.004}) {
    const LabelModel labels(kLabelError, kFalseContact, noise);
    const double width = 2.0 * labels.reach() / LabelModel::kSteps;
    EXPECT_NEAR(labels.reach(), 3.5 * noise, 1e-11);
    EXPECT_NEAR(labels.steps_per_metre() * width, 1.0, 1e-12);
    for (int i = LabelModel::kOutside; i <= LabelModel::kInside; ++i) {
      const auto step = static_cast<LabelModel::Step>(i);
      const double depth = (i - 0.5) * width - labels.reach();
      EXPECT_EQ(labels.step(depth), step);
      EXPECT_EQ(LabelModel::inside(step), depth > 0.0);
      const bool beyond = i == LabelModel::kOutside || i == LabelModel::kInside;
      const double inside = probability_inside(depth, beyond ? 0.0 : std::max(noise, 1e-12));
      for (const bool on : {false, true}) {
        const double right = on ? inside * (1.0 - kLabelError) : (1.0 - inside) * (1.0 - kFalseContact);
        const double wrong = on ? (1.0 - inside) * kFalseContact : inside * kLabelError;
        const double loss = std::log((on ? 1.0 - kLabelError : 1.0 - kFalseContact) / (right + wrong));
        EXPECT_NEAR(labels.probability(step, on), right + wrong, 1e-12) << i;
        EXPECT_NEAR(labels.wrong(step, on), wrong / (right + wrong), 1e-12) << i;
        EXPECT_NEAR(from_units(labels.loss(step, on)), loss, 1e-6) << i;
        const double surely_wrong =
            on ? std::log((1.0 - kLabelError) / kFalseContact) : std::log((1.0 - kFalseContact) / kLabelError);
        EXPECT_EQ(labels.contradicts(step, on), loss > 0.5 * surely_wrong) << i;
      }
    }
    EXPECT_EQ(labels.step(-1.0), LabelModel::kOutside);
    EXPECT_EQ(labels.step(1.0), LabelModel::kInside);
    EXPECT_EQ(labels.step(0.0), LabelModel::kSteps / 2 + 1) << "inside";
  }
}

TEST(Sampler, KeepsTheLikelihoodAndTheDensityOfEachParticle) {
  const Prior prior(default_prior(8.0));
  for (const auto& [noise, pushes] : {std::pair(0.0, 0.0), std::pair(0.004, 0.0), std::pair(0.004, 0.2)}) {
    SamplerSettings how;
    how.particles = 300;
    how.label_error = 0.05;
    how.false_contact = 0.02;
    how.position_noise = noise;
    how.push_probability = pushes;
    Sampler belief(prior, how, Random(10, "particles test"));
    std::vector<Touch> made = test::disc_touches(25);
    for (std::size_t i = 0; i < made.size(); ++i) {
      made[i].on = std::hypot(made[i].place.x - 0.115, made[i].place.y - 0.115) < 0.07;
      made[i].height = made[i].on ? 0.05 + 0.004 * static_cast<double>(i % 3) : 0.0;
    }
    for (const Touch& touch : made) belief.add(touch);
    int primitives = 0;
    int beside = 0;
    for (const Particle& one : belief.particles()) {
      const std::vector<Touch> touches = touches_after(one.hypothesis.push, made);
      const LabelModel labels(how.label_error, how.false_contact, one.hypothesis.noisy ? noise : 0.0);
      LogUnits loss = 0;
      for (std::size_t i = 0; i < touches.size(); ++i) {
        const Target& place = touches[i].place;
        LabelModel::Step deepest = LabelModel::kOutside;
        for (int p = 0; p < one.hypothesis.primitives.size(); ++p) {
          const LabelModel::Step kept = one.rows.row(p)[i];
          const Primitive& primitive = one.hypothesis.primitives[p];
          // Single precision may give the neighbouring step, once in some thousand.
          const LabelModel::Step step = labels.step(primitive.depth(place.x, place.y));
          ASSERT_LE(std::abs(kept - step), one.hypothesis.noisy ? 1 : 0);
          ASSERT_TRUE(one.hypothesis.noisy || LabelModel::inside(kept) == primitive.contains(place.x, place.y));
          beside += kept != step ? 1 : 0;
          deepest = std::max(deepest, kept);
        }
        loss += labels.loss(deepest, touches[i].on);
      }
      ASSERT_EQ(one.loss, loss) << "whole numbers do not drift";
      ASSERT_NEAR(from_units(one.heights), std::log(height_evidence(one.hypothesis, made, touches)), 1e-5);
      for (const Primitive& primitive : one.hypothesis.primitives) {
        ASSERT_EQ(primitive.density, prior.density(primitive));
        ASSERT_TRUE(has_object_tap(primitive, touches));
      }
      primitives += one.hypothesis.primitives.size();
    }
    EXPECT_LE(beside, 40) << "of some 40000";
    EXPECT_DOUBLE_EQ(belief.mean_primitives(), primitives / (1.0 * belief.size()));
  }
}

}  // namespace
}  // namespace palpate::footprints
