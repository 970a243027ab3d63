// SPDX-License-Identifier: MIT
// The table model of all outputs: text for terminals, Markdown, LaTeX, rows for CSV and JSON, cells for pages.
#pragma once

#include "record/row.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// A table with cells for people, each under a title, and fields for programs, each with a name. All rows show the same
/// titles in the same order.
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
  /// Adds a cell for people to the last row.
  void show(const std::string& title, std::string cell, Kind kind = Kind::number);
  /// Adds a field for programs to the last row: a scalar, or an optional scalar with null for none.
  template <class Value>
  void store(std::string name, Value value) {
    rows_.back().add(std::move(name), std::move(value));
  }

  /// Returns the fields for programs, one row per row of the table, in SI units.
  const std::vector<Row>& rows() const { return rows_; }
  Row& last_row() { return rows_.back(); }

  /// Returns the titles, then the cells of each row, without hidden columns.
  std::vector<std::vector<std::string>> cells() const;
  /// Returns the number of text columns before the first other column.
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
  /// Returns the titles, then the cells of each row, both after `escape`, without hidden columns.
  std::vector<std::vector<std::string>> lines(std::string (*escape)(const std::string&)) const;
  /// Returns `left` or `right` for each column that is not hidden, as one string.
  std::string sides(const std::string& left, const std::string& right) const;

  std::vector<Column> columns_;
  std::vector<Row> rows_;
  std::size_t next_ = 0;  ///< index of the next cell's column
};

/// Returns `text` with LaTeX's special characters escaped. A '[' at the beginning is put in braces: LaTeX would read it
/// as an argument of the line break before it.
std::string latex_text(const std::string& text);

}  // namespace palpate
