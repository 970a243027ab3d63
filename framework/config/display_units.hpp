// SPDX-License-Identifier: MIT
// Units and digits of quantities in output for users. Tables, summaries, status lines and reports format all numbers
// with this file; common.js of the pages follows the same rules. Machine formats (CSV, JSON, records) have all digits
// in SI.
//
// Units: positions, heights and their standard deviations are in centimetres, errors in millimetres, times in seconds,
// all else in SI. A column or axis has one unit. The unit changes only if the largest number would have too many digits
// before the point or too many zeros after it. A single length in a sentence has the unit that gives a short number.
//
// Digits: a column has as many decimals as its smallest number needs for three significant digits, at most four. A
// number that would be shown as 0 gets two significant digits. Numbers below a nanometre or a nanosecond are 0.
#pragma once

#include <palpate/options.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Kinds of lengths, which have different units.
enum class LengthKind { error, place };

/// Unit and decimals of the numbers of a column, axis or sentence.
struct Scale {
  std::string unit;     ///< "": none
  double factor = 1.0;  ///< SI units per `unit`
  int decimals = 0;
  bool scientific = false;  ///< true for numbers without a unit that are too small or too large for decimals
  bool open = false;        ///< whether the values are not known yet; each then gets at least two significant digits

  /// Returns for example "3.21" for `value` in SI, without its unit; "nan" or "inf" for values that are not finite.
  std::string number(double value) const;
  /// Returns the number; "-" for nullopt.
  std::string number(const std::optional<double>& value) const { return value ? number(*value) : "-"; }
  /// Returns the number with its sign, for example "+0.3". A number that is rounded to 0 has no sign.
  std::string difference(double value) const;
  /// Returns for example "3.21 [3.02, 3.40]" for a mean and its interval; "-" without values. See
  /// analysis/mean_output.hpp.
  template <class Mean>
  std::string estimate(const Mean& mean) const;
  /// Returns a number with its unit, for example "5 mm".
  std::string with_unit(const std::string& number) const { return number + (unit.empty() ? "" : " " + unit); }
  /// Returns a value in SI with its unit, for example "3.2 mm".
  std::string quantity(double value) const { return with_unit(number(value)); }
  /// Returns the title of a column with its unit, for example "robot_seconds [s]".
  std::string title(const std::string& name) const { return name + (unit.empty() ? "" : " [" + unit + "]"); }
};

/// Returns the scale of a column with these values in SI. Its smallest number except 0 gets `digits` significant
/// digits.
Scale readable_scale(Unit unit, const std::vector<double>& values, int digits = 3, LengthKind kind = LengthKind::error);

/// Returns the scale of a table whose later values are unknown: the usual unit, with two decimals for positions and one
/// for other quantities. Small lengths get more decimals.
Scale usual_scale(Unit unit, LengthKind kind = LengthKind::error);

/// Returns for example "1.57 cm": a single value in SI with `digits` significant digits and without trailing zeros.
std::string readable(double value, Unit unit, int digits = 3, LengthKind kind = LengthKind::error);

/// Returns `value` with `digits` significant digits and without trailing zeros, for example "0.00123", "1.2e-07" or
/// "65.5".
std::string significant(double value, int digits = 3);

}  // namespace palpate
