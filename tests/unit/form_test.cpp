// SPDX-License-Identifier: MIT
// Boxes and ellipses, against the simplest ways to compute the same: corners and foci.
#include "primitives/form.hpp"
#include "primitives/forms.hpp"

#include "outline_bench.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

namespace palpate::footprints {
namespace {

/// Forms and holes as the prior has them.
std::vector<Form> forms(std::size_t count, std::uint64_t seed) {
  OutlinePrior::Settings settings;
  settings.area = {0.23, 0.23};
  const OutlinePrior prior(settings);
  Random random(seed, "form test");
  std::vector<Form> out;
  while (out.size() < count) {
    Piece piece = prior.draw_piece(random);
    prior.draw_hole(piece, random);
    out.push_back(piece.form);
    out.push_back(piece.hole);
  }
  return out;
}

/// The rim, corners among it.
std::vector<Point> rim(const Form& o) {
  std::vector<Point> out;
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    const double turn = 2.0 * kPi * i / kSteps;
    if (o.family == Form::Family::ellipse) out.push_back(placed(o, o.a * std::cos(turn), o.b * std::sin(turn)));
  }
  for (const double one : {-1.0, 1.0}) {
    for (const double other : {-1.0, 1.0})
      if (o.family == Form::Family::box) out.push_back(placed(o, one * o.a, other * o.b));
  }
  return out;
}

TEST(Form, HoldsWhatItsEdgesOrItsFociSay) {
  const Points places = test::lattice(97, 97);
  for (const Form& form : forms(60, 1)) {
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      const double inside = inside_of(form, {places(i, 0), places(i, 1)});
      if (std::abs(inside) <= kOnTheRim) continue;
      ASSERT_EQ(form.contains(places(i, 0), places(i, 1)), inside > 0.0) << inside;
      ASSERT_EQ(form.depth(places(i, 0), places(i, 1)) > 0.0, inside > 0.0) << inside;
    }
  }
}

TEST(Form, ReachesAsFarAsItsRim) {
  for (const Form& form : forms(200, 2)) {
    double x = 0.0, y = 0.0, radius = 0.0;
    for (const Point& p : rim(form)) {
      x = std::max(x, std::abs(p[0] - form.x));
      y = std::max(y, std::abs(p[1] - form.y));
      radius = std::max(radius, std::hypot(p[0] - form.x, p[1] - form.y));
    }
    // The farthest of 4000 points of an ellipse falls short by half the square of half a step.
    EXPECT_NEAR(form.reach_x(), x, 1e-7);
    EXPECT_NEAR(form.reach_y(), y, 1e-7);
    EXPECT_GE(form.radius(), radius - 1e-12);
  }
}

TEST(Form, AmongManyMeetsWhatItMeetsAlone) {
  const std::vector<Form> all = forms(301, 6);
  Forms many;
  for (const Form& form : all) many.add(form);
  ASSERT_EQ(many.size(), all.size());
  for (const Form& other : forms(50, 7)) {
    std::vector<std::uint8_t> met;
    many.mark_met(other, false, met);
    for (std::size_t i = 0; i < all.size(); ++i) ASSERT_EQ(met[i] != 0, meet(other, all[i])) << i;
    many.mark_met(all[7], true, met);
    for (std::size_t i = 0; i < all.size(); ++i)
      ASSERT_EQ(met[i] != 0, meet(other, all[i]) || meet(all[7], all[i])) << i;
    many.mark_met(other, false, met);
    for (std::size_t i = 0; i < all.size(); ++i) ASSERT_EQ(met[i] != 0, meet(other, all[i])) << i;
  }
}

TEST(Form, IsCutWhereALineEntersAndLeavesIt) {
  constexpr int kRows = 121;
  constexpr int kColumns = 241;
  for (const Form& form : forms(100, 3)) {
    const double x0 = form.x - 1.2 * form.reach_x();
    const double y0 = form.y - 1.2 * form.reach_y();
    const double step_x = 0.01 * form.reach_x();
    const double step_y = 0.02 * form.reach_y();
    std::array<int, kRows> begins{};
    std::array<int, kRows> ends{};
    Cuts(form).scaled(x0, step_x, y0, step_y).rows(0, kRows, kColumns, begins.data(), ends.data());
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        const double inside = inside_of(form, {x0 + column * step_x, y0 + row * step_y});
        if (std::abs(inside) <= kOnTheRim) continue;
        const auto at = static_cast<std::size_t>(row);
        ASSERT_EQ(begins[at] <= column && column<ends[at], inside> 0.0) << "row " << row << " column " << column;
      }
    }
  }
}

/// Of the cut of a form at one place along y: the first millimetre that it holds the middle of, and the first beyond.
std::pair<int, int> millimetres(const Form& form, double y) {
  std::pair<int, int> out;
  Cuts(form).scaled(0.0005, 0.001, y, 1.0).rows(0, 1, 230, &out.first, &out.second);
  return out;
}

