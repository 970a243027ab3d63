// SPDX-License-Identifier: MIT
// Boxes and ellipses, against corners, foci and rims.
#include "primitives/coverage.hpp"
#include "primitives/hypothesis.hpp"

#include "hypothesis_bench.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

namespace palpate::footprints {
namespace {

/// Forms and holes as the prior has them.
std::vector<Form> forms(std::size_t count, std::uint64_t seed) {
  const Prior prior(default_prior());
  Random random(seed, "form test");
  std::vector<Form> out;
  while (out.size() < count) {
    Primitive primitive = prior.draw_whole(random);
    prior.draw_hole(primitive, random);
    out.push_back(primitive.form);
    out.push_back(primitive.hole);
  }
  return out;
}

/// Points of the rim of an ellipse, or the corners of a box.
std::vector<Point> rim(const Form& o, int steps) {
  std::vector<Point> out;
  for (int i = 0; i < steps; ++i) {
    const double turn = 2.0 * kPi * i / steps;
    if (o.family == Form::Family::ellipse) out.push_back(placed(o, o.a * std::cos(turn), o.b * std::sin(turn)));
  }
  for (const double one : {-1.0, 1.0}) {
    for (const double other : {-1.0, 1.0})
      if (o.family == Form::Family::box) out.push_back(placed(o, one * o.a, other * o.b));
  }
  return out;
}

TEST(Form, ContainsThePositionsWithinItsEdgesOrByItsFoci) {
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
    for (const Point& p : rim(form, 4000)) {
      x = std::max(x, std::abs(p[0] - form.x));
      y = std::max(y, std::abs(p[1] - form.y));
      radius = std::max(radius, std::hypot(p[0] - form.x, p[1] - form.y));
    }
    // The farthest of 4000 points of an ellipse falls short by half the square of half a step.
    EXPECT_NEAR(form.reach_x(), x, 1e-7);
    EXPECT_NEAR(form.reach_y(), y, 1e-7);
    EXPECT_GE(radius_of(form), radius - 1e-12);
  }
}

/// The greatest distance between two forms along 720 directions, metres; negative if they overlap in all of them.
double gap_between(const std::vector<Point>& one, const std::vector<Point>& other) {
  double out = -1.0;
  for (int i = 0; i < 720; ++i) {
    double last = -1.0, first = 1.0;
    const double c = std::cos(kPi * i / 360.0);
    const double s = std::sin(kPi * i / 360.0);
    for (const Point& p : one) last = std::max(last, c * p[0] + s * p[1]);
    for (const Point& p : other) first = std::min(first, c * p[0] + s * p[1]);
    out = std::max(out, first - last);
  }
  return out;
}

TEST(Form, OverlapsAnotherIfNoDirectionSeparatesThem) {
  const std::vector<Form> all = forms(2000, 8);
  std::array<int, 2> decided{};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Form& other = all[(i + 7) % all.size()];
    const double gap = gap_between(rim(all[i], 120), rim(other, 120));
    // Between two directions the gap changes by less. Ellipses pass by each other at such a distance, too.
    if (std::abs(gap) < 5e-4) continue;
    ASSERT_EQ(overlap(all[i], other), gap < 0.0) << i << ": " << gap;
    ++decided[gap < 0.0 ? 1 : 0];
  }
  EXPECT_GT(std::min(decided[0], decided[1]), 700);
}

TEST(Form, OverlapsTheSameFormsInATableAsAlone) {
  const std::vector<Form> all = forms(301, 6);
  std::vector<const Form*> pointers;
  for (const Form& form : all) pointers.push_back(&form);
  FormTable table;
  table.set(pointers);
  ASSERT_GE(table.x.size(), all.size());
  for (const Form& other : forms(50, 7)) {
    Hypothesis hypothesis;
    for (const Form& form : {other, all[7]}) {
      hypothesis.primitives.add({}).form = form;
      std::vector<float> count(table.x.size(), 2.0F);
      count_overlaps(hypothesis, table, count.data());
      for (std::size_t i = 0; i < all.size(); ++i) {
        const bool any = std::any_of(hypothesis.primitives.begin(), hypothesis.primitives.end(),
                                     [&](const Primitive& one) { return overlap(one.form, all[i]); });
        ASSERT_EQ(count[i], any ? 3.0F : 2.0F) << i;
      }
    }
  }
}

/// For each position of a grid, how many spans have it.
std::vector<int> span_counts(const CoverageGrid& grid, const Primitive& primitive) {
  CoverageGrid::Spans spans;
  grid.add_spans(primitive, spans);
  std::vector<int> out(static_cast<std::size_t>(grid.size()), 0);
  for (const CoverageGrid::Span& span : spans) {
    for (int i = span.begin; i < span.end; ++i) ++out[static_cast<std::size_t>(i)];
  }
  return out;
}

