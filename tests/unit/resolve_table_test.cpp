// SPDX-License-Identifier: MIT
#include "resolve_fixtures.hpp"

#include <gtest/gtest.h>

#include <array>

namespace palpate {
namespace {

using test::refusal;
using test::resolved;

/// Points, and a plugin's options beside them.
struct Adopting : Options {
  std::vector<std::array<double, 2>> points;
  PluginChoice chosen{"kernel", "rough", nullptr};
  double last = 1.0;
  void list(Fields& fields) override {
    fields.table(points, Field("points", "some places").in(Unit::metre).at_least(0));
    fields.adopt(chosen);
    fields.real(last, Field("last", "after them"));
  }
};

TEST(Resolve, ReadsATableRowByRow) {
  Adopting some;
  const Tree tree = resolved(some, "points: [[1 cm, 2 cm], [3 mm, 0 m], [5 m, 6 m]]\n");
  EXPECT_EQ(some.points, (std::vector<std::array<double, 2>>{{0.01, 0.02}, {0.003, 0.0}, {5.0, 6.0}}));
  Adopting again;
  EXPECT_EQ(resolved(again, "points: [[0.01 m, 0.02 m], [3 mm, 0 cm], [5 m, 6 m]]").canonical(), tree.canonical());
  Adopting none;
  resolved(none, "points: []\n");
  EXPECT_TRUE(none.points.empty());
}

TEST(Resolve, RefusesATableWithAWrongRow) {
  EXPECT_EQ(
      refusal<Adopting>("points: [[1 cm, 2 cm], [3 cm]]\n"),
      "c.yaml:1:24: points: expects a list of rows of 2 values, write [[1 cm, 2 cm], [3 cm, 4 cm]] with the values "
      "and units that it needs");
  EXPECT_EQ(refusal<Adopting>("points: 3 cm\n").substr(0, 47), "c.yaml:1:9: points: expects a list of rows of 2");
  EXPECT_EQ(refusal<Adopting>("points: [1 cm, 2 cm]\n").substr(0, 48),
            "c.yaml:1:10: points: expects a list of rows of 2");
  EXPECT_EQ(refusal<Adopting>("points: [[1 cm, -2 cm]]\n"),
            "c.yaml:1:17: points: -2 cm is out of range, it must be at least 0 m");
  EXPECT_NE(refusal<Adopting>("points: [[1 cm, 2]]\n"), "accepted");
}

TEST(Resolve, ReadsAnAdoptedPluginAmongTheFieldsAtHand) {
  Adopting some;
  ResolveNotes notes;
  const Tree tree = resolved(some, "nu: 2.5\nlast: 3\n", &notes);
  EXPECT_EQ(tree.canonical(), parse_yaml("{points: [], scale: 0.1 m, nu: 2.5, last: 3}", "c.yaml").canonical());
  ASSERT_NE(some.chosen.options, nullptr);
  EXPECT_EQ(some.chosen.options->canonical(), parse_yaml("{scale: 0.1 m, nu: 2.5}", "c.yaml").canonical());
  EXPECT_EQ(notes.plugins.count({"kernel", "rough"}), 1U);
  EXPECT_EQ(refusal<Adopting>("nuu: 2.5\n"), "c.yaml:1:1: unknown option 'nuu', did you mean 'nu'?");
  EXPECT_EQ(refusal<Adopting>("scale: 0 m\n"), "c.yaml:1:8: scale: 0 m is out of range, it must be above 0 m");
}

}  // namespace
}  // namespace palpate
