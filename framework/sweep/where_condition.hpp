// SPDX-License-Identifier: MIT
// Conditions on named values, such as the `where` of a sweep. Example: taps >= 12 and (surface == two_part or not
// kernel == rbf).
#pragma once

#include "config/tree.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A condition: comparisons (==, !=, <, <=, >, >=), joined by `and`, `or` (lower precedence than `and`), `not` and
/// parentheses.
///
/// The left side of a comparison is a name. The right side is a name if that name exists, and else a value. Numbers are
/// compared with their units (1 cm == 10 mm); other values are texts and can only be compared with == and !=. A quoted
/// value is always a text and may contain any character.
class WhereCondition {
 public:
  /// The value of a name.
  struct Value {
    std::string text;        ///< for example "2 cm" or "rbf"; "": no value
    bool is_result = false;  ///< whether the value is the result of a run, not a setting
  };
  /// Returns the value of a name; nullopt if there is no such name.
  using Values = std::function<std::optional<Value>(const std::string& name)>;

  /// Throws Error, with the place of `text`, for an invalid condition.
  explicit WhereCondition(const Tree& text);
  /// Reads the option --where of a command, if it is given.
  static std::optional<WhereCondition> of_command_line(const std::optional<std::string>& text);

  /// Returns whether the condition holds.
  ///
  /// A comparison with an option that has no value is false: `not kernel.alpha > 1` keeps a job without kernel.alpha. A
  /// comparison with a result that is missing or not finite is undecided, and so is its negation: `rmse_m <= 3 mm` and
  /// `not rmse_m <= 3 mm` both exclude the job (Kleene's three-valued logic). `and` and `or` stop as soon as the result
  /// is certain, so that `spacing != none and spacing > 2 mm` is valid.
  ///
  /// Throws Error, with the place of the condition, for an unknown name on the left; the Error's hint comes from
  /// `known`. Also throws Error for texts compared by order (<, >) and for units of different dimensions.
  bool holds(const Values& value_of, const std::vector<std::string>& known) const;

  const std::string& place() const { return place_; }

 private:
  std::string place_;
  std::string text_;
};

}  // namespace palpate
