// SPDX-License-Identifier: MIT
// The moves of the belief over outlines leave the distribution as it is that they are to come to: what is drawn from it
// and moved cannot be told from what is drawn; and can be where the ratio of one kind of move is false. Without labels
// it is that of those pieces of the prior that were touched.
#include "outline_bench.hpp"
#include "primitives/particles.hpp"
#include "primitives/steps.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <array>
#include <numeric>
#include <tuple>
#include <utility>

namespace palpate::footprints {
namespace {

using Kind = Proposal::Kind;
/// Of each touch: bit i is set where piece i holds it.
using Holders = std::vector<std::uint16_t>;

// That a standard normal deviation is above 5 happens once in three million times; each test looks at forty at most.
constexpr double kRare = 5.0;

OutlinePrior::Settings prior_settings(int most, double side) {
  OutlinePrior::Settings out;
  out.area = {side, side};
  out.most = most;
  return out;
}

std::vector<Touch> touches_over(double side, int count) {
  std::vector<Touch> out = test::disc_touches(count);
  for (Touch& touch : out) touch.place = {touch.place.x * side / 0.23, touch.place.y * side / 0.23};
  return out;
}

/// Labels by turns, whatever is there.
std::vector<Touch> by_turns(std::vector<Touch> touches) {
  for (std::size_t i = 0; i < touches.size(); ++i) touches[i].on = i % 2 == 0;
  return touches;
}

/// Touches as proposals see them, without a push.
class Made {
 public:
  Seen seen(const std::vector<Touch>& touches) {
    places_ = {};
    for (const Touch& touch : touches) places_.add(touch.place);
    objects_.assign(static_cast<std::size_t>(places_.length()), 0);
    for (std::size_t i = 0; i < touches.size(); ++i) objects_[i] = touches[i].on ? 0xFF : 0;
    return {places_, objects_.data(), static_cast<int>(std::count(objects_.begin(), objects_.end(), 0xFF))};
  }

 private:
  Places places_;
  std::vector<LabelModel::Step> objects_;
};

/// Moves by the book of Metropolis and Hastings: without the short cuts of the belief.
class Chain {
 public:
  Chain(const OutlinePrior& prior, std::vector<Touch> touches, double mistaken, Random random)
      : prior_(prior), touches_(std::move(touches)), mistaken_(mistaken), random_(random) {}

  Random& random() { return random_; }
  const std::vector<Touch>& touches() const { return touches_; }

  /// Draws labels as the outline has them.
  void draw_labels(const Outline& outline) {
    for (Touch& touch : touches_) {
      const bool right = random_.uniform() >= mistaken_;
      touch.on = outline.contains(touch.place.x, touch.place.y) == right;
    }
  }

  /// `times` proposals for the pieces that were touched, each taken or not, the others beside them; `factor` of its
  /// kind is 1, or makes the ratio false, or forbids it.
  template <class Factor>
  void move(Outline& seen, const Outline& unseen, int times, const Factor& factor) {
    const Holders beside = holders_of(unseen);
    Holders holders = holders_of(seen);
    for (int i = 0; i < times; ++i) {
      proposal_.begin({seen, {}});
      if (factor(Kind::change_form) > 0.0 || factor(Kind::split) == 0.0) {
        propose(proposal_, prior_, made_.seen(touches_), random_.uniform(), random_);
      } else {
        propose_one_of_two();
      }
      const double accepted = proposal_.correction * factor(proposal_.kind);
      const double taken = random_.uniform();
      if (!(accepted > 0.0)) continue;
      Holders after = holders_of(proposal_.outline);
      if (!all_touched(proposal_.outline, after)) continue;
      if (taken >= accepted * likelihood(after, beside) / likelihood(holders, beside)) continue;
      seen = proposal_.outline;
      holders = std::move(after);
    }
  }

  /// Draws the pieces that were not touched anew, and takes them or not.
  void draw_unseen(const Outline& seen, Outline& unseen) {
    const Outline other = drawn_if(prior_, random_, [&](const Piece& piece) { return !touched(piece, touches_); });
    const Holders beside = holders_of(seen);
    const double ratio = likelihood(holders_of(other), beside) / likelihood(holders_of(unseen), beside);
    if (random_.uniform() < ratio) unseen = other;
  }

 private:
  /// Among all moves a split or a merge is so rare that hardly anything would be seen of them.
  void propose_one_of_two() {
    const bool splits = random_.uniform() < 0.5;
    proposal_.kind = splits ? Kind::split : Kind::merge;
    splits ? propose_split(proposal_, prior_, random_) : propose_merge(proposal_, prior_, random_);
  }