TEST(CoverageGrid, HasSpansOfThePositionsInAPrimitive) {
  Prior::Settings settings = default_prior();
  settings.hole_probability = 0.6;
  const Prior prior(settings);
  Random random(3, "form test: spans");
  for (const auto& [columns, rows] : {std::pair{97, 89}, {31, 200}, {150, 3}, {1, 40}, {40, 1}, {1, 1}}) {
    const Points positions = test::lattice(columns, rows);
    const CoverageGrid grid(positions);
    const CoverageGrid scattered(test::doubled(positions, 0.0));
    for (int k = 0; k < 60; ++k) {
      const Primitive primitive = prior.draw_primitive(random);
      const std::vector<int> in_rows = span_counts(grid, primitive);
      const std::vector<int> one_by_one = span_counts(scattered, primitive);
      for (Eigen::Index i = 0; i < positions.rows(); ++i) {
        const Point p{positions(i, 0), positions(i, 1)};
        const double in_form = inside_of(primitive.form, p);
        const double in_hole = primitive.hollow ? inside_of(primitive.hole, p) : -1.0;
        if (std::min(std::abs(in_form), std::abs(in_hole)) <= kOnTheRim) continue;
        const auto at = static_cast<std::size_t>(i);
        ASSERT_EQ(in_rows[at], in_form > 0.0 && in_hole < 0.0 ? 1 : 0) << columns << " x " << rows << ", " << i;
        ASSERT_EQ(one_by_one[2 * at], in_rows[at]);
      }
    }
  }
}

TEST(CoverageGrid, MatchesOnlyItsPositions) {
  const Points positions = test::lattice(5, 4);
  const CoverageGrid grid(positions);
  EXPECT_TRUE(grid.matches(positions));
  EXPECT_FALSE(grid.matches(test::lattice(4, 5)));
  EXPECT_FALSE(grid.matches(test::scattered(20)));
}

TEST(Form, HasTheDepthAndExtentOfABoxAndACircle) {
  const Form box{Form::Family::box, 0.1, 0.1, 0.04, 0.02, 1.0, 0.0};
  EXPECT_DOUBLE_EQ(box.depth(0.13, 0.1), 0.01);
  EXPECT_DOUBLE_EQ(box.extent(), 0.08 * 0.04);
  const Form circle{Form::Family::ellipse, 0.1, 0.1, 0.05, 0.05, 0.8, 0.6};
  EXPECT_NEAR(circle.depth(0.1, 0.16), -0.01, 2e-3) << "to first order";
  EXPECT_DOUBLE_EQ(circle.extent(), kPi * 0.05 * 0.05);
}

/// Steps of the depths by the wide loop are those of the depths one by one, but for rounding to single precision.
TEST(Taps, HaveTheStepOfEachDepthInAPrimitive) {
  Prior::Settings settings = default_prior();
  settings.hole_probability = 0.5;
  const Prior prior(settings);
  Random random(4, "form test: steps");
  Taps taps;
  for (const Touch& touch : test::disc_touches(77)) taps.add(touch);
  ASSERT_EQ(taps.length() % Taps::kRound, 0);
  std::vector<LabelModel::Step> row(static_cast<std::size_t>(taps.length()));
  int beside = 0;
  for (const double noise : {0.0, 0.004}) {
    const LabelModel labels(0.02, 0.01, noise);
    for (int k = 0; k < 500; ++k) {
      const Primitive primitive = prior.draw_primitive(random);
      taps.steps(primitive, labels, row.data());
      for (int i = 0; i < taps.length(); ++i) {
        const LabelModel::Step found = row[static_cast<std::size_t>(i)];
        const Target place = taps[i];
        const LabelModel::Step exact = labels.step(primitive.depth(place.x, place.y));
        ASSERT_LE(std::abs(found - exact), noise > 0.0 ? 1 : 0) << k << ", tap " << i;
        ASSERT_TRUE(i < taps.size() || found == LabelModel::kOutside);
        beside += found != exact ? 1 : 0;
      }
    }
  }
  EXPECT_LE(beside, 50) << "of 48000";
}

TEST(Form, HasTheDistanceToItsRimAsDepthNearTheRim) {
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

TEST(Form, HasAtLeastTheDistanceToACircleAboutItOutside) {
  Random random(7, "form test: beyond");
  for (const Form& form : forms(300, 6)) {
    for (int i = 0; i < 300; ++i) {
      const double angle = 2.0 * kPi * random.uniform();
      const double beyond = 0.05 * random.uniform();
      const double far = radius_of(form) + beyond;
      ASSERT_LE(form.depth(form.x + far * std::cos(angle), form.y + far * std::sin(angle)), -beyond + 1e-12);
    }
  }
  const Form box{Form::Family::box, 0.1, 0.1, 0.04, 0.02, 1.0, 0.0};
  EXPECT_NEAR(box.depth(0.143, 0.124), -0.005, 1e-15) << "from a corner";
}

TEST(Form, CoversTheSameRegionWhenItsAxesAreSwappedAndTurnsFromXToY) {
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
