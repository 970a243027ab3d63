// SPDX-License-Identifier: MIT
// What nobody has touched, against pieces drawn from the prior that are weighed by what the touches say of each.
#include "primitives/unseen.hpp"

#include "outline_bench.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

namespace palpate::footprints {
namespace {

OutlinePrior::Settings common_prior() {
  OutlinePrior::Settings out;
  out.area = {0.23, 0.23};
  out.expected = 3.0;
  return out;
}

/// Two touches of objects, and four of the desk, two of which are near one another.
const std::vector<Touch> kTouches{test::touch_at(0.10, 0.10, true),   test::touch_at(0.14, 0.12, false),
                                  test::touch_at(0.15, 0.125, false), test::touch_at(0.03, 0.19, true),
                                  test::touch_at(0.06, 0.05, false),  test::touch_at(0.18, 0.20, false)};

/// Some in the middle, some at an edge, some at touches.
const std::vector<Target> kPlaces{{0.115, 0.115}, {0.01, 0.12},  {0.06, 0.07}, {0.17, 0.06},  {0.2, 0.21},
                                  {0.141, 0.121}, {0.05, 0.195}, {0.09, 0.18}, {0.225, 0.005}};

constexpr double kMistaken = 0.1;
constexpr double kLies = 0.03;

/// How much less often a piece is there by a touch, by the definition of a label.
double share_left(const Piece& piece, const Touch& touch, double blur) {
  if (touch.on) return piece.contains(touch.place.x, touch.place.y) ? 0.0 : 1.0;
  const double depth = piece.depth(touch.place.x, touch.place.y);
  const double inside = blur > 0.0 ? 0.5 * std::erfc(-depth / blur / std::sqrt(2.0)) : (depth > 0.0 ? 1.0 : 0.0);
  return (inside * kMistaken + (1.0 - inside) * (1.0 - kLies)) / (1.0 - kLies);
}

bool holds(const Piece& piece, const Target& place) { return piece.contains(place.x, place.y); }

/// So many numbers of a piece are compared: whether it holds each place, two of them, and is long.
constexpr std::size_t kNumbers = 11;
constexpr double kLong = 0.08;  // metres
using Numbers = std::array<double, kNumbers>;
Numbers numbers_of_places(const Piece& piece) {
  Numbers out{};
  for (std::size_t i = 0; i < kPlaces.size(); ++i) out[i] = holds(piece, kPlaces[i]) ? 1.0 : 0.0;
  out[9] = out[0] * out[7];
  out[10] = 2.0 * piece.form.a >= kLong ? 1.0 : 0.0;
  return out;
}

struct Means {
  Numbers of{}, variance{};  ///< the variance is that of one draw
};

/// What is expected of each by `draws` of the prior.
Means weighed(const OutlinePrior& prior, const std::vector<Touch>& touches, double blur, int draws) {
  Means out;
  Random random(1, "unseen test: the prior");
  for (int i = 0; i < draws; ++i) {
    const Piece piece = prior.draw_piece_or_hollow(random);
    double weight = prior.settings().expected;
    for (const Touch& touch : touches) weight *= share_left(piece, touch, blur);
    if (!(weight > 0.0)) continue;
    const Numbers numbers = numbers_of_places(piece);
    for (std::size_t k = 0; k < kNumbers; ++k) {
      out.of[k] += weight * numbers[k] / draws;
      out.variance[k] += weight * weight * numbers[k] / draws;
    }
  }
  for (std::size_t k = 0; k < kNumbers; ++k) out.variance[k] -= out.of[k] * out.of[k];
  return out;
}

Unseen told(const OutlinePrior& prior, const std::vector<Touch>& touches, double blur, std::uint64_t seed) {
  Random random(seed, "unseen test");
  Unseen out(prior, random);
  const LabelModel labels(kMistaken, kLies, blur);
  for (const Touch& touch : touches) out.add(touch, labels);
  return out;
}

struct Case {
  const char* name;
  std::size_t touches;
  double blur;
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

/// How many pieces are expected, each counted for what `counts` says of it.
template <class Counts>
double sum_over(const Unseen& unseen, const Counts& counts) {
  double out = 0.0;
  unseen.for_each([&](const Piece& piece, double expected, double) { out += expected * counts(piece); });
  return out;
}

class UnseenAfter : public testing::TestWithParam<Case> {
 protected:
  std::vector<Touch> touches() const {
    return {kTouches.begin(), kTouches.begin() + static_cast<std::ptrdiff_t>(GetParam().touches)};
  }
};
INSTANTIATE_TEST_SUITE_P(Every, UnseenAfter,
                         testing::Values(Case{"NoTouch", 0, 0.0}, Case{"ATouchOfAnObject", 1, 0.0},
                                         Case{"SixTouches", 6, 0.0}, Case{"SixBlurredTouches", 6, 0.006}),
                         [](const auto& one) { return one.param.name; });

TEST_P(UnseenAfter, IsExpectedAsOftenAsDrawsOfThePriorSayThatAreWeighed) {
  const OutlinePrior prior(common_prior());
  const int draws = test::brief() ? 50000 : 500000;
  const Means exact = weighed(prior, touches(), GetParam().blur, draws);
  const int seeds = test::brief() ? 3 : 20;
  Numbers mean{};
  for (int seed = 0; seed < seeds; ++seed) {
    const Unseen unseen = told(prior, touches(), GetParam().blur, static_cast<std::uint64_t>(seed));
    for (std::size_t k = 0; k < kPlaces.size(); ++k) mean[k] += unseen.holding(kPlaces[k]).rate() / seeds;
    for (std::size_t k = kPlaces.size(); k + 1 < kNumbers; ++k)
      mean[k] += sum_over(unseen, [&](const Piece& piece) { return numbers_of_places(piece)[k]; }) / seeds;
    mean[10] += unseen.apart(kLong) / seeds;
  }
  for (std::size_t k = 0; k < kNumbers; ++k) {
    // Each of them stands for the prior by eight thousand draws; steps of the depth come to a thousandth.
    const double error = std::sqrt(exact.variance[k] * (1.0 / draws + 1.0 / (8192.0 * seeds)));
    EXPECT_NEAR(mean[k], exact.of[k], 5.0 * error + (GetParam().blur > 0.0 ? 1e-3 * exact.of[k] : 0.0)) << k;
  }
  EXPECT_GT(mean[10], 0.1) << "or there would be nothing to see";
}

TEST(Unseen, HoldsNoTouchOfAnObjectAndIsRarerAroundOneOfTheDeskAndNowhereMoreOftenThere) {
  const OutlinePrior prior(common_prior());
  for (const double blur : {0.0, 0.005}) {
    Random random(2, "unseen test");
    Unseen unseen(prior, random);
    const LabelModel labels(kMistaken, kLies, blur);
    std::vector<double> before;
    const Points places = test::scattered(60);
    const auto rate = [&](Eigen::Index i) { return unseen.holding({places(i, 0), places(i, 1)}).rate(); };
    for (Eigen::Index i = 0; i < places.rows(); ++i) before.push_back(rate(i));
    for (const Touch& touch : kTouches) {
      const double here = unseen.holding(touch.place).rate();
      unseen.add(touch, labels);
      const double left = unseen.holding(touch.place).rate();
      if (touch.on) {
        EXPECT_EQ(left, 0.0);
      } else if (blur > 0.0) {
        EXPECT_LT(left, 0.5 * here);
      } else {
        EXPECT_NEAR(left, here * kMistaken / (1.0 - kLies), 1e-4 * left) << "but for steps of a millionth of a piece";
      }
      for (Eigen::Index i = 0; i < places.rows(); ++i) {
        EXPECT_LE(rate(i), before[static_cast<std::size_t>(i)] + 1e-12);
        before[static_cast<std::size_t>(i)] = rate(i);
      }
    }
    const auto held = [](const Piece& piece) { return touched(piece, kTouches) ? 1.0 : 0.0; };
    EXPECT_EQ(sum_over(unseen, held), 0.0);
  }
}

TEST(Unseen, IsDrawnAtAPlaceAsOftenAsItIsExpectedThere) {
  const OutlinePrior prior(common_prior());
  const Unseen unseen = told(prior, kTouches, 0.0, 3);
  Random random(4, "unseen test: draws");
  const Target& at = kPlaces[5];
  const Unseen::Holding here = unseen.holding(at);
  constexpr int kDraws = 4000;
  Numbers drawn{};
  for (int i = 0; i < kDraws; ++i) {
    const Piece& piece = here.draw(random);
    ASSERT_TRUE(holds(piece, at));
    ASSERT_FALSE(touched(piece, kTouches));
    const Numbers numbers = numbers_of_places(piece);
    for (std::size_t k = 0; k < kNumbers; ++k) drawn[k] += numbers[k] / kDraws;
  }
  for (std::size_t k = 0; k < kNumbers; ++k) {
    const auto both = [&](const Piece& piece) { return holds(piece, at) ? numbers_of_places(piece)[k] : 0.0; };
    const double share = sum_over(unseen, both) / unseen.holding(at).rate();
    EXPECT_NEAR(drawn[k], share, 5.0 * std::sqrt(share * (1.0 - share) / kDraws) + 1e-12) << k;
  }
}

TEST(Unseen, IsDrawnInWholeAsAPoissonProcess) {
  const OutlinePrior prior(common_prior());
  const int draws = test::brief() ? 2000 : 30000;
  for (const std::size_t touches : {0, 6}) {
    const Unseen unseen =
        told(prior, {kTouches.begin(), kTouches.begin() + static_cast<std::ptrdiff_t>(touches)}, 0.0, 5);
    const double mean = sum_over(unseen, [](const Piece&) { return 1.0; });
    Random random(6, "unseen test: draws");
    std::vector<std::size_t> sizes(static_cast<std::size_t>(draws), 0);
    std::vector<std::size_t> here(static_cast<std::size_t>(draws), 0);  // that hold one place
    Numbers drawn{};
    for (const Unseen::Drawn& one : unseen.draw(static_cast<std::size_t>(draws), random)) {
      const Piece& piece = unseen.piece(one.piece);
      ++sizes[one.draw];
      here[one.draw] += holds(piece, kPlaces[7]) ? 1U : 0U;
      const Numbers numbers = numbers_of_places(piece);
      for (std::size_t k = 0; k < kNumbers; ++k) drawn[k] += numbers[k];
    }
    const auto counted = [](const std::vector<std::size_t>& numbers) {
      std::vector<long> out(Outline::kMost + 1, 0);
      for (const std::size_t number : numbers) ++out[std::min<std::size_t>(number, Outline::kMost)];
      return out;
    };
    std::vector<double> expected = poisson(mean, Outline::kMost);
    std::vector<double> expected_here = poisson(unseen.holding(kPlaces[7]).rate(), Outline::kMost);
    for (double& one : expected) one *= draws;
    for (double& one : expected_here) one *= draws;
    EXPECT_LT(deviation_from(expected, counted(sizes)), 5.0);
    EXPECT_LT(deviation_from(expected_here, counted(here)), 5.0);
    for (std::size_t k = 0; k < kNumbers; ++k) {
      const double rate = sum_over(unseen, [&](const Piece& piece) { return numbers_of_places(piece)[k]; });
      EXPECT_NEAR(drawn[k] / draws, rate, 5.0 * std::sqrt(rate / draws) + 1e-12) << k;
    }
  }
}

TEST(Unseen, HasOverALatticeTheRatesThatItHasOneByOne) {
  const OutlinePrior prior(common_prior());
  for (const std::size_t touches : {0, 1, 6}) {
    Unseen unseen = told(prior, {kTouches.begin(), kTouches.begin() + static_cast<std::ptrdiff_t>(touches)}, 0.004, 9);
    for (const Points& places :
         {test::lattice(41, 37), test::lattice(31, 7), test::lattice(1, 40), test::lattice(40, 1), test::lattice(1, 1),
          test::scattered(50), test::doubled(test::scattered(5), 0.0)}) {
      Eigen::VectorXd rates = Eigen::VectorXd::Constant(places.rows(), std::nan(""));
      unseen.rates(places, Lattice::over(places), rates);
      for (Eigen::Index i = 0; i < places.rows(); ++i) {
        ASSERT_NEAR(rates(i), unseen.holding({places(i, 0), places(i, 1)}).rate(), 1e-9)
            << places.rows() << " places, " << i;
        ASSERT_GE(rates(i), 0.0);
      }
    }
  }
}

}  // namespace
}  // namespace palpate::footprints
