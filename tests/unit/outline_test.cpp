// SPDX-License-Identifier: MIT
// Outlines and the belief over them, against the simplest ways to compute the same: lattices, corners and foci, and a
// million draws.
#include "shape/outline.hpp"

#include "shape/particles.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <array>
#include <functional>
#include <map>

namespace palpate::footprints {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr Area kArea{0.23, 0.23};

// All that these tests know of how a belief is made stands here.

Particles particles(int count, double moves, double mistaken, std::uint64_t seed) {
  OutlinePrior::Settings settings;
  settings.area = kArea;
  ParticleSettings how;
  how.count = count;
  how.moves = moves;
  how.mistaken = how.lies = mistaken;
  return {OutlinePrior(settings), how, Random(seed, "outline test")};
}

std::vector<Outline> outlines(const Particles& belief) {
  std::vector<Outline> out;
  for (const Particle& particle : belief.particles()) out.push_back(particle.outline);
  return out;
}

/// Outlines as the prior has them: before any label.
std::vector<Outline> prior_draws(int count, std::uint64_t seed) { return outlines(particles(count, 4, 0.02, seed)); }

std::vector<Piece> pieces(int count, std::uint64_t seed) {
  std::vector<Piece> out;
  for (const Outline& outline : prior_draws(count, seed)) out.push_back(outline.first);
  return out;
}

/// With labels that are wrong as good as every other time none says anything: what is left are the moves.
Particles moved_without_a_word(int count, int touches, std::uint64_t seed) {
  Particles out = particles(count, 4, 0.5 - 1e-9, seed);
  for (const Touch& touch : test::disc_touches(touches)) out.add(touch);
  return out;
}

double direction(const Piece& piece) {
  const double angle = std::atan2(piece.sine, piece.cosine);
  return angle - kPi * std::floor(angle / kPi);
}

/// Every number that says what an outline is, where it lies and how large; -1 for those that it has not.
std::map<std::string, std::function<double(const Outline&)>> numbers() {
  const auto of_second = [](const Outline& o, double value) { return o.kind == Outline::Kind::one ? -1.0 : value; };
  return {
      {"kind", [](const Outline& o) { return static_cast<double>(o.kind); }},
      {"x", [](const Outline& o) { return o.first.x; }},
      {"y", [](const Outline& o) { return o.first.y; }},
      {"direction", [](const Outline& o) { return direction(o.first); }},
      {"a", [](const Outline& o) { return o.first.a; }},
      {"b", [](const Outline& o) { return o.first.b; }},
      {"slenderness", [](const Outline& o) { return o.first.a / o.first.b; }},
      {"a of ellipses", [](const Outline& o) { return o.first.family == Piece::Family::ellipse ? o.first.a : -1; }},
      {"edge", [](const Outline& o) { return std::min(o.first.x - o.first.reach_x(), o.first.y - o.first.reach_y()); }},
      {"second x", [=](const Outline& o) { return of_second(o, o.second.x); }},
      {"second direction", [=](const Outline& o) { return of_second(o, direction(o.second)); }},
      {"second b", [=](const Outline& o) { return of_second(o, o.second.b); }},
      {"hole a", [](const Outline& o) { return o.kind == Outline::Kind::without ? o.second.a : -1.0; }},
      {"distance",
       [=](const Outline& o) { return of_second(o, std::hypot(o.first.x - o.second.x, o.first.y - o.second.y)); }}};
}

bool equal(const Piece& one, const Piece& other) {
  return one.family == other.family && one.x == other.x && one.y == other.y && one.a == other.a && one.b == other.b &&
         one.cosine == other.cosine && one.sine == other.sine;
}

bool equal_outlines(const Outline& one, const Outline& other) {
  return one.kind == other.kind && equal(one.first, other.first) && equal(one.second, other.second);
}

// Up to here.

using Point = std::array<double, 2>;

/// `along` and `across` from the centre, in the piece's own frame.
Point placed(const Piece& o, double along, double across) {
  return {o.x + o.cosine * along - o.sine * across, o.y + o.sine * along + o.cosine * across};
}

/// How far inside of a piece a point is, roughly in metres; negative outside. A box lies on one side of each of its
/// edges, an ellipse where the distances from its foci come to less than its length.
double depth(const Piece& o, const Point& p) {
  if (o.family == Piece::Family::ellipse) {
    const double focus = std::sqrt(o.a * o.a - o.b * o.b);
    const Point one = placed(o, focus, 0.0);
    const Point other = placed(o, -focus, 0.0);
    return 2.0 * o.a - std::hypot(p[0] - one[0], p[1] - one[1]) - std::hypot(p[0] - other[0], p[1] - other[1]);
  }
  const std::array<Point, 4> corners{placed(o, o.a, o.b), placed(o, -o.a, o.b), placed(o, -o.a, -o.b),
                                     placed(o, o.a, -o.b)};
  double out = 1.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Point& from = corners[i];
    const Point& to = corners[(i + 1) % 4];
    const double edge = std::hypot(to[0] - from[0], to[1] - from[1]);
    out = std::min(out, ((to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0])) / edge);
  }
  return out;
}

