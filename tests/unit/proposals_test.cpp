// SPDX-License-Identifier: MIT
// Moves leave the distribution of primitives with an object tap unchanged, and a wrong acceptance ratio of any kind of
// move is detected. The posterior is compared with draws of the prior in sampler_posterior_test.cpp.
#include "primitives/proposals.hpp"
#include "hypothesis_bench.hpp"
#include "primitives/sampler.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <array>
#include <utility>

namespace palpate::footprints {
namespace {

using Kind = Proposal::Kind;

// A standard normal deviation exceeds 5 once in three million times; each test compares forty at most.
constexpr double kRare = 5.0;

Prior::Settings prior_settings(int most, double side) {
  Prior::Settings out = default_prior();
  out.area = {side, side};
  out.most = most;
  return out;
}

std::vector<Touch> touches_over(double side, int count) {
  std::vector<Touch> out = test::disc_touches(count);
  for (Touch& touch : out) touch.place = {touch.place.x * side / 0.23, touch.place.y * side / 0.23};
  return out;
}

/// Alternating labels.
std::vector<Touch> with_alternating_labels(std::vector<Touch> touches) {
  for (std::size_t i = 0; i < touches.size(); ++i) touches[i].on = i % 2 == 0;
  return touches;
}

Taps taps_of(const std::vector<Touch>& touches) {
  Taps out;
  for (const Touch& touch : touches) out.add(touch);
  return out;
}

/// A hypothesis after a proposal.
Hypothesis after(const Proposal& proposal, Hypothesis hypothesis) {
  proposal.apply(proposal.added, hypothesis.primitives);
  hypothesis.push = proposal.push;
  hypothesis.noisy = proposal.noisy;
  return hypothesis;
}

/// A kind of move with a wrong ratio, and its reverse. In this prior most moves of the kind are accepted sometimes: a
/// move that is always accepted would be accepted with a slightly wrong ratio, too.
struct FalseRatio {
  const char* name;
  Kind kind, back;
  double hollow;
  double side;
  double expected;
  double by;
  int proposals;  ///< for each hypothesis, of all kinds
  int hypotheses;
};
void PrintTo(const FalseRatio& one, std::ostream* out) { *out << one.name; }

class Jumps : public testing::TestWithParam<FalseRatio> {
 protected:
  /// The mean change that moves cause in hypotheses of the prior, in standard errors, if the ratio of one kind is `by`
  /// times too large; and the number that changes most.
  std::pair<double, std::string> drift(double by) const {
    const FalseRatio& one = GetParam();
    Prior::Settings settings = prior_settings(8, one.side);
    settings.min_width = 0.015;
    settings.max_length = 0.09;
    settings.expected = one.expected;
    settings.hole_probability = one.hollow;
    const Prior prior(settings);
    Random random(1, "hypothesis jumps test: ratios");
    Drift drift(settings);
    const int hypotheses = test::brief() ? one.hypotheses / 10 : one.hypotheses;
    for (int i = 0; i < hypotheses; ++i) {
      const Hypothesis before = drawn_known(prior, touches_, random);
      Hypothesis moved = before;
      for (int k = 0; k < one.proposals; ++k) move(moved, prior, by, random);
      drift.add(before, moved);
    }
    return drift.deviation();
  }

 private:
  /// Metropolis and Hastings without labels: a proposal is accepted by its ratio alone.
  void move(Hypothesis& hypothesis, const Prior& prior, double by, Random& random) const {
    const FalseRatio& one = GetParam();
    Proposal proposal;
    propose(proposal, hypothesis, prior, taps_of(touches_), random.uniform(), random);
    const double factor = proposal.kind == one.kind ? by : proposal.kind == one.back ? 1.0 : 0.0;
    if (random.uniform() >= proposal.ratio * factor) return;
    const Hypothesis proposed = after(proposal, hypothesis);
    for (const Primitive& primitive : proposed.primitives) {
      if (!has_object_tap(primitive, touches_)) return;
    }
    hypothesis = proposed;
  }

