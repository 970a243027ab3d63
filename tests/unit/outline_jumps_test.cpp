// SPDX-License-Identifier: MIT
// Moves of the belief over outlines leave the distribution of touched primitives unchanged, and a wrong acceptance
// ratio of any kind of move is seen. The posterior is compared with draws of the prior in outline_posterior_test.cpp.
#include "outline_bench.hpp"
#include "primitives/particles.hpp"
#include "primitives/steps.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <array>
#include <tuple>
#include <utility>

namespace palpate::footprints {
namespace {

using Kind = Proposal::Kind;

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
  /// The mean change that moves cause in outlines of the prior, in standard errors, if the ratio of one kind is `by`
  /// times too large; and the number that changes most.
  std::pair<double, std::string> drift(double by) const {
    const FalseRatio& one = GetParam();
    OutlinePrior::Settings settings = prior_settings(8, one.side);
    settings.smallest = 0.015;
    settings.largest = 0.09;
    settings.expected = one.expected;
    settings.hollow = one.hollow;
    const OutlinePrior prior(settings);
    Random random(1, "outline jumps test: ratios");
    Drift drift(settings);
    const int outlines = test::brief() ? one.outlines / 10 : one.outlines;
    for (int i = 0; i < outlines; ++i) {
      const Outline before = drawn_and_touched(prior, touches_, random);
      Outline after = before;
      for (int k = 0; k < one.proposals; ++k) move(after, prior, by, random);
      drift.add(before, after);
    }
    return drift.deviation();
  }

 private:
  /// Metropolis and Hastings without labels: a proposal is accepted by its ratio alone.
  void move(Outline& outline, const OutlinePrior& prior, double by, Random& random) const {
    const FalseRatio& one = GetParam();
    Proposal proposal;
    proposal.begin({outline, {}});
    // Among all moves a split or a merge is so rare that hardly anything would be seen of them.
    if (one.kind == Kind::split || one.kind == Kind::merge) {
      const bool splits = random.uniform() < 0.5;
      proposal.kind = splits ? Kind::split : Kind::merge;
      splits ? propose_split(proposal, prior, random) : propose_merge(proposal, prior, random);
    } else {
      Made made;
      propose(proposal, prior, made.seen(touches_), random.uniform(), random);
    }
    const double factor = proposal.kind == one.kind ? by : proposal.kind == one.back ? 1.0 : 0.0;
    if (random.uniform() >= proposal.correction * factor) return;
    for (const Piece& piece : proposal.outline) {
      if (!touched(piece, touches_)) return;
    }
    outline = proposal.outline;
  }

  const std::vector<Touch> touches_ = by_turns(touches_over(GetParam().side, 8));
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

/// A hypothesis with all primitives, those with an object tap and the others, a push, noise, and labels.
struct Joint {
  Outline seen, unseen;
  Push push;
  bool noisy = false;
  std::vector<Touch> touches;
};

/// Draws labels for hypotheses and moves hypotheses by the labels, in turn (Geweke 2004). Metropolis and Hastings with
/// likelihoods by the definition, and with what no tap has touched drawn in full.
class Geweke {
 public:
  static constexpr int kTaps = 10;
  static constexpr double kPushes = 0.06;
  static constexpr double kMistaken = 0.1, kLies = 0.05, kNoise = 0.01;

  /// `by`: makes the ratios of pushes so much larger.
  Geweke(const OutlinePrior& prior, double by, Random random) : prior_(prior), by_(by), random_(random) {}

  Joint draw() {
    Joint out;
    out.touches = touches_over(0.23, kTaps);
    out.noisy = random_.uniform() < 0.5;
    out.unseen = prior_.draw(random_);
    if (random_.uniform() * (1.0 + kPushes * (kTaps - 1)) >= 1.0) {
      out.push.before = 1 + static_cast<int>(random_.index(kTaps - 1));
      out.push.origin_x = out.push.origin_y = 0.115;
      out.push.dx = 0.012 * normal(random_);
      out.push.dy = 0.012 * normal(random_);
      const double angle = 0.1 * normal(random_);
      out.push.cosine = std::cos(angle);
      out.push.sine = std::sin(angle);
    }
    draw_labels(out);
    return out;
  }

  void draw_labels(Joint& one) {
    Outline all = one.seen;
    for (const Piece& piece : one.unseen) all.add(piece);
    for (std::size_t i = 0; i < kTaps; ++i) {
      one.touches[i].on = true;
      one.touches[i].on = random_.uniform() < probability(one, all, i);
    }
    std::tie(one.seen, one.unseen) = std::pair(Outline(), Outline());
    for (const Piece& piece : all) (touched(piece, seen_touches(one)) ? one.seen : one.unseen).add(piece);
  }

  void move(Joint& one, int times) {
    for (int i = 0; i < times; ++i) {
      const double which = random_.uniform();
      Joint other = one;
      double ratio = 1.0;
      if (which < 0.05) {
        other.noisy = !one.noisy;
      } else if (which < 0.1) {
        other.unseen = drawn_unseen(one);
      } else {
        Proposal proposal;
        proposal.begin({one.seen, one.push});
        if (which < 0.4) {
          propose_push(proposal, prior_, kTaps, kPushes, random_);
          ratio = by_;
        } else {
          const std::vector<Touch> touches = seen_touches(one);
          propose(proposal, prior_, made_.seen(touches), random_.uniform(), random_);
        }
        ratio *= proposal.correction;
        other.seen = proposal.outline;
        other.push = proposal.push;
      }
      if (!(ratio > 0.0) || other.seen.size() + other.unseen.size() > prior_.settings().most) continue;
      if (!in_order(other)) continue;
      if (random_.uniform() < ratio * likelihood(other) / likelihood(one)) one = other;
    }
  }

