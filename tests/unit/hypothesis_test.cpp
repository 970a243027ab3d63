// SPDX-License-Identifier: MIT
// Hypotheses, and whether the density of the prior is that of its draws.
#include "primitives/hypothesis.hpp"

#include "hypothesis_bench.hpp"
#include "primitives/sampler.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <map>
#include <tuple>

namespace palpate::footprints {
namespace {

TEST(Hypothesis, ContainsThePositionsInItsPrimitives) {
  const Prior prior(default_prior());
  Random random(11, "hypothesis test");
  const Points places = test::lattice(31, 31);
  int several = 0;
  int hollow = 0;
  for (int k = 0; k < 200; ++k) {
    const Hypothesis hypothesis = prior.draw(random);
    several += hypothesis.primitives.size() > 1 ? 1 : 0;
    hollow += holes_of(hypothesis) > 0 ? 1 : 0;
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      const Point p{places(i, 0), places(i, 1)};
      bool held = false;
      double nearest = 1.0;
      for (const Primitive& primitive : hypothesis.primitives) {
        const double in_form = inside_of(primitive.form, p);
        const double in_hole = primitive.hollow ? inside_of(primitive.hole, p) : -1.0;
        nearest = std::min({nearest, std::abs(in_form), std::abs(in_hole)});
        held = held || (in_form > 0.0 && in_hole < 0.0);
        if (std::min(std::abs(in_form), std::abs(in_hole)) > kOnTheRim) {
          ASSERT_EQ(primitive.depth(p[0], p[1]) > 0.0, in_form > 0.0 && in_hole < 0.0);
        }
      }
      if (nearest > kOnTheRim) {
        ASSERT_EQ(hypothesis.contains(p[0], p[1]), held);
      }
    }
  }
  EXPECT_GT(several, 50);
  EXPECT_GT(hollow, 50);
}

TEST(Hypothesis, LosesOnlyTheRemovedPrimitiveAndIsCopiedInFull) {
  const Prior prior(default_prior());
  Random random(12, "hypothesis test");
  ShortList<Primitive> hypothesis;
  std::vector<double> left;
  for (int i = 0; i < ShortList<Primitive>::kMost; ++i) {
    hypothesis.add(prior.draw_whole(random));
    left.push_back(hypothesis[i].form.x);
  }
  for (const int one : {0, 10, 4, 8}) {
    left.erase(std::find(left.begin(), left.end(), hypothesis[one].form.x));
    ShortList<Primitive> copy;
    copy = hypothesis;
    copy.remove(one);
    hypothesis = copy;
    std::vector<double> found;
    for (const Primitive& primitive : hypothesis) found.push_back(primitive.form.x);
    EXPECT_THAT(found, testing::UnorderedElementsAreArray(left));
  }
}

TEST(Hypothesis, KeepsAFittedHoleWhenItsAxesAreSwapped) {
  const Prior prior(default_prior());
  Random random(15, "hypothesis test");
  const Points places = test::lattice(61, 61);
  int corners = 0;
  for (int k = 0; k < 400; ++k) {
    Primitive primitive = prior.draw_primitive(random);
    if (!primitive.fitted()) continue;
    corners += primitive.fit == Primitive::HolePlacement::corner ? 1 : 0;
    primitive.form.b = 1.7 * primitive.form.a;
    primitive.fit_hole();
    Primitive ordered = primitive;
    ordered.order_axes();
    ordered.fit_hole();
    ASSERT_LE(ordered.form.b, ordered.form.a);
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      // Depths are those of forms whose axes are in order.
      const bool held = primitive.contains(places(i, 0), places(i, 1));
      ASSERT_EQ(ordered.contains(places(i, 0), places(i, 1)), held) << k;
    }
  }
  EXPECT_GT(corners, 10);
}

/// Priors that have little in common.
std::vector<Prior::Settings> priors() {
  Prior::Settings crowded = default_prior();
  crowded.area = {0.12, 0.09};  // most forms do not fit
  crowded.most = 2;
  crowded.ellipses = 0.6;
  Prior::Settings wide = default_prior();
  wide.area = {0.46, 0.46};
  wide.min_width = 0.03;
  wide.most_slender = 4.0;
  wide.expected = 3.5;
  wide.hole_probability = 0.7;
  return {default_prior(), crowded, wide};
}

TEST(Prior, HasAPoissonNumberOfPrimitivesUpToItsLimit) {
  constexpr int kDraws = 200000;
  for (const Prior::Settings& settings : priors()) {
    const Prior prior(settings);
    Random random(13, "hypothesis test");
    std::vector<long> counts(static_cast<std::size_t>(settings.most) + 1, 0);
    for (int i = 0; i < kDraws; ++i) ++counts[static_cast<std::size_t>(prior.draw(random).primitives.size())];
    std::vector<double> expected = poisson(settings.expected, settings.most);
    for (double& one : expected) one *= kDraws;
    // Above 5 once in three million times.
    EXPECT_LT(deviation_from(expected, counts), 5.0);
  }
}

