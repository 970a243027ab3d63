// SPDX-License-Identifier: MIT
#include "sweep/where_condition.hpp"

#include "support/testing.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

namespace palpate {
namespace {

Tree text_at(const std::string& text) {
  Tree tree = Tree::scalar(text);
  tree.place = {std::make_shared<const std::string>("c.yaml"), 3, 5};
  return tree;
}

const std::map<std::string, std::string> kValues{
    {"taps", "17"},       {"seed", "3"},      {"belief.surface", "two_part"}, {"belief.height.noise", "0.1 mm"},
    {"kernel", "rbf"},    {"reach", "10 mm"}, {"clearance", "1cm"},           {"acquisition.beta", ""},
    {"name", "object i"}, {"spacing", "none"}};

bool holds(const std::string& text) {
  std::vector<std::string> known;
  for (const auto& one : kValues) known.push_back(one.first);
  const auto value_of = [](const std::string& name) -> std::optional<WhereCondition::Value> {
    if (name == "rmse_m" || name == "nlpd") return WhereCondition::Value{name == "rmse_m" ? "" : "4.5", true};
    const auto found = kValues.find(name);
    return found != kValues.end() ? std::optional(WhereCondition::Value{found->second}) : std::nullopt;
  };
  return WhereCondition(text_at(text)).holds(value_of, known);
}

std::string refusal(const std::string& text) {
  return test::error_of([&] { holds(text); });
}

using Texts = std::vector<std::string>;

void all_hold(const Texts& texts) {
  for (const std::string& text : texts) EXPECT_TRUE(holds(text)) << text;
}
void none_holds(const Texts& texts) {
  for (const std::string& text : texts) EXPECT_FALSE(holds(text)) << text;
}

TEST(WhereCondition, ComparesNumbersAsNumbers) {
  // As texts, 9 would be greater than 17.
  all_hold({"taps == 17", "taps == 17.0", "taps == 1.7e1", "taps > 9", "taps >= 17", "taps <= 17", "taps > -17"});
  none_holds({"taps != 17.0", "taps < 9", "taps > 17", "taps < 17"});
}

TEST(WhereCondition, ComparesQuantitiesWithTheirUnits) {
  all_hold({"reach == 1 cm", "reach == 1cm", "reach==0.01m", "reach < 11 mm and reach > 0.9 cm",
            "belief.height.noise <= 100 um"});
}

TEST(WhereCondition, ComparesTextsAsTheyStand) {
  all_hold({"belief.surface == two_part", "belief.surface != single", "name == object i", "name == 'object i'",
            "belief.surface != 17"});
  none_holds({"belief.surface == single", "taps == many"});
}

TEST(WhereCondition, TakesTheRightForANameWhereOneIsKnown) {
  all_hold({"reach == clearance", "seed < taps", "kernel != belief.surface"});
}

TEST(WhereCondition, TakesWhatIsInQuotesForAText) {
  all_hold({"taps == \"17\"", "name != ') and ('"});
  none_holds({"kernel == 'kernel'", "taps == '17.0'"});
}

TEST(WhereCondition, AgreesWithATruthTable) {
  // seed == 3 is true and seed == 4 is false. All combinations of three comparisons are compared with C++'s operators.
  for (int bits = 0; bits < 8; ++bits) {
    const auto word = [&](int bit) { return (bits >> bit & 1) != 0 ? std::string("seed == 3") : "seed == 4"; };
    const bool a = (bits & 1) != 0, b = (bits & 2) != 0, c = (bits & 4) != 0;
    const std::string x = word(0), y = word(1), z = word(2);
    EXPECT_EQ(holds(x + " and " + y + " or " + z), (a && b) || c) << bits;
    EXPECT_EQ(holds(x + " or " + y + " and " + z), a || (b && c)) << bits;
    EXPECT_EQ(holds(x + " and (" + y + " or not " + z + ")"), a && (b || !c)) << bits;
    EXPECT_EQ(holds("not " + x + " or " + y + " or " + z), !a || b || c) << bits;
    EXPECT_EQ(holds("not (" + x + " and " + y + " and " + z + ")"), !(a && b && c)) << bits;
  }
}

TEST(WhereCondition, DoesNotHoldOfANameWithoutValue) {
  for (const char* sign : {"==", "!=", "<", "<=", ">", ">="}) {
    EXPECT_FALSE(holds(std::string("acquisition.beta ") + sign + " 2"));
    EXPECT_FALSE(holds(std::string("taps ") + sign + " acquisition.beta"));
  }
  EXPECT_TRUE(holds("not acquisition.beta == 2"));
}

TEST(WhereCondition, DoesNotHoldOfAResultThatIsMissingNorDoesItsNegation) {
  for (const char* sign : {"==", "!=", "<", "<=", ">", ">="}) {
    const std::string comparison = std::string("rmse_m ") + sign + " 2 mm";
    none_holds({comparison, "not " + comparison, "not not " + comparison, "not (" + comparison + " and taps == 17)",
                "nlpd == 4.5 and not (" + comparison + " or taps == 3)"});
    // The invalid comparison is not evaluated.
    all_hold({comparison + " or taps == 17", "not (" + comparison + " and taps == 3)",
              "not (taps == 3 and " + comparison + ")"});
  }
  none_holds({"not nlpd == rmse_m", "not rmse_m == nlpd"});
  all_hold({"nlpd == 4.5", "not nlpd == 4"});
}

TEST(WhereCondition, JoinsWhatIsUndecidedByKleenesTruthTables) {
  // -1 stands for undecided. The reference evaluates all completions: a formula is decided if they agree.
  const auto comparison = [](int truth) {
    return std::string(truth < 0 ? "rmse_m > 0 m" : truth == 1 ? "seed == 3" : "seed == 4");
  };
  for (int a = -1; a <= 1; ++a) {
    for (int b = -1; b <= 1; ++b) {
      const int all = a == 0 || b == 0 ? 0 : a < 0 || b < 0 ? -1 : 1;
      const int any = a == 1 || b == 1 ? 1 : a < 0 || b < 0 ? -1 : 0;
      const std::string x = comparison(a), y = comparison(b);
      EXPECT_EQ(holds(x + " and " + y), all == 1) << a << b;
      EXPECT_EQ(holds("not (" + x + " and " + y + ")"), all == 0) << a << b;
      EXPECT_EQ(holds(x + " or " + y), any == 1) << a << b;
      EXPECT_EQ(holds("not (" + x + " or " + y + ")"), any == 0) << a << b;
    }
  }
}

TEST(WhereCondition, LooksNoFurtherThanItNeedsTo) {
  EXPECT_FALSE(holds("spacing != none and spacing > 2 mm"));
  EXPECT_TRUE(holds("spacing == none or spacing > 2 mm"));
}

TEST(WhereCondition, RefusesANameThatIsNotKnownWhereverItStands) {
  EXPECT_EQ(refusal("taps == 1 and belief.surfac == single"),
            "c.yaml:3:5: the condition 'belief.surfac == single' has the unknown name 'belief.surfac', did you mean "
            "'belief.surface'?");
  EXPECT_EQ(refusal("taps == 17 or not (tap == 3)"),
            "c.yaml:3:5: the condition 'tap == 3' has the unknown name 'tap', did you mean 'taps'?");
}

TEST(WhereCondition, RefusesAnOrderOfTexts) {
  EXPECT_EQ(refusal("belief.surface < single"),
            "c.yaml:3:5: the condition 'belief.surface < single' compares the order of texts: 'two_part' and 'single', "
            "compare texts with == or !=");
  EXPECT_EQ(refusal("spacing > 2 mm"),
            "c.yaml:3:5: the condition 'spacing > 2 mm' compares the order of texts: 'none' and '2 mm', compare texts "
            "with == or !=");
}

TEST(WhereCondition, RefusesUnitsThatDoNotGoTogether) {
  EXPECT_EQ(refusal("reach > 2 s"),
            "c.yaml:3:5: the condition 'reach > 2 s' compares a length ('10 mm') with a time ('2 s'), give both the "
            "same dimension");
  EXPECT_EQ(refusal("reach == 2"),
            "c.yaml:3:5: the condition 'reach == 2' compares a length ('10 mm') with a number ('2'), give both the "
            "same dimension");
}

TEST(WhereCondition, RefusesWhatIsNoCondition) {
  const std::string how_to = ", write it like taps >= 12 and not belief.surface == two_part";
  const auto expect = [](const std::string& text, const std::string& rest) {
    EXPECT_EQ(refusal(text), "c.yaml:3:5: the condition '" + text + "': " + rest);
  };
  expect("", "it is empty" + how_to);
  expect("  ", "it is empty" + how_to);
  expect("taps", "a comparison is missing after 'taps'" + how_to);
  expect("taps count > 3", "a comparison is missing after 'taps'" + how_to);
  expect("taps >", "a value is missing after 'taps >'" + how_to);
  expect("taps > and seed > 1", "a value is missing after 'taps >'" + how_to);
  expect("taps > 3 and", "a comparison is missing" + how_to);
  expect("not", "a comparison is missing" + how_to);
  expect("or taps > 3", "a comparison is missing" + how_to);
  expect("taps > 3 not seed > 3", "'not' is not expected here" + how_to);
  expect("(taps > 3", "a '(' is not closed, close it");
  expect("taps > 3)", "there is a ')' without a '('" + how_to);
  expect("()", "a comparison is missing" + how_to);
  expect("name == 'object", "a quote is not closed, close it");
}

TEST(WhereCondition, SaysHowToWriteWhatOtherLanguagesWrite) {
  const auto hint = [](const std::string& text) {
    const std::string line = refusal(text);
    return line.substr(line.rfind(": ") + 2);
  };
  EXPECT_EQ(hint("taps = 3"), "'=' is not a comparison, write '=='");
  EXPECT_EQ(hint("taps <> 3"), "'<>' is not a comparison, write '!='");
  EXPECT_EQ(hint("taps => 3"), "'=>' is not a comparison, write '>='");
  EXPECT_EQ(hint("taps > 3 && seed > 1"), "'&&' is not expected here, write 'and'");
  EXPECT_EQ(hint("taps > 3 || seed > 1"), "'||' is not expected here, write 'or'");
  EXPECT_EQ(hint("!(taps > 3)"), "'!' is not expected here, write 'not'");
  EXPECT_EQ(hint("1 < taps < 5"), "taps >= 12") << "'1' is not a name, write the name first: taps >= 12";
  EXPECT_EQ(hint("taps > 1 < 5"), "'<' is not expected here, join two comparisons by 'and'");
}

TEST(WhereCondition, RefusesWhatIsNestedTooDeeply) {
  const std::string deep = std::string(50000, '(') + "taps > 3" + std::string(50000, ')');
  EXPECT_NE(refusal(deep).find("nested too deeply, at most 100 levels"), std::string::npos);
  std::string nots;
  for (int i = 0; i < 50000; ++i) nots += "not ";
  EXPECT_NE(refusal(nots + "taps > 3").find("nested too deeply"), std::string::npos);
}

TEST(WhereCondition, RefusesWhatIsNoText) {
  Tree list = Tree::list();
  list.place = text_at("").place;
  EXPECT_EQ(test::error_of([&] { const WhereCondition condition(list); }),
            "c.yaml:3:5: a condition is a text, write it like taps >= 12 and not belief.surface == two_part");
}

}  // namespace
}  // namespace palpate