 private:
  /// The taps where they would be made after the push.
  static std::vector<Touch> seen_touches(const Joint& one) {
    std::vector<Touch> out = one.touches;
    for (int i = 0; i < one.push.before; ++i) {
      Target& place = out[static_cast<std::size_t>(i)].place;
      place = one.push.now(place);
    }
    return out;
  }

  double probability(const Joint& one, const Outline& all, std::size_t tap) const {
    const Touch touch = seen_touches(one)[tap];
    double depth = -1.0;
    for (const Piece& piece : all) depth = std::max(depth, piece.depth(touch.place.x, touch.place.y));
    const double inside = one.noisy ? 0.5 * std::erfc(-depth / kNoise / std::sqrt(2.0)) : (depth >= 0.0 ? 1.0 : 0.0);
    const double on = inside * (1.0 - kMistaken) + (1.0 - inside) * kLies;
    return touch.on ? on : 1.0 - on;
  }

  double likelihood(const Joint& one) const {
    Outline all = one.seen;
    for (const Piece& piece : one.unseen) all.add(piece);
    double out = 1.0;
    for (std::size_t i = 0; i < kTaps; ++i) out *= probability(one, all, i);
    return out;
  }

  /// Whether each primitive is on its side.
  static bool in_order(const Joint& one) {
    const std::vector<Touch> touches = seen_touches(one);
    const auto is_touched = [&](const Piece& piece) { return touched(piece, touches); };
    return std::all_of(one.seen.begin(), one.seen.end(), is_touched) &&
           std::none_of(one.unseen.begin(), one.unseen.end(), is_touched);
  }

  /// Primitives without an object tap, of a new draw of the prior.
  Outline drawn_unseen(const Joint& one) {
    const std::vector<Touch> touches = seen_touches(one);
    return parts_of(prior_.draw(random_), touches).unseen;
  }

  OutlinePrior prior_;
  double by_;
  Random random_;
  Made made_;
};

/// What moves and labels do on average to draws of the joint distribution, in standard errors.
std::pair<double, std::string> drift_of_the_joint(double by, int draws) {
  OutlinePrior::Settings settings = prior_settings(12, 0.23);
  settings.expected = 3.0;
  const OutlinePrior prior(settings);
  Geweke chain(prior, by, Random(9, "outline jumps test: the joint"));
  const auto numbers = [&](const Joint& one) {
    double wrong = 0.0, extent = 0.0, on = 0.0;
    for (const Touch& touch : one.touches) {
      on += touch.on ? 1.0 : 0.0;
      wrong += touch.on != one.seen.contains(touch.place.x, touch.place.y) ? 1.0 : 0.0;
    }
    for (const Piece& piece : one.seen) extent += piece.form.extent();
    const double pushed = one.push ? 1.0 : 0.0;
    const double far = one.push.dx * one.push.dx + one.push.dy * one.push.dy;
    const double angle = one.push.angle();
    return std::array<Number, 14>{{{"primitives", 1.0 * one.seen.size()},
                                   {"no primitive", one.seen.size() == 0 ? 1.0 : 0.0},
                                   {"primitives without a tap", 1.0 * one.unseen.size()},
                                   {"holes", 1.0 * holes_of(one.seen)},
                                   {"extent", extent},
                                   {"noise", one.noisy ? 1.0 : 0.0},
                                   {"pushed", pushed},
                                   {"before", 1.0 * one.push.before},
                                   {"dx", one.push.dx},
                                   {"shift squared", far},
                                   {"turn squared", angle * angle},
                                   {"pushed noise", one.noisy ? pushed : 0.0},
                                   {"objects", on},
                                   {"contradictions", wrong}}};
  };
  std::array<double, 14> sums{}, squares{};
  std::pair<double, std::string> out{0.0, ""};
  for (int i = 0; i < draws; ++i) {
    Joint one = chain.draw();
    const auto before = numbers(one);
    for (int round = 0; round < 4; ++round) {
      chain.move(one, 25);
      chain.draw_labels(one);
    }
    const auto after = numbers(one);
    for (std::size_t k = 0; k < sums.size(); ++k) {
      const double change = after[k].value - before[k].value;
      sums[k] += change;
      squares[k] += change * change;
    }
  }
  for (std::size_t k = 0; k < sums.size(); ++k)
    out = std::max(out, {std::abs(sums[k]) / std::sqrt(squares[k]), numbers(chain.draw())[k].name});
  return out;
}

TEST(Moves, WithPushesAndNoiseAndLabelsInTurnLeaveTheJointDistributionAsItIs) {
  const auto [right, of] = drift_of_the_joint(1.0, test::brief() ? 1500 : 15000);
  EXPECT_LT(right, kRare) << of;
  if (test::brief()) return;  // few draws do not show a wrong ratio
  for (const double by : {0.8, 1.0 / 0.8}) EXPECT_GT(drift_of_the_joint(by, 15000).first, kRare) << by;
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
