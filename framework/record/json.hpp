// SPDX-License-Identifier: MIT
// JSON in and out, as rows and as trees. The only door to the JSON library.
#pragma once

#include "config/tree.hpp"
#include "reading/reading.hpp"
#include "record/row.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// One JSON object as a row: nested objects joined by dots, lists as their text. None, with `reason`, for anything that
/// is not one valid object, that holds more than 4096 values, is nested deeper than 100 levels, or has a name of more
/// than 1 KiB once it is joined.
std::optional<Row> parse_json_row(const std::string& text, std::string* reason = nullptr);

/// Returns the objects of a list; none of them for what is not a list of objects.
std::vector<Row> rows_of(const JsonList& list);
std::vector<Row> rows_of(const Tree& list);

/// Rows as a list of objects.
JsonList list_of(const std::vector<Row>& rows);

/// Reads the lines of a file one by one, an object each, and bounds what they hold together.
class RowLines {
 public:
  explicit RowLines(std::filesystem::path file) : file_(std::move(file)) {}

  /// Passes over a line that is read by somebody else.
  void skip() { ++number_; }
  /// Returns the row of the next line. Throws Error, naming file and line, for one that is no object, for one of more
  /// than 1 MiB, and for more than 1.1 million lines or 20 million values.
  Row read(const std::string& line);

  /// "FILE:LINE" of the last line.
  std::string place() const;
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::size_t number_ = 0;  ///< of the last line, from 1
  std::size_t values_ = 0;
};

/// Hands `use` the objects of a file, one a line. A last line without its line end was cut off by a kill and is left
/// out. Returns the bytes of the complete lines. Throws Error for any other line that is no object.
std::uintmax_t read_json_lines(const std::filesystem::path& file, const std::function<void(Row)>& use);

/// The JSON object in a file of at most 64 MiB, in which nothing is nested deeper than 100 levels: what to_json() wrote
/// comes back as it was. Throws Error.
Tree read_json(const std::filesystem::path& file, Origin origin = Origin::record);

/// The same of the text of a file. Throws Error.
Tree parse_json(const std::string& text, const std::filesystem::path& file);

/// A tree as indented JSON: unquoted scalars stand as they are (numbers, true, false), quoted ones become strings, in
/// which bytes that are not UTF-8 become U+FFFD.
std::string to_json(const Tree& tree);
/// The same of a row as a map, nested by the dots of its names. Numbers as in csv_cell; what is not finite is null.
std::string to_json(const Row& row);

/// The same as one line without its end.
std::string to_json_line(const Tree& tree);
std::string to_json_line(const Row& row);

}  // namespace palpate
