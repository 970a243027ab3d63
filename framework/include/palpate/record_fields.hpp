// SPDX-License-Identifier: MIT
// Named values for the record of a run.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace palpate {

/// A list or a map, as JSON: `[{"tap": 8, "probability": 0.93}]`.
struct JsonList {
  std::string text;
  bool operator==(const JsonList& other) const { return text == other.text; }
  bool operator!=(const JsonList& other) const { return text != other.text; }
};

/// null, truth value, whole number, real number, text or list.
using Scalar = std::variant<std::monostate, bool, std::int64_t, double, std::string, JsonList>;

/// Values with dotted names such as "height_gp.jitter", in the order of the record.
using RecordFields = std::vector<std::pair<std::string, Scalar>>;

/// The state of a belief, for one row of the record.
struct BeliefState {
  /// Fields of the record. A belief may add fields of its own, with a dot in their names, such as "my_belief.radius".
  RecordFields fields;
  /// Number of numerical problems so far, by kind: "fit_failed", "jitter", "pivoted", "redundant_taps",
  /// "variance_clamped".
  std::map<std::string, int> diagnostics;
  double jitter_max = 0.0;  ///< largest jitter of a model, as a variance

  void add(std::string name, Scalar value) { fields.emplace_back(std::move(name), std::move(value)); }
  template <class T>
  void add(std::string name, const std::optional<T>& value) {
    add(std::move(name), value ? Scalar(*value) : Scalar());
  }

  /// Returns null if there is no such field.
  const Scalar* find(std::string_view name) const {
    for (const auto& [field, value] : fields) {
      if (field == name) return &value;
    }
    return nullptr;
  }
};

}  // namespace palpate
