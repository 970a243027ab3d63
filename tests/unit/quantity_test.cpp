// SPDX-License-Identifier: MIT
#include "config/quantity.hpp"

#include "support/testing.hpp"

#include <cstring>
#include <random>

namespace palpate::test {
namespace {

Tree scalar(const std::string& text) {
  Tree tree = Tree::scalar(text);
  tree.place = {std::make_shared<const std::string>("c.yaml"), 2, 5};
  return tree;
}

double metres(const std::string& text) { return read_quantity(scalar(text), "length", Unit::metre); }

std::string quantity_refusal(const std::string& text, Unit unit = Unit::metre) {
  return error_of([&] { read_quantity(scalar(text), "x", unit); });
}

std::string refused_integer(const std::string& text) {
  return error_of([&] { read_integer(scalar(text), "n"); });
}

std::uint64_t bits(double value) {
  std::uint64_t out = 0;
  std::memcpy(&out, &value, sizeof out);
  return out;
}

TEST(Quantity, ReadsTheSameBitsThroughEveryDecimalUnit) {
  for (const char* text : {"1.7 cm", "17 mm", "1.7cm", "0.17 dm", "0.017 m", "17000 um", "17e-3 m", "0.0017e1 m",
                           "1.7E0 cm", "170e-1 mm"}) {
    EXPECT_EQ(bits(metres(text)), bits(0.017)) << text;
  }
}

TEST(Quantity, RoundsOnlyOnce) {
  // Every one of these differs in the last bit when the number is read first and multiplied by the unit then.
  EXPECT_EQ(metres("0.57 cm"), 0.0057);
  EXPECT_EQ(metres("1.1 mm"), 0.0011);
  EXPECT_EQ(metres("3.3 um"), 0.0000033);
  EXPECT_EQ(read_quantity(scalar("1.1 kN"), "x", Unit::newton), 1100.0);
}

TEST(Quantity, ReadsSignsPointsAndExponents) {
  EXPECT_EQ(metres("+1.5 m"), 1.5);
  EXPECT_EQ(metres("-1.5 m"), -1.5);
  EXPECT_EQ(metres(".5 m"), 0.5);
  EXPECT_EQ(metres("5. m"), 5.0);
  EXPECT_EQ(metres("1e2 cm"), 1.0);
  EXPECT_EQ(metres("1E+2 cm"), 1.0);
  EXPECT_EQ(metres("1e-2m"), 0.01);
  EXPECT_EQ(metres("0 m"), 0.0);
  EXPECT_EQ(metres("0.5\t m"), 0.5);
  EXPECT_EQ(read_quantity(Tree::scalar("1.7 cm", true), "x", Unit::metre), 0.017) << "in quotes";
}

TEST(Quantity, ReadsUnitsOfEveryDimension) {
  EXPECT_EQ(read_quantity(scalar("500 ms"), "x", Unit::second), 0.5);
  EXPECT_EQ(read_quantity(scalar("1.5 min"), "x", Unit::second), 90.0);
  EXPECT_EQ(read_quantity(scalar("2 h"), "x", Unit::second), 7200.0);
  EXPECT_EQ(read_quantity(scalar("250 mN"), "x", Unit::newton), 0.25);
  EXPECT_EQ(read_quantity(scalar("5 mrad"), "x", Unit::radian), 0.005);
  EXPECT_EQ(read_quantity(scalar("90 deg"), "x", Unit::radian), 1.5707963267948966);
  EXPECT_EQ(read_quantity(scalar("10 cm/s"), "x", Unit::metre_per_second), 0.1);
  EXPECT_EQ(read_quantity(scalar("1e-4"), "x", Unit::none), 1e-4);
}

TEST(Quantity, RefusesABareNumberAnotherDimensionAndWhatIsNoUnitAndSaysWhatToWrite) {
  struct Row {
    const char* text;
    Unit unit;
    std::string message;
  };
  const Row rows[] = {{"0.017", Unit::metre, "'0.017' has no unit, write a length like '1.7 cm'"},
                      {"0", Unit::second, "'0' has no unit, write a time like '500 ms'"},
                      {"8", Unit::newton, "'8' has no unit, write a force like '10 N'"},
                      {"8", Unit::radian, "'8' has no unit, write an angle like '30 deg'"},
                      {"8", Unit::metre_per_second, "'8' has no unit, write a speed like '10 cm/s'"},
                      {"3 s", Unit::metre, "'3 s' is a time, not a length, write a length like '1.7 cm'"},
                      {"3 cm", Unit::newton, "'3 cm' is a length, not a force, write a force like '10 N'"},
                      {"1 cm", Unit::none, "'1 cm' is not a plain number, write it without a unit"},
                      {"3 cmm", Unit::metre, "unknown unit 'cmm', did you mean 'cm'?"},
                      {"3 inch", Unit::metre, "unknown unit 'inch', known: m, dm, cm, mm, um"},
                      {"3 degs", Unit::radian, "unknown unit 'degs', did you mean 'deg'?"},
                      {"0x10", Unit::none, "'0x10' is not a plain number, write it without a unit"},
                      {"0x10 m", Unit::metre, "unknown unit 'x10 m', known: m, dm, cm, mm, um"},
                      {"1,7 cm", Unit::metre, "'1,7 cm' has a decimal comma, write a point"},
                      {"1 2 cm", Unit::metre, "unknown unit '2 cm', known: m, dm, cm, mm, um"},
                      {"1_000 m", Unit::metre, "unknown unit '_000 m', known: m, dm, cm, mm, um"},
                      {"1 cm ", Unit::metre, "unknown unit 'cm ', did you mean 'cm'?"}};
  for (const auto& [text, unit, message] : rows) EXPECT_EQ(quantity_refusal(text, unit), "c.yaml:2:5: x: " + message);
}

TEST(Quantity, RefusesWhatIsNotANumber) {
  for (const char* text : {".nan", "nan", "NaN m", ".inf", "inf m", "-inf", "infinity", "-.inf m", "", "cm", "-", ".",
                           "e5 m", "--1 m", "one m"}) {
    EXPECT_EQ(quantity_refusal(text),
              std::string("c.yaml:2:5: x: '") + text + "' is not a number, write a length like '1.7 cm'");
  }
}

TEST(Quantity, RefusesWhatNoDoubleCanHold) {
  for (const char* text : {"1e309 m", "-1e309 m", "1e311 cm", "1e99999999999 m", "1e99999999999 cm", "1e-400 m"}) {
    EXPECT_EQ(quantity_refusal(text),
              std::string("c.yaml:2:5: x: '") + text + "' is out of range, write a length like '1.7 cm'");
  }
}

TEST(Quantity, HoldsWhatOnlyTheUnitBringsIntoRange) { EXPECT_EQ(metres("1e309 cm"), 1e307); }

TEST(Quantity, RefusesLeadingZeros) {
  for (const char* text : {"010 cm", "-010 cm", "+01 cm", "00.5 m", "08 m"}) {
    EXPECT_EQ(quantity_refusal(text),
              std::string("c.yaml:2:5: x: '") + text +
                  "' has a leading zero, octal numbers are not supported: write it without the zero");
  }
  EXPECT_EQ(quantity_refusal("0.5 m"), "accepted");
}

TEST(Quantity, RefusesListsMapsAndNothing) {
  for (const auto& [tree, reason] :
       {std::pair{Tree::list(), "is a list or a map, not a number"},
        std::pair{Tree::map(), "is a list or a map, not a number"}, std::pair{Tree{}, "has no value"}}) {
    EXPECT_EQ(error_of([&, &tree = tree] { read_quantity(tree, "x", Unit::metre); }),
              std::string("x: ") + reason + ", write a length like '1.7 cm'");
  }
}

TEST(Integer, IsReadWithASign) {
  EXPECT_EQ(read_integer(scalar("17"), "n"), 17);
  EXPECT_EQ(read_integer(scalar("+17"), "n"), 17);
  EXPECT_EQ(read_integer(scalar("-17"), "n"), -17);
  EXPECT_EQ(read_integer(scalar("0"), "n"), 0);
}

TEST(Integer, ReachesTheEndsOfItsRange) {
  EXPECT_EQ(read_integer(scalar("9223372036854775807"), "n"), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(read_integer(scalar("-9223372036854775808"), "n"), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(refused_integer("9223372036854775808"),
            "c.yaml:2:5: n: '9223372036854775808' is out of range, at most 9223372036854775807");
}

TEST(Integer, IsRefusedUnlessItIsWholeAndInDecimal) {
  for (const char* text : {"1.5", "1.0", "1e3", "0x10", "17 taps", "1_000", "0b1", "0o17"}) {
    EXPECT_EQ(refused_integer(text),
              std::string("c.yaml:2:5: n: '") + text + "' is not a whole number, write digits only");
  }
  EXPECT_EQ(refused_integer("010"),
            "c.yaml:2:5: n: '010' has a leading zero, octal numbers are not supported: write it without the zero");
}

TEST(WrittenQuantity, IsTheShortestTextWithItsUnit) {
  EXPECT_EQ(write_quantity(0.017, Unit::metre), "0.017 m");
  EXPECT_EQ(write_quantity(0.1, Unit::none), "0.1");
  EXPECT_EQ(write_quantity(1.0, Unit::second), "1 s");
  EXPECT_EQ(write_quantity(1.5707963267948966, Unit::radian), "1.5707963267948966 rad");
  EXPECT_EQ(write_quantity(8.0, Unit::newton), "8 N");
  EXPECT_EQ(write_quantity(0.1, Unit::metre_per_second), "0.1 m/s");
}

TEST(AnyQuantity, HasTheDimensionOfItsUnit) {
  const auto expect = [](const char* text, double value, Unit unit) {
    const auto found = any_quantity(text);
    ASSERT_TRUE(found) << text;
    EXPECT_EQ(found->value, value) << text;
    EXPECT_EQ(found->unit, unit) << text;
  };
  expect("17", 17.0, Unit::none);
  expect("-1e3", -1000.0, Unit::none);
  expect("1.7 cm", 0.017, Unit::metre);
  expect("500ms", 0.5, Unit::second);
  expect("2 kN/m", 2000.0, Unit::newton_per_metre);
}

TEST(AnyQuantity, IsNoneOfWhatIsNoQuantity) {
  for (const char* text : {"", "rbf", "cm", "1 parsec", "1,5 cm", "017", "1e999", "12ab", "two 2", " 3"}) {
    EXPECT_FALSE(any_quantity(text)) << text;
  }
}

TEST(WrittenQuantity, ReadsBackAsTheSameBits) {
  constexpr Unit kUnits[] = {Unit::none, Unit::metre, Unit::second, Unit::newton, Unit::radian, Unit::metre_per_second};
  std::mt19937_64 random(20210601);
  int finite = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t pattern = random();
    double value = 0.0;
    std::memcpy(&value, &pattern, sizeof value);
    if (!std::isfinite(value)) continue;
    ++finite;
    const Unit unit = kUnits[i % 6];
    const std::string text = write_quantity(value, unit);
    ASSERT_EQ(bits(read_quantity(scalar(text), "x", unit)), pattern) << text;
  }
  EXPECT_GT(finite, 19000) << "about one pattern in 2000 is not finite";
}

TEST(WrittenQuantity, ReadsBackAtTheEdgesOfTheRange) {
  using Limits = std::numeric_limits<double>;
  for (const double value :
       {0.0, -0.0, Limits::min(), Limits::denorm_min(), Limits::max(), -Limits::max(), Limits::epsilon(), 1e16, 1e17}) {
    EXPECT_EQ(bits(metres(write_quantity(value, Unit::metre))), bits(value)) << value;
  }
}

TEST(UnitNames, BelongToTheirDimension) {
  EXPECT_EQ(unit_names(Unit::newton), (std::vector<std::string>{"N", "mN", "kN"}));
  EXPECT_TRUE(unit_names(Unit::none).empty());
  EXPECT_EQ(unit_symbol(Unit::none), "");
  EXPECT_EQ(unit_symbol(Unit::radian), "rad");
  EXPECT_EQ(dimension_name(Unit::metre_per_second), "speed");
}

}  // namespace
}  // namespace palpate::test
