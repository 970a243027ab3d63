// SPDX-License-Identifier: MIT
// The table class that all outputs use: text for terminals, Markdown, LaTeX, rows for CSV and JSON, and cells for
// pages.
#pragma once

#include "record/row.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// A table with cells for display, each with a title, and fields for machine-readable output (CSV, JSON), each with a
/// name. All rows must have the same titles in the same order.
///
///       table.add_row();
///       table.show("failed", "2", Table::Kind::count);
///       table.store("failed", 2);
class Table {
 public:
  enum class Kind {
    text,    ///< left-aligned
    number,  ///< right-aligned
    count,   ///< right-aligned; the column is hidden if all its cells are "" or "0"
    latex,   ///< right-aligned; title and cells are LaTeX source, which latex() does not escape
  };

  void add_row() { rows_.emplace_back(), next_ = 0; }
  /// Adds a displayed cell to the last row.
  void show(const std::string& title, std::string cell, Kind kind = Kind::number);
  /// Adds a field to the last row that appears only in machine-readable output (CSV, JSON). The value is a scalar or an
  /// optional scalar. An empty optional is stored as null.
  template <class Value>
  void store(std::string name, Value value) {
    rows_.back().add(std::move(name), std::move(value));
  }

  /// Returns the fields of store() as one row per row of the table, in SI units.
  const std::vector<Row>& rows() const { return rows_; }
  Row& last_row() { return rows_.back(); }

  /// Returns the titles, followed by the cells of each row. Hidden columns are left out.
  std::vector<std::vector<std::string>> cells() const;
  /// Returns the number of text columns at the beginning of the table.
  std::size_t text_columns() const { return std::min(sides("l", "r").find('r'), columns_.size()); }
  /// Returns a line of titles and one line per row, with aligned columns.
  std::string text() const;
  /// Returns a table in GitHub's Markdown.
  std::string markdown() const;
  /// Returns a tabular environment with the rules of the package booktabs.
  std::string latex() const;

 private:
  struct Column {
    std::string title;
    Kind kind = Kind::number;
    std::vector<std::string> cells;
  };

  bool is_hidden(const Column& column) const;
  /// Returns the titles, followed by the cells of each row, all converted by `escape`. Hidden columns are left out.
  std::vector<std::vector<std::string>> lines(std::string (*escape)(const std::string&)) const;
  /// Returns a string with `left` or `right` for each column that is not hidden.
  std::string sides(const std::string& left, const std::string& right) const;

  std::vector<Column> columns_;
  std::vector<Row> rows_;
  std::size_t next_ = 0;  ///< index of the next cell's column
};

/// Returns `text` with LaTeX's special characters escaped. A '[' at the beginning is put in braces, because LaTeX would
/// otherwise read it as an argument of the preceding line break.
std::string latex_text(const std::string& text);

}  // namespace palpate
