// SPDX-License-Identifier: MIT
// The numbers of one recorded tap and where each is from: the record, or the models as they are brought back now.
#pragma once

#include "record/row.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// The fields of a tap as in taps.jsonl. What the run recorded counts; what it left null is taken from the same row as
/// computed now, and marked wherever it is shown. A process is one thing: all its fields are recorded, or none is.
class Evidence {
 public:
  Evidence(const Row& recorded, const Row& computed);

  /// None where neither row has a number.
  std::optional<double> number(std::string_view field) const;
  /// "" where neither row has a text.
  std::string text(std::string_view field) const;
  std::optional<bool> flag(std::string_view field) const;
  bool has(std::string_view field) const { return find(field) != nullptr; }

  /// Whether the run recorded it.
  bool recorded(std::string_view field) const;

  /// "*" for what was computed now, else "". Asking for it counts as showing it.
  std::string star(std::string_view field) const;
  /// The same for what no record has.
  std::string star() const;
  /// Whether any star was asked for: then the text owes its reader a word on it.
  bool starred() const { return starred_; }

  /// The number as `words` has it, with its star; "" where there is none.
  template <class Words>
  std::string shown(std::string_view field, const Words& words) const {
    const std::optional<double> value = number(field);
    return value ? words(*value) + star(field) : std::string();
  }

  /// The fields that begin with `prefix`, without it.
  std::vector<std::string> below(const std::string& prefix) const;

 private:
  struct Field {
    std::string name;
    Scalar value;
    bool recorded;
  };
  const Field* find(std::string_view field) const;
  void take(const Row& row, bool recorded);

  std::vector<Field> fields_;
  mutable bool starred_ = false;
};

}  // namespace palpate
