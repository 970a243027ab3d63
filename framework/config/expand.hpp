// SPDX-License-Identifier: MIT
// Parses the values of the keys that a sweep varies (lists, `range` and `logspace`), and continuous ranges.
#pragma once

#include "config/compose.hpp"
#include "config/tree.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A key that a sweep varies, and its values.
struct SweepAxis {
  std::string key;  ///< dotted path
  std::vector<Tree> values;
  Tree written;  ///< the values as they were written; expand_values() can parse them again
};

/// A number in the arguments of a range, with its unit as written.
struct Bound {
  double value;
  std::string unit;  ///< "": none
};

/// The parts of a text such as `range(1cm, 5cm)`.
struct RangeCall {
  std::string name;
  std::vector<Bound> bounds;
};

/// Parses `name(...)` for one of `names`. Returns nullopt for any other value. Throws Error, with the hint `how_to`, if
/// an argument is not a number.
std::optional<RangeCall> parse_call(const Tree& value, const std::string& key, const std::vector<std::string>& names,
                                    const std::string& how_to);

/// A continuous range: `uniform(a, b)`, or `log_uniform(a, b)`, which is uniform in the logarithm.
struct ContinuousRange {
  bool logarithmic = false;
  double first = 0.0;  ///< first end, in `unit`; less than `last`; positive if logarithmic
  double last = 1.0;
  std::string unit;  ///< "": none

  /// Returns the number at position `share` of the range: the first end for 0, the last end for 1.
  double at(double share) const;
};

/// Parses a continuous range. If its ends have different units, the last end is converted to the unit of the first.
/// Returns nullopt for any other value. Throws Error, which names `key`, for ends with units of different dimensions or
/// in the wrong order.
std::optional<ContinuousRange> parse_continuous(const Tree& value, const std::string& key);

/// The hint of errors about continuous ranges.
inline constexpr const char* kContinuousHint =
    "write uniform(0.1 mm, 1 mm) or log_uniform(1 cm, 10 cm), with a unit at both ends";

/// Rounds to this many significant digits, independent of the locale.
double rounded(double value, int digits);

/// Returns a scalar with the text of a number and its unit, and with the source location of `like`.
Tree number(double value, const std::string& unit, const Tree& like);

/// Counts the values of all axes before they are created, because a short text can mean a million values.
class ValueCount {
 public:
  /// Throws Error, which names `place` and `key`, for more than two million values in total.
  void add(std::size_t values, const SourceLocation& place, const std::string& key);

 private:
  std::size_t all_ = 0;
};

/// Returns the values of a list, of `range(first, end)` or `range(first, end, step)`, or of `logspace(first, last,
/// count)`. The end of a range is excluded. The values of logspace include both ends and are evenly spaced in the
/// logarithm. For anything else, returns `value` itself as the only value. Throws Error for an empty or malformed list
/// or range.
std::vector<Tree> expand_values(const Tree& value, const std::string& key, ValueCount& count);

/// Parses KEY=VALUES of `palpate sweep`: `KEY=V1,V2`, `KEY=[V1, V2]`, `KEY=range(0,10)`, `KEY=logspace(1cm,5cm,8)`. If
/// VALUES has several parts, a part that is a list counts as one value.
SweepAxis parse_axis(const std::string& text, ValueCount& count);

/// Returns the text of a swept value in results.csv.
std::string value_text(const Tree& value);

}  // namespace palpate
