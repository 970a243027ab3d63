// SPDX-License-Identifier: MIT
#include "resolve_fixtures.hpp"

#include <array>
#include <set>

namespace palpate::test {
namespace {

struct Table : Options {
  std::vector<std::array<double, 2>> points;
  void list(Fields& fields) override {
    fields.table(points, Field("points", "some places").in(Unit::metre).at_least(0));
  }
};

/// A plugin's options, and others beside them.
struct Adopting : Options {
  PluginChoice chosen{"kernel", {}, nullptr};
  double last = 1.0;
  void list(Fields& fields) override {
    fields.adopt(chosen, Field("type", "type of the part").needed());
    fields.real(last, Field("last", "after them"));
  }
};

/// The same with an option that kernel/smooth has.
struct Clashing : Options {
  PluginChoice chosen{"kernel", {}, nullptr};
  double scale = 1.0;
  void list(Fields& fields) override {
    fields.adopt(chosen, Field("type", "type of the part").needed());
    fields.real(scale, Field("scale", "of the whole"));
  }
};

TEST(Resolve, ReadsATableRowByRow) {
  Table some;
  const Tree tree = resolved(some, "points: [[1 cm, 2 cm], [3 mm, 0 m], [5 m, 6 m]]\n");
  EXPECT_EQ(some.points, (std::vector<std::array<double, 2>>{{0.01, 0.02}, {0.003, 0.0}, {5.0, 6.0}}));
  Table again;
  EXPECT_EQ(resolved(again, "points: [[0.01 m, 0.02 m], [3 mm, 0 cm], [5 m, 6 m]]").canonical(), tree.canonical());
  Table none;
  resolved(none, "points: []\n");
  EXPECT_TRUE(none.points.empty());
}

TEST(Resolve, RefusesATableWithAWrongRow) {
  EXPECT_EQ(
      refusal<Table>("points: [[1 cm, 2 cm], [3 cm]]\n"),
      "c.yaml:1:24: points: expects a list of rows of 2 values, write [[1 cm, 2 cm], [3 cm, 4 cm]] with the values "
      "and units that it needs");
  EXPECT_EQ(refusal<Table>("points: 3 cm\n").substr(0, 47), "c.yaml:1:9: points: expects a list of rows of 2");
  EXPECT_EQ(refusal<Table>("points: [1 cm, 2 cm]\n").substr(0, 48), "c.yaml:1:10: points: expects a list of rows of 2");
  EXPECT_EQ(refusal<Table>("points: [[1 cm, -2 cm]]\n"),
            "c.yaml:1:17: points: -2 cm is out of range, it must be at least 0 m");
  EXPECT_NE(refusal<Table>("points: [[1 cm, 2]]\n"), "accepted");
}

TEST(ResolveAdopted, ReadsThePluginAmongTheFieldsAtHand) {
  Adopting some;
  ResolveNotes notes;
  const Tree tree = resolved(some, "{nu: 2.5, last: 3, type: rough}\n", &notes);
  EXPECT_EQ(tree.canonical(), parse_yaml("{type: rough, scale: 0.1 m, nu: 2.5, last: 3}", "c.yaml").canonical());
  EXPECT_EQ(some.chosen.type, "rough");
  ASSERT_NE(some.chosen.options, nullptr);
  EXPECT_EQ(some.chosen.options->canonical(), parse_yaml("{scale: 0.1 m, nu: 2.5}", "c.yaml").canonical());
  EXPECT_EQ(some.chosen.options->place.text(), "c.yaml:1:26") << "where its complaints will point";
  EXPECT_EQ(notes.plugins, (std::set<std::pair<std::string, std::string>>{{"kernel", "rough"}}));
  EXPECT_EQ(origins(notes), "type@c.yaml:1:26 scale@default nu@c.yaml:1:6 last@c.yaml:1:17 ");
}

TEST(ResolveAdopted, TellsTheLineOfWhatIsWrongAndTheNearestName) {
  EXPECT_EQ(refusal<Adopting>("last: 3\n"), "c.yaml:1:1: 'type' is missing, set it: type of the part");
  EXPECT_EQ(refusal<Adopting>("typ: rough\n"), "c.yaml:1:1: unknown option 'typ', did you mean 'type'?");
  EXPECT_EQ(refusal<Adopting>("type: ruff\n"), "c.yaml:1:7: no plugin kernel/ruff, known: rough, smooth");
  EXPECT_EQ(refusal<Adopting>("type: [rough]\n"),
            "c.yaml:1:7: type is not a name, 'palpate plugins kernel' lists the types");
  EXPECT_EQ(refusal<Adopting>("type: rough\nnuu: 2.5\n"), "c.yaml:2:1: unknown option 'nuu', did you mean 'nu'?");
  EXPECT_EQ(refusal<Adopting>("type: smooth\nnu: 2.5\n"), "c.yaml:2:1: unknown option 'nu', known: type, scale, last");
  EXPECT_EQ(refusal<Adopting>("type: rough\nscale: 0 m\n"),
            "c.yaml:2:8: scale: 0 m is out of range, it must be above 0 m");
  EXPECT_EQ(refusal<Adopting>("last: 2\ntype: many\n"), "c.yaml:2:7: 'parts' is missing, set it: list of kernels")
      << "what a type needs is missing where it was chosen";
}

TEST(ResolveAdopted, DropsAndListsOptionsThatALaterTypeLacks) {
  Tree input = parse_yaml("{type: smooth, scale: 3 cm, nu: 2.5, last: 2}\n", "c.yaml");
  input.find("type")->layer = kCommandLineLayer;
  Adopting some;
  ResolveNotes notes;
  EXPECT_EQ(to_yaml(resolve(some, input, test::TwoPlugins(), notes)), "type: smooth\nscale: 0.03 m\nlast: 2\n");
  ASSERT_EQ(notes.dropped.size(), 1U);
  EXPECT_EQ(notes.dropped[0].path, "nu");
}

TEST(ResolveAdopted, RefusesAPluginWhoseOptionHasTheNameOfAFieldBesideIt) {
  EXPECT_EQ(refusal<Clashing>("type: smooth\n"),
            "c.yaml:1:1: kernel/smooth has an option 'scale', and the config has one of the same name, rename the "
            "plugin's option");
}

}  // namespace
}  // namespace palpate::test
