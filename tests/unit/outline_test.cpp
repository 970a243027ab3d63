// SPDX-License-Identifier: MIT
// Outlines, and whether the density of the prior is that of its draws.
#include "primitives/outline.hpp"

#include "outline_bench.hpp"
#include "primitives/particles.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <map>
#include <numeric>
#include <tuple>

namespace palpate::footprints {
namespace {

OutlinePrior::Settings common_prior() {
  OutlinePrior::Settings out;
  out.area = {0.23, 0.23};
  return out;
}

TEST(Outline, HoldsWhatItsPiecesSay) {
  const OutlinePrior prior(common_prior());
  Random random(11, "outline test");
  const Points places = test::lattice(31, 31);
  int several = 0;
  int hollow = 0;
  for (int k = 0; k < 200; ++k) {
    const Outline outline = prior.draw(random);
    several += outline.size() > 1 ? 1 : 0;
    hollow += holes_of(outline) > 0 ? 1 : 0;
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      const Point p{places(i, 0), places(i, 1)};
      bool held = false;
      double nearest = 1.0;
      for (const Piece& piece : outline) {
        const double in_form = inside_of(piece.form, p);
        const double in_hole = piece.hollow ? inside_of(piece.hole, p) : -1.0;
        nearest = std::min({nearest, std::abs(in_form), std::abs(in_hole)});
        held = held || (in_form > 0.0 && in_hole < 0.0);
        if (std::min(std::abs(in_form), std::abs(in_hole)) > kOnTheRim) {
          ASSERT_EQ(piece.depth(p[0], p[1]) > 0.0, in_form > 0.0 && in_hole < 0.0);
        }
      }
      if (nearest > kOnTheRim) {
        ASSERT_EQ(outline.contains(p[0], p[1]), held);
      }
    }
  }
  EXPECT_GT(several, 50);
  EXPECT_GT(hollow, 50);
}

TEST(Outline, OfTwelvePiecesLosesTheOneThatIsTakenAwayAndCopiesAreWhole) {
  const OutlinePrior prior(common_prior());
  Random random(12, "outline test");
  Outline outline;
  std::vector<double> left;
  for (int i = 0; i < Outline::kMost; ++i) {
    outline.add(prior.draw_piece(random));
    left.push_back(outline[i].form.x);
  }
  for (const int one : {0, 10, 4, 8}) {
    left.erase(std::find(left.begin(), left.end(), outline[one].form.x));
    Outline copy;
    copy = outline;
    copy.remove(one);
    outline = copy;
    std::vector<double> found;
    for (const Piece& piece : outline) found.push_back(piece.form.x);
    EXPECT_THAT(found, testing::UnorderedElementsAreArray(left));
  }
}

TEST(Outline, KeepsAHoleThatFitsWhereItIsWhenAxesAreNamedAnew) {
  const OutlinePrior prior(common_prior());
  Random random(15, "outline test");
  const Points places = test::lattice(61, 61);
  int corners = 0;
  for (int k = 0; k < 400; ++k) {
    Piece piece = prior.draw_piece_or_hollow(random);
    if (!piece.fitted()) continue;
    corners += piece.fit == Piece::Fit::corner ? 1 : 0;
    piece.form.b = 1.7 * piece.form.a;
    piece.fit_hole();
    Piece ordered = piece;
    ordered.order_axes();
    ordered.fit_hole();
    ASSERT_LE(ordered.form.b, ordered.form.a);
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      // Depths are those of forms whose axes are in order.
      const bool held = piece.contains(places(i, 0), places(i, 1));
      ASSERT_EQ(ordered.contains(places(i, 0), places(i, 1)), held) << k;
    }
  }
  EXPECT_GT(corners, 10);
}

/// Priors that have little in common.
std::vector<OutlinePrior::Settings> priors() {
  OutlinePrior::Settings crowded = common_prior();
  crowded.area = {0.12, 0.09};  // most forms do not fit
  crowded.most = 2;
  crowded.ellipses = 0.6;
  OutlinePrior::Settings wide = common_prior();
  wide.area = {0.46, 0.46};
  wide.smallest = 0.03;
  wide.most_slender = 4.0;
  wide.expected = 3.5;
  wide.hollow = 0.7;
  return {common_prior(), crowded, wide};
}

TEST(OutlinePrior, HasAsManyPiecesAsTheLawOfPoissonSaysUpToTheMost) {
  constexpr int kDraws = 200000;
  for (const OutlinePrior::Settings& settings : priors()) {
    const OutlinePrior prior(settings);
    Random random(13, "outline test");
    std::vector<long> counts(static_cast<std::size_t>(settings.most) + 1, 0);
    for (int i = 0; i < kDraws; ++i) ++counts[static_cast<std::size_t>(prior.draw(random).size())];
    std::vector<double> expected = poisson(settings.expected, settings.most);
    for (double& one : expected) one *= kDraws;
    // Above 5 once in three million times.
    EXPECT_LT(deviation_from(expected, counts), 5.0);
  }
}

