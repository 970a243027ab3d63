// SPDX-License-Identifier: MIT
// Undiscovered primitives, against draws of the prior that are weighed by the taps.
#include "primitives/undiscovered.hpp"

#include "hypothesis_bench.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

namespace palpate::footprints {
namespace {

/// Two taps of objects and four of the desk, two of which are near each other.
const std::vector<Touch> kTouches{test::touch_at(0.10, 0.10, true),   test::touch_at(0.14, 0.12, false),
                                  test::touch_at(0.15, 0.125, false), test::touch_at(0.03, 0.19, true),
                                  test::touch_at(0.06, 0.05, false),  test::touch_at(0.18, 0.20, false)};

/// Positions in the middle, at an edge and at taps.
const std::vector<Target> kRatePositions{{0.115, 0.115}, {0.01, 0.12},  {0.06, 0.07}, {0.17, 0.06},  {0.2, 0.21},
                                         {0.141, 0.121}, {0.05, 0.195}, {0.09, 0.18}, {0.225, 0.005}};

constexpr double kLabelError = 0.1;
constexpr double kFalseContact = 0.03;

/// The factor by which a tap changes the weight of an undiscovered primitive, by the definition of a label.
double share_left(const Primitive& primitive, const Touch& touch, double noise) {
  if (touch.on) return primitive.contains(touch.place.x, touch.place.y) ? 0.0 : 1.0;
  const double depth = primitive.depth(touch.place.x, touch.place.y);
  const double inside = probability_inside(depth, noise);
  return (inside * kLabelError + (1.0 - inside) * (1.0 - kFalseContact)) / (1.0 - kFalseContact);
}

bool holds(const Primitive& primitive, const Target& place) { return primitive.contains(place.x, place.y); }

/// The compared numbers of a primitive: whether it contains each position, whether it contains two of them, and whether
/// it is long.
constexpr std::size_t kCompared = 11;
constexpr double kCountedLength = 0.08;  // metres
using Numbers = std::array<double, kCompared>;
Numbers numbers_of_places(const Primitive& primitive) {
  Numbers out{};
  for (std::size_t i = 0; i < kRatePositions.size(); ++i) out[i] = holds(primitive, kRatePositions[i]) ? 1.0 : 0.0;
  out[9] = out[0] * out[7];
  out[10] = 2.0 * primitive.form.a >= kCountedLength ? 1.0 : 0.0;
  return out;
}

struct RateMeans {
  Numbers of{}, variance{};  ///< the variance is that of one draw
};

/// The expected numbers by `draws` of the prior.
RateMeans means_by_draws(const Prior& prior, std::size_t taps, double noise, int draws) {
  RateMeans out;
  Random random(1, "undiscovered test: the prior");
  for (int i = 0; i < draws; ++i) {
    const Primitive primitive = prior.draw_primitive(random);
    double weight = prior.settings().expected;
    for (std::size_t k = 0; k < taps; ++k) weight *= share_left(primitive, kTouches[k], noise);
    if (!(weight > 0.0)) continue;
    const Numbers numbers = numbers_of_places(primitive);
    for (std::size_t k = 0; k < kCompared; ++k) {
      out.of[k] += weight * numbers[k] / draws;
      out.variance[k] += weight * weight * numbers[k] / draws;
    }
  }
  for (std::size_t k = 0; k < kCompared; ++k) out.variance[k] -= out.of[k] * out.of[k];
  return out;
}

UndiscoveredPrimitives undiscovered_after(const Prior& prior, std::size_t taps, double noise, std::uint64_t seed) {
  Random random(seed, "undiscovered test");
  UndiscoveredPrimitives out(prior, random);
  const LabelModel labels(kLabelError, kFalseContact, noise);
  for (std::size_t k = 0; k < taps; ++k) out.add(kTouches[k], labels);
  return out;
}

struct UndiscoveredCase {
  const char* name;
  std::size_t touches;
  double noise;
};
void PrintTo(const UndiscoveredCase& one, std::ostream* out) { *out << one.name; }

/// The expected sum of `counts` over all primitives.
template <class Counts>
double sum_over(const UndiscoveredPrimitives& undiscovered, const Counts& counts) {
  double out = 0.0;
  undiscovered.for_each([&](const Primitive& primitive, double expected) { out += expected * counts(primitive); });
  return out;
}

class UndiscoveredAfter : public testing::TestWithParam<UndiscoveredCase> {};
INSTANTIATE_TEST_SUITE_P(Every, UndiscoveredAfter,
                         testing::Values(UndiscoveredCase{"NoTouch", 0, 0.0},
                                         UndiscoveredCase{"ATouchOfAnObject", 1, 0.0},
                                         UndiscoveredCase{"SixTouches", 6, 0.0},
                                         UndiscoveredCase{"SixNoisyTouches", 6, 0.006}),
                         [](const auto& one) { return one.param.name; });

TEST_P(UndiscoveredAfter, HasTheRatesOfWeighedDrawsOfThePrior) {
  const Prior prior(default_prior(3.0));
  const int draws = test::brief() ? 50000 : 500000;
  const RateMeans exact = means_by_draws(prior, GetParam().touches, GetParam().noise, draws);
  const int seeds = test::brief() ? 3 : 20;
  Numbers mean{};
  for (int seed = 0; seed < seeds; ++seed) {
    const UndiscoveredPrimitives undiscovered =
        undiscovered_after(prior, GetParam().touches, GetParam().noise, static_cast<std::uint64_t>(seed));
    for (std::size_t k = 0; k < kRatePositions.size(); ++k)
      mean[k] += undiscovered.covering(kRatePositions[k]).rate() / seeds;
    for (std::size_t k = kRatePositions.size(); k + 1 < kCompared; ++k)
      mean[k] +=
          sum_over(undiscovered, [&](const Primitive& primitive) { return numbers_of_places(primitive)[k]; }) / seeds;
    mean[10] += undiscovered.expected_apart(kCountedLength) / seeds;
  }
  for (std::size_t k = 0; k < kCompared; ++k) {
    // Each has 8192 draws of the prior; steps of the depth are an error of a thousandth.
    const double error = std::sqrt(exact.variance[k] * (1.0 / draws + 1.0 / (8192.0 * seeds)));
    EXPECT_NEAR(mean[k], exact.of[k], 5.0 * error + (GetParam().noise > 0.0 ? 1e-3 * exact.of[k] : 0.0)) << k;
  }
  EXPECT_GT(mean[10], 0.1) << "many long primitives are apart";
}

TEST(UndiscoveredPrimitives, ContainsNoObjectTapAndBecomesRarerAroundTapsOfTheDesk) {
  const Prior prior(default_prior(3.0));
  for (const double noise : {0.0, 0.005}) {
    Random random(2, "undiscovered test");
    UndiscoveredPrimitives undiscovered(prior, random);
    const LabelModel labels(kLabelError, kFalseContact, noise);
    std::vector<double> before;
    const Points places = test::scattered(60);
    const auto rate = [&](Eigen::Index i) { return undiscovered.covering({places(i, 0), places(i, 1)}).rate(); };
    for (Eigen::Index i = 0; i < places.rows(); ++i) before.push_back(rate(i));
    for (const Touch& touch : kTouches) {
      const double here = undiscovered.covering(touch.place).rate();
      undiscovered.add(touch, labels);
      const double left = undiscovered.covering(touch.place).rate();
      if (touch.on) {
        EXPECT_EQ(left, 0.0);
      } else if (noise > 0.0) {
        EXPECT_LT(left, 0.5 * here);
      } else {
        EXPECT_NEAR(left, here * kLabelError / (1.0 - kFalseContact), 1e-4 * left)
            << "up to steps of a millionth of a primitive";
      }
      for (Eigen::Index i = 0; i < places.rows(); ++i) {
        EXPECT_LE(rate(i), before[static_cast<std::size_t>(i)] + 1e-12);
        before[static_cast<std::size_t>(i)] = rate(i);
      }
    }
    const auto held = [](const Primitive& primitive) { return has_object_tap(primitive, kTouches) ? 1.0 : 0.0; };
    EXPECT_EQ(sum_over(undiscovered, held), 0.0);
  }
}

TEST(UndiscoveredPrimitives, IsDrawnAtAPositionInProportionToItsWeight) {
  const Prior prior(default_prior(3.0));
  const UndiscoveredPrimitives undiscovered = undiscovered_after(prior, kTouches.size(), 0.0, 3);
  Random random(4, "undiscovered test: draws");
  const Target& at = kRatePositions[5];
  const UndiscoveredPrimitives::CoveringDraws here = undiscovered.covering(at);
  constexpr int kDraws = 4000;
  Numbers drawn{};
  for (int i = 0; i < kDraws; ++i) {
    const Primitive& primitive = here.draw(random);
    ASSERT_TRUE(holds(primitive, at));
    ASSERT_FALSE(has_object_tap(primitive, kTouches));
    const Numbers numbers = numbers_of_places(primitive);
    for (std::size_t k = 0; k < kCompared; ++k) drawn[k] += numbers[k] / kDraws;
  }
  for (std::size_t k = 0; k < kCompared; ++k) {
    const auto both = [&](const Primitive& primitive) {
      return holds(primitive, at) ? numbers_of_places(primitive)[k] : 0.0;
    };
    const double share = sum_over(undiscovered, both) / undiscovered.covering(at).rate();
    EXPECT_NEAR(drawn[k], share, 5.0 * std::sqrt(share * (1.0 - share) / kDraws) + 1e-12) << k;
  }
}

TEST(UndiscoveredPrimitives, IsDrawnAsAPoissonProcess) {
  const Prior prior(default_prior(3.0));
  const int draws = test::brief() ? 2000 : 30000;
  for (const std::size_t touches : {0, 6}) {
    const UndiscoveredPrimitives undiscovered = undiscovered_after(prior, touches, 0.0, 5);
    const double mean = sum_over(undiscovered, [](const Primitive&) { return 1.0; });
    Random random(6, "undiscovered test: draws");
    std::vector<std::size_t> sizes(static_cast<std::size_t>(draws), 0);
    std::vector<std::size_t> here(static_cast<std::size_t>(draws), 0);  // those that contain one position
    Numbers drawn{};
    for (const UndiscoveredPrimitives::Member& one : undiscovered.draw(draws, random)) {
      const Primitive& primitive = *one.primitive;
      ++sizes[static_cast<std::size_t>(one.set)];
      here[static_cast<std::size_t>(one.set)] += holds(primitive, kRatePositions[7]) ? 1U : 0U;
      const Numbers numbers = numbers_of_places(primitive);
      for (std::size_t k = 0; k < kCompared; ++k) drawn[k] += numbers[k];
    }
    const auto counted = [](const std::vector<std::size_t>& numbers) {
      std::vector<long> out(ShortList<Primitive>::kMost + 1, 0);
      for (const std::size_t number : numbers) ++out[std::min<std::size_t>(number, ShortList<Primitive>::kMost)];
      return out;
    };
    std::vector<double> expected = poisson(mean, ShortList<Primitive>::kMost);
    std::vector<double> expected_here =
        poisson(undiscovered.covering(kRatePositions[7]).rate(), ShortList<Primitive>::kMost);
    for (double& one : expected) one *= draws;
    for (double& one : expected_here) one *= draws;
    EXPECT_LT(deviation_from(expected, counted(sizes)), 5.0);
    EXPECT_LT(deviation_from(expected_here, counted(here)), 5.0);
    for (std::size_t k = 0; k < kCompared; ++k) {
      const double rate =
          sum_over(undiscovered, [&](const Primitive& primitive) { return numbers_of_places(primitive)[k]; });
      EXPECT_NEAR(drawn[k] / draws, rate, 5.0 * std::sqrt(rate / draws) + 1e-12) << k;
    }
  }
}

TEST(UndiscoveredPrimitives, HasTheSameRatesOnALatticeAsAtSinglePositions) {
  const Prior prior(default_prior(3.0));
  for (const std::size_t touches : {0, 1, 6}) {
    UndiscoveredPrimitives undiscovered = undiscovered_after(prior, touches, 0.004, 9);
    for (const Points& places :
         {test::lattice(41, 37), test::lattice(31, 7), test::lattice(1, 40), test::lattice(40, 1), test::lattice(1, 1),
          test::scattered(50), test::doubled(test::scattered(5), 0.0)}) {
      undiscovered.prepare(places);
      const Eigen::VectorXd rates = undiscovered.rates();
      ASSERT_EQ(rates.size(), places.rows());
      for (Eigen::Index i = 0; i < places.rows(); ++i) {
        ASSERT_NEAR(rates(i), undiscovered.covering({places(i, 0), places(i, 1)}).rate(), 1e-9)
            << places.rows() << " places, " << i;
        ASSERT_GE(rates(i), 0.0);
      }
    }
  }
}

}  // namespace
}  // namespace palpate::footprints