  Holders holders_of(const Outline& outline) const {
    Holders out;
    for (const Touch& touch : touches_) {
      unsigned held = 0;
      for (int i = 0; i < outline.size(); ++i) held |= outline[i].contains(touch.place.x, touch.place.y) ? 1U << i : 0U;
      out.push_back(static_cast<std::uint16_t>(held));
    }
    return out;
  }
  bool all_touched(const Outline& outline, const Holders& holders) const {
    unsigned seen = 0;
    for (std::size_t i = 0; i < holders.size(); ++i) seen |= touches_[i].on ? holders[i] : 0U;
    return seen + 1 == 1U << outline.size();
  }
  double likelihood(const Holders& holders, const Holders& beside) const {
    double out = 1.0;
    for (std::size_t i = 0; i < holders.size(); ++i)
      out *= ((holders[i] | beside[i]) != 0) == touches_[i].on ? 1.0 - mistaken_ : mistaken_;
    return out;
  }

  OutlinePrior prior_;
  std::vector<Touch> touches_;
  double mistaken_;
  Random random_;
  Proposal proposal_;
  Made made_;
};

/// Or the way back would have to be weighed.
TEST(Steps, AreAsLongEitherWayAndOfAllSizes) {
  const int draws = test::brief() ? 20000 : 200000;
  Random random(7, "outline jumps test: steps");
  std::array<long, 4> coins{};
  double one = 0.0, other = 0.0, both = 0.0, sides = 0.0;
  int longer = 0;   // than six sevenths of the longest
  int shorter = 0;  // than a seventieth
  for (int i = 0; i < draws; ++i) {
    const Steps steps(random);
    ASSERT_LE(std::max(std::abs(steps.one), std::abs(steps.other)), 1.0);
    one += steps.one;
    other += steps.other;
    both += steps.one * steps.other;
    sides += steps.one * (steps.heads ? 1.0 : -1.0);
    longer += std::abs(steps.one) > 6.0 / 7.0 ? 1 : 0;
    shorter += std::abs(steps.one) < 1.0 / 70.0 ? 1 : 0;
    ++coins[(steps.heads ? 2U : 0U) + (steps.also_heads ? 1U : 0U)];
  }
  const double error = 5.0 / std::sqrt(draws);
  EXPECT_NEAR(one / draws, 0.0, error);
  EXPECT_NEAR(other / draws, 0.0, error);
  EXPECT_NEAR(both / draws, 0.0, error);
  EXPECT_NEAR(sides / draws, 0.0, error);
  for (const long coin : coins) EXPECT_NEAR(static_cast<double>(coin) / draws, 0.25, error);
  // Of sixteen factors from 1 down to a twentieth one reaches beyond 6/7; of each a share is short.
  double some_longer = 0.0, some_shorter = 0.0;
  for (int i = 0; i < 16; ++i) {
    const double factor = std::pow(20.0, -i / 15.0);
    some_longer += std::max(0.0, 1.0 - 6.0 / 7.0 / factor) / 16.0;
    some_shorter += 1.0 / 70.0 / factor / 16.0;
  }
  EXPECT_NEAR(static_cast<double>(longer) / draws, some_longer, error);
  EXPECT_NEAR(static_cast<double>(shorter) / draws, some_shorter, error);
}

struct PriorCase {
  const char* name;
  int most;
  double side;
  double expected;
};
void PrintTo(const PriorCase& one, std::ostream* out) { *out << one.name; }

class Priors : public testing::TestWithParam<PriorCase> {
 protected:
  static constexpr int kTouches = 8;
  static OutlinePrior::Settings settings() {
    OutlinePrior::Settings out = prior_settings(GetParam().most, GetParam().side);
    out.expected = GetParam().expected;
    return out;
  }
  static std::vector<Touch> touches() { return by_turns(touches_over(GetParam().side, kTouches)); }
  /// The deviation of these counts of touched pieces from the law of Poisson.
  static double deviation_of_pieces(const OutlinePrior& prior, const std::vector<long>& pieces) {
    constexpr int kDraws = 2000000;
    Random random(6, "outline jumps test: touched");
    const std::vector<Touch> all = touches();
    long held = 0;
    const int draws = test::brief() ? kDraws / 10 : kDraws;
    for (int i = 0; i < draws; ++i) held += touched(prior.draw_piece_or_hollow(random), all) ? 1 : 0;
    const double count = static_cast<double>(std::accumulate(pieces.begin(), pieces.end(), 0L));
    std::vector<double> expected =
        poisson(prior.settings().expected * static_cast<double>(held) / draws, prior.settings().most);
    for (double& one : expected) one *= count;
    return deviation_from(expected, pieces);
  }
};
INSTANTIATE_TEST_SUITE_P(Every, Priors,
                         testing::Values(PriorCase{"FewPieces", 2, 0.23, 2.0}, PriorCase{"ManyPieces", 12, 0.23, 4.0},
                                         PriorCase{"LargeArea", 12, 0.46, 8.0}),
                         [](const auto& one) { return one.param.name; });

/// With labels that are wrong every other time none says anything: what is left are the moves, a million of them.
TEST_P(Priors, OfTouchedPiecesAreLeftAsTheyAreByMovesWithoutLabels) {
  const OutlinePrior prior(settings());
  const int outlines = test::brief() ? 4000 : 50000;
  Tally moved(settings()), drawn(settings());
  Drift drift(settings());
  std::vector<long> pieces(static_cast<std::size_t>(settings().most) + 1, 0);
  Chain chain(prior, touches(), 0.5, Random(3, "outline jumps test: by the book"));
  for (int i = 0; i < outlines; ++i) {
    const Outline before = drawn_and_touched(prior, chain.touches(), chain.random());
    Outline after = before;
    chain.move(after, Outline(), 20, [](Kind) { return 1.0; });
    moved.add(after, chain.random());
    drawn.add(drawn_and_touched(prior, chain.touches(), chain.random()), chain.random());
    drift.add(before, after);
    ++pieces[static_cast<std::size_t>(after.size())];
  }
  EXPECT_LT(deviation_of_pieces(prior, pieces), kRare);
  EXPECT_LT(moved.deviation(drawn).first, kRare) << moved.deviation(drawn).second;
  EXPECT_LT(drift.deviation().first, kRare) << drift.deviation().second;
  EXPECT_GT(drift.moved(), 0.5) << "or there would be nothing to see";
}

/// The same of the belief, with all its short cuts: it finds pieces as they are touched, and moves them until nothing
/// is left of how they were found.
TEST_P(Priors, OfTouchedPiecesAreWhatABeliefComesToWithoutLabels) {
  const OutlinePrior prior(settings());
  ParticleSettings how;
  how.count = 1000;
  how.mistaken = how.lies = 0.5;
  how.heights = false;
  how.moves = how.most_moves = 400;
  const int runs = test::brief() ? 2 : 10;
  Tally moved(settings()), drawn(settings());
  std::vector<long> pieces(static_cast<std::size_t>(settings().most) + 1, 0);
  Random random(3, "outline jumps test");
  const std::vector<Touch> all = touches();
  for (int run = 0; run < runs; ++run) {
    Particles belief(prior, how, Random(static_cast<std::uint64_t>(run), "outline jumps test: moved"));
    for (const Touch& touch : all) belief.add(touch);
    for (const Particle& one : belief.particles()) {
      moved.add(one.outline, random);
      drawn.add(drawn_and_touched(prior, all, random), random);
      ++pieces[static_cast<std::size_t>(one.outline.size())];
    }
  }
  EXPECT_LT(deviation_of_pieces(prior, pieces), kRare);
  EXPECT_LT(moved.deviation(drawn).first, kRare) << moved.deviation(drawn).second;
}

/// A kind of move whose ratio is made false, and the kind that leads back, in a prior by which most moves of the first
/// are neither always taken nor never: what is always taken would be so as well by a ratio that is somewhat false.
struct FalseRatio {
  const char* name;
  Kind kind, back;
  double hollow;
  double side;
  double expected;
  double by;
  int proposals;  ///< for each outline; of all kinds, but for splitting and merging
  int outlines;
};
void PrintTo(const FalseRatio& one, std::ostream* out) { *out << one.name; }

class Jumps : public testing::TestWithParam<FalseRatio> {
 protected:
  /// What moves do on average to outlines as the prior has them, when the ratio of one kind is `by` times too large, in
  /// standard errors; and to which number.
  std::pair<double, std::string> drift(double by) const {
    const FalseRatio& one = GetParam();
    OutlinePrior::Settings settings = prior_settings(8, one.side);
    settings.smallest = 0.015;
    settings.largest = 0.09;
    settings.expected = one.expected;
    settings.hollow = one.hollow;
    const OutlinePrior prior(settings);
    Chain chain(prior, by_turns(touches_over(one.side, 8)), 0.5, Random(1, "outline jumps test: ratios"));
    Drift drift(settings);
    const int outlines = test::brief() ? one.outlines / 10 : one.outlines;
    for (int i = 0; i < outlines; ++i) {
      const Outline before = drawn_and_touched(prior, chain.touches(), chain.random());
      Outline after = before;
      chain.move(after, Outline(), one.proposals, [&](Kind kind) {
        return kind == one.kind ? by : kind == one.back ? 1.0 : 0.0;
      });
      drift.add(before, after);
    }
    return drift.deviation();
  }
};

TEST_P(Jumps, HaveARatioThatIsSeenToBeFalseWhereItIsSomewhatLargerOrSmaller) {
  const auto [right, of] = drift(1.0);
  EXPECT_LT(right, kRare) << of;
  if (test::brief()) return;  // few outlines do not show it
  for (const double by : {GetParam().by, 1.0 / GetParam().by}) EXPECT_GT(drift(by).first, kRare) << by;
}

INSTANTIATE_TEST_SUITE_P(
    Every, Jumps,
    testing::Values(FalseRatio{"Add", Kind::add, Kind::remove, 0.4, 0.15, 5.0, 0.8, 40, 40000},
                    FalseRatio{"Remove", Kind::remove, Kind::add, 0.2, 0.15, 5.0, 0.8, 40, 20000},
                    FalseRatio{"MakeAHole", Kind::make_hole, Kind::fill_hole, 0.4, 0.15, 5.0, 0.8, 30, 20000},
                    FalseRatio{"FillAHole", Kind::fill_hole, Kind::make_hole, 0.6, 0.15, 5.0, 0.8, 20, 20000},
                    FalseRatio{"Split", Kind::split, Kind::merge, 0.0, 0.1, 5.0, 0.5, 20, 15000},
                    FalseRatio{"Merge", Kind::merge, Kind::split, 0.0, 0.1, 5.0, 0.5, 20, 15000},
                    FalseRatio{"Replace", Kind::replace, Kind::replace, 0.45, 0.15, 5.0, 0.8, 200, 40000},
                    FalseRatio{"ChangeForm", Kind::change_form, Kind::change_form, 0.45, 0.15, 5.0, 0.8, 20, 90000}),
    [](const auto& one) { return one.param.name; });

/// Pieces that were touched, together with all labels.
class Joint {
 public:
  explicit Joint(const OutlinePrior::Settings& prior) : outlines_(prior) {}

