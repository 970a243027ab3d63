// SPDX-License-Identifier: MIT
#include "resolve_fixtures.hpp"

namespace palpate::test {
namespace {

/// A field of every type.
struct Inner : Options {
  double width = 0.5;
  void list(Fields& fields) override {
    fields.real(width, Field("width", "width of the group").in(Unit::metre).above(0).needed());
  }
};

struct Everything : Options {
  double real = 0.25;
  std::optional<double> optional_real;
  double pair[2] = {0.0, 1.0};
  std::int64_t whole = 3;
  std::optional<std::int64_t> optional_whole;
  bool flag = false;
  std::string text = "word";
  std::size_t choice = 0;
  std::int64_t extra = 1;
  std::vector<Inner> items;
  Inner group;
  bool lawful = true;

  void list(Fields& fields) override {
    fields.real(real, Field("real", "a share").at_least(0).at_most(1));
    fields.real(optional_real, Field("optional_real", "a time or none").in(Unit::second));
    fields.reals(pair, 2, Field("pair", "two lengths").in(Unit::metre));
    fields.integer(whole, Field("whole", "a count").at_least(1).at_most(10));
    fields.integer(optional_whole, Field("optional_whole", "a count or none"));
    fields.flag(flag, Field("flag", "yes or no"));
    fields.text(text, Field("text", "a word"));
    fields.choice(choice, Field("choice", "one of two"),
                  {{"plain", "nothing more", {}},
                   {"rich", "with a field", [this](Fields& inner) { inner.integer(extra, Field("extra", "more")); }}});
    fields.sections(items, Field("items", "a list"));
    fields.section(group, Field("group", "a group"));
    fields.require(lawful, "group.width", "breaks a law");
  }
};

struct Pair : Options {
  PluginChoice plugin{"kernel", "", nullptr};
  std::optional<PluginChoice> other;
  void list(Fields& fields) override {
    fields.plugin(plugin, Field("kernel", "a kernel"));
    fields.plugin(other, "kernel", Field("other", "another"));
  }
};

struct SeveralByDefault : Options {
  std::vector<PluginChoice> parts{{"kernel", "smooth", nullptr}, {"kernel", "rough", nullptr}};
  void list(Fields& fields) override { fields.plugins(parts, "kernel", Field("parts", "list of kernels")); }
};

constexpr const char* kGroup = "group: {width: 1 m}\n";

TEST(Resolve, FillsEveryFieldFromTheConfig) {
  Everything all;
  resolved(
      all,
      "real: 0.5\noptional_real: 2 s\npair: [1 cm, 2 cm]\nwhole: 7\noptional_whole: -4\nflag: true\ntext: two words\n"
      "choice: rich\nextra: 9\nitems: [{width: 1 m}, {width: 2 m}]\ngroup: {width: 3 m}\n");
  EXPECT_EQ(all.real, 0.5);
  EXPECT_EQ(all.optional_real, 2.0);
  EXPECT_EQ(all.pair[0], 0.01);
  EXPECT_EQ(all.pair[1], 0.02);
  EXPECT_EQ(all.whole, 7);
  EXPECT_EQ(all.optional_whole, -4);
  EXPECT_TRUE(all.flag);
  EXPECT_EQ(all.text, "two words");
  EXPECT_EQ(all.choice, 1U);
  EXPECT_EQ(all.extra, 9);
  ASSERT_EQ(all.items.size(), 2U);
  EXPECT_EQ(all.items[1].width, 2.0);
  EXPECT_EQ(all.group.width, 3.0);
}

TEST(Resolve, WritesEveryFieldWithItsFinalValueInSiUnits) {
  Everything all;
  EXPECT_EQ(to_yaml(resolved(all, "pair: [1 cm, 20 mm]\ngroup: {width: 3 cm}\n")),
            "real: 0.25\npair: [0.01 m, 0.02 m]\nwhole: 3\nflag: false\ntext: \"word\"\nchoice: plain\nitems: []\n"
            "group:\n  width: 0.03 m\n");
}

TEST(Resolve, ReadsItsOwnOutputAsTheSame) {
  Everything first;
  Everything second;
  const Tree once =
      resolved(first, "optional_real: 90 ms\nchoice: rich\nitems: [{width: 1.7 cm}]\ntext: '1'\ngroup: {width: 1 m}\n");
  const Tree again = resolved(second, to_yaml(once));
  EXPECT_EQ(again.canonical(), once.canonical());
  EXPECT_EQ(second.text, "1");
}

TEST(Resolve, TakesTheWordNoneForAnAbsentNumber) {
  Everything all;
  all.optional_real = 5.0;
  const Tree tree = resolved(all, std::string("optional_whole: none\n") + kGroup);
  EXPECT_FALSE(all.optional_whole);
  EXPECT_EQ(tree.find("optional_whole"), nullptr);
}

TEST(Resolve, RefusesWhatNoFieldTakesWithItsPlaceAndTheNearestName) {
  // With the group behind them that is always needed.
  std::vector<std::pair<std::string, std::string>> lines{
      {"whol: 3", "1: unknown option 'whol', did you mean 'whole'?"},
      {"extra: 3",  // of a case that was not chosen
       "1: unknown option 'extra', known: real, optional_real, pair, whole, optional_whole, flag, text, choice, items, "
       "group"},
      {"real: -0.1", "7: real: -0.1 is out of range, it must be at least 0"},
      {"real: 1.1", "7: real: 1.1 is out of range, it must be at most 1"},
      {"whole: 11", "8: whole: 11 is out of range, it must be at most 10"},
      {"items: [{width: 1 m}, {width: -1 m}]", "31: items.1.width: -1 m is out of range, it must be above 0 m"},
      {"flag: [true]", "7: flag: a list is not a truth value, write true or false"},
      {"flag:", "1: flag: nothing is not a truth value, write true or false"},
      {"choice: ritch", "9: choice: unknown value 'ritch', did you mean 'rich'?"},
      {"choice: [rich]", "9: choice: a list is not a name, known: plain, rich"},
      {"pair: [1 cm, 2]", "14: pair: '2' has no unit, write a length like '1.7 cm'"},
      {"whole: [3]", "8: whole: is a list or a map, not a number, write a plain number"},
      {"text: [a]", "7: text: expects a text, not a list, write a word or two"},
      {"items: {width: 1 m}", "8: items: expects a list, write [{...}, {...}]"},
      {"items: [3]", "9: items.0 is not a group of options, write {key: value, ...} or items.0.KEY=VALUE"}};
  for (const char* text : {"yes", "no", "on", "off", "True", "1", "0", "y"}) {
    lines.emplace_back(std::string("flag: ") + text,
                       std::string("7: flag: '") + text + "' is not a truth value, write true or false");
  }
  for (const char* text : {"[1 cm]", "[1 cm, 2 cm, 3 cm]", "[]", "1 cm"}) {
    lines.emplace_back(std::string("pair: ") + text,
                       "7: pair: expects a list of 2 values, write them in brackets, with commas between them");
  }
  for (const auto& [line, message] : lines) {
    EXPECT_EQ(refusal<Everything>(line + "\n" + kGroup), "c.yaml:1:" + message) << line;
  }
  for (const std::string end : {"real: 0\n", "real: 1\n"}) EXPECT_EQ(refusal<Everything>(end + kGroup), "accepted");
}

TEST(Resolve, RefusesWhatNoGroupIsOrWhatAGroupLacksAtTheGroupOrAtTheConfigThatLacksIt) {
  const std::pair<const char*, const char*> cases[] = {
      {"group: {width: 1 m, depth: 2 m}", "c.yaml:1:21: unknown option 'depth' of group, known: width"},
      {"group: {width: 0 cm}", "c.yaml:1:16: group.width: 0 cm is out of range, it must be above 0 m"},
      {"group: 3", "c.yaml:1:8: group is not a group of options, write {key: value, ...} or group.KEY=VALUE"},
      {"real: 0\ngroup: {}\n", "c.yaml:2:8: 'group.width' is missing, set it: width of the group"},
      {"# only this\nreal: 0\n", "c.yaml:2:1: 'group.width' is missing, set it: width of the group"},
      {"group: {widht: 1 m}\n", "c.yaml:1:9: unknown option 'widht', did you mean 'width'?"}};
  for (const auto& [text, message] : cases) EXPECT_EQ(refusal<Everything>(text), message) << text;
}

TEST(Resolve, PlacesABrokenLawAtTheNestedOptionThatItNames) {
  Everything all;
  all.lawful = false;
  EXPECT_EQ(error_of([&] { resolved(all, "real: 0\ngroup: {width: 1 m}\n"); }),
            "c.yaml:2:16: group.width: breaks a law");
}

TEST(Resolve, NotesTheOriginOfEveryValue) {
  Everything all;
  ResolveNotes notes;
  resolved(all, "whole: 4\ngroup: {width: 1 m}\n", &notes);
  EXPECT_EQ(
      origins(notes),
      "real@default pair@default whole@c.yaml:1:8 flag@default text@default choice@default group.width@c.yaml:2:16 ");
}

TEST(ResolvePlugin, ReadsItsTypeAndItsOptions) {
  Pair pair;
  const Tree tree = resolved(pair, "kernel: {scale: 2 cm, type: rough}\n");
  EXPECT_EQ(pair.plugin.type, "rough");
  EXPECT_EQ(to_yaml(tree), "kernel:\n  type: rough\n  scale: 0.02 m\n  nu: 1.5\n");
  EXPECT_FALSE(pair.other);
}

TEST(ResolvePlugin, RefusesAMissingOneAMissingTypeAnUnknownTypeAndAnOptionThatTheTypeLacks) {
  const std::pair<const char*, const char*> cases[] = {
      {"# empty\nother: {type: rough}\n",
       "2:1: no kernel is chosen, write kernel: {type: ...} or name a group under 'defaults'"},
      {"kernel: {scale: 1 cm}\n", "1:9: kernel has no type, 'palpate plugins kernel' lists the types"},
      {"kernel: {type: spline}\n", "1:16: no plugin kernel/spline, known: rough, smooth"},
      {"kernel: [rough]\n", "1:9: kernel is not a group of options, write {type: ...}"},
      {"kernel: {type: [rough]}\n", "1:16: kernel.type is not a name, 'palpate plugins kernel' lists the types"},
      {"kernal: {type: rough}\n", "1:1: unknown option 'kernal', did you mean 'kernel'?"},
      {"kernel: {type: smooth, nu: 2.5}\n", "1:24: unknown option 'nu' of kernel/smooth, known: type, scale"}};
  for (const auto& [text, message] : cases) EXPECT_EQ(refusal<Pair>(text), std::string("c.yaml:") + message);
}

TEST(ResolvePlugin, DropsAndListsOptionsThatALaterTypeLacks) {
  Tree input = parse_yaml("kernel: {type: smooth, scale: 3 cm, nu: 2.5}\n", "c.yaml");
  input.find("kernel")->find("type")->layer = kCommandLineLayer;
  Pair pair;
  ResolveNotes notes;
  const Tree tree = resolve(pair, input, TwoPlugins(), notes);
  EXPECT_EQ(to_yaml(tree), "kernel:\n  type: smooth\n  scale: 0.03 m\n");
  ASSERT_EQ(notes.dropped.size(), 1U);
  EXPECT_EQ(notes.dropped[0].path, "kernel.nu");
  EXPECT_EQ(notes.dropped[0].place, "c.yaml:1:41");
}

TEST(ResolvePlugins, ReadsAListInItsOrderWithOptionsOfEach) {
  Several several;
  ResolveNotes notes;
  const Tree tree = resolved(several, "parts: [{type: rough, nu: 2.5}, {scale: 2 cm, type: smooth}]\n", &notes);
  ASSERT_EQ(several.parts.size(), 2U);
  EXPECT_EQ(several.parts[0].kind, "kernel");
  EXPECT_EQ(several.parts[0].type, "rough");
  EXPECT_EQ(several.parts[0].options->find("nu")->text, "2.5");
  EXPECT_EQ(several.parts[1].type, "smooth");
  EXPECT_EQ(tree.find_path("parts.0.scale")->text, "0.1 m") << "a default";
  EXPECT_EQ(tree.find_path("parts.1.scale")->text, "0.02 m");
  EXPECT_EQ(notes.plugins.count({"kernel", "rough"}), 1U);
  EXPECT_EQ(notes.plugins.count({"kernel", "smooth"}), 1U);
  EXPECT_EQ(origins(notes),
            "parts.0.type@c.yaml:1:16 parts.0.scale@default parts.0.nu@c.yaml:1:27 parts.1.type@c.yaml:1:53 "
            "parts.1.scale@c.yaml:1:41 ");
}

TEST(ResolvePlugins, ReadsListsInsideLists) {
  Several several;
  const std::string text = "parts: [{type: many, parts: [{type: smooth}, {type: many, parts: [{type: rough}]}]}]\n";
  const Tree tree = resolved(several, text);
  EXPECT_EQ(tree.find_path("parts.0.parts.1.parts.0.nu")->text, "1.5");
  Several again;
  EXPECT_EQ(resolved(again, to_yaml(tree)).canonical(), tree.canonical()) << "its own output reads as the same";
}

TEST(ResolvePlugins, FillsInTheListOfTheDefaults) {
  SeveralByDefault several;
  EXPECT_EQ(to_yaml(resolved(several, "{}")),
            "parts:\n  - type: smooth\n    scale: 0.1 m\n  - type: rough\n    scale: 0.1 m\n    nu: 1.5\n");
  EXPECT_EQ(several.parts[1].options->find("nu")->text, "1.5");
  SeveralByDefault other;
  resolved(other, "parts: [{type: rough}]\n");
  EXPECT_EQ(other.parts.size(), 1U) << "a list takes the place of the defaults";
}

TEST(ResolvePlugins, RefusesWhatIsNoListOfPluginsAndPlacesABadItemAtTheItemWithItsPath) {
  const std::string list = "parts: expects a list, write [{type: ...}, {type: ...}]";
  const std::pair<const char*, std::string> cases[] = {
      {"parts: rough\n", "1:8: " + list},
      {"parts: {type: rough}\n", "1:8: " + list},
      {"# none\nparts:\n", "2:1: " + list},
      {"parts: []\n", "1:8: parts: needs at least one kernel"},
      {"# nothing\n{}\n", "2:1: 'parts' is missing, set it: list of kernels"},
      {"part: []\n", "1:1: unknown option 'part', did you mean 'parts'?"},
      {"parts: [{type: rough}, rough]\n", "1:24: parts.1 is not a group of options, write {type: ...}"},
      {"parts: [{type: rough}, {scale: 1 cm}]\n",
       "1:24: parts.1 has no type, 'palpate plugins kernel' lists the types"},
      {"parts: [{type: ruogh}]\n", "1:16: no plugin kernel/ruogh, did you mean 'rough'?"},
      {"parts: [{type: smooth, scle: 1 cm}]\n", "1:24: unknown option 'scle', did you mean 'scale'?"},
      {"parts: [{type: many, parts: [{type: smooth}, {type: smooth, scale: 0 m}]}]\n",
       "1:68: parts.0.parts.1.scale: 0 m is out of range, it must be above 0 m"}};
  for (const auto& [text, message] : cases) EXPECT_EQ(refusal<Several>(text), "c.yaml:" + message);
}

TEST(ResolvePlugins, DropsOptionsThatALaterTypeOfAnItemLacks) {
  Tree input = parse_yaml("parts: [{type: smooth, scale: 3 cm, nu: 2.5}]\n", "c.yaml");
  input.find("parts")->items[0].find("type")->layer = kCommandLineLayer;
  Several several;
  ResolveNotes notes;
  resolve(several, input, TwoPlugins(), notes);
  ASSERT_EQ(notes.dropped.size(), 1U);
  EXPECT_EQ(notes.dropped[0].path, "parts.0.nu");
}

}  // namespace
}  // namespace palpate::test
