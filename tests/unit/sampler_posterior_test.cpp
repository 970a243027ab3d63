// SPDX-License-Identifier: MIT
// The posterior of the sampler against draws of the prior, with undiscovered primitives, that are weighed by labels and
// heights, each likelihood by its definition.
#include "hypothesis_bench.hpp"
#include "primitives/sampler.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

namespace palpate::footprints {
namespace {

/// Two objects of different heights, or one.
const std::vector<Touch> kTwoObjects{{{0.08, 0.09}, 0.050, true}, {{0.15, 0.13}, 0.071, true},
                                     {{0.11, 0.10}, 0.053, true}, {{0.12, 0.17}, 0.000, false},
                                     {{0.16, 0.15}, 0.070, true}, {{0.125, 0.115}, 0.000, false}};

/// One object, with the desk about it.
const std::vector<Touch> kOneObject{test::touch_at(0.10, 0.10, true), test::touch_at(0.16, 0.10, false),
                                    test::touch_at(0.05, 0.10, false), test::touch_at(0.10, 0.16, false),
                                    test::touch_at(0.10, 0.05, false)};

/// The label before the last is an error, or there are two objects.
const std::vector<Touch> kDoubtful{test::touch_at(0.10, 0.12, true),  test::touch_at(0.14, 0.12, true),
                                   test::touch_at(0.12, 0.17, false), test::touch_at(0.06, 0.10, false),
                                   test::touch_at(0.13, 0.07, false), test::touch_at(0.20, 0.20, true),
                                   test::touch_at(0.19, 0.21, false)};

/// A rim between two taps a centimetre apart.
const std::vector<Touch> kRim{test::touch_at(0.10, 0.10, true), test::touch_at(0.11, 0.10, false)};

struct PosteriorCase {
  const char* name;
  const std::vector<Touch>* touches;
  double expected;  ///< number of primitives
  SamplerSettings how;
  /// Whether draws are weighed by the approximation of the sampler: undiscovered primitives are independent of known
  /// ones. A tap of the desk in both counts twice, and an object tap near a noisy rim is in a known primitive.
  bool approximate;
  /// Allowed for the approximation, whose largest error is 0.009, 0.008 with noise, and 0.0014 for one object. A noisy
  /// rim alone has 0.097, so it is compared with the approximation; this then allows for the steps of the depth.
  double allowance;
  int draws;  ///< more for informative labels, with which few draws agree
};
void PrintTo(const PosteriorCase& one, std::ostream* out) { *out << one.name; }

SamplerSettings settled(double noise, bool heights, double label_error = 0.04, double false_contact = 0.08) {
  SamplerSettings out;
  out.particles = 1000;
  out.label_error = label_error;
  out.false_contact = false_contact;
  out.position_noise = noise;
  out.heights = heights;
  out.moves = 100;
  out.most_moves = 1000;
  return out;
}

/// The probability of a label, by the definition of LabelModel.
struct LabelProbability {
  double right, wrong;
};
LabelProbability of_label(const Hypothesis& hypothesis, const Touch& touch, const SamplerSettings& how, bool noisy) {
  double depth = -1.0;
  for (const Primitive& primitive : hypothesis.primitives)
    depth = std::max(depth, primitive.depth(touch.place.x, touch.place.y));
  const double inside = probability_inside(depth, noisy ? how.position_noise : 0.0);
  if (touch.on) return {inside * (1.0 - how.label_error), (1.0 - inside) * how.false_contact};
  return {(1.0 - inside) * (1.0 - how.false_contact), inside * how.label_error};
}

/// The compared numbers: the probability that each of some positions is on an object; the shares of hypotheses with
/// none to three known primitives and with more, with a hole in one, and with noise; and the probabilities of label
/// errors.
constexpr int kPositions = 64;
constexpr int kErrors = kPositions + 7;  ///< index of the first of them
constexpr int kShares = kErrors + 7;
Eigen::VectorXd shares_of(const Hypothesis& seen, bool noisy) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(kShares);
  out(kPositions + std::min(seen.primitives.size(), 4)) = 1.0;
  out(kPositions + 5) = holes_of(seen) > 0 ? 1.0 : 0.0;
  out(kPositions + 6) = noisy ? 1.0 : 0.0;
  return out;
}
Eigen::VectorXd shares_of(const PosteriorCase& one, const Hypothesis& hypothesis, bool noisy, const Points& places) {
  const Hypothesis seen = parts_of(hypothesis, *one.touches).seen;
  Eigen::VectorXd out = shares_of(seen, noisy);
  for (int i = 0; i < kPositions; ++i) out(i) = hypothesis.contains(places(i, 0), places(i, 1)) ? 1.0 : 0.0;
  int index = kErrors;
  for (const Touch& touch : *one.touches) {
    const LabelProbability label = of_label(one.approximate ? seen : hypothesis, touch, one.how, noisy);
    out(index++) = label.wrong / (label.right + label.wrong);
  }
  return out;
}

struct Estimate {
  Eigen::VectorXd mean, error;
};

/// The factor of the labels in the weight of a hypothesis.
double label_weight(const PosteriorCase& one, const Hypothesis& hypothesis, bool noisy) {
  double out = 1.0;
  const Parts parts = parts_of(hypothesis, *one.touches);
  for (const Touch& touch : *one.touches) {
    const LabelProbability label = of_label(one.approximate ? parts.seen : hypothesis, touch, one.how, noisy);
    out *= label.right + label.wrong;
    if (!one.approximate || touch.on) continue;
    // Undiscovered primitives are seen with noise by all hypotheses.
    for (const Primitive& primitive : parts.undiscovered.primitives) {
      Hypothesis alone;
      alone.primitives.add(primitive);
      const LabelProbability of_one = of_label(alone, touch, one.how, true);
      out *= (of_one.right + of_one.wrong) / (1.0 - one.how.false_contact);
    }
  }
  return out;
}

/// The posterior by `draws` of the prior.
Estimate posterior_by_draws(const PosteriorCase& one, int draws, const Points& places) {
  const Prior prior(default_prior(one.expected));
  Random random(1, "hypothesis posterior test");
  double sum = 0.0, sum_of_squares = 0.0;
  Eigen::VectorXd first = Eigen::VectorXd::Zero(kShares), second = first, third = first;
  for (int i = 0; i < draws; ++i) {
    const Hypothesis hypothesis = prior.draw(random);
    for (const bool noisy : {false, true}) {
      if (noisy && one.how.position_noise <= 0.0) continue;
      double weight = label_weight(one, hypothesis, noisy);
      // Draws with little weight are kept with a probability, and then weigh more.
      constexpr double kLittle = 0.05;
      if (weight < kLittle && random.uniform() >= weight / kLittle) continue;
      weight = std::max(weight, kLittle);
      if (one.how.heights) weight *= height_evidence(hypothesis, *one.touches, *one.touches);
      const Eigen::VectorXd shares = shares_of(one, hypothesis, noisy, places);
      sum += weight;
      sum_of_squares += weight * weight;
      first += weight * shares;
      second += weight * weight * shares;
      third += weight * weight * shares.cwiseAbs2();
    }
  }
  Estimate out;
  out.mean = first / sum;
  // The error of a ratio of two sums.
  const auto mean = out.mean.array();
  out.error = (third.array() - 2.0 * mean * second.array() + sum_of_squares * mean.square()).max(0.0).sqrt() / sum;
  return out;
}

class Posterior : public testing::TestWithParam<PosteriorCase> {};
INSTANTIATE_TEST_SUITE_P(
    Every, Posterior,
    testing::Values(
        PosteriorCase{"Labels", &kTwoObjects, 3.0, settled(0.0, false), false, 0.01, 600000},
        PosteriorCase{"LabelsAndHeights", &kTwoObjects, 3.0, settled(0.0, true), false, 0.01, 600000},
        PosteriorCase{"NoisyLabelsAndHeights", &kTwoObjects, 3.0, settled(0.006, true), false, 0.01, 400000},
        PosteriorCase{"OneObjectAndTheDeskAboutIt", &kOneObject, 3.0, settled(0.0, false, 0.02, 0.02), false, 0.0015,
                      400000},
        PosteriorCase{"LabelErrorOrObject", &kDoubtful, 0.5, settled(0.004, false, 0.02, 0.06), false, 0.01, 300000},
        PosteriorCase{"ANoisyRim", &kRim, 3.0, settled(0.006, false, 0.02, 0.02), true, 0.003, 60000}),
    [](const auto& one) { return one.param.name; });

TEST_P(Posterior, IsThatOfWeighedDrawsOfThePrior) {
  const Points places = test::lattice(8, 8);
  const Estimate exact =
      posterior_by_draws(GetParam(), test::brief() ? GetParam().draws / 10 : GetParam().draws, places);
  const int runs = test::brief() ? 3 : 10;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(kShares), squares = sum;
  for (int run = 0; run < runs; ++run) {
    Sampler belief(Prior(default_prior(GetParam().expected)), GetParam().how,
                   Random(static_cast<std::uint64_t>(run), "hypothesis posterior test: a belief"));
    for (const Touch& touch : *GetParam().touches) belief.add(touch);
    Eigen::VectorXd of_run = Eigen::VectorXd::Zero(kShares);
    for (const Particle& one : belief.particles())
      of_run += shares_of(one.hypothesis, one.hypothesis.noisy) / belief.size();
    belief.probability(places, of_run.head(kPositions));
    belief.label_errors(of_run.segment(kErrors, static_cast<Eigen::Index>(GetParam().touches->size())));
    sum += of_run;
    squares += of_run.cwiseAbs2();
  }
  const Eigen::VectorXd mean = sum / runs;
  // Few runs may give one share a small variance by chance, so each has the mean variance of all at least.
  const Eigen::ArrayXd variance = (squares / runs - mean.cwiseAbs2()).array() / (runs - 1);
  for (Eigen::Index i = 0; i < kShares; ++i) {
    const double error = std::sqrt(std::max(variance(i), variance.mean()) + exact.error(i) * exact.error(i));
    // A standard normal deviation exceeds 4.5 once in 150000 times.
    EXPECT_NEAR(mean(i), exact.mean(i), (test::brief() ? 9.0 : 4.5) * error + GetParam().allowance)
        << (i < kPositions ? "place " : "share ") << i;
    EXPECT_TRUE(test::brief() || error < 0.013) << "enough runs: " << error;
  }
  EXPECT_GT(exact.mean.head(kPositions).maxCoeff(), 0.5) << "the labels change the posterior";
  EXPECT_GT(std::min(exact.mean(kPositions + 1), exact.mean(kPositions + 2)), 0.05)
      << "one or two primitives have taps";
}

}  // namespace
}  // namespace palpate::footprints
