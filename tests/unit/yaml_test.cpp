// SPDX-License-Identifier: MIT
#include "config/yaml.hpp"

#include "support/testing.hpp"

#include <gmock/gmock.h>

namespace palpate::test {
namespace {

std::string yaml_refusal(const std::string& text) {
  return error_of([&] { parse_yaml(text, "c.yaml"); });
}

std::string refusal_of_file(const fs::path& file) {
  return error_of([&] { read_yaml(file); });
}

std::string repeated(const std::string& text, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += text;
  return out;
}

TEST(Yaml, GivesEveryKeyAndValueItsPlaceAndAMissingValueThatOfItsKey) {
  const Tree tree = parse_yaml("# first\nkernel:\n  type: rbf\n  at: [1 cm, 2 cm]\nnone:\n\n\nb: 2\n", "c.yaml");
  EXPECT_EQ(tree.find("none")->kind, Tree::Kind::null);
  EXPECT_EQ(tree.find("none")->place.text(), "c.yaml:5:1");
  const Tree& kernel = *tree.find("kernel");
  EXPECT_EQ(tree.entries[0].place.text(), "c.yaml:2:1");
  EXPECT_EQ(kernel.entries[0].place.text(), "c.yaml:3:3");
  EXPECT_EQ(kernel.find("type")->place.text(), "c.yaml:3:9");
  EXPECT_EQ(kernel.find("at")->items[1].place.text(), "c.yaml:4:14");
}

TEST(Yaml, KeepsTheOrderOfKeys) {
  const Tree tree = parse_yaml("z: 1\na: 2\nm: 3\n", "c.yaml");
  ASSERT_EQ(tree.entries.size(), 3U);
  EXPECT_EQ(tree.entries[0].key + tree.entries[1].key + tree.entries[2].key, "zam");
}

TEST(Yaml, KeepsScalarsAsTheyAreWritten) {
  for (const char* text : {"010", "yes", "1e3", "0x10", "1.70", ".nan", "1_000", "12:30:45", "2021-01-01"}) {
    const Tree tree = parse_yaml(std::string("a: ") + text, "c.yaml");
    EXPECT_EQ(tree.find("a")->text, text);
    EXPECT_FALSE(tree.find("a")->quoted) << text;
  }
}

TEST(Yaml, RemembersWhichScalarsStoodInQuotes) {
  for (const char* text : {"a: \"1\"", "a: '1'", "a: |-\n  1"}) {
    const Tree tree = parse_yaml(text, "c.yaml");
    EXPECT_EQ(tree.find("a")->text, "1") << text;
    EXPECT_TRUE(tree.find("a")->quoted) << text;
  }
  EXPECT_FALSE(parse_yaml("a: 1", "c.yaml").find("a")->quoted);
}

TEST(Yaml, TakesAnEmptyDocumentAsAnEmptyMap) {
  for (const char* text : {"", "\n\n", "# nothing\n", "---\n", "~", "{}"}) {
    const Tree tree = parse_yaml(text, "c.yaml");
    EXPECT_TRUE(tree.is_map()) << text;
    EXPECT_TRUE(tree.entries.empty()) << text;
  }
}

TEST(Yaml, ReadsLinesThatEndLikeOnWindowsAndAByteOrderMark) {
  const Tree tree = parse_yaml(
      "\xef\xbb\xbf"
      "a: 1\r\nb: x y\r\n",
      "c.yaml");
  EXPECT_EQ(tree.find("a")->text, "1");
  EXPECT_EQ(tree.find("b")->text, "x y");
}

TEST(Yaml, RefusesWhatIsNoPlainConfigWithItsPlace) {
  const std::pair<std::string, const char*> cases[] = {
      {"k:\n  a: 1\n  b: 2\n  a: 1\n", "c.yaml:4:3: duplicate key 'a', it is already at line 2, column 3"},
      {"a: 1\n'a': 2\n", "c.yaml:2:1: duplicate key 'a', it is already at line 1, column 1"},
      {"a: {x: 1}\nb: {x: 1}\n", "accepted"},
      {"base: &b {x: 1}\nk:\n  <<: *b\n",
       "c.yaml:3:3: merge keys ('<<') are not supported, repeat the options, or put them into a group file and name it "
       "under 'defaults'"},
      {"? [a, b]\n: 1\n", "c.yaml:1:3: a key must be plain text"},
      {"? {a: b}\n: 1\n", "c.yaml:1:3: a key must be plain text"},
      {"a: !!int 5\n", "c.yaml:1:4: tags ('tag:yaml.org,2002:int') are not supported, remove it"},
      {"a: 1\nb: !include x.yaml\n", "c.yaml:2:4: tags ('!include') are not supported, remove it"},
      {"a: 1\n---\nb: 2\n",
       "c.yaml:3:1: a second document begins here, remove a '---' or a stray character here or above"},
      {"---\na: 1\n...\n", "accepted"},
      {"a: &x {b: *x}\n", "c.yaml:1:11: nested too deeply, at most 100 levels"},
      {"a: " + repeated("[", 99) + repeated("]", 99), "accepted"},
      {"a: " + repeated("[", 101) + repeated("]", 101), "c.yaml:1:104: nested too deeply, at most 100 levels"},
      {"a: 1\n  b: 2\n",
       "c.yaml:2:4: not valid YAML: illegal map value, look here or above for a missing bracket or quote, a wrong "
       "indent or a tab"},
      {"a: [1, 2\n",
       "c.yaml:2:1: not valid YAML: end of sequence flow not found, look here or above for a missing bracket or "
       "quote, a wrong indent or a tab"}};
  for (const auto& [text, message] : cases) EXPECT_EQ(yaml_refusal(text), message) << text;
}

TEST(Yaml, RefusesAStrayCommaInsteadOfReadingDocumentsWithoutEnd) {
  const std::string refused = "a second document begins here, remove a '---' or a stray character here or above";
  EXPECT_EQ(yaml_refusal("{name: x},"), "c.yaml:1:10: " + refused);
  EXPECT_EQ(yaml_refusal("#\n,"), "c.yaml:2:1: " + refused);
  EXPECT_EQ(parse_value("{a: 1},", "command line").text, "{a: 1},") << "what does not parse is text";
}

TEST(Yaml, RefusesAQuoteThatDoesNotEnd) {
  for (const char* quote : {"\"", "'"}) {
    const std::string begun = std::string(quote) + "x";
    EXPECT_EQ(yaml_refusal("a: 1\nb: " + begun + "\n"),
              "c.yaml:2:4: the quote that begins here does not end, close it");
    EXPECT_THAT(yaml_refusal("a: 1\nb: " + begun), testing::HasSubstr("illegal EOF in scalar"))
        << "yaml-cpp's own words";
    EXPECT_EQ(yaml_refusal("a: " + begun + "\nb: 1\nc: 2\n"),
              "c.yaml:1:4: the quote that begins here does not end, close it");
    EXPECT_EQ(yaml_refusal("a: [" + begun + quote + ", " + begun + quote + "]\n"), "accepted");
  }
  EXPECT_EQ(yaml_refusal("\xef\xbb\xbf"
                         "a: 'x\n"),
            "c.yaml:1:4: the quote that begins here does not end, close it");
  EXPECT_EQ(yaml_refusal("a: 'it''s'\nb: \"a \\\" b\"\nc: ''\n\"d\": |\n  'x\n"), "accepted");
  EXPECT_EQ(yaml_refusal("a: 'it''\n"), "c.yaml:1:4: the quote that begins here does not end, close it");
}

TEST(Yaml, RefusesBytesThatAreNotUtf8AndSaysWhere) {
  EXPECT_EQ(yaml_refusal("a: 1\nname: caf\xe9\n"), "c.yaml:2:10: not UTF-8, save the file as UTF-8");
  EXPECT_EQ(yaml_refusal("name: caf\xc3\xa9\n"), "accepted");
  EXPECT_THROW(parse_value("caf\xe9", "command line"), Error);
}

TEST(Yaml, RefusesAMapOfMoreThanAThousandKeysBeforeItCompares) {
  const auto keys = [](int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += "k" + std::to_string(i) + ": 1\n";
    return text;
  };
  EXPECT_EQ(yaml_refusal(keys(1000)), "accepted");
  EXPECT_EQ(yaml_refusal(keys(90'000)), "c.yaml:1001:1: too many keys, a map has at most 1000");
}

TEST(Yaml, UnfoldsAliasesWithThePlaceOfTheirAnchor) {
  const Tree tree = parse_yaml("a: &x {b: 1}\nc: *x\n", "c.yaml");
  EXPECT_EQ(tree.find_path("c.b")->text, "1");
  EXPECT_EQ(tree.find_path("c.b")->place.text(), "c.yaml:1:11");
}

TEST(Yaml, RefusesAnAliasBombBeforeItUnfolds) {
  std::string bomb = "l0: &l0 [x, x, x, x, x, x, x, x, x, x]\n";
  for (int i = 1; i < 10; ++i) {
    const std::string below = "*l" + std::to_string(i - 1);
    bomb += "l" + std::to_string(i) + ": &l" + std::to_string(i) + " [" + below + repeated(", " + below, 9) + "]\n";
  }
  EXPECT_EQ(yaml_refusal(bomb),
            "c.yaml:1:37: too many values, use fewer aliases: they expand to more than 100000 values");
}

TEST(Yaml, RefusesAliasesThatUnfoldToMuchText) {
  const std::string text = "a: &x " + std::string(500'000, 'y') + "\nb: [*x";
  EXPECT_EQ(yaml_refusal(text + ", *x]\n"), "accepted");
  EXPECT_EQ(yaml_refusal(text + repeated(", *x", 100'000) + "]\n"),
            "c.yaml:1:4: too much text, use fewer aliases: they expand to more than 4 MiB");
}

TEST(Yaml, RefusesAnUnknownAlias) {
  // yaml-cpp 0.8 names it, 0.7 does not.
  EXPECT_THAT(yaml_refusal("a: *x\n"),
              testing::MatchesRegex("c.yaml:1:4: not valid YAML: the referenced anchor is not defined(: x)?, look here "
                                    "or above for a missing bracket or quote, a wrong indent or a tab"));
}

TEST(Yaml, RefusesNestingThatTheParserItselfGivesUpOn) {
  const std::string text = yaml_refusal("a: " + repeated("[", 100000));
  EXPECT_EQ(text.substr(0, 7), "c.yaml:");
  EXPECT_NE(text.find(": nested too deeply, at most 100 levels"), std::string::npos) << text;
}

using YamlFile = InFolder;

TEST_F(YamlFile, ReadsAFileUnderTheNameThatTheUserGave) {
  folder_.write("sub/c.yaml", "a: 1\n");
  const Tree tree = read_yaml(folder_.path() / "sub" / ".." / "sub" / "c.yaml");
  EXPECT_EQ(*tree.find("a")->place.file, (folder_.path() / "sub" / "c.yaml").string());
}

TEST_F(YamlFile, RefusesAFileThatIsMissingAndNamesANearOne) {
  folder_.write("object_i.yaml", "");
  folder_.write("notes.txt", "");
  EXPECT_EQ(refusal_of_file(folder_.path() / "object_1.yaml"),
            (folder_.path() / "object_1.yaml").string() + ": no such file, did you mean 'object_i.yaml'?");
  EXPECT_EQ(refusal_of_file(folder_.path() / "notes.tx"),
            (folder_.path() / "notes.tx").string() + ": no such file, name a YAML file");
}

TEST_F(YamlFile, RefusesADirectoryADeviceAndWhatIsTooLarge) {
  EXPECT_EQ(refusal_of_file(folder_.path()), folder_.path().string() + ": not a regular file, name a YAML file");
  EXPECT_EQ(refusal_of_file("/dev/zero"), "/dev/zero: not a regular file, name a YAML file");
  const fs::path large = folder_.write("large.yaml", "a: '" + std::string(1 << 20, 'x') + "'\n");
  EXPECT_EQ(refusal_of_file(large), large.string() + ": too large for a config, at most 1 MiB");
}

TEST(Value, IsReadAsYaml) {
  EXPECT_EQ(parse_value("[1, {a: b}]", "command line").items[1].find("a")->text, "b");
  EXPECT_EQ(parse_value("", "command line").kind, Tree::Kind::null);
  EXPECT_FALSE(parse_value("2cm", "command line").quoted);
}

TEST(Value, IsTextWhenItDoesNotParse) {
  for (const char* text : {"[1, 2", "@x", "a: b: c", "{", "*x"}) {
    const Tree tree = parse_value(text, "command line");
    EXPECT_EQ(tree.text, text);
    EXPECT_TRUE(tree.is_scalar()) << text;
  }
}

TEST(Value, HasAPlaceWithoutLines) {
  const Tree tree = parse_value("{a: [1]}", "command line");
  EXPECT_EQ(tree.place.text(), "command line");
  EXPECT_EQ(tree.entries[0].place.text(), "command line");
  EXPECT_EQ(tree.find("a")->items[0].place.text(), "command line");
}

TEST(Value, IsAsStrictAsAFile) {
  EXPECT_EQ(error_of([] { parse_value("{a: 1, a: 2}", "command line"); }),
            "command line: duplicate key 'a', write it once");
}

TEST(Yaml, ReadsBackWhatItWrites) {
  const Tree tree = parse_yaml(
      "a: 1\nb: '1'\nc: [1 cm, '2 cm', ~]\nd: {}\ne: []\nf: {g: [{h: 1}, {h: [2, 3]}], i: 'yes'}\n"
      "j: \"line\\nbreak \\\"quoted\\\" \\t # no comment: \\x01\"\nk: \"\"\nl: 'null'\nm: '~'\nn: \"\xc3\xa4\"\n",
      "c.yaml");
  const Tree again = parse_yaml(to_yaml(tree), "d.yaml");
  EXPECT_EQ(again.canonical(), tree.canonical());
  EXPECT_TRUE(again.find("b")->quoted);
  EXPECT_FALSE(again.find("a")->quoted);
  EXPECT_TRUE(again.find("l")->quoted);
}

TEST(Yaml, WritesBlocksForMapsAndOneLineForPlainLists) {
  EXPECT_EQ(to_yaml(parse_yaml("{a: {b: 1}, c: [1 cm, 2 cm], d: {}}", "c.yaml")),
            "a:\n  b: 1\nc: [1 cm, 2 cm]\nd: {}\n");
}

TEST(YamlWriter, EndsEachLineInThePlaceOfItsValueWhichReadersOfTheConfigPassOver) {
  Tree tree =
      parse_yaml("{a: {b: '1  # x', c: 2}, d: [1 cm, 2 cm], e: [[1, 2], [3, 4]], f: {}, g: [{h: 1}]}", "c.yaml");
  tree.find("a")->find("c")->place = {};
  tree.find("a")->find("b")->place.file = std::make_shared<const std::string>("odd\n\x1b name.yaml");
  tree.find("g")->items.front().find("h")->place = {};
  const std::string text = to_yaml_with_places(tree);
  EXPECT_EQ(text,
            "a:\n  b: \"1  # x\"  # odd \\x1b name.yaml:1:9\n  c: 2  # default\nd: [1 cm, 2 cm]  # c.yaml:1:29\n"
            "e:\n  - [1, 2]  # c.yaml:1:47\n  - [3, 4]  # c.yaml:1:55\nf: {}\ng:\n  - h: 1  # default\n");
  EXPECT_EQ(parse_yaml(text, "d.yaml").canonical(), tree.canonical());
  EXPECT_THAT(places_of_lines(text), testing::ElementsAre("", "", "odd \\x1b name.yaml:1:9", "default", "c.yaml:1:29",
                                                          "", "c.yaml:1:47", "c.yaml:1:55", "", "", "default"));
}

TEST(YamlWriter, TellsWhatItsReaderWouldRefuse) {
  Tree tree = Tree::map();
  tree.at("list") = Tree::list();
  std::vector<Tree>& items = tree.at("list").items;
  items.assign(99'998, Tree::scalar("1"));
  check_readable(tree, "c.yaml");
  EXPECT_EQ(parse_yaml(to_yaml(tree), "config.yaml").canonical(), tree.canonical());
  const auto check = [&] { check_readable(tree, "c.yaml"); };
  const std::string refusal =
      "c.yaml: too large after the defaults are filled in, reduce config.yaml to at most 1 MiB and 100000 values";
  items.push_back(Tree::scalar("1"));
  EXPECT_EQ(error_of(check), refusal);
  items.assign(2, Tree::scalar(std::string(1 << 19, 'x')));
  EXPECT_EQ(error_of(check), refusal);
}

}  // namespace
}  // namespace palpate::test