  const std::vector<Touch> touches_ = with_alternating_labels(touches_over(GetParam().side, 8));
};

TEST_P(Jumps, KeepThePriorOnlyWithTheRightRatio) {
  const auto [right, of] = drift(1.0);
  EXPECT_LT(right, kRare) << of;
  if (test::brief()) return;  // few hypotheses do not show it
  for (const double by : {GetParam().by, 1.0 / GetParam().by}) EXPECT_GT(drift(by).first, kRare) << by;
}

INSTANTIATE_TEST_SUITE_P(
    Every, Jumps,
    testing::Values(FalseRatio{"Add", Kind::add, Kind::remove, 0.4, 0.15, 5.0, 0.8, 40, 40000},
                    FalseRatio{"Remove", Kind::remove, Kind::add, 0.2, 0.15, 5.0, 0.8, 40, 20000},
                    FalseRatio{"MakeAHole", Kind::make_hole, Kind::fill_hole, 0.4, 0.15, 5.0, 0.8, 30, 20000},
                    FalseRatio{"FillAHole", Kind::fill_hole, Kind::make_hole, 0.6, 0.15, 5.0, 0.8, 20, 20000},
                    FalseRatio{"Replace", Kind::replace, Kind::replace, 0.45, 0.15, 5.0, 0.8, 200, 40000},
                    FalseRatio{"ChangeForm", Kind::change_form, Kind::change_form, 0.45, 0.15, 5.0, 0.8, 20, 90000}),
    [](const auto& one) { return one.param.name; });

/// A hypothesis with all primitives, those with an object tap and the others, a push, noise, and labels.
struct Joint {
  Hypothesis seen, undiscovered;  ///< push and noise are those of `seen`
  std::vector<Touch> touches;
};

/// Draws labels for hypotheses and moves hypotheses by the labels, in turn (Geweke 2004). Metropolis and Hastings with
/// likelihoods by the definition, and with undiscovered primitives drawn in full.
class Geweke {
 public:
  static constexpr int kTaps = 10;
  static constexpr double kPushes = 0.06;
  static constexpr double kLabelError = 0.1, kFalseContact = 0.05, kNoise = 0.01;

  /// `by`: makes the ratios of pushes so much larger.
  Geweke(const Prior& prior, double by, Random random) : prior_(prior), by_(by), random_(random) {}

  Joint draw() {
    Joint out;
    out.touches = touches_over(0.23, kTaps);
    out.seen.noisy = random_.uniform() < 0.5;
    out.undiscovered = prior_.draw(random_);
    if (random_.uniform() * (1.0 + kPushes * (kTaps - 1)) >= 1.0) {
      Push& push = out.seen.push;
      push.before = 1 + static_cast<int>(random_.index(kTaps - 1));
      push.origin_x = push.origin_y = 0.115;
      push.dx = 0.012 * standard_normal(random_);
      push.dy = 0.012 * standard_normal(random_);
      const double angle = 0.1 * standard_normal(random_);
      push.cosine = std::cos(angle);
      push.sine = std::sin(angle);
    }
    draw_labels(out);
    return out;
  }

  void draw_labels(Joint& one) {
    Hypothesis all = one.seen;
    for (const Primitive& primitive : one.undiscovered.primitives) all.primitives.add(primitive);
    for (std::size_t i = 0; i < kTaps; ++i) {
      one.touches[i].on = true;
      one.touches[i].on = random_.uniform() < probability(one, all, i);
    }
    const Parts parts = parts_of(all, seen_touches(one));
    one.seen.primitives = parts.seen.primitives;
    one.undiscovered = parts.undiscovered;
  }

  void move(Joint& one, int times) {
    for (int i = 0; i < times; ++i) {
      const double which = random_.uniform();
      Joint other = one;
      double ratio = 1.0;
      if (which < 0.05) {
        Proposal proposal;
        propose_noise(proposal, one.seen);
        other.seen = after(proposal, one.seen);
      } else if (which < 0.1) {
        other.undiscovered = drawn_undiscovered(one);
      } else {
        Proposal proposal;
        if (which < 0.4) {
          propose_push(proposal, one.seen, prior_, kTaps, kPushes, random_);
          ratio = by_;
        } else {
          propose(proposal, one.seen, prior_, taps_of(seen_touches(one)), random_.uniform(), random_);
        }
        ratio *= proposal.ratio;
        if (ratio > 0.0) other.seen = after(proposal, one.seen);
      }
      if (!(ratio > 0.0) ||
          other.seen.primitives.size() + other.undiscovered.primitives.size() > prior_.settings().most)
        continue;
      if (!in_order(other)) continue;
      if (random_.uniform() < ratio * likelihood(other) / likelihood(one)) one = other;
    }
  }

 private:
  /// The taps where they would be made after the push.
  static std::vector<Touch> seen_touches(const Joint& one) { return touches_after(one.seen.push, one.touches); }

  double probability(const Joint& one, const Hypothesis& all, std::size_t tap) const {
    const Touch touch = seen_touches(one)[tap];
    double depth = -1.0;
    for (const Primitive& primitive : all.primitives)
      depth = std::max(depth, primitive.depth(touch.place.x, touch.place.y));
    const double inside = probability_inside(depth, one.seen.noisy ? kNoise : 0.0);
    const double on = inside * (1.0 - kLabelError) + (1.0 - inside) * kFalseContact;
    return touch.on ? on : 1.0 - on;
  }

