// SPDX-License-Identifier: MIT
// Whether a value satisfies a condition: the one place that compares a measured number with a bound, for expectations,
// conditions on jobs, stop rules and choices.
#pragma once

#include <optional>
#include <string_view>

namespace palpate {

/// How a condition relates a value to a bound.
enum class Relation { at_least, above, at_most, below, equal, unequal };

/// The sign that a condition writes for it: ">=", ">", "<=", "<", "==", "!=".
std::string_view sign_of(Relation relation);

/// The relation that `sign` stands for, or none.
std::optional<Relation> relation_of(std::string_view sign);

/// Returns whether there is a `value`, it is finite, and it is in `relation` to `bound`, both in the same unit. A value
/// that is missing, infinite or not a number satisfies no relation, `unequal` included.
bool satisfies(const std::optional<double>& value, Relation relation, double bound);

}  // namespace palpate
