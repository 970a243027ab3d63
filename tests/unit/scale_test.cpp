// SPDX-License-Identifier: MIT
#include "config/display_units.hpp"

#include "support/testing.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace palpate::test {
namespace {

/// SI units in one of a unit, written here again.
double metres_in(const std::string& unit) {
  if (unit == "m") return 1.0;
  if (unit == "cm") return 1e-2;
  if (unit == "mm") return 1e-3;
  EXPECT_EQ(unit, "um");
  return 1e-6;
}

TEST(DisplayScale, OneUnitPerQuantity) {
  EXPECT_EQ(readable_scale(Unit::metre, {0.0402, 0.0026}).unit, "mm");
  EXPECT_EQ(readable_scale(Unit::metre, {0.11, 0.0}, 3, LengthKind::place).unit, "cm");
  EXPECT_EQ(usual_scale(Unit::metre).unit, "mm");
  EXPECT_EQ(usual_scale(Unit::metre, LengthKind::place).unit, "cm");
  EXPECT_EQ(readable_scale(Unit::second, {65.5}).unit, "s");
  EXPECT_EQ(readable_scale(Unit::none, {0.99}).unit, "");
}

TEST(DisplayScale, NoLengthHasManyDigitsOrReadsAsNothing) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> power(-8.5, 1.5);
  for (int i = 0; i < 2000; ++i) {
    const double value = std::pow(10.0, power(random)) * (i % 2 == 0 ? 1.0 : -1.0);
    for (const LengthKind kind : {LengthKind::error, LengthKind::place}) {
      const DisplayScale column = readable_scale(Unit::metre, {value}, 3, kind);
      const DisplayScale live = usual_scale(Unit::metre, kind);
      const std::string alone = readable(value, Unit::metre, 3, kind);
      const std::string unit = alone.substr(alone.find(' ') + 1);
      // Half a unit of the third digit, or of the second where a table began with another size.
      EXPECT_NEAR(std::stod(alone) * metres_in(unit), value, 5.01e-3 * std::abs(value)) << alone;
      EXPECT_NEAR(std::stod(column.number(value)) * metres_in(column.unit), value, 5.01e-3 * std::abs(value));
      EXPECT_NEAR(std::stod(live.number(value)) * metres_in(live.unit), value, 5.01e-2 * std::abs(value));
      for (const std::string& text : {alone, column.quantity(value), live.quantity(value)})
        EXPECT_LE(text.size(), 14u) << text << " of " << value;
    }
  }
}

TEST(DisplayScale, MicronsAreNotZeroInATableThatBeganWithCentimetres) {
  EXPECT_EQ(usual_scale(Unit::metre).number(0.04023), "40.2");
  EXPECT_EQ(usual_scale(Unit::metre).number(3.24e-6), "0.0032");
  EXPECT_EQ(usual_scale(Unit::metre, LengthKind::place).number(4e-6), "0.00040");
  EXPECT_EQ(usual_scale(Unit::metre).number(0.0), "0.0");
  EXPECT_EQ(usual_scale(Unit::metre).number(-1e-18), "0.0") << "what rounding left of a coordinate";
  EXPECT_EQ(usual_scale(Unit::metre).number(std::nullopt), "-");
}

TEST(DisplayScale, AColumnHasTheDecimalsOfItsSmallestNumberAndFourAtMost) {
  const DisplayScale column = readable_scale(Unit::metre, {0.0402, 0.0026});
  EXPECT_EQ(column.number(0.0402), "40.20");
  EXPECT_EQ(column.number(0.0026), "2.60");
  EXPECT_EQ(readable_scale(Unit::none, {30.0, 1e-7}).decimals, 4);
  EXPECT_EQ(readable_scale(Unit::none, {30.0, 1.26e-7}).number(1.26e-7), "0.00000013");
  EXPECT_EQ(readable_scale(Unit::none, {30.0, 1.26e-20}).number(1.26e-20), "1.3e-20");
  EXPECT_EQ(readable_scale(Unit::metre, {1.5650845800732873e-2}).quantity(1.5650845800732873e-2), "15.7 mm");
}

TEST(DisplayScale, NumbersWithoutAUnitKeepTheirDigitsHoweverSmall) {
  EXPECT_EQ(readable_scale(Unit::none, {1.234e-10}).number(1.234e-10), "1.23e-10");
  EXPECT_EQ(readable_scale(Unit::none, {1.234e-10}).number(0.0), "0");
  EXPECT_EQ(readable_scale(Unit::none, {2e12}).number(2e12), "2.00e+12");
  EXPECT_EQ(significant(1234.5), "1234");
  EXPECT_EQ(significant(0.00123456, 2), "0.0012");
  EXPECT_EQ(significant(65.5), "65.5");
  EXPECT_EQ(significant(-0.0), "0");
}

TEST(DisplayScale, LargerAndSmallerUnitsOnlyWhereTheUsualOneCannotBeRead) {
  EXPECT_EQ(readable(0.017, Unit::metre, 4, LengthKind::place), "1.7 cm");
  EXPECT_EQ(readable(1e-4, Unit::metre, 4, LengthKind::place), "0.1 mm");
  EXPECT_EQ(readable(3.2e-6, Unit::metre), "3.2 um");
  EXPECT_EQ(readable(1.5, Unit::metre), "1.5 m");
  EXPECT_EQ(readable(1.5, Unit::metre, 3, LengthKind::place), "1.5 m");
  EXPECT_EQ(readable_scale(Unit::metre, {1.5}, 3, LengthKind::place).quantity(1.5), "150 cm") << "of a column";
  EXPECT_EQ(readable(0.0, Unit::metre), "0 mm");
  EXPECT_EQ(readable(0.004, Unit::second), "4 ms");
  EXPECT_EQ(readable(90.0, Unit::second), "90 s");
}

TEST(DisplayScale, WhatIsNotFiniteSaysSo) {
  EXPECT_EQ(usual_scale(Unit::metre).number(std::numeric_limits<double>::infinity()), "inf");
  EXPECT_EQ(readable(std::nan(""), Unit::none), "nan");
  EXPECT_EQ(readable_scale(Unit::metre, {std::numeric_limits<double>::infinity(), 0.002}).number(0.002), "2.00");
}

}  // namespace
}  // namespace palpate::test
