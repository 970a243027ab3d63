// SPDX-License-Identifier: MIT
// The sampler against its model: the prior of pushes, the truth of drawn desks, and an exact sum over all sets of taps
// that primitives can cover.
#include "hypothesis_bench.hpp"
#include "primitives/sampler.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <array>
#include <cmath>
#include <numeric>

namespace palpate::footprints {
namespace {

// A standard normal deviation exceeds 4.5 once in 150000 times.
constexpr double kDeviations = 4.5;

/// Mean and variance of numbers that are added one by one.
struct SampleMoments {
  double count = 0.0, sum = 0.0, squares = 0.0;
  void add(double value) {
    count += 1.0;
    sum += value;
    squares += value * value;
  }
  double mean() const { return sum / count; }
  double deviation() const { return std::sqrt(squares / count - mean() * mean()); }
  /// Standard error of the mean.
  double error() const { return deviation() / std::sqrt(count - 1.0); }
};

// Only the last tap has the label of an object. No push comes after it, so primitives and pushes are independent.
TEST(SamplerModel, KeepsThePriorOfPushesAndNoiseWithUninformativeLabels) {
  constexpr int kTaps = 15;
  SamplerSettings how;
  how.particles = test::brief() ? 1000 : 2000;
  how.label_error = how.false_contact = 0.5;
  how.position_noise = 0.004;
  how.push_probability = 0.05;
  how.heights = false;
  how.moves = test::brief() ? 60 : 100;
  how.most_moves = 1000;
  std::vector<Touch> touches = test::alike_touches(kTaps, false);
  touches.back() = test::touch_at(0.11, 0.12, true);
  const int runs = test::brief() ? 6 : 60;
  SampleMoments pushed, noisy, dx, dy, turn;
  std::vector<long> before(kTaps - 1, 0);
  for (int run = 0; run < runs; ++run) {
    Sampler belief(Prior(default_prior()), how,
                   Random(static_cast<std::uint64_t>(run), "footprint model test: pushes"));
    for (const Touch& touch : touches) belief.add(touch);
    SampleMoments of_run, noisy_of_run;
    for (const Particle& one : belief.particles()) {
      of_run.add(one.hypothesis.push ? 1.0 : 0.0);
      noisy_of_run.add(one.hypothesis.noisy ? 1.0 : 0.0);
      if (!one.hypothesis.push) continue;
      dx.add(one.hypothesis.push.dx);
      dy.add(one.hypothesis.push.dy);
      turn.add(one.hypothesis.push.angle());
      ++before[static_cast<std::size_t>(one.hypothesis.push.before - 1)];
    }
    pushed.add(of_run.mean());
    noisy.add(noisy_of_run.mean());
  }
  const double expected = how.push_probability * (kTaps - 1) / (1.0 + how.push_probability * (kTaps - 1));
  // Hypotheses are doubled after the find: copies that have not moved apart yet count once.
  const double independent = 0.5 * dx.count;
  EXPECT_NEAR(pushed.mean(), expected, kDeviations * std::sqrt(expected * (1.0 - expected) / how.particles / runs));
  EXPECT_NEAR(noisy.mean(), 0.5, kDeviations * 0.5 / std::sqrt(how.particles * runs));
  EXPECT_NEAR(dx.mean(), 0.0, kDeviations * 0.012 / std::sqrt(independent));
  EXPECT_NEAR(dx.deviation(), 0.012, kDeviations * 0.012 / std::sqrt(2.0 * independent));
  EXPECT_NEAR(dy.deviation(), 0.012, kDeviations * 0.012 / std::sqrt(2.0 * independent));
  EXPECT_NEAR(turn.deviation(), 0.1, kDeviations * 0.1 / std::sqrt(2.0 * independent));
  // Each tap but the last is equally probable. The doubled count makes the sum of squares twice as large.
  for (long& count : before) count /= 2;
  const long sum = std::accumulate(before.begin(), before.end(), 0L);
  EXPECT_LT(deviation_from(std::vector<double>(before.size(), static_cast<double>(sum) / (kTaps - 1)), before),
            kDeviations);
}

struct CalibrationCase {
  const char* name;
  double noise;  ///< metres
  int runs;
};
void PrintTo(const CalibrationCase& one, std::ostream* out) { *out << one.name; }

class Calibrated : public testing::TestWithParam<CalibrationCase> {};
INSTANTIATE_TEST_SUITE_P(Every, Calibrated,
                         testing::Values(CalibrationCase{"ExactPositions", 0.0, 1200},
                                         CalibrationCase{"NoisyPositions", 0.004, 800}),
                         [](const auto& one) { return one.param.name; });

TEST_P(Calibrated, HasTheProbabilitiesOfDesksOfThePrior) {
  constexpr std::array<int, 3> kTaps{6, 15, 30};
  const Prior prior(default_prior());
  SamplerSettings how;
  how.false_contact = 0.015;
  how.position_noise = GetParam().noise;
  how.heights = false;
  const Points places = test::lattice(15, 15);
  const int runs = test::brief() ? 40 : GetParam().runs;
  std::array<SampleMoments, kTaps.size()> difference;
  struct Bin {
    double count = 0.0, truth = 0.0, predicted = 0.0;
  };
  std::array<Bin, 10> bins{};
  for (int run = 0; run < runs; ++run) {
    Random random(static_cast<std::uint64_t>(run), "footprint model test: desks");
    const Hypothesis desk = prior.draw(random);
    const double noise = random.uniform() < 0.5 ? how.position_noise : 0.0;
    Sampler belief(prior, how, Random(static_cast<std::uint64_t>(run), "footprint model test: belief"));
    std::size_t checked = 0;
    for (int tap = 1; tap <= kTaps.back(); ++tap) {
      const Target place{0.23 * random.uniform(), 0.23 * random.uniform()};
      const bool on =
          desk.contains(place.x + noise * standard_normal(random), place.y + noise * standard_normal(random));
      const bool wrong = random.uniform() < (on ? how.label_error : how.false_contact);
      belief.add({place, 0.0, on != wrong});
      if (tap != kTaps[checked]) continue;
      Eigen::VectorXd predicted(places.rows());
      belief.probability(places, predicted);
      SampleMoments of_run;
      for (Eigen::Index i = 0; i < places.rows(); ++i) {
        const double truth = desk.contains(places(i, 0), places(i, 1)) ? 1.0 : 0.0;
        of_run.add(truth - predicted(i));
        Bin& bin = bins[std::min<std::size_t>(9, static_cast<std::size_t>(10.0 * predicted(i)))];
        bin.count += 1.0;
        bin.truth += truth;
        bin.predicted += predicted(i);
      }
      difference[checked++].add(of_run.mean());
    }
  }
  for (std::size_t i = 0; i < kTaps.size(); ++i)
    EXPECT_NEAR(difference[i].mean(), 0.0, kDeviations * difference[i].error()) << "after " << kTaps[i] << " taps";
  if (test::brief()) return;  // few desks give each bin few positions
  for (const Bin& bin : bins) {
    // Places of one desk go together. The largest difference of a model without faults was 0.05.
    if (bin.count < 600.0) continue;
    EXPECT_NEAR(bin.truth / bin.count, bin.predicted / bin.count, 0.06);
  }
}

/// Taps with labels of objects alone: each primitive with a tap inside is a known one, and nothing is approximated.
const std::vector<Touch> kObjectTaps{test::touch_at(0.08, 0.09, true), test::touch_at(0.10, 0.10, true),
                                     test::touch_at(0.15, 0.13, true), test::touch_at(0.09, 0.12, true),
                                     test::touch_at(0.17, 0.15, true), test::touch_at(0.20, 0.04, true)};
constexpr int kCounted = 7;  ///< primitives

/// Returns the probabilities of 0 to 7 primitives with a tap, and that one of them covers the last tap.
std::pair<std::vector<double>, double> enumerated(const Prior& prior, const SamplerSettings& how, int draws) {
  constexpr std::size_t kCount = 6;  // of the taps
  constexpr std::size_t kSets = std::size_t{1} << kCount;
  const auto in_set = [](std::size_t set, std::size_t tap) { return (set >> tap & 1U) != 0; };
  // The share of primitives of the prior that cover each set of taps.
  std::array<double, kSets> share{};
  Random random(1, "footprint model test: sets");
  for (int i = 0; i < draws; ++i) {
    const Primitive primitive = prior.draw_primitive(random);
    std::size_t set = 0;
    for (std::size_t k = 0; k < kCount; ++k)
      set |= primitive.contains(kObjectTaps[k].place.x, kObjectTaps[k].place.y) ? std::size_t{1} << k : 0;
    share[set] += 1.0 / draws;
  }
  // Weights of the unions of n primitives with a tap each, times expected^n / n!.
  std::array<double, kSets> of_union{};
  of_union[0] = 1.0;
  std::vector<double> weights(kCounted + 1, 0.0);
  double last_covered = 0.0;
  for (int n = 0; n <= kCounted; ++n) {
    std::array<double, kSets> next{};
    for (std::size_t set = 0; set < kSets; ++set) {
      double weight = of_union[set];
      for (std::size_t k = 0; k < kCount; ++k) weight *= in_set(set, k) ? 1.0 - how.label_error : how.false_contact;
      weights[static_cast<std::size_t>(n)] += weight;
      last_covered += in_set(set, kCount - 1) ? weight : 0.0;
      for (std::size_t more = 1; more < kSets; ++more)
        next[set | more] += of_union[set] * share[more] * prior.settings().expected / (n + 1);
    }
    of_union = next;
  }
  const double evidence = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& one : weights) one /= evidence;
  return {weights, last_covered / evidence};
}

TEST(SamplerModel, HasTheExactProbabilityOfEachNumberOfPrimitives) {
  SamplerSettings how;
  how.particles = 1000;
  how.label_error = 0.01;
  how.false_contact = 0.1;
  how.heights = false;
  how.moves = 100;
  how.most_moves = 1000;
  const Prior prior(default_prior());
  const auto [of_count, last_covered] = enumerated(prior, how, test::brief() ? 300000 : 3000000);
  std::vector<SampleMoments> sampled(of_count.size());
  SampleMoments covered;
  const int runs = test::brief() ? 4 : 20;
  for (int run = 0; run < runs; ++run) {
    Sampler belief(prior, how, Random(static_cast<std::uint64_t>(run), "footprint model test: enumeration"));
    for (const Touch& touch : kObjectTaps) belief.add(touch);
    std::vector<double> shares(of_count.size(), 0.0);
    double last = 0.0;
    for (const Particle& one : belief.particles()) {
      shares[static_cast<std::size_t>(std::min(one.hypothesis.primitives.size(), kCounted))] += 1.0 / belief.size();
      last +=
          one.hypothesis.contains(kObjectTaps.back().place.x, kObjectTaps.back().place.y) ? 1.0 / belief.size() : 0.0;
    }
    for (std::size_t n = 0; n < of_count.size(); ++n) sampled[n].add(shares[n]);
    covered.add(last);
  }
  // Chance in the draws of the prior: the rarest sets that matter are covered by one primitive in some thousand.
  const double of_draws = test::brief() ? 0.01 : 0.003;
  const double few = test::brief() ? 2.0 : 1.0;  // the error of the mean of few runs is hardly known
  for (std::size_t n = 0; n < of_count.size(); ++n) {
    EXPECT_NEAR(sampled[n].mean(), of_count[n], few * kDeviations * sampled[n].error() + of_draws) << n;
    EXPECT_LT(sampled[n].error(), test::brief() ? 0.02 : 0.004) << "enough runs";
  }
  EXPECT_NEAR(covered.mean(), last_covered, few * kDeviations * covered.error() + of_draws);
  EXPECT_GT(std::min(of_count[1], of_count[2]), 0.05) << "the taps leave open how many primitives there are";
  EXPECT_NEAR(last_covered, 0.5, 0.4) << "and whether the last label is an error";
}

}  // namespace
}  // namespace palpate::footprints