/// The rim, corners among it.
std::vector<Point> rim(const Piece& o) {
  std::vector<Point> out;
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    const double turn = 2.0 * kPi * i / kSteps;
    if (o.family == Piece::Family::ellipse) out.push_back(placed(o, o.a * std::cos(turn), o.b * std::sin(turn)));
  }
  for (const double one : {-1.0, 1.0}) {
    for (const double other : {-1.0, 1.0})
      if (o.family == Piece::Family::box) out.push_back(placed(o, one * o.a, other * o.b));
  }
  return out;
}

constexpr double kOnTheRim = 1e-12;

TEST(Piece, HoldsWhatItsEdgesOrItsFociSay) {
  const Points places = test::lattice(97, 97);
  for (const Piece& piece : pieces(60, 1)) {
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      const double inside = depth(piece, {places(i, 0), places(i, 1)});
      if (std::abs(inside) > kOnTheRim) {
        ASSERT_EQ(piece.contains(places(i, 0), places(i, 1)), inside > 0.0) << inside;
      }
    }
  }
}

TEST(Piece, ReachesAsFarAsItsRim) {
  for (const Piece& piece : pieces(200, 2)) {
    double x = 0.0;
    double y = 0.0;
    for (const Point& p : rim(piece)) {
      x = std::max(x, std::abs(p[0] - piece.x));
      y = std::max(y, std::abs(p[1] - piece.y));
    }
    // The farthest of 4000 points of an ellipse falls short by half the square of half a step.
    EXPECT_NEAR(piece.reach_x(), x, 1e-7);
    EXPECT_NEAR(piece.reach_y(), y, 1e-7);
  }
}

TEST(Piece, IsCutWhereALineEntersAndLeavesIt) {
  for (const Piece& piece : pieces(100, 3)) {
    for (int row = -60; row <= 60; ++row) {
      const double y = piece.y + row / 50.0 * piece.reach_y();
      const auto [low, high] = piece.cut(y);
      for (int column = -120; column <= 120; ++column) {
        const double x = piece.x + column / 100.0 * piece.reach_x();
        const double inside = depth(piece, {x, y});
        if (std::abs(inside) > kOnTheRim) {
          ASSERT_EQ(low <= x && x <= high, inside > 0.0) << "row " << row << " column " << column;
        }
      }
    }
  }
}

TEST(Piece, OfAnUprightBoxAndACircleIsWhatItIs) {
  const Piece box{Piece::Family::box, 0.1, 0.1, 0.04, 0.02, 1.0, 0.0};
  EXPECT_DOUBLE_EQ(box.cut(0.115).first, 0.06);
  EXPECT_DOUBLE_EQ(box.cut(0.115).second, 0.14);
  EXPECT_GT(box.cut(0.125).first, box.cut(0.125).second) << "beyond it";
  const Piece circle{Piece::Family::ellipse, 0.1, 0.1, 0.05, 0.05, 0.8, 0.6};
  EXPECT_DOUBLE_EQ(circle.cut(0.13).first, 0.06);
  EXPECT_DOUBLE_EQ(circle.cut(0.13).second, 0.14);
  EXPECT_GT(circle.cut(0.1501).first, circle.cut(0.1501).second);
}

