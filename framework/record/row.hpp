// SPDX-License-Identifier: MIT
// Named scalars in an order: one line of a table, one JSON object. Names are dotted ("height_gp.jitter"): JSON
// nests by the dots, CSV keeps them.
#pragma once

#include <palpate/record_fields.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace palpate {

struct Row {
  RecordFields fields;

  void add(std::string name, Scalar value) { fields.emplace_back(std::move(name), std::move(value)); }
  template <class T>
  void add(std::string name, const std::optional<T>& value) {
    add(std::move(name), value ? Scalar(*value) : Scalar());
  }

  /// The value at `name`, or null if there is none.
  const Scalar* find(std::string_view name) const;
  /// The same, looked for at `near` first, which becomes its place: where the row before has it, one like it does, too.
  const Scalar* find(std::string_view name, std::size_t& near) const;
  /// The number at `name`, of a truth value 1 or 0; none where there is none, or null, or a text, or what is not
  /// finite: that is null in every file.
  std::optional<double> number(std::string_view name) const;
  /// The truth value at `name`; none where there is something else.
  std::optional<bool> flag(std::string_view name) const;
  /// The text at `name`; "" where there is something else.
  std::string text(std::string_view name) const;
  /// Takes away what stands at `name`.
  void erase(std::string_view name);
  /// Whatever stands at `name`, as csv_cell() has it; "" where there is none.
  std::string cell(std::string_view name) const;
};

/// Appends the shortest digits that read back as the same bits, with an exponent where that is shorter.
void append_number(std::string& out, double value);

/// Text of one scalar as it stands in a CSV cell: shortest digits that read back as the same bits, empty for null and
/// for what is not a finite number, quoted where commas, quotes or line ends need it.
std::string csv_cell(const Scalar& value);

/// Text quoted for CSV where it needs to be.
std::string csv_text(const std::string& text);

/// The names of all fields of all rows, each behind the one that it follows in its row.
std::vector<std::string> names_of(const std::vector<Row>& rows);

/// A table of rows that may differ in their fields: the header is names_of() them; cells are found by name. A text that
/// a spreadsheet would compute ("=1+1") has an apostrophe before it.
std::string to_csv(const std::vector<Row>& rows);

}  // namespace palpate
