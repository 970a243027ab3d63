// SPDX-License-Identifier: MIT
// The values that a swept key takes, from the texts that name them.
#pragma once

#include "config/compose.hpp"
#include "config/tree.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A key that is swept, and its values in order.
struct Axis {
  std::string key;  ///< dotted path
  std::vector<Tree> values;
  Tree written;  ///< what they were read from, and can be read from again
};

/// A number of a range, with its unit as written.
struct Bound {
  double value;
  std::string unit;  ///< "" for none
};

/// `name(1cm, 5cm)` taken apart.
struct Call {
  std::string name;
  std::vector<Bound> bounds;
};

/// None unless `value` is the text `name(...)` for one of `names`. Throws Error, with `how_to` as its hint, where what
/// stands in the parentheses are no numbers.
std::optional<Call> parse_call(const Tree& value, const std::string& key, const std::vector<std::string>& names,
                               const std::string& how_to);

/// A continuous range: `uniform(a, b)`, or `log_uniform(a, b)`, which is uniform in the logarithm.
struct ContinuousRange {
  bool logarithmic = false;
  double first = 0.0;  ///< in `unit`; below `last`, and above 0 if logarithmic
  double last = 1.0;
  std::string unit;  ///< "" for none

  /// Returns the number at `share` of the way, 0 to 1.
  double at(double share) const;
};

/// Returns nullopt for a value that is no such text. Throws Error, with `key`, for ends with different units or in the
/// wrong order.
std::optional<ContinuousRange> parse_continuous(const Tree& value, const std::string& key);

/// How a continuous range is written: the hint of an error.
inline constexpr const char* kContinuousHint =
    "write uniform(0.1 mm, 1 mm) or log_uniform(1 cm, 10 cm), both ends with the same unit";

/// A number as people write it, with its unit, at the place of `like`.
Tree number(double value, const std::string& unit, const Tree& like);

/// Counts the values of all axes of a sweep before they are made: a line of text can name a million.
class ValueCount {
 public:
  /// Throws Error, with `place` and `key`, for more than two million values together.
  void add(std::size_t values, const Place& place, const std::string& key);

 private:
  std::size_t all_ = 0;
};

/// The values of a list, of `range(first, end)`, `range(first, end, step)` (end excluded) or of
/// `logspace(first, last, count)` (both included, evenly spaced in the logarithm; both with the same unit); any other
/// value is the only one. Throws Error.
std::vector<Tree> expand_values(const Tree& value, const std::string& key, ValueCount& count);

/// `KEY=V1,V2`, `KEY=[V1, V2]`, `KEY=range(0,10)`, `KEY=logspace(1cm,5cm,8)`: as typed behind `palpate sweep`. A list
/// among several values is one value.
Axis parse_axis(const std::string& text, ValueCount& count);

/// The text of a swept value as it stands in results.csv.
std::string value_text(const Tree& value);

}  // namespace palpate