TEST(Outline, HoldsWhatItsPiecesSay) {
  const Points places = test::lattice(31, 31);
  std::array<int, 3> seen{};
  for (const Outline& outline : prior_draws(100, 11)) {
    ++seen[static_cast<std::size_t>(outline.kind)];
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      const Point p{places(i, 0), places(i, 1)};
      const double first = depth(outline.first, p);
      const double second = outline.kind == Outline::Kind::one ? -1.0 : depth(outline.second, p);
      if (std::min(std::abs(first), std::abs(second)) < kOnTheRim) continue;
      const bool held =
          outline.kind == Outline::Kind::without ? first > 0.0 && second < 0.0 : std::max(first, second) > 0.0;
      ASSERT_EQ(outline.contains(p[0], p[1]), held);
    }
  }
  for (const int count : seen) EXPECT_GT(count, 10) << "outlines of each kind";
}

TEST(OutlinePrior, FindsRoomOnAnAreaThatIsHardlyLargerThanTheSmallestPiece) {
  OutlinePrior::Settings settings;
  settings.area = {0.0207, 0.0207};
  Particles belief(OutlinePrior(settings), {200, 0.01}, Random(1, "outline test"));
  for (int i = 0; i < 3; ++i) belief.add({{0.01, 0.01}, 0.0, true});
  for (const Particle& one : belief.particles()) EXPECT_GT(OutlinePrior(settings).density(one.outline), 0.0);
  settings.area = {0.019, 0.2};
  EXPECT_THROW(Particles(OutlinePrior(settings), {}, Random(1, "outline test")), Error);
}

TEST(Particles, CountOutlinesOverPlacesAsOneByOne) {
  Particles belief = particles(500, 4, 0.02, 4);
  for (const Touch& touch : test::disc_touches(6)) {
    belief.add(touch);
    for (const auto& [columns, rows] : {std::pair{47, 47}, {31, 7}, {1, 40}, {40, 1}, {1, 1}}) {
      const Points places = test::lattice(columns, rows);
      Eigen::VectorXd inside = Eigen::VectorXd::Zero(places.rows());
      belief.count_inside(places, inside);
      for (Eigen::Index i = 0; i < places.rows(); ++i) {
        const auto one_by_one =
            std::count_if(belief.particles().begin(), belief.particles().end(),
                          [&](const Particle& one) { return one.outline.contains(places(i, 0), places(i, 1)); });
        ASSERT_EQ(inside(i), static_cast<double>(one_by_one)) << columns << " x " << rows << ", place " << i;
      }
    }
  }
}

/// The largest difference of the distributions of two samples of equal size (Kolmogorov and Smirnov).
double distribution_gap(std::vector<double> one, std::vector<double> other) {
  std::sort(one.begin(), one.end());
  std::sort(other.begin(), other.end());
  double worst = 0.0;
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < one.size() && j < other.size()) {
    const double at = std::min(one[i], other[j]);
    while (i < one.size() && one[i] == at) ++i;
    while (j < other.size() && other[j] == at) ++j;
    worst = std::max(worst, std::abs(static_cast<double>(i) - static_cast<double>(j)));
  }
  return worst / static_cast<double>(one.size());
}

