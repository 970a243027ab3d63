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
  /// One of those that it joins.
  struct Comparison {
    std::string name;
    std::string sign;
    std::string value;
    bool quoted = false;
    std::string shown() const { return name + " " + sign + " " + value; }
  };
  using Comparisons = std::vector<Comparison>;
  /// How they are joined: whether it holds, given which of them, by their numbers, do.
  using Formula = std::function<bool(const std::function<bool(std::size_t comparison)>& holds)>;

  /// The text of a name's value ("2 cm", "rbf"; "" where it has none), or none where there is no such name.
  using Values = std::function<std::optional<std::string>(const std::string& name)>;

  /// Throws Error, with the place of `text`, for what is no condition.
  explicit Condition(const Tree& text);
  /// Of the option --where of a command.
  static Condition of_command_line(const std::string& text);

  /// A comparison with a name that has no value does not hold, whatever it compares. `and` and `or` look no further
  /// than they need to, so `spacing != none and spacing > 2 mm` is fine. Throws Error, with the place of the condition,
  /// for any name on the left that is not known (`known` is what to suggest from), for an order of texts, and for units
  /// that do not go together.
  bool holds(const Values& value_of, const std::vector<std::string>& known) const;

  const std::string& place() const { return place_; }

 private:
  bool holds(const Comparison& comparison, const Values& value_of) const;

  std::string place_;
  Comparisons comparisons_;
  Formula formula_;
};

}  // namespace palpate
