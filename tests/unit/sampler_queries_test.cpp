// SPDX-License-Identifier: MIT
// Queries of the sampler: their results follow from the particles and the undiscovered primitives.
#include "primitives/sampler.hpp"

#include "hypothesis_bench.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

namespace palpate::footprints {
namespace {

/// Whether bit `k` of a sample is set at place `i`.
template <class Bits>
bool bit(const Bits& bits, int k, Eigen::Index i) {
  return (bits(k / 64, i) >> (k % 64) & 1U) != 0;
}

TEST(Sampler, HasTheSameProbabilitiesOnALatticeAsAtSinglePositions) {
  Sampler belief = sampler_of(500, 4, 0.02, 4);
  std::vector<Touch> touches = test::disc_touches(6);
  touches.insert(touches.begin() + 2, test::touch_at(0.115, 0.115, true));
  for (const Touch& touch : touches) {
    belief.add(touch);
    for (const auto& [columns, rows] :
         {std::pair{31, 31}, {31, 7}, {63, 5}, {64, 5}, {150, 3}, {1, 40}, {40, 1}, {1, 1}}) {
      const Points places = test::lattice(columns, rows);
      Eigen::VectorXd inside = Eigen::VectorXd::Zero(places.rows());
      belief.probability(places, inside);
      const Points twice = test::doubled(places, 0.0);  // not a lattice
      Eigen::VectorXd one_by_one = Eigen::VectorXd::Zero(twice.rows());
      belief.probability(twice, one_by_one);
      for (Eigen::Index i = 0; i < places.rows(); ++i) {
        ASSERT_NEAR(inside(i), one_by_one(2 * i), 1e-9) << columns << " x " << rows << ", place " << i;
        const auto held = std::count_if(belief.particles().begin(), belief.particles().end(), [&](const Particle& one) {
          return one.hypothesis.contains(places(i, 0), places(i, 1));
        });
        ASSERT_GE(inside(i), static_cast<double>(held) / belief.size() - 1e-12);
        ASSERT_LE(inside(i), 1.0);
      }
    }
  }
}

TEST(Sampler, SamplesParticlesWithUndiscoveredPrimitivesThatOverlapThem) {
  constexpr int kSample = 6400;
  Sampler belief = sampler_of(320, 4, 0.02, 5);
  const std::vector<Touch> touches{test::touch_at(0.08, 0.08, true), test::touch_at(0.03, 0.10, false),
                                   test::touch_at(0.09, 0.14, false), test::touch_at(0.12, 0.05, false)};
  for (const Touch& touch : touches) belief.add(touch);
  for (const Points& where : {test::lattice(23, 23), test::lattice(130, 4), test::scattered(200)}) {
    HypothesisSample sample;
    belief.sample(where, kSample, sample);
    ASSERT_EQ(sample.count, kSample);
    Eigen::VectorXd probability(where.rows());
    belief.probability(where, probability);
    Eigen::VectorXd held = Eigen::VectorXd::Zero(where.rows());
    Eigen::VectorXd covered = Eigen::VectorXd::Zero(where.rows());
    for (int k = 0; k < kSample; ++k) {
      const int one = k / (kSample / belief.size());
      const Hypothesis& hypothesis = belief.particles()[static_cast<std::size_t>(one)].hypothesis;
      for (Eigen::Index i = 0; i < where.rows(); ++i) {
        const bool holds = bit(sample.holds, k, i);
        const bool has = hypothesis.contains(where(i, 0), where(i, 1));
        ASSERT_TRUE(holds || !has);
        held(i) += holds ? 1.0 / kSample : 0.0;
        covered(i) += has ? 1.0 / kSample : 0.0;
      }
    }
    // An event that is expected less often than once may happen once.
    for (Eigen::Index i = 0; i < where.rows(); ++i)
      EXPECT_LE(held(i),
                probability(i) + 5.0 * std::sqrt(probability(i) * (1.0 - probability(i)) / kSample) + 1.0 / kSample);
    EXPECT_GT(held.sum(), 1.01 * covered.sum()) << "some undiscovered primitives overlap known ones";
  }
}

TEST(Sampler, TakesEveryParticleForSomeOfItsSmallerSamples) {
  constexpr int kCount = 384;
  constexpr int kSample = 256;
  Sampler belief = sampler_of(kCount / 2, 4, 0.02, 6);
  belief.add(test::touch_at(0.11, 0.12, true));  // doubles them
  const Points where = test::scattered(100);
  std::vector<bool> taken(kCount, false);
  for (int tap = 0; tap < 8; ++tap) {
    belief.add(test::touch_at(0.02 + 0.01 * tap, 0.2, false));
    ASSERT_EQ(belief.size(), kCount);
    HypothesisSample sample;
    belief.sample(where, kSample, sample);
    // Two of three particles from a first one on: the sample is one of these, with other primitives beside.
    int possible = 0;
    for (const double first : {0.1, 0.5, 0.9}) {
      const auto particle = [&](int k) { return static_cast<std::size_t>((k + first) * kCount / kSample); };
      bool is = true;
      for (int k = 0; k < kSample && is; ++k) {
        for (Eigen::Index i = 0; i < where.rows(); ++i)
          is = is && (bit(sample.holds, k, i) ||
                      !belief.particles()[particle(k)].hypothesis.contains(where(i, 0), where(i, 1)));
      }
      if (!is) continue;
      ++possible;
      for (int k = 0; k < kSample; ++k) taken[particle(k)] = true;
    }
    EXPECT_EQ(possible, 1);
  }
  EXPECT_EQ(std::count(taken.begin(), taken.end(), false), 0);
}

TEST(Sampler, ExpectsToFindTheExtentOfThePriorAndLessBesideAnObject) {
  const Points places = test::scattered(12);
  Eigen::VectorXd exact = Eigen::VectorXd::Zero(places.rows()), squares = exact;
  const Prior prior(default_prior());
  Random random(31, "particles test");
  const int draws = test::brief() ? 50000 : 200000;
  for (int i = 0; i < draws; ++i) {
    const Primitive primitive = prior.draw_primitive(random);
    for (Eigen::Index k = 0; k < places.rows(); ++k) {
      if (!primitive.contains(places(k, 0), places(k, 1))) continue;
      const double extent = prior.settings().expected * primitive.form.extent();
      exact(k) += extent / draws;
      squares(k) += extent * extent / draws;
    }
  }
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(places.rows());
  Eigen::VectorXd beside = Eigen::VectorXd::Zero(places.rows());
  constexpr int kRuns = 10;
  HypothesisSample sample;
  for (int run = 0; run < kRuns; ++run) {
    Sampler belief = sampler_of(100, 20, 0.02, 40 + static_cast<std::uint64_t>(run));
    belief.sample(places, 64, sample);
    mean += sample.expected_discovery_area / kRuns;
    belief.add(test::touch_at(places(0, 0), places(0, 1), true));
    belief.sample(places, 64, sample);
    beside += sample.expected_discovery_area / kRuns;
    EXPECT_EQ(sample.expected_discovery_area(0), 0.0) << "the primitives there are known";
  }
  // Five standard errors: a run has 4096 draws of the prior.
  const Eigen::ArrayXd variance = (squares - exact.cwiseAbs2()) * (1.0 / (4096.0 * kRuns) + 1.0 / draws);
  EXPECT_TRUE(((mean - exact).array().abs() < 5.0 * variance.sqrt()).all()) << (mean - exact).array() / variance.sqrt();
  EXPECT_TRUE((beside.array() <= mean.array() + 1e-15).all());
}

TEST(Sampler, HasTheUndiscoveredProbabilityOfDrawsWeighedByAllLabels) {
  constexpr double kWrong = 0.05;
  constexpr double kLong = 0.04;
  EXPECT_EQ(sampler_of(10, 0, kWrong, 11).undiscovered_probability(1.0), 0.0) << "nothing is a metre long";
  // The desk alone, then an object in the middle.
  for (const bool on : {false, true}) {
    std::vector<Touch> touches;
    const Points places = test::lattice(3, 3);
    for (Eigen::Index i = 0; i < places.rows(); ++i)
      touches.push_back(test::touch_at(places(i, 0), places(i, 1), on && i == 4));
    const int runs = test::brief() ? 3 : 8;
    double found = 0.0;
    for (int run = 0; run < runs; ++run) {
      Sampler belief = sampler_of(500, 40, kWrong, 20 + static_cast<std::uint64_t>(run));
      for (const Touch& touch : touches) belief.add(touch);
      found += belief.undiscovered_probability(kLong) / runs;
    }
    const Prior prior(default_prior());
    Random random(12, "particles test");
    double evidence = 0.0;
    double squares = 0.0;
    double left = 0.0;
    double before = 0.0;
    const int draws = test::brief() ? 20000 : 80000;
    for (int k = 0; k < draws; ++k) {
      const Hypothesis hypothesis = prior.draw(random);
      double weight = 1.0;
      for (const Touch& touch : touches)
        weight *= hypothesis.contains(touch.place.x, touch.place.y) == touch.on ? 1.0 - kWrong : kWrong;
      const auto is_long = [](const Primitive& primitive) { return 2.0 * primitive.form.a >= kLong; };
      before += std::any_of(hypothesis.primitives.begin(), hypothesis.primitives.end(), is_long) ? 1.0 / draws : 0.0;
      // Draws with little weight are kept with a probability, and then weigh more.
      constexpr double kLittle = 0.1;
      if (weight < kLittle && random.uniform() >= weight / kLittle) continue;
      weight = std::max(weight, kLittle);
      evidence += weight;
      squares += weight * weight;
      left += has_undiscovered(hypothesis, touches, kLong) ? weight : 0.0;
    }
    left /= evidence;
    // The taps of the desk are counted for each primitive, not for all together: an error below 0.01.
    EXPECT_NEAR(found, left, 5.0 * std::sqrt(left * (1.0 - left) * squares) / evidence + 0.01);
    EXPECT_LT(left, before - 0.2) << "the labels change the probability";
  }
}

}  // namespace
}  // namespace palpate::footprints