TEST(Particles, AreLeftAsThePriorHasThemByMovesWithoutLabels) {
  constexpr int kCount = 20000;
  const Particles moved = moved_without_a_word(kCount, 40, 5);
  EXPECT_GT(moved.acceptance(), 0.2) << "or there would be nothing to see";
  const std::vector<Outline> drawn = prior_draws(kCount, 6);
  // Of samples of n each, sqrt(n / 2) times the gap is above 2.9 once in ten million: fourteen numbers at most so in a
  // million.
  const double most = 2.9 * std::sqrt(2.0 / kCount);
  for (const auto& [name, number] : numbers()) {
    std::vector<double> one;
    std::vector<double> other;
    const std::vector<Outline> after = outlines(moved);
    std::transform(after.begin(), after.end(), std::back_inserter(one), number);
    std::transform(drawn.begin(), drawn.end(), std::back_inserter(other), number);
    EXPECT_LT(distribution_gap(one, other), most) << name;
  }
}

TEST(Particles, ComeToThePosteriorThatAMillionDrawsWeighedByTheirLabelsComeTo) {
  constexpr double kMistaken = 0.05;
  const std::vector<std::pair<Target, bool>> labels{
      {{0.10, 0.12}, true}, {{0.14, 0.12}, true}, {{0.12, 0.17}, false}, {{0.06, 0.10}, false}, {{0.13, 0.07}, false}};
  const Points places = test::lattice(8, 8);
  Eigen::VectorXd exact = Eigen::VectorXd::Zero(places.rows());
  double evidence = 0.0;
  for (int batch = 0; batch < 10; ++batch) {
    for (const Outline& outline : prior_draws(100000, 100 + static_cast<std::uint64_t>(batch))) {
      double weight = 1e-6;
      for (const auto& [place, on] : labels)
        weight *= outline.contains(place.x, place.y) == on ? 1.0 - kMistaken : kMistaken;
      evidence += weight;
      for (Eigen::Index i = 0; i < places.rows(); ++i)
        exact(i) += outline.contains(places(i, 0), places(i, 1)) ? weight : 0.0;
    }
  }
  exact /= evidence;

  constexpr int kRuns = 10;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(places.rows());
  double found_evidence = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    Particles belief = particles(4000, 4, kMistaken, 200 + static_cast<std::uint64_t>(run));
    double product = 1.0;
    for (const auto& [place, on] : labels) product *= belief.add({place, 0.0, on});
    found_evidence += product / kRuns;
    Eigen::VectorXd inside = Eigen::VectorXd::Zero(places.rows());
    belief.count_inside(places, inside);
    mean += inside / (4000.0 * kRuns);
  }
  // Forty thousand outlines, of which one in three is new: 0.5 / sqrt(13000) is 0.004.
  EXPECT_LT((mean - exact).cwiseAbs().maxCoeff(), 0.025);
  EXPECT_GT(exact.maxCoeff(), 0.8) << "the labels say something";
  EXPECT_NEAR(found_evidence / evidence, 1.0, 0.08);
}

TEST(Particles, DoubtALabelAsOftenAsTheDrawsDoThatAreWeighedByAllLabels) {
  ParticleSettings how;
  how.count = 4000;
  how.mistaken = 0.02;
  how.lies = 0.06;
  how.blur = 0.004;
  // The last but one is a lie, or there are two things.
  const std::vector<std::pair<Target, bool>> labels{{{0.10, 0.12}, true},  {{0.14, 0.12}, true},  {{0.12, 0.17}, false},
                                                    {{0.06, 0.10}, false}, {{0.13, 0.07}, false}, {{0.20, 0.20}, true},
                                                    {{0.19, 0.21}, false}};
  const LabelModel models[] = {{how, 0.0}, {how, how.blur}};
  Eigen::VectorXd exact = Eigen::VectorXd::Zero(7);
  double evidence = 0.0;
  for (const Outline& outline : prior_draws(test::brief() ? 200000 : 1000000, 77)) {
    for (const LabelModel& model : models) {
      double weight = 1.0;
      Eigen::VectorXd wrong(7);
      for (Eigen::Index i = 0; i < 7; ++i) {
        const auto& [place, on] = labels[static_cast<std::size_t>(i)];
        // By the definition, without the model's table.
        const double depth = outline.depth(place.x, place.y);
        const double inside =
            &model == &models[0] ? (depth >= 0.0 ? 1.0 : 0.0) : 0.5 * std::erfc(-depth / how.blur / std::sqrt(2.0));
        const double right = on ? inside * (1.0 - how.mistaken) : (1.0 - inside) * (1.0 - how.lies);
        const double lying = on ? (1.0 - inside) * how.lies : inside * how.mistaken;
        weight *= right + lying;
        wrong(i) = lying / (right + lying);
      }
      evidence += weight;
      exact += weight * wrong;
    }
  }
  exact /= evidence;
  constexpr int kRuns = 8;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(7);
  for (int run = 0; run < kRuns; ++run) {
    OutlinePrior::Settings settings;
    settings.area = kArea;
    Particles belief(OutlinePrior(settings), how, Random(300 + static_cast<std::uint64_t>(run), "outline test"));
    for (const auto& [place, on] : labels) belief.add({place, 0.0, on});
    Eigen::VectorXd doubt(7);
    belief.doubt(doubt);
    mean += doubt / kRuns;
  }
  EXPECT_LT((mean - exact).cwiseAbs().maxCoeff(), 0.05) << mean.transpose() << " for " << exact.transpose();
  EXPECT_GT(exact(5), 0.2) << "it is doubted";
}

