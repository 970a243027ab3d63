// SPDX-License-Identifier: MIT
// How quantities are shown to people: one unit per quantity, and the digits that it deserves. Tables, summaries, status
// lines and reports format numbers by this file alone; common.js of the pages has the same rule. Machine formats (CSV,
// JSON, records) keep full digits in SI.
//
// Unit: places, heights and their standard deviations are in centimetres, errors in millimetres, times in seconds, all
// else in SI. A column or an axis has one unit. It is another one only where the largest of its numbers would have too
// many digits before the point, or too many zeros behind it. A length alone in a sentence has the unit that suits it.
//
// Digits: a column has as many decimals as its smallest number needs for three significant digits, four at most. A
// number that would then read as 0 has two significant digits. Below a nanometre or a nanosecond a number is 0.
#pragma once

#include <palpate/options.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Kinds of lengths: each has its unit.
enum class LengthKind { error, place };

/// Unit and decimals of the numbers of one column, axis or sentence.
struct Scale {
  std::string unit;     ///< "" for none
  double factor = 1.0;  ///< SI units in one of `unit`
  int decimals = 0;
  bool scientific = false;  ///< "1.23e-09": numbers without a unit that are too small or too large for decimals
  bool open = false;        ///< its values are not known yet: each has two significant digits at least

  /// Returns "3.21", `value` in SI without its unit; "nan" and "inf" of what is not finite.
  std::string number(double value) const;
  /// Returns "-" for nothing.
  std::string number(const std::optional<double>& value) const { return value ? number(*value) : "-"; }
  /// Returns the number with its sign: "+0.3". What rounds to 0 has none.
  std::string difference(double value) const;
  /// Returns "3.21 [3.02, 3.40]" of a mean with its interval, "-" of no values: see analysis/readable.hpp.
  template <class Mean>
  std::string estimate(const Mean& mean) const;
  /// Returns "5 mm".
  std::string with_unit(const std::string& number) const { return number + (unit.empty() ? "" : " " + unit); }
  /// Returns "3.2 mm" of a value in SI.
  std::string quantity(double value) const { return with_unit(number(value)); }
  /// Returns "robot_seconds [s]".
  std::string title(const std::string& name) const { return name + (unit.empty() ? "" : " [" + unit + "]"); }
};

/// Returns the scale for a column with these values in SI, whose smallest number (0 apart) gets `digits` significant
/// digits.
Scale readable_scale(Unit unit, const std::vector<double>& values, int digits = 3, LengthKind kind = LengthKind::error);

/// Returns the scale for a table whose values come one by one: the usual unit with two decimals for places, else one,
/// and more for small lengths.
Scale usual_scale(Unit unit, LengthKind kind = LengthKind::error);

/// Returns "1.57 cm": one value in SI that stands alone, with `digits` significant digits and no trailing zeros.
std::string readable(double value, Unit unit, int digits = 3, LengthKind kind = LengthKind::error);

/// Returns `value` with `digits` significant digits and without trailing zeros: "0.00123", "1.2e-07", "65.5".
std::string significant(double value, int digits = 3);

}  // namespace palpate