  double likelihood(const Joint& one) const {
    Hypothesis all = one.seen;
    for (const Primitive& primitive : one.undiscovered.primitives) all.primitives.add(primitive);
    double out = 1.0;
    for (std::size_t i = 0; i < kTaps; ++i) out *= probability(one, all, i);
    return out;
  }

  /// Whether each primitive is on its side.
  static bool in_order(const Joint& one) {
    const std::vector<Touch> touches = seen_touches(one);
    const auto has_tap = [&](const Primitive& primitive) { return has_object_tap(primitive, touches); };
    return std::all_of(one.seen.primitives.begin(), one.seen.primitives.end(), has_tap) &&
           std::none_of(one.undiscovered.primitives.begin(), one.undiscovered.primitives.end(), has_tap);
  }

  /// Primitives without an object tap, of a new draw of the prior.
  Hypothesis drawn_undiscovered(const Joint& one) {
    const std::vector<Touch> touches = seen_touches(one);
    return parts_of(prior_.draw(random_), touches).undiscovered;
  }

  Prior prior_;
  double by_;
  Random random_;
};

/// The greatest mean change of draws of the joint distribution by moves and labels, in standard errors.
std::pair<double, std::string> drift_of_the_joint(double by, int draws) {
  Prior::Settings settings = prior_settings(12, 0.23);
  settings.expected = 3.0;
  const Prior prior(settings);
  Geweke chain(prior, by, Random(9, "hypothesis jumps test: the joint"));
  const auto numbers = [&](const Joint& one) {
    double wrong = 0.0, extent = 0.0, on = 0.0;
    for (const Touch& touch : one.touches) {
      on += touch.on ? 1.0 : 0.0;
      wrong += touch.on != one.seen.contains(touch.place.x, touch.place.y) ? 1.0 : 0.0;
    }
    for (const Primitive& primitive : one.seen.primitives) extent += primitive.form.extent();
    const double pushed = one.seen.push ? 1.0 : 0.0;
    const double far = one.seen.push.dx * one.seen.push.dx + one.seen.push.dy * one.seen.push.dy;
    const double angle = one.seen.push.angle();
    return std::array<Number, 14>{{{"primitives", 1.0 * one.seen.primitives.size()},
                                   {"no primitive", one.seen.primitives.size() == 0 ? 1.0 : 0.0},
                                   {"primitives without a tap", 1.0 * one.undiscovered.primitives.size()},
                                   {"holes", 1.0 * holes_of(one.seen)},
                                   {"extent", extent},
                                   {"noise", one.seen.noisy ? 1.0 : 0.0},
                                   {"pushed", pushed},
                                   {"before", 1.0 * one.seen.push.before},
                                   {"dx", one.seen.push.dx},
                                   {"shift squared", far},
                                   {"turn squared", angle * angle},
                                   {"pushed noise", one.seen.noisy ? pushed : 0.0},
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

TEST(Moves, KeepTheJointDistributionOfLabelsPushesAndNoise) {
  const auto [right, of] = drift_of_the_joint(1.0, test::brief() ? 1500 : 15000);
  EXPECT_LT(right, kRare) << of;
  if (test::brief()) return;  // few draws do not show a wrong ratio
  for (const double by : {0.8, 1.0 / 0.8}) EXPECT_GT(drift_of_the_joint(by, 15000).first, kRare) << by;
}

TEST(Moves, KeepTheDensityOfPrimitivesAndChangeOneAtMost) {
  const Prior prior(prior_settings(12, 0.23));
  const Taps taps = taps_of(touches_over(0.23, 12));
  Random random(5, "hypothesis jumps test: primitives");
  std::array<int, 6> changed{};
  for (int i = 0; i < 100000; ++i) {
    const Hypothesis before = prior.draw(random);
    Proposal proposal;
    propose(proposal, before, prior, taps, random.uniform(), random);
    if (!(proposal.ratio > 0.0)) continue;
    ++changed[static_cast<std::size_t>(proposal.kind)];
    ASSERT_LE(proposal.added.size(), 1);
    ASSERT_LE(proposal.removed.size(), 1);
    const Hypothesis now = after(proposal, before);
    ASSERT_EQ(now.primitives.size(), before.primitives.size() + proposal.added.size() - proposal.removed.size());
    for (const Primitive& primitive : now.primitives) ASSERT_EQ(primitive.density, prior.density(primitive));
    ASSERT_FALSE(now.push || now.noisy);
  }
  for (const int count : changed) EXPECT_GT(count, 15) << "of each kind";
}

}  // namespace
}  // namespace palpate::footprints