TEST(Particles, AreDrawnAsOftenAsTheirWeightSaysButForLessThanOneAndOnAverage) {
  constexpr int kCount = 100;
  constexpr int kSeeds = 2000;
  constexpr double kMistaken = 0.2;
  const Target place{0.11, 0.12};
  std::array<double, 3> excess{};  // of the first outline, of one in the middle, of the last
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Particles belief = particles(kCount, 0.0, kMistaken, seed);  // no moves
    const std::vector<Outline> before = outlines(belief);
    const double evidence = belief.add({place, 0.0, true});
    const std::vector<Outline> after = outlines(belief);
    for (std::size_t i = 0; i < before.size(); ++i) {
      const double weight = before[i].contains(place.x, place.y) ? 1.0 - kMistaken : kMistaken;
      const double expected = weight / evidence;  // evidence is the mean weight
      const auto copies = static_cast<double>(std::count_if(
          after.begin(), after.end(), [&](const Outline& one) { return equal_outlines(one, before[i]); }));
      ASSERT_LT(std::abs(copies - expected), 1.0);
      if (i == 0) excess[0] += copies - expected;
      if (i == kCount / 2) excess[1] += copies - expected;
      if (i == kCount - 1) excess[2] += copies - expected;
    }
  }
  // A count that is one of two neighbours has a standard deviation of at most 1/2.
  for (const double one : excess) EXPECT_LT(std::abs(one) / kSeeds, 5.0 * 0.5 / std::sqrt(kSeeds));
}

TEST(Particles, OfOneSeedAreTheSameToTheLastBitAndOfAnotherAreOthers) {
  const auto after = [](std::uint64_t seed) {
    Particles belief = particles(300, 4, 0.02, seed);
    for (const Touch& touch : test::disc_touches(8)) belief.add(touch);
    return outlines(belief);
  };
  const std::vector<Outline> one = after(7);
  EXPECT_TRUE(std::equal(one.begin(), one.end(), after(7).begin(), equal_outlines));
  EXPECT_FALSE(std::equal(one.begin(), one.end(), after(8).begin(), equal_outlines));
}

TEST(Particles, AgreeWithLabelsThatAnOutlineExplains) {
  Particles belief = particles(1000, 4, 0.02, 9);
  for (const Touch& touch : test::disc_touches(25)) belief.add(touch);
  EXPECT_LT(belief.mean_mistakes(), 0.7);
  Particles puzzled = particles(1000, 4, 0.02, 9);
  for (const Touch& touch : test::disorderly_touches(25)) puzzled.add(touch);
  EXPECT_GT(puzzled.mean_mistakes(), 3.0);
}

}  // namespace
}  // namespace palpate::footprints
