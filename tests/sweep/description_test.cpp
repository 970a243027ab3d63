// SPDX-License-Identifier: MIT
#include "sweep/description.hpp"

#include "config/yaml.hpp"
#include "support/testing.hpp"
#include "sweep/sobol.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>

namespace palpate {
namespace {

/// A count for a sweep without other values.
ValueCount& new_value_count() {
  static ValueCount count;
  return count = {};
}

SweepDescription described(const std::string& sweep, const std::vector<std::string>& words = {}) {
  const Tree tree = sweep.empty() ? Tree::map() : parse_yaml("sweep:" + sweep, "c.yaml");
  return SweepDescription(tree.find("sweep"), parse_sweep_words(words));
}

/// Returns the wanted combinations, for example "a=1 b=x; a=1 b=y; ".
std::string shown(const SweepDescription& description, const std::map<std::string, std::string>& base = {}) {
  std::string out;
  const auto value_of = [&](const std::string& name) -> std::optional<WhereCondition::Value> {
    const auto found = base.find(name);
    return found != base.end() ? std::optional(WhereCondition::Value{found->second}) : std::nullopt;
  };
  for (const Combination& combination : description.combinations()) {
    if (!description.wanted(combination, value_of)) continue;
    for (const SweptValue& one : combination) out += one.axis->key + "=" + value_text(one.value()) + " ";
    if (!out.empty()) out.back() = ';';
    out += " ";
  }
  return out;
}

std::string refused(const std::string& sweep, const std::vector<std::string>& words = {}) {
  return test::error_of([&] { shown(described(sweep, words), {{"taps", "17"}}); });
}

TEST(Grid, MultipliesItsKeysTheLastRunningFastest) {
  EXPECT_EQ(shown(described(" {grid: {a: [1, 2], b: [x, y, z]}}")),
            "a=1 b=x; a=1 b=y; a=1 b=z; a=2 b=x; a=2 b=y; a=2 b=z; ");
  EXPECT_EQ(shown(described(" {grid: {b.c: 'range(0,2)', a: only}}")), "b.c=0 a=only; b.c=1 a=only; ");
}

TEST(Zip, TakesItsKeysSideBySide) {
  EXPECT_EQ(shown(described(" {zip: {a: [1, 2, 3], b: 'range(7,10)', c: 'logspace(1,100,3)'}}")),
            "a=1 b=7 c=1; a=2 b=8 c=10; a=3 b=9 c=100; ");
}

TEST(List, TakesItsItemsOneAfterTheOtherEachAGridOfItsOwn) {
  EXPECT_EQ(shown(described(" {list: [{a: 1}, {a: 2, b: [x, y], c: [u, v]}]}")),
            "a=1; a=2 b=x c=u; a=2 b=x c=v; a=2 b=y c=u; a=2 b=y c=v; ");
}

TEST(Blocks, MultiplyInTheOrderInWhichTheyAreWritten) {
  EXPECT_EQ(shown(described(" {zip: {a: [1, 2], b: [x, y]}, grid: {c: [u, v]}}")),
            "a=1 b=x c=u; a=1 b=x c=v; a=2 b=y c=u; a=2 b=y c=v; ");
  EXPECT_EQ(shown(described(" {grid: {c: [u, v]}, zip: {a: [1, 2], b: [x, y]}}")),
            "c=u a=1 b=x; c=u a=2 b=y; c=v a=1 b=x; c=v a=2 b=y; ");
  EXPECT_EQ(shown(described(" {list: [{a: 1}, {b: [x, y]}], grid: {c: [u, v]}}")),
            "a=1 c=u; a=1 c=v; b=x c=u; b=x c=v; b=y c=u; b=y c=v; ");
}

TEST(Blocks, NameTheirKeysInTheOrderOfWriting) {
  const SweepDescription description = described(" {list: [{b: 1}, {a: 1, b: 2}], zip: {d: [1], c: [1]}}");
  EXPECT_EQ(description.keys(), (std::vector<std::string>{"b", "a", "d", "c"}));
}

TEST(Blocks, AreNothingWhenEmpty) {
  EXPECT_TRUE(described(" {}").keys().empty());
  EXPECT_EQ(shown(described(" {grid: {a: [1]}, zip: {}, list: [], sobol: {}, where: []}")), "a=1; ");
}

TEST(Where, KeepsTheCombinationsForWhichItHolds) {
  EXPECT_EQ(shown(described(" {grid: {a: [1, 2, 3], b: [x, y]}, where: a >= 2 and not b == y}")), "a=2 b=x; a=3 b=x; ");
  EXPECT_EQ(shown(described(" {grid: {a: [1, 2, 3], b: [x, y]}, where: [a > 1, b == x, a < 3]}")), "a=2 b=x; ");
}

TEST(Where, AsksTheConfigForWhatIsNotSwept) {
  EXPECT_EQ(shown(described(" {grid: {taps: [12, 17]}, where: taps >= least}"), {{"least", "15"}}), "taps=17; ");
  EXPECT_EQ(shown(described(" {list: [{a: 1}, {b: 2}], where: a == 5}"), {{"a", "5"}}), "b=2; ")
      << "the second item leaves a to the config";
}

TEST(Where, SeesTheTypeOfAGroupThatIsWrittenOut) {
  EXPECT_EQ(shown(described(" {grid: {kernel: [rbf, {type: matern52}]}, where: kernel == matern52}")).substr(0, 7),
            "kernel=");
  EXPECT_EQ(shown(described(" {grid: {kernel: [rbf, {type: matern52}]}, where: kernel == other}")), "");
}

TEST(Where, FindsNoValueOfAnOptionThatAnotherItemHas) {
  const char* sweep =
      " {list: [{kernel: rbf}, {kernel: rational_quadratic, kernel.alpha: [1, 2]}], where: 'not kernel.alpha == 1'}";
  EXPECT_EQ(shown(described(sweep), {{"kernel.alpha", "1"}}), "kernel=rbf; kernel=rational_quadratic kernel.alpha=2; ");
}

TEST(Where, RefusesWhatItCannotKnowYet) {
  EXPECT_EQ(
      refused(" {grid: {kernel: [rbf, matern52]}, where: kernel.length_scale > 2 cm}"),
      "c.yaml:1:49: 'kernel.length_scale' depends on 'kernel', which is swept, sweep it too, or compare 'kernel'");
  EXPECT_EQ(refused(" {grid: {tap: [1, 2]}, where: tp > 2}"),
            "c.yaml:1:37: the condition 'tp > 2' has the unknown name 'tp', did you mean 'tap'?");
  EXPECT_EQ(refused(" {grid: {a: [1, 2]}, where: 'a >'}").substr(0, 13), "c.yaml:1:35: ");
  EXPECT_EQ(refused(" {grid: {a: [1, 2]}, where: {a: 2}}").substr(0, 35), "c.yaml:1:35: a condition is a text,");
}

TEST(Sobol, FillsEveryBinaryBoxAlike) {
  // A (t, m, s)-net in base 2: each half, quarter, ... of an axis contains the same number of the first 2^m points.
  const auto axes = sobol_axes(parse_yaml("{samples: 64, keys: {a: 'uniform(0, 1)', b: 'uniform(0, 1)'}}", "c.yaml"),
                               new_value_count());
  ASSERT_EQ(axes.size(), 2U);
  for (const SweepAxis& axis : axes) {
    std::map<int, int> cells;
    for (const Tree& value : axis.values) ++cells[static_cast<int>(std::atof(value.text.c_str()) * 64)];
    EXPECT_EQ(cells.size(), 64U) << "one in each cell";
  }
  std::map<int, int> boxes;
  for (std::size_t i = 0; i < 64; ++i) {
    const auto half = [&](std::size_t k) { return static_cast<int>(std::atof(axes[k].values[i].text.c_str()) * 8); };
    ++boxes[half(0) * 8 + half(1)];
  }
  EXPECT_EQ(boxes.size(), 64U) << "and one in each square of 8 by 8, as Sobol's first two axes have it";
}

TEST(Sobol, SpreadsALogarithmicRangeInTheLogarithmAndKeepsToItsEnds) {
  const auto axes =
      sobol_axes(parse_yaml("{samples: 32, keys: {a: 'log_uniform(1 cm, 10 cm)', b: 'uniform(-2 mm, 3 mm)'}}", "c"),
                 new_value_count());
  int below = 0;
  for (std::size_t i = 0; i < 32; ++i) {
    const double a = std::atof(axes[0].values[i].text.c_str());
    const double b = std::atof(axes[1].values[i].text.c_str());
    EXPECT_GE(a, 1.0);
    EXPECT_LE(a, 10.0);
    EXPECT_GE(b, -2.0);
    EXPECT_LE(b, 3.0);
    below += a < std::sqrt(10.0) ? 1 : 0;
    EXPECT_EQ(axes[0].values[i].text.substr(axes[0].values[i].text.find(' ')), " cm");
  }
  EXPECT_EQ(below, 16);
}

TEST(Sobol, RefusesWhatIsNoContinuousRange) {
  const std::string how_to = ", write uniform(0.1 mm, 1 mm) or log_uniform(1 cm, 10 cm), with a unit at both ends";
  const auto line = [](const std::string& range) {
    return refused("\n  sobol: {samples: 4, keys: {a: " + range + "}}");
  };
  EXPECT_EQ(line("'uniform(1 cm, 20 s)'"),
            "c.yaml:2:33: a: 'uniform(1 cm, 20 s)' has ends with units of different dimensions" + how_to);
  EXPECT_EQ(line("'uniform(1, 2 cm)'"),
            "c.yaml:2:33: a: 'uniform(1, 2 cm)' has ends with units of different dimensions" + how_to);
  EXPECT_EQ(line("'uniform(2, 1)'"),
            "c.yaml:2:33: a: 'uniform(2, 1)' is not a range, the first end must be below the last");
  EXPECT_EQ(line("'uniform(1, 1)'"),
            "c.yaml:2:33: a: 'uniform(1, 1)' is not a range, the first end must be below the last");
  EXPECT_EQ(line("'uniform(-1e308, 1e308)'"),
            "c.yaml:2:33: a: 'uniform(-1e308, 1e308)' is not a range, the first end must be below the last");
  EXPECT_EQ(line("'log_uniform(0, 1)'"), "c.yaml:2:33: a: 'log_uniform(0, 1)' is not above 0, both ends must be");
  EXPECT_EQ(line("'range(0, 1)'"), "c.yaml:2:33: a: 'range(0, 1)' is not a continuous range" + how_to);
  EXPECT_EQ(line("'logspace(1, 2, 3)'"), "c.yaml:2:33: a: 'logspace(1, 2, 3)' is not a continuous range" + how_to);
  EXPECT_EQ(line("[1, 2]"), "c.yaml:2:33: a: this is not a continuous range" + how_to);
  EXPECT_EQ(line("'uniform(a, b)'"), "c.yaml:2:33: a: 'a' in 'uniform(a, b)' is not a number" + how_to);
}

TEST(Sobol, RefusesWrongSamplesAndKeys) {
  EXPECT_EQ(refused(" {sobol: {samples: 0, keys: {a: 'uniform(0,1)'}}}"),
            "c.yaml:1:26: sweep.sobol.samples: 0 is out of range, it must be 1 to 100000");
  EXPECT_EQ(refused(" {sobol: {samples: 100001, keys: {a: 'uniform(0,1)'}}}"),
            "c.yaml:1:26: sweep.sobol.samples: 100001 is out of range, it must be 1 to 100000");
  EXPECT_EQ(refused(" {sobol: {samples: many, keys: {a: 'uniform(0,1)'}}}").substr(0, 12), "c.yaml:1:26:");
  EXPECT_EQ(refused(" {sobol: {keys: {a: 'uniform(0,1)'}}}"),
            "c.yaml:1:16: sweep.sobol: 'samples' is missing, write samples: 64");
  EXPECT_EQ(refused(" {sobol: {samples: 4}}"),
            "c.yaml:1:16: sweep.sobol.keys: expects a map of 1 to 1000 keys to ranges, write keys: "
            "{kernel.length_scale: \"log_uniform(1 cm, 10 cm)\"}");
  EXPECT_EQ(refused(" {sobol: {sample: 4, keys: {a: 'uniform(0,1)'}}}"),
            "c.yaml:1:17: unknown option 'sample' of sweep.sobol, did you mean 'samples'?");
  EXPECT_EQ(refused(" {sobol: 4}").substr(0, 54), "c.yaml:1:16: sweep.sobol: expects samples and keys, wr");
}

TEST(Description, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(refused(" 3"), "c.yaml:1:8: sweep: expects a map, write sweep: {grid: {key: [values]}}");
  EXPECT_EQ(refused(" {gird: {}}"), "c.yaml:1:9: unknown option 'gird' of sweep, did you mean 'grid'?");
  EXPECT_EQ(refused(" {product: {}}"),
            "c.yaml:1:9: unknown option 'product' of sweep, known: grid, zip, list, sobol, where");
  EXPECT_EQ(refused(" {grid: [seed]}"),
            "c.yaml:1:15: sweep.grid: expects a map of keys to values, write seed: range(0,10), one key per line");
  EXPECT_EQ(refused(" {zip: seed}"),
            "c.yaml:1:14: sweep.zip: expects a map of keys to values, write seed: range(0,10), one key per line");
  const std::string how_to = ", write [{key: value}, {key: value, other: [value, value]}]";
  EXPECT_EQ(refused(" {list: {a: 1}}"), "c.yaml:1:15: sweep.list: expects a list of settings" + how_to);
  EXPECT_EQ(refused(" {list: [a]}"), "c.yaml:1:16: sweep.list: expects a map of keys to values" + how_to);
}

TEST(Description, RefusesUnequalLengthsSideBySide) {
  EXPECT_EQ(refused(" {zip: {a: [1, 2], b: [1, 2, 3]}}"),
            "c.yaml:1:30: sweep.zip: 'b' has 3 values, 'a' has 2, give all keys the same number of values, or combine "
            "them in 'grid'");
}

TEST(Description, RefusesAKeyInTwoBlocksAndNamesBothPlaces) {
  EXPECT_EQ(refused("\n  grid:\n    taps: [12, 17]\n  zip:\n    taps: [12, 17]\n    seed: [1, 2]"),
            "c.yaml:5:12: 'taps' is in sweep.zip and, at c.yaml:3:12, in sweep.grid, write each key in one block only");
  EXPECT_EQ(
      refused(" {grid: {taps: [12, 17]}}", {"sweep.zip={taps: [1, 2]}"}),
      "command line: 'taps' is in sweep.zip and, at c.yaml:1:23, in sweep.grid, write each key in one block only");
}

TEST(Description, RefusesKeysThatAreNone) {
  EXPECT_EQ(refused(" {grid: {'': [1]}}"), "c.yaml:1:21: '' is not a dotted path, write it like kernel.length_scale");
  EXPECT_EQ(refused(" {grid: {a..b: [1]}}"),
            "c.yaml:1:23: 'a..b' is not a dotted path, write it like kernel.length_scale");
  EXPECT_EQ(refused(" {grid: {sweep.zip: [1]}}"),
            "c.yaml:1:28: 'sweep.zip' cannot be swept, list its names, as in kernel: [rbf, matern52]");
  EXPECT_EQ(refused(" {zip: {expect.rmse_m: [1]}}"),
            "c.yaml:1:31: expect.rmse_m: expectations cannot be swept, write it under 'expect:', which applies to the "
            "whole sweep");
}

TEST(Description, RefusesMoreThanAMillionCombinations) {
  EXPECT_EQ(refused("", {"a=range(0,1001)", "b=range(0,1000)"}),
            "command line: b: the sweep has more than a million jobs, use fewer values");
  EXPECT_EQ(refused(" {grid: {a: 'range(0,1001)'}, zip: {b: 'range(0,1000)', c: 'range(0,1000)'}}").substr(0, 40),
            "c.yaml:1:46: b: the sweep has more than ");
  EXPECT_EQ(refused(" {list: [{a: 'range(0,500000)'}, {a: 'range(0,500001)'}]}").substr(0, 40),
            "c.yaml:1:44: a: the sweep has more than ");
  EXPECT_EQ(described("", {"a=range(0,1000)", "b=range(0,1000)"}).combinations().size(), 1000000U);
}

TEST(Words, AddToTheGridAndTakeThePlaceOfItsKeys) {
  EXPECT_EQ(shown(described(" {grid: {a: [1, 2], b: [x, y]}}", {"a=7", "c=u"})), "a=7 b=x c=u; a=7 b=y c=u; ");
  EXPECT_EQ(shown(described("", {"a=1,2"})), "a=1; a=2; ");
}

TEST(Words, TakeAKeyOutOfTheOtherBlocks) {
  EXPECT_EQ(shown(described(" {zip: {a: [1, 2], b: [x, y]}}", {"a=7"})), "b=x a=7; b=y a=7; ");
  EXPECT_EQ(shown(described(" {zip: {a: [1, 2]}}", {"a=7"})), "a=7; ") << "nothing is left of it";
  EXPECT_EQ(shown(described(" {list: [{a: 1}, {a: 2, b: [x, y]}]}", {"a=7"})).substr(0, 5), "a=7; ");
  EXPECT_EQ(shown(described(" {list: [{a: 1, b: x}, {a: 2, b: x}, {a: 3, b: y}]}", {"a=7"})), "b=x a=7; b=y a=7; ")
      << "items that differed by it alone are one";
  const std::string sobol = " {sobol: {samples: 2, keys: {a: 'uniform(0,1)', b: 'uniform(0,1)'}}}";
  EXPECT_EQ(described(sobol, {"a=7"}).keys(), (std::vector<std::string>{"b", "a"}));
  EXPECT_EQ(described(sobol, {"a=7", "b=8"}).combinations().size(), 1U);
}

TEST(Words, ReplaceWholeBlocks) {
  EXPECT_EQ(shown(described(" {grid: {a: [1, 2]}, where: a > 1}", {"sweep.where=a < 2"})), "a=1; ");
  EXPECT_EQ(shown(described(" {grid: {a: [1, 2]}, where: a > 1}", {"sweep.where=[]"})), "a=1; a=2; ");
  EXPECT_EQ(shown(described(" {grid: {a: [1, 2]}}", {"sweep.grid={b: [x]}"})), "b=x; ");
  EXPECT_EQ(shown(described(" {list: [{a: 1}]}", {"sweep.list=[{a: 2}, {b: x}]", "c=3"})), "a=2 c=3; b=x c=3; ");
  EXPECT_EQ(shown(described("", {"sweep.zip={taps: [12, 17], candidates.count: [24, 47]}"})),
            "taps=12 candidates.count=24; taps=17 candidates.count=47; ");
  EXPECT_EQ(described("", {"sweep.sobol={samples: 16, keys: {kernel.length_scale: 'log_uniform(1cm,10cm)'}}"})
                .combinations()
                .size(),
            16U);
}

TEST(Words, RefuseBlocksThatThereAreNot) {
  EXPECT_EQ(refused("", {"sweep.were=a > 1"}), "command line: unknown option 'were' of sweep, did you mean 'where'?");
  EXPECT_EQ(refused("", {"sweep={}"}),
            "command line: 'sweep' cannot be set as a whole, set its blocks: \"sweep.where=taps > 12\"");
  EXPECT_EQ(refused("", {"sweep.where="}).substr(0, 41), "command line: a condition is a text, writ");
  EXPECT_EQ(refused("", {"sweep.zip=[taps"}).substr(0, 41), "command line: sweep.zip: expects a map of");
}

TEST(Words, KeepWhatIsExpectedApart) {
  const SweepOverrides words = parse_sweep_words({"expect.rmse_m=<= 2 cm", "seed=1,2"});
  ASSERT_EQ(words.expectations.size(), 1U);
  EXPECT_EQ(words.expectations[0].path, "expect.rmse_m");
  ASSERT_EQ(words.axes.size(), 1U);
  EXPECT_EQ(test::error_of([] { parse_sweep_words({"expect.rmse_m=1,2"}); }),
            "command line: expect.rmse_m: expectations cannot be swept, give it one value");
}

}  // namespace
}  // namespace palpate
