// SPDX-License-Identifier: MIT
#include "config/tree.hpp"

#include "config/yaml.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

Tree tree_of(const std::string& text) { return parse_yaml(text, "c.yaml"); }

Tree layered(const std::string& text, Layer layer) {
  Tree tree = tree_of(text);
  tree.set_layer(layer);
  return tree;
}

std::string refusal_at_path(const std::string& text, const std::string& path) {
  return error_of([&] { tree_of(text).at_path(path, {std::make_shared<const std::string>("command line"), 0, 0}); });
}

TEST(SourceLocation, IsWrittenAsFarAsItIsKnown) {
  const auto file = std::make_shared<const std::string>("a.yaml");
  EXPECT_EQ((SourceLocation{file, 3, 7}.text()), "a.yaml:3:7");
  EXPECT_EQ((SourceLocation{file, 0, 0}.text()), "a.yaml");
  EXPECT_EQ(SourceLocation{}.text(), "");
}

TEST(Tree, FindsAValueAtADottedPathThroughMapsAndLists) {
  const Tree tree = tree_of("scene: {objects: [{at: [1, 2]}, {at: [3, 4]}]}");
  ASSERT_NE(tree.find_path("scene.objects.1.at.0"), nullptr);
  EXPECT_EQ(tree.find_path("scene.objects.1.at.0")->text, "3");
}

TEST(Tree, FindsNothingWhereAPathLeadsNowhere) {
  const Tree tree = tree_of("a: {b: 1, l: [1]}");
  for (const char* path : {"b", "a.c", "a.b.c", "a.l.1", "a.l.-1", "a.l.x", "a.l.0x"}) {
    EXPECT_EQ(tree.find_path(path), nullptr) << path;
  }
}

TEST(Tree, MakesTheMapsOnTheWayToAPathWithThePlaceOfWhoAskedForThem) {
  Tree tree = tree_of("a: 1");
  const SourceLocation asker{std::make_shared<const std::string>("command line"), 0, 0};
  tree.at_path("b.c.d", asker) = Tree::scalar("2");
  EXPECT_EQ(to_yaml(tree), "a: 1\nb:\n  c:\n    d: 2\n");
  EXPECT_EQ(tree.entries.back().place.text(), "command line");
  EXPECT_EQ(tree.find("b")->entries.front().place.text(), "command line");
}

TEST(Tree, ReachesItemsOfAListByTheirNumber) {
  Tree tree = tree_of("l: [{x: 1}, {x: 2}]");
  tree.at_path("l.1.x", {}).text = "5";
  EXPECT_EQ(tree.find("l")->items[1].find("x")->text, "5");
  EXPECT_EQ(tree.find("l")->items[0].find("x")->text, "1");
}

TEST(Tree, RefusesAPathThroughAValueOrToAnItemThatAListDoesNotHave) {
  EXPECT_EQ(refusal_at_path("a: {b: 1}", "a.b.c.d"),
            "command line: 'a.b.c.d': there is no 'c' below a value, the path ends at 'a.b'");
  EXPECT_EQ(refusal_at_path("l: [1, 2]", "l.2"), "command line: 'l.2': the list has no item '2', its items are 0 to 1");
  EXPECT_EQ(refusal_at_path("l: [1, 2]", "l.first"),
            "command line: 'l.first': the list has no item 'first', its items are 0 to 1");
  EXPECT_EQ(
      refusal_at_path("l: [1]", "l.99999999999999999999"),
      "command line: 'l.99999999999999999999': the list has no item '99999999999999999999', its items are 0 to 0");
  EXPECT_EQ(refusal_at_path("l: []", "l.0"), "command line: 'l.0': the list has no item '0', it is empty");
}

TEST(Tree, KnowsThePlaceOfAPathOrOfWhatEnclosesIt) {
  const Tree tree = tree_of("a:\n  b:\n    - {c: 1}\n");
  EXPECT_EQ(tree.place_of("a.b.0.c").text(), "c.yaml:3:11");
  EXPECT_EQ(tree.place_of("a.b.0.missing").text(), "c.yaml:3:7");
  EXPECT_EQ(tree.place_of("missing").text(), "");
  EXPECT_EQ(tree.place_of("").text(), "");
}