TEST(Form, OfAnUprightBoxAndACircleIsWhatItIs) {
  const Form box{Form::Family::box, 0.1, 0.1, 0.04, 0.02, 1.0, 0.0};
  EXPECT_EQ(millimetres(box, 0.115), std::pair(60, 140));
  EXPECT_GT(millimetres(box, 0.125).first, millimetres(box, 0.125).second) << "beyond it";
  EXPECT_DOUBLE_EQ(box.depth(0.13, 0.1), 0.01);
  EXPECT_DOUBLE_EQ(box.extent(), 0.08 * 0.04);
  const Form circle{Form::Family::ellipse, 0.1, 0.1, 0.05, 0.05, 0.8, 0.6};
  EXPECT_EQ(millimetres(circle, 0.13), std::pair(60, 140));
  EXPECT_GT(millimetres(circle, 0.1501).first, millimetres(circle, 0.1501).second);
  EXPECT_NEAR(circle.depth(0.1, 0.16), -0.01, 2e-3) << "to first order";
  EXPECT_DOUBLE_EQ(circle.extent(), kPi * 0.05 * 0.05);
}

TEST(Form, IsAsDeepNearItsRimAsThatIsFar) {
  for (const Form& form : forms(200, 4)) {
    for (int i = 0; i < 40; ++i) {
      const double turn = 2.0 * kPi * (i + 0.5) / 40.0;
      const double c = std::cos(turn);
      const double s = std::sin(turn);
      // Of an ellipse by its normal; of a box from the middle third of a side.
      const bool ellipse = form.family == Form::Family::ellipse;
      const Point at = ellipse                     ? Point{form.a * c, form.b * s}
                       : std::abs(c) > std::abs(s) ? Point{std::copysign(form.a, c), form.b * s / 3.0}
                                                   : Point{form.a * c / 3.0, std::copysign(form.b, s)};
      Point normal = ellipse                     ? Point{form.b * c, form.a * s}
                     : std::abs(c) > std::abs(s) ? Point{std::copysign(1.0, c), 0.0}
                                                 : Point{0.0, std::copysign(1.0, s)};
      const double length = std::hypot(normal[0], normal[1]);
      // So far that an ellipse bends by a hundredth of it.
      const double far = 0.02 * form.b * form.b / form.a;
      for (const double depth : {-far, far}) {
        const Point p = placed(form, at[0] - depth * normal[0] / length, at[1] - depth * normal[1] / length);
        ASSERT_NEAR(form.depth(p[0], p[1]), depth, 0.05 * far);
      }
    }
  }
}

TEST(Form, IsBeyondACircleAboutItNoNearerThanThat) {
  Random random(7, "form test: beyond");
  for (const Form& form : forms(300, 6)) {
    for (int i = 0; i < 300; ++i) {
      const double angle = 2.0 * kPi * random.uniform();
      const double beyond = 0.05 * random.uniform();
      const double far = form.radius() + beyond;
      ASSERT_LE(form.depth(form.x + far * std::cos(angle), form.y + far * std::sin(angle)), -beyond + 1e-12);
    }
  }
  const Form box{Form::Family::box, 0.1, 0.1, 0.04, 0.02, 1.0, 0.0};
  EXPECT_NEAR(box.depth(0.143, 0.124), -0.005, 1e-15) << "from a corner";
}

TEST(Form, KeepsWhatItHoldsWhenItsAxesAreNamedAgainAndTurnsFromXToY) {
  for (const Form& form : forms(50, 5)) {
    Form other = form;
    std::swap(other.a, other.b);
    other.turn(0.5 * kPi);
    Form again = other;
    again.order_axes();
    EXPECT_LE(again.b, again.a);
    Random random(6, "form test: places");
    for (int i = 0; i < 500; ++i) {
      const Point p =
          placed(form, 1.2 * form.a * (2.0 * random.uniform() - 1.0), 1.2 * form.b * (2.0 * random.uniform() - 1.0));
      if (std::abs(inside_of(form, p)) < 1e-9) continue;
      ASSERT_EQ(other.contains(p[0], p[1]), form.contains(p[0], p[1]));
      ASSERT_EQ(again.contains(p[0], p[1]), form.contains(p[0], p[1]));
    }
  }
  Form quarter{Form::Family::box, 0.0, 0.0, 0.04, 0.02, 1.0, 0.0};
  quarter.turn(kPi / 6.0);
  EXPECT_TRUE(quarter.contains(0.039 * std::cos(kPi / 6.0), 0.039 * std::sin(kPi / 6.0)));
  EXPECT_FALSE(quarter.contains(0.039 * std::cos(kPi / 6.0), -0.039 * std::sin(kPi / 6.0)));
}

}  // namespace
}  // namespace palpate::footprints
