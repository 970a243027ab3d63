// SPDX-License-Identifier: MIT
// Outlines that are drawn again take over what a touch tells of, and keep their own of what lies apart.
#include "primitives/exchange.hpp"

#include "outline_bench.hpp"
#include "primitives/particles.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <set>
#include <vector>

namespace palpate::footprints {
namespace {

constexpr int kMost = Outline::kMost;

/// Touches, and particles that see them.
class Desk {
 public:
  explicit Desk(const std::vector<Touch>& touches) {
    for (const Touch& touch : touches) places_.add(touch.place);
    objects_.resize(static_cast<std::size_t>(places_.length()), 0);
    for (std::size_t i = 0; i < touches.size(); ++i) objects_[i] = touches[i].on ? 0xFF : 0;
  }

  Particle with(const std::vector<Form>& forms) const {
    Particle out;
    out.depths.grow_to(places_.length());
    for (const Form& form : forms) {
      Piece piece;
      piece.form = form;
      places_.steps(piece, exact_, out.depths.row(out.outline.size()));
      out.outline.add(piece);
    }
    deepest_of(out.depths.rows().data(), out.outline.size(), places_.length(), out.depths.deepest());
    return out;
  }

  bool take_over(const Particle& from, const Target& here, Particle& to, int most = kMost) const {
    return footprints::take_over(from, here, objects_.data(), most, to);
  }

  /// That its rows are what its pieces come to.
  void expect_rows(const Particle& one) const {
    std::vector<Form> forms;
    for (const Piece& piece : one.outline) forms.push_back(piece.form);
    const Particle again = with(forms);
    for (int i = 0; i < one.outline.size(); ++i)
      EXPECT_TRUE(std::equal(one.depths.row(i), one.depths.row(i) + places_.length(), again.depths.row(i)));
    EXPECT_TRUE(std::equal(one.depths.deepest(), one.depths.deepest() + places_.length(), again.depths.deepest()));
  }

 private:
  Places places_;
  std::vector<LabelModel::Step> objects_;
  LabelModel exact_{0.01, 0.01, 0.0};
};

Form box(double x, double y, double a = 0.02, double b = 0.02) {
  Form out;
  out.x = x;
  out.y = y;
  out.a = a;
  out.b = b;
  return out;
}

std::vector<double> lefts(const Particle& one) {
  std::vector<double> out;
  for (const Piece& piece : one.outline) out.push_back(piece.form.x);
  return out;
}

const std::vector<Touch> kTwo{test::touch_at(0.05, 0.05, true), test::touch_at(0.30, 0.30, true),
                              test::touch_at(0.17, 0.17, false), test::touch_at(0.06, 0.06, true)};

TEST(Exchange, TakesOverWhatATouchTellsOfAndKeepsWhatLiesApart) {
  const Desk desk(kTwo);
  const Particle from = desk.with({box(0.301, 0.30), box(0.052, 0.05), box(0.055, 0.055)});
  Particle to = desk.with({box(0.049, 0.05), box(0.299, 0.30)});
  ASSERT_TRUE(desk.take_over(from, {0.06, 0.06}, to));
  EXPECT_EQ(lefts(to), (std::vector<double>{0.299, 0.052, 0.055}));
  desk.expect_rows(to);
  ASSERT_TRUE(desk.take_over(desk.with({box(0.048, 0.05)}), {0.06, 0.06}, to));
  EXPECT_EQ(lefts(to), (std::vector<double>{0.299, 0.048}));
  desk.expect_rows(to);
}

TEST(Exchange, IsOfAllThatGoesTogetherInEitherOutline) {
  const Desk desk(kTwo);
  const std::vector<Form> apart{box(0.05, 0.05), box(0.30, 0.30)};
  Form across = box(0.175, 0.175, 0.20, 0.02);
  across.turn(kPi / 4.0);
  // One holds touches of both; between the others lies one that comes near each.
  for (const std::vector<Form>& whole :
       {std::vector<Form>{across}, {box(0.05, 0.05), box(0.17, 0.17, 0.105, 0.105), box(0.30, 0.30)}}) {
    Particle to = desk.with(apart);
    EXPECT_FALSE(desk.take_over(desk.with(whole), {0.06, 0.06}, to));
    EXPECT_EQ(lefts(to), lefts(desk.with(apart)));
    to = desk.with(whole);
    EXPECT_FALSE(desk.take_over(desk.with(apart), {0.06, 0.06}, to));
    EXPECT_EQ(lefts(to), lefts(desk.with(whole)));
  }
}

TEST(Exchange, IsNotOfOutlinesThatSeeTouchesUnalikeNorOfMoreThanThereIsRoomFor) {
  const Desk desk(kTwo);
  const Target here{0.06, 0.06};
  const Particle to = desk.with({box(0.05, 0.05), box(0.30, 0.30)});
  const Particle from = desk.with({box(0.05, 0.05), box(0.055, 0.055), box(0.30, 0.30)});
  const auto takes = [&](const auto& change, int most) {
    Particle one = from;
    Particle other = to;
    change(one, other);
    return desk.take_over(one, here, other, most);
  };
  EXPECT_TRUE(takes([](Particle&, Particle&) {}, 3));
  EXPECT_FALSE(takes([](Particle&, Particle&) {}, 2));
  EXPECT_FALSE(takes([](Particle& one, Particle&) { one.blurred = true; }, 3));
  EXPECT_FALSE(takes([](Particle& one, Particle&) { one.push.before = 1; }, 3));
  EXPECT_FALSE(takes([](Particle&, Particle& other) { other.push.before = 1; }, 3));
}

TEST(Exchange, LeavesOfOneObjectAsManyOutlinesAsThereAreHoweverOftenAnotherIsTouched) {
  OutlinePrior::Settings settings;
  settings.area = {0.4, 0.4};
  ParticleSettings how;
  how.count = 300;
  how.moves = how.moves_apart = 0.1;
  Particles belief(OutlinePrior(settings), how, Random(3, "exchange test"));
  const auto touch_disc = [&](double x, double y, int from, int until) {
    for (int i = from; i < until; ++i) {
      const double far = 0.02 + 0.01 * (i % 5);
      belief.add(test::touch_at(x + far * std::cos(2.4 * i), y + far * std::sin(2.4 * i), far < 0.035));
    }
  };
  const auto outlines_of_first = [&] {
    std::set<double> different;
    for (const Particle& one : belief.particles()) {
      for (const Piece& piece : one.outline) {
        if (piece.contains(0.1, 0.12)) different.insert(piece.form.x);
      }
    }
    return different.size();
  };
  touch_disc(0.1, 0.1, 0, 10);
  touch_disc(0.3, 0.3, 0, 10);
  touch_disc(0.3, 0.3, 10, 40);
  EXPECT_GT(2 * outlines_of_first(), static_cast<std::size_t>(belief.size()));
}

}  // namespace
}  // namespace palpate::footprints