TEST(Tree, MergesMapsKeyByKeyInTheOrderOfTheLowerAndReplacesLists) {
  Tree lower = tree_of("a: 1\nb: {c: 2, d: 3, l: [1, 2, 3]}");
  lower.merge(tree_of("e: 6\nb: {d: 4, f: 5, l: [4]}"));
  EXPECT_EQ(lower.canonical(), tree_of("a: 1\nb: {c: 2, d: 4, l: [4], f: 5}\ne: 6").canonical());
}

TEST(Tree, LeavesAValueOfAHigherLayerWhenALowerOneIsMergedLater) {
  Tree tree = layered("a: high\nb: low", kCommandLineLayer);
  tree.find("b")->layer = kGroupLayer;
  tree.merge(layered("a: file\nb: file", kFileLayer));
  EXPECT_EQ(tree.find("a")->text, "high");
  EXPECT_EQ(tree.find("b")->text, "file");
}

TEST(Tree, LetsTheLaterOfEqualLayersWin) {
  Tree tree = layered("a: 1", kFileLayer);
  tree.merge(layered("a: 2", kFileLayer));
  EXPECT_EQ(tree.find("a")->text, "2");
}

TEST(Tree, ShiftsLayersWithoutChangingTheirOrder) {
  Tree tree = layered("a: {b: [1]}", 7);
  tree.find("a")->find("b")->items[0].layer = 9;
  tree.shift_layer(-100);
  EXPECT_EQ(tree.layer, -93);
  EXPECT_EQ(tree.find("a")->layer, -93);
  EXPECT_EQ(tree.find("a")->find("b")->items[0].layer, -91);
}

TEST(Tree, HasDifferentCanonicalTextsForDifferentValues) {
  const std::vector<const char*> values{"a: 1", "a: [1]",  "a: {1: 1}", "a: ",        "a: ~ ",
                                        "b: 1", "a: '1,'", "a: [1, 1]", "a: [[1], 1]"};
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t j = i + 1; j < values.size(); ++j) {
      if (i == 3 && j == 4) continue;  // two ways to write nothing
      EXPECT_NE(tree_of(values[i]).canonical(), tree_of(values[j]).canonical()) << values[i] << " and " << values[j];
    }
  }
}

TEST(Tree, HasACanonicalTextThatPlacesAndLayersDoNotChangeAndNoOtherTextLooksLike) {
  EXPECT_EQ(tree_of("a: 1\nb: [x, y]").canonical(), layered("{a: 1,   b:\n [x,\n y]}", kCommandLineLayer).canonical());
  EXPECT_NE(tree_of("a: ['1', '2']").canonical(), tree_of("a: ['1,1:2']").canonical());
  EXPECT_NE(tree_of("a: '~'").canonical(), tree_of("a: ~").canonical());
}

TEST(Suggestion, NamesTheNearestOfTheKnownNamesOrListsThem) {
  EXPECT_EQ(suggestion("length_scal", {"length_scale", "signal"}), "did you mean 'length_scale'?");
  EXPECT_EQ(suggestion("rfb", {"matern32", "rbf"}), "did you mean 'rbf'?") << "two neighbours swapped are one mistake";
  EXPECT_EQ(suggestion("spline", {"matern32", "rbf"}), "known: matern32, rbf");
  EXPECT_EQ(suggestion("x", {}), "");
}

TEST(Suggestion, TakesTheFirstOfEquallyNearNamesAndNoneThatSharesLittleOrIsAMonster) {
  EXPECT_EQ(nearest("cm", {"dm", "mm"}), "dm");
  EXPECT_EQ(nearest("ab", {"cd"}), "");
  EXPECT_EQ(nearest("", {"a", "bb"}), "a") << "one letter is missing";
  EXPECT_EQ(nearest(std::string(65, 'a'), {std::string(65, 'a')}), "");
}

}  // namespace
}  // namespace palpate::test
