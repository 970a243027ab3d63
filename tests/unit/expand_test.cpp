// SPDX-License-Identifier: MIT
#include "config/expand.hpp"

#include "config/yaml.hpp"
#include "support/testing.hpp"

#include <cstdlib>

namespace palpate::test {
namespace {

using Texts = std::vector<std::string>;

Texts texts(const std::vector<Tree>& values) {
  Texts out;
  for (const Tree& value : values) out.push_back(value_text(value));
  return out;
}

/// Of a sweep that has no other values.
ValueCount& fresh() {
  static ValueCount count;
  return count = {};
}

Texts expanded(const std::string& value) {
  return texts(expand_values(*parse_yaml("k: " + value, "c.yaml").find("k"), "k", fresh()));
}

Texts typed(const std::string& text) { return texts(parse_axis(text, fresh()).values); }

std::string refused_value(const std::string& value) {
  return error_of([&] { expanded(value); });
}

constexpr const char* kHowTo =
    ", write range(0,10), range(0,10,2) or logspace(1cm,5cm,8), both ends with the same unit";

TEST(Expand, TakesAPlainValueAsTheOnlyOneAListAsItsItemsAndCountsARangeWithoutItsEnd) {
  const std::pair<const char*, Texts> cases[] = {
      {"3 cm", {"3 cm"}},
      {"ranger(1,2)", {"ranger(1,2)"}},
      {"range", {"range"}},
      {"[a, 2, [1, 2]]", {"a", "2", "[1, 2]"}},
      {"range(0,3)", {"0", "1", "2"}},
      {"range( 2 , 10 , 3 )", {"2", "5", "8"}},
      {"range(-1,1)", {"-1", "0"}},
      {"range(3,0,-1)", {"3", "2", "1"}},
      {"range(1cm, 4 cm, 1cm)", {"1 cm", "2 cm", "3 cm"}},
      {"range(0,0.5,0.1)", {"0", "0.1", "0.2", "0.3", "0.4"}},  // as people write decimals
      {"range(1,1.3,0.1)", {"1", "1.1", "1.2"}},                // despite rounding
      {"range(0,0.3,0.1)", {"0", "0.1", "0.2"}},
      {"range(1000000,1000002)", {"1000000", "1000001"}}};
  for (const auto& [text, values] : cases) EXPECT_EQ(expanded(text), values) << text;
}

TEST(Expand, SpacesALogarithmicRangeEvenlyAndKeepsItsEnds) {
  EXPECT_EQ(expanded("logspace(1,100,3)"), (Texts{"1", "10", "100"}));
  const Texts values = expanded("logspace(1cm,5cm,8)");
  ASSERT_EQ(values.size(), 8U);
  EXPECT_EQ(values.front(), "1 cm");
  EXPECT_EQ(values.back(), "5 cm");
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(std::log(std::atof(values[i].c_str())), std::log(5.0) * static_cast<double>(i) / 7.0, 1e-14)
        << values[i];
  }
}

TEST(Expand, RefusesRangesThatAreNotUnderstood) {
  for (const char* text : {"range(5)", "range(1,2,3,4)", "logspace(1,2)", "range(1cm,2)", "range(1cm,3cm,1)",
                           "logspace(1cm,2m,3)", "logspace(1,2,3cm)", "range(0x10,20)"}) {
    EXPECT_EQ(refused_value(text), std::string("c.yaml:1:4: k: '") + text + "' is not understood" + kHowTo);
  }
}

TEST(Expand, RefusesARangeThatYamlCutAtItsComma) {
  EXPECT_EQ(error_of([] { expand_values(*parse_yaml("{k: range(0,3)}", "c.yaml").find("k"), "k", fresh()); }),
            "c.yaml:1:5: k: 'range(0' has no closing ')', inside braces, put it into quotes: \"range(...)\"");
}

TEST(Expand, RefusesRangesOfWhatAreNoNumbers) {
  EXPECT_EQ(refused_value("range(a,b)"), std::string("c.yaml:1:4: k: 'a' in 'range(a,b)' is not a number") + kHowTo);
  EXPECT_EQ(refused_value("range()"), std::string("c.yaml:1:4: k: '' in 'range()' is not a number") + kHowTo);
  EXPECT_EQ(refused_value("range(0,inf)"),
            std::string("c.yaml:1:4: k: 'inf' in 'range(0,inf)' is not a number") + kHowTo);
}

TEST(Expand, RefusesRangesWithoutValuesOrWithTooMany) {
  EXPECT_EQ(refused_value("range(10,0)"),
            "c.yaml:1:4: k: 'range(10,0)' has no value, the end must lie beyond the start");
  EXPECT_EQ(refused_value("range(0,0)"), "c.yaml:1:4: k: 'range(0,0)' has no value, the end must lie beyond the start");
  EXPECT_EQ(refused_value("range(0,1000001)"),
            "c.yaml:1:4: k: 'range(0,1000001)' has more than a million values, use a wider step");
  EXPECT_EQ(refused_value("range(0,1,0)"),
            "c.yaml:1:4: k: 'range(0,1,0)' has more than a million values, use a wider step");
}

TEST(Expand, RefusesLogarithmsOfNothing) {
  for (const char* text :
       {"logspace(0,1,3)", "logspace(-1,1,3)", "logspace(1,2,1)", "logspace(1,2,2.5)", "logspace(1,2,10001)"}) {
    EXPECT_EQ(refused_value(text),
              std::string("c.yaml:1:4: k: '") + text + "' needs two positive ends and a count of 2 to 10000" + kHowTo);
  }
}

TEST(Expand, RefusesNothing) {
  EXPECT_EQ(refused_value("[]"), "c.yaml:1:4: k: the list of values is empty, write [value, value]");
  EXPECT_EQ(refused_value(""), "c.yaml:1:1: k: has no value, write [value, value]");
}

TEST(AxisText, SplitsAtCommas) {
  EXPECT_EQ(typed("seed=1,2, 3"), (Texts{"1", "2", "3"}));
  EXPECT_EQ(parse_axis("kernel.length_scale=1cm,2cm", fresh()).key, "kernel.length_scale");
}

TEST(AxisText, DoesNotSplitInBracketsOrQuotes) {
  EXPECT_EQ(typed("a=[1, 2],[3, 4]"), (Texts{"[1, 2]", "[3, 4]"}));
  EXPECT_EQ(typed("a=[1, 2]"), (Texts{"1", "2"})) << "one list is the list of values";
  EXPECT_EQ(typed("a='x,y',z"), (Texts{"x,y", "z"}));
  EXPECT_EQ(typed("seed=range(0,3)"), (Texts{"0", "1", "2"}));
  EXPECT_EQ(typed("seed=range(0,2),7"), (Texts{"0", "1", "7"}));
}

TEST(AxisText, RefusesAGapBetweenCommas) {
  EXPECT_EQ(error_of([] { parse_axis("seed=1,,2", fresh()); }),
            "command line: seed: has no value, write [value, value]");
}

TEST(AxisText, IsWrittenAsWhatReadsBackAsTheSame) {
  const auto again = [](const std::string& text) {
    const SweepAxis axis = parse_axis(text, fresh());
    Tree sweep = Tree::map();
    sweep.at("k") = axis.written;
    const Tree file = parse_yaml(to_yaml(sweep), "c.yaml");
    EXPECT_EQ(texts(expand_values(*file.find("k"), "k", fresh())), texts(axis.values)) << text;
  };
  for (const char* text : {"seed=range(0,3)", "seed=range(0,2),7", "a=1", "a=x,y", "a=[1, 2],[3, 4]", "a=[1, 2]",
                           "a='x,y',z", "a=logspace(1cm,5cm,3)", "kernel={type: rbf},matern52"}) {
    again(text);
  }
}

TEST(ParsedCall, TakesNameAndBoundsApart) {
  const auto call = parse_call(Tree::scalar("uniform( 1 mm,2.5cm )"), "k", {"uniform"}, "");
  ASSERT_TRUE(call);
  EXPECT_EQ(call->name, "uniform");
  ASSERT_EQ(call->bounds.size(), 2U);
  EXPECT_EQ(call->bounds[0].value, 1.0);
  EXPECT_EQ(call->bounds[0].unit, "mm");
  EXPECT_EQ(call->bounds[1].value, 2.5);
  EXPECT_EQ(call->bounds[1].unit, "cm");
  EXPECT_FALSE(parse_call(Tree::scalar("log_uniform(1,2)"), "k", {"uniform"}, "")) << "another name";
  EXPECT_FALSE(parse_call(Tree::scalar(""), "k", {"uniform"}, ""));
}

TEST(ValueText, IsOneLineWhateverItIs) {
  EXPECT_EQ(value_text(parse_value("{}", "x")), "{}");
  EXPECT_EQ(value_text(parse_yaml("type: sum\nparts:\n  - {type: rbf, scale: 1 cm}\n  - [1, ~]\n", "x")),
            "{type: sum, parts: [{type: rbf, scale: 1 cm}, [1, ~]]}");
}

}  // namespace
}  // namespace palpate::test
