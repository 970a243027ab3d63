// SPDX-License-Identifier: MIT
// What the belief over hypotheses comes to, against draws of the prior, with all that nobody has touched, that are
// weighed by all that the touches say, each likelihood by its definition.
#include "hypothesis_bench.hpp"
#include "primitives/sampler.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

namespace palpate::footprints {
namespace {

Prior::Settings about_three_primitives() {
  Prior::Settings out;
  out.area = {0.23, 0.23};
  out.expected = 3.0;
  return out;
}

/// Two things of unlike heights, or one.
const std::vector<Touch> kTwoThings{{{0.08, 0.09}, 0.050, true}, {{0.15, 0.13}, 0.071, true},
                                    {{0.11, 0.10}, 0.053, true}, {{0.12, 0.17}, 0.000, false},
                                    {{0.16, 0.15}, 0.070, true}, {{0.125, 0.115}, 0.000, false}};

/// One thing, with the desk about it.
const std::vector<Touch> kOneThing{test::touch_at(0.10, 0.10, true), test::touch_at(0.16, 0.10, false),
                                   test::touch_at(0.05, 0.10, false), test::touch_at(0.10, 0.16, false),
                                   test::touch_at(0.10, 0.05, false)};

/// A rim between two touches a centimetre apart.
const std::vector<Touch> kRim{test::touch_at(0.10, 0.10, true), test::touch_at(0.11, 0.10, false)};

struct Case {
  const char* name;
  const std::vector<Touch>* touches;
  SamplerSettings how;
  /// How far the belief may be off, as it takes what was not touched for independent of what was: where both hold a
  /// touch of the desk it counts twice, and a noisy touch of an object is thought to lie on it. Reweighing draws by
  /// that comes to 0.009, 0.008 with the noise, 0.0014 about one thing, and, where a noisy rim is all there is, 0.097.
  double allowance;
  int draws;  ///< where the touches say much, few of them agree
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

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

double normal_at(double deviation, double scale) {
  return std::exp(-0.5 * deviation * deviation / (scale * scale)) / (scale * std::sqrt(2.0 * kPi));
}

/// The probability of a label, by the definition of LabelModel.
struct LabelProbability {
  double right, wrong;
};
LabelProbability of_label(const Hypothesis& hypothesis, const Touch& touch, const SamplerSettings& how, bool noisy) {
  double depth = -1.0;
  for (const Primitive& primitive : hypothesis.primitives)
    depth = std::max(depth, primitive.depth(touch.place.x, touch.place.y));
  const double inside = noisy ? 0.5 * std::erfc(-depth / how.position_noise / std::sqrt(2.0))
                              : (hypothesis.contains(touch.place.x, touch.place.y) ? 1.0 : 0.0);
  if (touch.on) return {inside * (1.0 - how.label_error), (1.0 - inside) * how.false_contact};
  return {(1.0 - inside) * (1.0 - how.false_contact), inside * how.label_error};
}

/// How much more probable one height is beside another than any, on a top that is level but for `slope`.
double gain(const Touch& one, const Touch& other, double slope) {
  const double distance = std::hypot(one.place.x - other.place.x, one.place.y - other.place.y);
  return 0.15 * 0.98 * normal_at(one.height - other.height, std::hypot(0.004, slope * distance)) + 0.02;
}

/// How much more probable the heights are than any, by the definition of HeightModel: primitive by primitive.
double of_heights(const Hypothesis& hypothesis, const std::vector<Touch>& touches) {
  const auto holds = [](const Primitive& primitive, const Touch& touch) {
    return primitive.contains(touch.place.x, touch.place.y);
  };
  const auto nearest_before = [&](std::size_t i, const auto& counts) {
    const Touch* out = nullptr;
    double nearest = 1e9;
    for (std::size_t k = 0; k < i; ++k) {
      const double distance =
          std::hypot(touches[i].place.x - touches[k].place.x, touches[i].place.y - touches[k].place.y);
      if (!touches[k].on || distance >= nearest || !counts(touches[k])) continue;
      nearest = distance;
      out = &touches[k];
    }
    return out;
  };
  double out = 1.0;
  for (const Primitive& primitive : hypothesis.primitives) {
    double level = 1.0;
    double slope = 1.0;
    for (std::size_t i = 0; i < touches.size(); ++i) {
      if (!touches[i].on || !holds(primitive, touches[i])) continue;
      const auto holders = std::count_if(hypothesis.primitives.begin(), hypothesis.primitives.end(),
                                         [&](const Primitive& other) { return holds(other, touches[i]); });
      const double part = 1.0 / static_cast<double>(holders);
      if (const Touch* in_it = nearest_before(i, [&](const Touch& touch) { return holds(primitive, touch); })) {
        level *= std::pow(gain(touches[i], *in_it, 0.05), part);
        slope *= std::pow(gain(touches[i], *in_it, 0.5), part);
      } else if (const Touch* beside = nearest_before(i, [](const Touch&) { return true; })) {
        out *= std::pow(0.7 + 0.3 * gain(touches[i], *beside, 0.05), part);
      }
    }
    out *= 0.5 * level + 0.3 * slope + 0.2;
  }
  return out;
}

/// What is compared: the probability that each of some places is on an object; of those primitives that were touched,
/// the share of hypotheses with none to three and with more, and with a hole; and that believe in the noise.
constexpr int kPlaces = 64;
constexpr int kShares = kPlaces + 7;
Eigen::VectorXd shares_of(const Hypothesis& seen, bool noisy) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(kShares);
  out(kPlaces + std::min(seen.primitives.size(), 4)) = 1.0;
  out(kPlaces + 5) = holes_of(seen) > 0 ? 1.0 : 0.0;
  out(kPlaces + 6) = noisy ? 1.0 : 0.0;
  return out;
}
Eigen::VectorXd shares_of(const Hypothesis& hypothesis, bool noisy, const std::vector<Touch>& touches,
                          const Points& places) {
  Eigen::VectorXd out = shares_of(parts_of(hypothesis, touches).seen, noisy);
  for (int i = 0; i < kPlaces; ++i) out(i) = hypothesis.contains(places(i, 0), places(i, 1)) ? 1.0 : 0.0;
  return out;
}

struct Estimate {
  Eigen::VectorXd mean, error;
};

/// By `draws` of the prior.
Estimate weighed(const Case& one, int draws, const Points& places) {
  const Prior prior(about_three_primitives());
  Random random(1, "hypothesis posterior test");
  double sum = 0.0;
  const Eigen::Index count = kShares;
  Eigen::VectorXd first = Eigen::VectorXd::Zero(count), second = first;
  double sum_of_squares = 0.0;
  for (int i = 0; i < draws; ++i) {
    const Hypothesis hypothesis = prior.draw(random);
    for (const bool noisy : {false, true}) {
      if (noisy && one.how.position_noise <= 0.0) continue;
      double weight = 1.0;
      for (const Touch& touch : *one.touches) {
        const LabelProbability label = of_label(hypothesis, touch, one.how, noisy);
        weight *= label.right + label.wrong;
      }
      // Of those with little weight some are taken by lot and weigh more: nothing is lost but time.
      constexpr double kLittle = 0.05;
      if (weight < kLittle && random.uniform() >= weight / kLittle) continue;
      weight = std::max(weight, kLittle);
      if (one.how.heights) weight *= of_heights(hypothesis, *one.touches);
      const Eigen::VectorXd shares = shares_of(hypothesis, noisy, *one.touches, places);
      sum += weight;
      sum_of_squares += weight * weight;
      first += weight * shares;
      second += weight * weight * shares;  // they are 0 or 1
    }
  }
  Estimate out;
  out.mean = first / sum;
  // Of a ratio of two sums.
  out.error =
      ((second.array() * (1.0 - 2.0 * out.mean.array()) + sum_of_squares * out.mean.array().square()).max(0.0)).sqrt() /
      sum;
  return out;
}

class Posteriors : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Every, Posteriors,
                         testing::Values(Case{"Labels", &kTwoThings, settled(0.0, false), 0.01, 600000},
                                         Case{"LabelsAndHeights", &kTwoThings, settled(0.0, true), 0.01, 600000},
                                         Case{"NoisyLabelsAndHeights", &kTwoThings, settled(0.006, true), 0.01, 400000},
                                         Case{"OneThingAndTheDeskAboutIt", &kOneThing, settled(0.0, false, 0.02, 0.02),
                                              0.0015, 400000},
                                         Case{"ANoisyRim", &kRim, settled(0.006, false, 0.02, 0.02), 0.1, 60000}),
                         [](const auto& one) { return one.param.name; });

TEST_P(Posteriors, AreWhatDrawsOfThePriorComeToThatAreWeighedByLabelsAndHeights) {
  const Points places = test::lattice(8, 8);
  const Estimate exact = weighed(GetParam(), test::brief() ? GetParam().draws / 10 : GetParam().draws, places);
  const int runs = test::brief() ? 3 : 10;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(kShares), squares = sum;
  for (int run = 0; run < runs; ++run) {
    Sampler belief(Prior(about_three_primitives()), GetParam().how,
                   Random(static_cast<std::uint64_t>(run), "hypothesis posterior test: a belief"));
    for (const Touch& touch : *GetParam().touches) belief.add(touch);
    Eigen::VectorXd of_run = Eigen::VectorXd::Zero(kShares);
    for (const Particle& one : belief.particles())
      of_run += shares_of(one.hypothesis, one.hypothesis.noisy) / belief.size();
    belief.probability(places, of_run.head(kPlaces));
    sum += of_run;
    squares += of_run.cwiseAbs2();
  }
  const Eigen::VectorXd mean = sum / runs;
  // The runs differ by so much; of few runs and one share that is itself hardly known, of all shares it is.
  const double variance = (squares / runs - mean.cwiseAbs2()).mean() / (runs - 1);
  for (Eigen::Index i = 0; i < kShares; ++i) {
    const double error = std::sqrt(variance + exact.error(i) * exact.error(i));
    // Above 4.5 of them a normal deviation is once in 150000 times; runs differ more in some shares than in others.
    EXPECT_NEAR(mean(i), exact.mean(i), (test::brief() ? 9.0 : 4.5) * error + GetParam().allowance)
        << (i < kPlaces ? "place " : "share ") << i;
    EXPECT_TRUE(test::brief() || error < 0.013) << "or it would say little: " << error;
  }
  EXPECT_GT(exact.mean.head(kPlaces).maxCoeff(), 0.5) << "the touches say something";
  EXPECT_GT(std::min(exact.mean(kPlaces + 1), exact.mean(kPlaces + 2)), 0.05) << "but not whether two were touched";
}

TEST(Sampler, DoubtALabelAsOftenAsTheDrawsDoThatAreWeighedByAllLabels) {
  Prior::Settings settings = about_three_primitives();
  settings.expected = 0.5;  // with few primitives a lie is soon one
  const Prior prior(settings);
  SamplerSettings how = settled(0.004, false);
  how.label_error = 0.02;
  how.false_contact = 0.06;
  // The last but one is a lie, or there are two things.
  const std::vector<Touch> touches{test::touch_at(0.10, 0.12, true),  test::touch_at(0.14, 0.12, true),
                                   test::touch_at(0.12, 0.17, false), test::touch_at(0.06, 0.10, false),
                                   test::touch_at(0.13, 0.07, false), test::touch_at(0.20, 0.20, true),
                                   test::touch_at(0.19, 0.21, false)};
  Eigen::VectorXd exact = Eigen::VectorXd::Zero(7);
  double evidence = 0.0;
  Random random(3, "hypothesis posterior test");
  for (int i = 0; i < (test::brief() ? 30000 : 300000); ++i) {
    const Hypothesis hypothesis = prior.draw(random);
    for (const bool noisy : {false, true}) {
      double weight = 1.0;
      Eigen::VectorXd wrong(7);
      for (std::size_t k = 0; k < 7; ++k) {
        const LabelProbability label = of_label(hypothesis, touches[k], how, noisy);
        weight *= label.right + label.wrong;
        wrong(static_cast<Eigen::Index>(k)) = label.wrong / (label.right + label.wrong);
      }
      evidence += weight;
      exact += weight * wrong;
    }
  }
  exact /= evidence;
  const int runs = test::brief() ? 4 : 12;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(7);
  for (int run = 0; run < runs; ++run) {
    Sampler belief(prior, how, Random(300 + static_cast<std::uint64_t>(run), "hypothesis posterior test"));
    for (const Touch& touch : touches) belief.add(touch);
    Eigen::VectorXd doubt(7);
    belief.label_errors(doubt);
    mean += doubt / runs;
  }
  // Some twelve thousand hypotheses, of which one in three is new, against ten thousand draws that say as much as
  // those: 0.5 / sqrt(4000) and 0.5 / sqrt(10000) come to 0.009.
  EXPECT_LT((mean - exact).cwiseAbs().maxCoeff(), test::brief() ? 0.08 : 0.04)
      << mean.transpose() << " for " << exact.transpose();
  EXPECT_GT(exact(5), 0.2) << "it is doubted";
}

}  // namespace
}  // namespace palpate::footprints
