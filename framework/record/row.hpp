// SPDX-License-Identifier: MIT
// An ordered list of named scalars: one line of a table or one JSON object. Names are dotted ("height_gp.jitter"): JSON
// files contain nested objects instead; CSV files contain the dotted names.
#pragma once

#include <palpate/record_fields.hpp>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

struct Row {
  RecordFields fields;

  void add(std::string name, Scalar value) { fields.emplace_back(std::move(name), std::move(value)); }
  template <class T>
  void add(std::string name, const std::optional<T>& value) {
    add(std::move(name), value ? Scalar(*value) : Scalar());
  }

  /// Returns the value at `name`; null if there is none.
  const Scalar* find(std::string_view name) const;
  /// Returns the value at `name`; null if there is none. Tests the field at index `near` first, and sets `near` to the
  /// index of the field that it finds. This is fast for a series of rows with the same fields.
  const Scalar* find(std::string_view name, std::size_t& near) const;
  /// Returns the number at `name`; a truth value counts as 1 or 0. Returns nullopt for a missing field, null, a text,
  /// or a number that is not finite. JSON files contain such a number as null, CSV files as an empty cell.
  std::optional<double> number(std::string_view name) const;
  /// Returns the truth value at `name`; nullopt if there is none.
  std::optional<bool> flag(std::string_view name) const;
  /// Returns the text at `name`; "" if there is none.
  std::string text(std::string_view name) const;
  /// Removes the field `name`.
  void erase(std::string_view name);
  /// Returns the value at `name` formatted by csv_cell(); "" if there is none.
  std::string cell(std::string_view name) const;
};

/// Appends the shortest decimal text that is parsed to the same bits; the text has an exponent if this is shorter.
void append_number(std::string& out, double value);

/// Returns a scalar as the text of a CSV cell. Numbers have the fewest digits from which the same bits are parsed. Null
/// and numbers that are not finite become empty. Texts are quoted as by csv_text().
std::string csv_cell(const Scalar& value);

/// Returns the text, in quotes if it contains commas, quotes or line ends.
std::string csv_text(const std::string& text);

/// Returns the names of all fields of all rows, each once. A name that earlier rows lack is inserted after the name
/// that precedes it in its row.
std::vector<std::string> names_of(const std::vector<Row>& rows);

/// Returns a table of rows, which may have different fields; the header is names_of(rows). A text that a spreadsheet
/// would compute ("=1+1") gets a leading apostrophe.
std::string to_csv(const std::vector<Row>& rows);

}  // namespace palpate
