// SPDX-License-Identifier: MIT
// Conditions on named values, as they stand in `where`: taps >= 12 and (surface == two_part or not kernel == rbf).
#pragma once

#include "config/tree.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A condition, read once and asked often.
///
/// Comparisons (==, !=, <, <=, >, >=) of a name with a value or with another name, joined by `and`, `or` (which binds
/// less than `and`), `not` and parentheses. Numbers compare as numbers, with their units (1 cm == 10 mm); all else
/// compares as text, and only by == and !=. What stands on the left is a name; what stands on the right is a name if
/// one is known, else a value. A value in quotes is always a text, and may hold any character.
class Condition {
 public:
  /// What a name stands for.
  struct Value {
    std::string text;        ///< "2 cm", "rbf"; "" where there is none
    bool is_result = false;  ///< it came out of a run; otherwise it was set
  };
  /// The value of a name, or none where there is no such name.
  using Values = std::function<std::optional<Value>(const std::string& name)>;

  /// Throws Error, with the place of `text`, for what is no condition.
  explicit Condition(const Tree& text);
  /// Of the option --where of a command.
  static Condition of_command_line(const std::string& text);

  /// A comparison with an option that has no value does not hold, whatever it compares: a job without a kernel.alpha is
  /// kept by `not kernel.alpha > 1`. With a result that is missing or not finite a comparison is undecided, so that it
  /// selects nothing, negated or not: `rmse_m <= 3 mm` and `not rmse_m <= 3 mm` both leave such a job out (Kleene's
  /// logic of three values). `and` and `or` look no further than they need to, so `spacing != none and spacing > 2 mm`
  /// is fine. Throws Error, with the place of the condition, for any name on the left that is not known (`known` is
  /// what to suggest from), for an order of texts, and for units that do not go together.
  bool holds(const Values& value_of, const std::vector<std::string>& known) const;

  const std::string& place() const { return place_; }

 private:
  std::string place_;
  std::string text_;
};

}  // namespace palpate