/// A primitive drawn evenly over all that may be, in the coordinates of its density, and over some that may not; and
/// the density of such draws.
std::pair<Primitive, double> drawn_evenly(const Prior::Settings& prior, Random& random) {
  double density = 1.0;
  const auto between = [&](double low, double high) {
    density /= high - low;
    return low + (high - low) * random.uniform();
  };
  const double longest = 0.5 * std::min(prior.max_length, std::hypot(prior.area.width, prior.area.depth));
  const auto axes = [&](Form& form) {
    form.family = random.uniform() < 0.5 ? Form::Family::box : Form::Family::ellipse;
    density *= 0.5;
    form.turn(between(0.0, kPi));
    const double range = std::log(2.0 * longest / prior.min_width);
    const double one = std::log(0.5 * prior.min_width) + range * random.uniform();
    // Half of them about round.
    constexpr double kRound = 0.1;
    const double other = random.uniform() < 0.5 ? std::log(0.5 * prior.min_width) + range * random.uniform()
                                                : one - kRound * random.uniform();
    density *= 0.5 * 2.0 / (range * range) + (std::abs(one - other) < kRound ? 0.5 / (range * kRound) : 0.0);
    std::tie(form.b, form.a) = std::minmax({std::exp(one), std::exp(other)});
  };
  Primitive out;
  axes(out.form);
  // A little more than the room of the form: weights of wide forms would vary too much over the whole area.
  const auto centre = [&](double reach, double side) {
    const double beyond = 0.05 * (side - 2.0 * reach);
    return between(reach - beyond, side - reach + beyond);
  };
  out.form.x = centre(out.form.reach_x(), prior.area.width);
  out.form.y = centre(out.form.reach_y(), prior.area.depth);
  out.hollow = random.uniform() < 0.5;
  density *= 0.5;
  if (!out.hollow) return {out, density};
  out.fit = static_cast<Primitive::HolePlacement>(random.index(3));
  density /= 3.0;
  if (out.fitted()) {
    const auto share = [&] { return between(0.0, 1.0); };
    out.along = share();
    out.across = share();
    const auto corner = static_cast<int>(random.index(4));
    out.side_a = corner % 2 == 0 ? 1 : -1;
    out.side_b = corner / 2 == 0 ? 1 : -1;
    if (out.fit == Primitive::HolePlacement::corner) density /= 4.0;
    out.fit_hole();
  } else {
    axes(out.hole);
    const double along = between(-out.form.a, out.form.a);
    const double across = between(-out.form.b, out.form.b);
    const Point at = placed(out.form, along, across);
    out.hole.x = at[0];
    out.hole.y = at[1];
  }
  return {out, density};
}

/// One of some dozens of kinds, by all numbers of a primitive.
std::string kind_of(const Primitive& primitive, const Prior::Settings& prior) {
  const auto numbers = numbers_of(primitive, prior);
  const auto half = [&](std::size_t number, double at) { return numbers[number].value > at ? "1" : "0"; };
  std::string out = std::string(primitive.form.family == Form::Family::box ? "box" : "ellipse") + half(0, 0.6) +
                    half(2, 0.3) + half(3, 0.45) + half(4, 0.2);
  if (!primitive.hollow) return out;
  if (primitive.fitted()) return out + half(14, 0.6) + half(15, 0.5) + half(16, 0.4) + half(17, 0.5);
  return std::string(primitive.hole.family == Form::Family::box ? "box" : "ellipse") + " in " +
         (primitive.form.family == Form::Family::box ? "box" : "ellipse") + half(3, 0.5) + half(10, 0.15) +
         half(11, 0.1) + half(13, 0.7);
}

TEST(Prior, DrawsEachKindOfPrimitiveInProportionToItsDensity) {
  const int draws = test::brief() ? 400000 : 1000000;
  for (const Prior::Settings& settings : priors()) {
    const Prior prior(settings);
    Random random(14, "hypothesis test");
    struct Share {
      double sum = 0.0, squares = 0.0, drawn = 0.0;
    };
    std::map<std::string, Share> kinds;
    Share all;
    for (int i = 0; i < draws; ++i) {
      const auto [primitive, density] = drawn_evenly(settings, random);
      const double weight = prior.density(primitive) / density;
      if (!(weight > 0.0)) continue;
      for (Share* share : {&all, &kinds[kind_of(primitive, settings)]}) {
        share->sum += weight / draws;
        share->squares += weight / draws * weight / draws;
      }
    }
    EXPECT_LT(std::sqrt(all.squares), 0.02 * all.sum) << "enough draws";
    int primitives = 0;
    for (int i = 0; i < draws / 4; ++i) {
      for (const Primitive& primitive : prior.draw(random).primitives) {
        ++kinds[kind_of(primitive, settings)].drawn;
        ++primitives;
        ASSERT_EQ(primitive.density, prior.density(primitive));
        ASSERT_GT(primitive.density, 0.0);
      }
    }
    int compared = 0;
    for (const auto& [kind, share] : kinds) {
      if (share.drawn < 100.0) continue;
      ++compared;
      const double drawn = share.drawn / primitives;
      // The density has a factor that all primitives share: the error is that of a ratio of two sums.
      const double expected = share.sum / all.sum;
      const double square = share.squares * (1.0 - 2.0 * expected) + expected * expected * all.squares;
      EXPECT_NEAR(drawn, expected, 5.0 * std::sqrt(square / (all.sum * all.sum) + drawn / primitives)) << kind;
    }
    EXPECT_GT(compared, 25);
  }
}

TEST(Prior, FindsRoomOnAnAreaThatIsHardlyLargerThanTheSmallestPrimitive) {
  Prior::Settings settings = default_prior();
  settings.area = {0.0207, 0.0207};
  const Prior prior(settings);
  SamplerSettings how;
  how.particles = 200;
  how.moves = 4;
  Sampler belief(prior, how, Random(1, "hypothesis test"));
  for (int i = 0; i < 3; ++i) belief.add({{0.01, 0.01}, 0.0, true});
  int primitives = 0;
  for (const Particle& one : belief.particles()) {
    for (const Primitive& primitive : one.hypothesis.primitives) {
      ++primitives;
      EXPECT_GT(prior.density(primitive), 0.0);
      EXPECT_LE(primitive.form.reach_x(), 0.5 * 0.0207);
    }
  }
  EXPECT_GT(primitives, 150);
  settings.area = {0.019, 0.2};
  EXPECT_THROW(Prior{settings}, Error);
}

}  // namespace
}  // namespace palpate::footprints
