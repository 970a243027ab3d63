// SPDX-License-Identifier: MIT
// Exchange between particles: primitives near the latest tap are replaced, and the others stay.
#include "primitives/sampler.hpp"

#include "support/testing.hpp"
#include "support/touches.hpp"

#include <set>
#include <vector>

namespace palpate::footprints {
namespace {

constexpr int kMostPrimitives = ShortList<Primitive>::kMost;

/// Taps, and particles with rows for these taps.
class PartialResamplingBench {
 public:
  explicit PartialResamplingBench(const std::vector<Touch>& touches) {
    for (const Touch& touch : touches) taps_.add(touch);
  }

  Particle with(const std::vector<Form>& forms) const {
    Particle out;
    out.rows.grow(taps_.length());
    for (const Form& form : forms) {
      Primitive primitive;
      primitive.form = form;
      taps_.steps(primitive, exact_, out.rows.row(out.hypothesis.primitives.size()));
      out.hypothesis.primitives.add(primitive);
    }
    return out;
  }

  bool exchange(const Particle& from, Particle& to, int most = kMostPrimitives) const {
    return footprints::resample_partially(from, taps_, most, to);
  }

  /// Expects the rows of its primitives.
  void expect_rows(const Particle& one) const {
    std::vector<Form> forms;
    for (const Primitive& primitive : one.hypothesis.primitives) forms.push_back(primitive.form);
    const Particle again = with(forms);
    for (int i = 0; i < one.hypothesis.primitives.size(); ++i)
      EXPECT_TRUE(std::equal(one.rows.row(i), one.rows.row(i) + taps_.length(), again.rows.row(i)));
  }

 private:
  Taps taps_;
  LabelModel exact_{0.01, 0.01, 0.0};
};

Form box_at(double x, double y, double a = 0.02, double b = 0.02) {
  Form out;
  out.x = x;
  out.y = y;
  out.a = a;
  out.b = b;
  return out;
}

std::vector<double> lefts(const Particle& one) {
  std::vector<double> out;
  for (const Primitive& primitive : one.hypothesis.primitives) out.push_back(primitive.form.x);
  return out;
}

const std::vector<Touch> kTwo{test::touch_at(0.05, 0.05, true), test::touch_at(0.30, 0.30, true),
                              test::touch_at(0.17, 0.17, false), test::touch_at(0.06, 0.06, true)};

TEST(PartialResampling, ReplacesPrimitivesNearTheTapAndKeepsThoseApart) {
  const PartialResamplingBench bench(kTwo);
  const Particle from = bench.with({box_at(0.301, 0.30), box_at(0.052, 0.05), box_at(0.055, 0.055)});
  Particle to = bench.with({box_at(0.049, 0.05), box_at(0.299, 0.30)});
  ASSERT_TRUE(bench.exchange(from, to));
  EXPECT_EQ(lefts(to), (std::vector<double>{0.299, 0.052, 0.055}));
  bench.expect_rows(to);
  ASSERT_TRUE(bench.exchange(bench.with({box_at(0.048, 0.05)}), to));
  EXPECT_EQ(lefts(to), (std::vector<double>{0.299, 0.048}));
  bench.expect_rows(to);
}

TEST(PartialResampling, IsRefusedIfAllPrimitivesBelongTogetherInOneHypothesis) {
  const PartialResamplingBench bench(kTwo);
  const std::vector<Form> apart{box_at(0.05, 0.05), box_at(0.30, 0.30)};
  Form across = box_at(0.175, 0.175, 0.20, 0.02);
  across.turn(kPi / 4.0);
  // One primitive contains taps of both; another one is between two and near both.
  for (const std::vector<Form>& whole :
       {std::vector<Form>{across}, {box_at(0.05, 0.05), box_at(0.17, 0.17, 0.105, 0.105), box_at(0.30, 0.30)}}) {
    Particle to = bench.with(apart);
    EXPECT_FALSE(bench.exchange(bench.with(whole), to));
    EXPECT_EQ(lefts(to), lefts(bench.with(apart)));
    to = bench.with(whole);
    EXPECT_FALSE(bench.exchange(bench.with(apart), to));
    EXPECT_EQ(lefts(to), lefts(bench.with(whole)));
  }
}

TEST(PartialResampling, IsRefusedIfEitherHasAPushForAnotherNoiseAndTooManyPrimitives) {
  const PartialResamplingBench bench(kTwo);
  const Particle to = bench.with({box_at(0.05, 0.05), box_at(0.30, 0.30)});
  const Particle from = bench.with({box_at(0.05, 0.05), box_at(0.055, 0.055), box_at(0.30, 0.30)});
  const auto takes = [&](const auto& change, int most) {
    Particle one = from;
    Particle other = to;
    change(one, other);
    return bench.exchange(one, other, most);
  };
  EXPECT_TRUE(takes([](Particle&, Particle&) {}, 3));
  EXPECT_FALSE(takes([](Particle&, Particle&) {}, 2));
  EXPECT_FALSE(takes([](Particle& one, Particle&) { one.hypothesis.noisy = true; }, 3));
  EXPECT_FALSE(takes([](Particle& one, Particle&) { one.hypothesis.push.before = 1; }, 3));
  EXPECT_FALSE(takes([](Particle&, Particle& other) { other.hypothesis.push.before = 1; }, 3));
}

TEST(PartialResampling, KeepsDistinctHypothesesOfOneObjectWhileAnotherIsTapped) {
  Prior::Settings settings;
  settings.area = {0.4, 0.4};
  SamplerSettings how;
  how.particles = 300;
  how.moves = how.moves_apart = 0.1;
  Sampler belief(Prior(settings), how, Random(3, "exchange test"));
  const auto touch_disc = [&](double x, double y, int from, int until) {
    for (int i = from; i < until; ++i) {
      const double far = 0.02 + 0.01 * (i % 5);
      belief.add(test::touch_at(x + far * std::cos(2.4 * i), y + far * std::sin(2.4 * i), far < 0.035));
    }
  };
  const auto hypotheses_of_first = [&] {
    std::set<double> different;
    for (const Particle& one : belief.particles()) {
      for (const Primitive& primitive : one.hypothesis.primitives) {
        if (primitive.contains(0.1, 0.12)) different.insert(primitive.form.x);
      }
    }
    return different.size();
  };
  touch_disc(0.1, 0.1, 0, 10);
  touch_disc(0.3, 0.3, 0, 10);
  touch_disc(0.3, 0.3, 10, 40);
  EXPECT_GT(2 * hypotheses_of_first(), static_cast<std::size_t>(belief.size()));
}

}  // namespace
}  // namespace palpate::footprints
