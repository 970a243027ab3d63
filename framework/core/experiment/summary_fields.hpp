// SPDX-License-Identifier: MIT
// What may be said about the fields of summary.json: their type, dimension, and which way is better. Expectations and
// the front of speed against accuracy read it; record/summary.cpp writes the fields.
#pragma once

#include <palpate/options.hpp>

#include <string>
#include <vector>

namespace palpate {

/// One field of the summary.
struct SummaryField {
  enum class Type { number, flag, text };
  enum class Better { less, more, neither };

  std::string name;  ///< dotted where nested: "compute.infer"
  Type type = Type::number;
  Unit unit = Unit::none;
  Better better = Better::less;
  std::string when_null;  ///< what it means that a run which ended well has no value; "" if it always has one
};

/// The fields that every summary has, in its order, but for those of the processes, which depend on the models.
const std::vector<SummaryField>& summary_fields();

/// The field of that name, or null.
const SummaryField* find_summary_field(const std::string& name);

/// The dimension of a column of results.csv: of a field as listed, of any other by the end of its name, `_m` or
/// `_seconds`.
Unit unit_of_column(const std::string& name);

}  // namespace palpate
