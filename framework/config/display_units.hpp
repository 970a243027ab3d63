// SPDX-License-Identifier: MIT
// Units and digits of quantities in output for users. Tables, summaries, status lines and reports format all numbers
// with these functions. common.js of the HTML pages follows the same rules. Machine formats (CSV, JSON, records)
// contain all digits, in SI units.
//
// Units: positions, heights and their standard deviations are in centimetres, errors in millimetres, times in seconds,
// and all other quantities in SI units. A column or axis has one unit. The unit changes only if the largest number
// would have too many digits before the point or too many zeros after it. For a single length in a sentence, the unit
// is chosen so that the number is short.
//
// Digits: a column has as many decimals as its smallest number needs for three significant digits, at most four. A
// number that would be shown as 0 gets two significant digits. Numbers below a nanometre or a nanosecond are 0.
#pragma once

#include <palpate/options.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Kinds of lengths: errors are shown in millimetres, positions (`place`) in centimetres.
enum class LengthKind { error, place };

/// Unit and number of decimals for the numbers of a column, axis or sentence.
struct DisplayScale {
  std::string unit;     ///< "": none
  double factor = 1.0;  ///< one `unit` in SI units, for example 0.001 for mm
  int decimals = 0;
  bool scientific = false;  ///< true for numbers without a unit that are too small or too large for decimals
  /// Whether the scale is made before its values are known. If so, each value has at least two significant digits.
  bool open = false;

  /// Formats `value` (in SI units) without its unit, for example "3.21"; "nan" or "inf" for values that are not finite.
  std::string number(double value) const;
  /// Formats a value without its unit; "-" for nullopt.
  std::string number(const std::optional<double>& value) const { return value ? number(*value) : "-"; }
  /// Formats a difference with its sign, for example "+0.3". A number that is rounded to 0 has no sign.
  std::string difference(double value) const;
  /// Returns for example "3.21 [3.02, 3.40]" for a mean and its interval; "-" without values. See
  /// analysis/mean_output.hpp.
  template <class Mean>
  std::string estimate(const Mean& mean) const;
  /// Appends the unit to a formatted number, for example "5 mm".
  std::string with_unit(const std::string& number) const { return number + (unit.empty() ? "" : " " + unit); }
  /// Formats a value in SI units with its unit, for example "3.2 mm".
  std::string quantity(double value) const { return with_unit(number(value)); }
  /// Returns the title of a column with its unit, for example "robot_seconds [s]".
  std::string title(const std::string& name) const { return name + (unit.empty() ? "" : " [" + unit + "]"); }
};

/// Returns the scale of a column with these values, in SI units. The smallest number except 0 has `digits` significant
/// digits.
DisplayScale readable_scale(Unit unit, const std::vector<double>& values, int digits = 3,
                            LengthKind kind = LengthKind::error);

/// Returns the scale of a table whose later values are not known yet. It has the usual unit, two decimals for
/// positions, and one decimal for other quantities. Small lengths are shown with more decimals.
DisplayScale usual_scale(Unit unit, LengthKind kind = LengthKind::error);

/// Formats a single value in SI units with `digits` significant digits and without trailing zeros, for example "1.57
/// cm".
std::string readable(double value, Unit unit, int digits = 3, LengthKind kind = LengthKind::error);

/// Returns `value` with `digits` significant digits and without trailing zeros, for example "0.00123", "1.2e-07" or
/// "65.5".
std::string significant(double value, int digits = 3);

}  // namespace palpate
