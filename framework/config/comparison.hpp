// SPDX-License-Identifier: MIT
// Compares a value with a bound. Expectations, conditions on jobs, stop rules and choices use these comparisons.
#pragma once

#include <optional>
#include <string_view>

namespace palpate {

/// The relation of a value to a bound.
enum class Relation { at_least, above, at_most, below, equal, unequal };

/// Returns the operator of a relation: ">=", ">", "<=", "<", "==" or "!=".
std::string_view sign_of(Relation relation);

/// Returns the relation that an operator stands for; nullopt for any other text.
std::optional<Relation> relation_of(std::string_view sign);

/// Returns whether `value` exists, is finite, and is in the given relation to `bound`. `value` and `bound` must have
/// the same unit. A missing, infinite or NaN value satisfies no relation, not even `unequal`.
bool satisfies(const std::optional<double>& value, Relation relation, double bound);

}  // namespace palpate