/// A piece drawn evenly over all that may be, in the coordinates of its density, and over some that may not; and the
/// density of such draws.
std::pair<Piece, double> drawn_evenly(const OutlinePrior::Settings& prior, Random& random) {
  double density = 1.0;
  const auto between = [&](double low, double high) {
    density /= high - low;
    return low + (high - low) * random.uniform();
  };
  const double longest = 0.5 * std::min(prior.largest, std::hypot(prior.area.width, prior.area.depth));
  const auto axes = [&](Form& form) {
    form.family = random.uniform() < 0.5 ? Form::Family::box : Form::Family::ellipse;
    density *= 0.5;
    form.turn(between(0.0, kPi));
    const double range = std::log(2.0 * longest / prior.smallest);
    const double one = std::log(0.5 * prior.smallest) + range * random.uniform();
    // Half of them about round.
    constexpr double kRound = 0.1;
    const double other = random.uniform() < 0.5 ? std::log(0.5 * prior.smallest) + range * random.uniform()
                                                : one - kRound * random.uniform();
    density *= 0.5 * 2.0 / (range * range) + (std::abs(one - other) < kRound ? 0.5 / (range * kRound) : 0.0);
    std::tie(form.b, form.a) = std::minmax({std::exp(one), std::exp(other)});
  };
  Piece out;
  axes(out.form);
  out.form.x = between(0.0, prior.area.width);
  out.form.y = between(0.0, prior.area.depth);
  out.hollow = random.uniform() < 0.5;
  density *= 0.5;
  if (!out.hollow) return {out, density};
  out.fit = static_cast<Piece::Fit>(random.index(3));
  density /= 3.0;
  if (out.fitted()) {
    const auto share = [&] { return between(0.0, 1.0); };
    out.along = share();
    out.across = share();
    const auto corner = static_cast<int>(random.index(4));
    out.side_a = corner % 2 == 0 ? 1 : -1;
    out.side_b = corner / 2 == 0 ? 1 : -1;
    if (out.fit == Piece::Fit::corner) density /= 4.0;
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

/// One of some dozens of kinds, by all that a piece is.
std::string kind_of(const Piece& piece, const OutlinePrior::Settings& prior) {
  const auto numbers = numbers_of(piece, prior);
  const auto half = [&](std::size_t number, double at) { return numbers[number].value > at ? "1" : "0"; };
  std::string out = std::string(piece.form.family == Form::Family::box ? "box" : "ellipse") + half(0, 0.6) +
                    half(2, 0.3) + half(3, 0.45) + half(4, 0.2);
  if (!piece.hollow) return out;
  if (piece.fitted()) return out + half(14, 0.6) + half(15, 0.5) + half(16, 0.4) + half(17, 0.5);
  return std::string(piece.hole.family == Form::Family::box ? "box" : "ellipse") + " in " +
         (piece.form.family == Form::Family::box ? "box" : "ellipse") + half(3, 0.5) + half(10, 0.15) + half(11, 0.1) +
         half(13, 0.7);
}

TEST(OutlinePrior, HasADensityThatComesToOneAndSaysHowOftenEachKindOfPieceIsDrawn) {
  const int draws = test::brief() ? 400000 : 1000000;
  for (const OutlinePrior::Settings& settings : priors()) {
    const OutlinePrior prior(settings);
    Random random(14, "outline test");
    struct Share {
      double sum = 0.0, squares = 0.0, drawn = 0.0;
    };
    std::map<std::string, Share> kinds;
    Share all;
    for (int i = 0; i < draws; ++i) {
      const auto [piece, density] = drawn_evenly(settings, random);
      const double weight = prior.density(piece) / density;
      if (!(weight > 0.0)) continue;
      for (Share* share : {&all, &kinds[kind_of(piece, settings)]}) {
        share->sum += weight / draws;
        share->squares += weight / draws * weight / draws;
      }
    }
    // Five standard errors, and the normaliser is computed to a thousandth.
    EXPECT_NEAR(all.sum, 1.0, 5.0 * std::sqrt(all.squares) + 1e-3);
    EXPECT_LT(std::sqrt(all.squares), 0.02) << "or it would say little";
    int pieces = 0;
    for (int i = 0; i < draws / 4; ++i) {
      for (const Piece& piece : prior.draw(random)) {
        ++kinds[kind_of(piece, settings)].drawn;
        ++pieces;
        ASSERT_EQ(piece.density, prior.density(piece));
        ASSERT_GT(piece.density, 0.0);
      }
    }
    int compared = 0;
    for (const auto& [kind, share] : kinds) {
      if (share.drawn < 100.0) continue;
      ++compared;
      const double drawn = share.drawn / pieces;
      const double error = std::sqrt(share.squares + drawn / pieces);
      EXPECT_NEAR(drawn, share.sum, 5.0 * error + 1e-3 * drawn) << kind;
    }
    EXPECT_GT(compared, 25);
  }
}

TEST(OutlinePrior, FindsRoomOnAnAreaThatIsHardlyLargerThanTheSmallestPiece) {
  OutlinePrior::Settings settings = common_prior();
  settings.area = {0.0207, 0.0207};
  const OutlinePrior prior(settings);
  ParticleSettings how;
  how.count = 200;
  how.moves = 4;
  Particles belief(prior, how, Random(1, "outline test"));
  for (int i = 0; i < 3; ++i) belief.add({{0.01, 0.01}, 0.0, true});
  int pieces = 0;
  for (const Particle& one : belief.particles()) {
    for (const Piece& piece : one.outline) {
      ++pieces;
      EXPECT_GT(prior.density(piece), 0.0);
      EXPECT_LE(piece.form.reach_x(), 0.5 * 0.0207);
    }
  }
  EXPECT_GT(pieces, 150);
  settings.area = {0.019, 0.2};
  EXPECT_THROW(OutlinePrior{settings}, Error);
}

}  // namespace
}  // namespace palpate::footprints
