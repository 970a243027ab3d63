// SPDX-License-Identifier: MIT
#include "config/comparison.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpate {
namespace {

/// Operators in the order of Relation.
constexpr std::array<std::string_view, 6> kSigns{">=", ">", "<=", "<", "==", "!="};

}  // namespace

std::string_view sign_of(Relation relation) { return kSigns.at(static_cast<std::size_t>(relation)); }

std::optional<Relation> relation_of(std::string_view sign) {
  const auto found = std::find(kSigns.begin(), kSigns.end(), sign);
  return found != kSigns.end() ? std::optional(static_cast<Relation>(found - kSigns.begin())) : std::nullopt;
}

bool satisfies(const std::optional<double>& value, Relation relation, double bound) {
  if (!value || !std::isfinite(*value)) return false;
  switch (relation) {
    case Relation::at_least:
      return *value >= bound;
    case Relation::above:
      return *value > bound;
    case Relation::at_most:
      return *value <= bound;
    case Relation::below:
      return *value < bound;
    case Relation::equal:
      return *value == bound;
    case Relation::unequal:
      return *value != bound;
  }
  return false;
}

}  // namespace palpate