  void add(const Outline& seen, const std::vector<Touch>& touches, Random& lot) {
    std::size_t on = 0;
    std::size_t wrong = 0;
    for (const Touch& touch : touches) {
      on += touch.on ? 1 : 0;
      wrong += seen.contains(touch.place.x, touch.place.y) == touch.on ? 0 : 1;
    }
    outlines_.add(seen, lot);
    ++labels_[on * kMost + wrong];
    ++pieces_[on * kMost + static_cast<std::size_t>(seen.size())];
  }

  std::pair<double, std::string> deviation(const Joint& other) const {
    return std::max({outlines_.deviation(other.outlines_),
                     {deviation_of_counts(labels_, other.labels_), "labels"},
                     {deviation_of_counts(pieces_, other.pieces_), "pieces and labels"}});
  }

 private:
  static constexpr std::size_t kMost = 13;
  Tally outlines_;
  std::vector<long> labels_ = std::vector<long>(kMost * kMost, 0);
  std::vector<long> pieces_ = std::vector<long>(kMost * kMost, 0);
};

constexpr int kTouches = 10;

/// Outlines of the prior with labels drawn for them.
Joint drawn_together(const OutlinePrior& prior, double mistaken, int count) {
  Joint out(prior.settings());
  Chain chain(prior, touches_over(0.23, kTouches), mistaken, Random(2, "outline jumps test: drawn together"));
  for (int i = 0; i < count; ++i) {
    const Outline outline = prior.draw(chain.random());
    chain.draw_labels(outline);
    out.add(parts_of(outline, chain.touches()).seen, chain.touches(), chain.random());
  }
  return out;
}

// Geweke (2004): what draws outlines by the labels and labels by the outlines, in turn, comes to both together.
TEST(Moves, AndLabelsDrawnInTurnComeToOutlinesWithTheirLabels) {
  constexpr double kMistaken = 0.1;
  const OutlinePrior prior(prior_settings(12, 0.23));
  const int count = test::brief() ? 2000 : 20000;
  Joint in_turn(prior.settings());
  Chain chain(prior, touches_over(0.23, kTouches), kMistaken, Random(1, "outline jumps test: in turn"));
  for (int i = 0; i < count; ++i) {
    Outline outline = prior.draw(chain.random());
    for (int round = 0; round < 8; ++round) {
      chain.draw_labels(outline);
      Parts parts = parts_of(outline, chain.touches());
      chain.draw_unseen(parts.seen, parts.unseen);
      chain.move(parts.seen, parts.unseen, 15, [](Kind) { return 1.0; });
      outline = parts.seen;
      for (const Piece& piece : parts.unseen) {
        if (outline.size() < Outline::kMost) outline.add(piece);
      }
    }
    in_turn.add(parts_of(outline, chain.touches()).seen, chain.touches(), chain.random());
  }
  const auto [deviation, of] = in_turn.deviation(drawn_together(prior, kMistaken, count));
  EXPECT_LT(deviation, kRare) << of;
}

// The same of the belief: a single outline is never drawn anew, so that it is moved by the labels and nothing else, and
// found by them; a label is what the outline and all that was not seen say.
TEST(Moves, OfABeliefAndLabelsDrawnInTurnComeToOutlinesWithTheirLabels) {
  constexpr double kMistaken = 0.05;
  const OutlinePrior prior(prior_settings(12, 0.23));
  const int count = test::brief() ? 300 : 1500;
  Joint in_turn(prior.settings());
  Random random(4, "outline jumps test: labels");
  ParticleSettings how;
  how.count = 1;
  how.mistaken = how.lies = kMistaken;
  how.heights = false;
  std::vector<Touch> touches = touches_over(0.23, kTouches);
  Points places(2, 2);  // the same twice: what is no lattice is asked one by one, which is quicker here
  Eigen::VectorXd inside(2);
  for (int i = 0; i < count; ++i) {
    Particles belief(prior, how, Random(static_cast<std::uint64_t>(i), "outline jumps test: a belief"));
    for (Touch& touch : touches) {
      places << touch.place.x, touch.place.y, touch.place.x, touch.place.y;
      belief.probability(places, inside);
      touch.on = (random.uniform() < inside(0)) == (random.uniform() >= kMistaken);
      belief.add(touch);
    }
    in_turn.add(belief.particles()[0].outline, touches, random);
  }
  const auto [deviation, of] = in_turn.deviation(drawn_together(prior, kMistaken, count));
  EXPECT_LT(deviation, kRare) << of;
}

TEST(Moves, SayWhichPiecesStayAndKeepTheDensityOfPieces) {
  const OutlinePrior prior(prior_settings(12, 0.23));
  const std::vector<Touch> touches = touches_over(0.23, 12);
  Made made;
  Random random(5, "outline jumps test: pieces");
  std::array<int, 8> changed{};
  const auto equal = [](const Piece& one, const Piece& other) {
    const auto numbers = [](const Piece& piece) {
      const auto of = [](const Form& form) {
        return std::tuple(form.family, form.x, form.y, form.a, form.b, form.cosine, form.sine);
      };
      return std::tuple(of(piece.form), piece.hollow, of(piece.hollow ? piece.hole : Form{}));
    };
    return numbers(one) == numbers(other);
  };
  for (int i = 0; i < 100000; ++i) {
    const Outline before = prior.draw(random);
    Proposal proposal;
    proposal.begin({before, {}});
    propose(proposal, prior, made.seen(touches), random.uniform(), random);
    if (!(proposal.correction > 0.0)) continue;
    ++changed[static_cast<std::size_t>(proposal.kind)];
    std::array<bool, Outline::kMost> stays{};
    for (int k = 0; k < proposal.outline.size(); ++k) {
      const Piece& piece = proposal.outline[k];
      ASSERT_EQ(piece.density, prior.density(piece));
      const int was = proposal.was[static_cast<std::size_t>(k)];
      if (was == Proposal::kNew) continue;
      ASSERT_TRUE(was < before.size() && equal(piece, before[was])) << static_cast<int>(proposal.kind);
      ASSERT_FALSE(std::exchange(stays[static_cast<std::size_t>(was)], true)) << static_cast<int>(proposal.kind);
    }
    ASSERT_EQ(proposal.since, proposal.until);
  }
  for (const int count : changed) EXPECT_GT(count, 15) << "of each kind";
}

}  // namespace
}  // namespace palpate::footprints
