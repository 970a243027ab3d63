// SPDX-License-Identifier: MIT
// Reads and writes JSON as rows and as trees. No other file uses the JSON library.
#pragma once

#include "config/tree.hpp"
#include "reading/read_file.hpp"
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

/// Returns a JSON object as a row: names of nested objects are joined by dots, lists are kept as text. Returns nullopt
/// and sets `reason` if the text is not one valid object. The limits are 4096 values, 100 levels, and 1 KiB per joined
/// name.
std::optional<Row> parse_json_row(const std::string& text, std::string* reason = nullptr);

/// Returns the objects in a list. Items that are not objects or that exceed the limits of parse_json_row() are left
/// out.
std::vector<Row> rows_of(const JsonList& list);
std::vector<Row> rows_of(const Tree& list);

/// Returns rows as a list of objects.
JsonList list_of(const std::vector<Row>& rows);

/// Reads the lines of a file with one JSON object per line, and limits the total number of lines and values.
class JsonLinesReader {
 public:
  explicit JsonLinesReader(std::filesystem::path file) : file_(std::move(file)) {}

  /// Counts a line that the caller reads itself.
  void skip() { ++number_; }
  /// Returns the row of the next line. Throws Error, with file and line, if the line is not an object or is longer than
  /// 1 MiB. Also throws Error after 1.1 million lines or 20 million values.
  Row read(const std::string& line);

  /// Returns "FILE:LINE" of the last line.
  std::string place() const;
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::size_t number_ = 0;  ///< number of the last line, from 1
  std::size_t values_ = 0;
};

/// Calls `use` with each object of a file that has one object per line. If the last line has no line end, a kill has
/// cut it off, and it is skipped. Returns the number of bytes of all complete lines. Throws Error for a complete line
/// that is not an object.
std::uintmax_t read_json_lines(const std::filesystem::path& file, const std::function<void(Row)>& use);

/// Returns the JSON object in a file of at most 64 MiB and 100 levels. A file written by to_json() gives the same tree
/// again. Throws Error.
Tree read_json(const std::filesystem::path& file, FileOrigin origin = FileOrigin::record);

/// Returns the JSON object in `text`, the content of `file`. Throws Error.
Tree parse_json(const std::string& text, const std::filesystem::path& file);

/// Returns a tree as indented JSON. Unquoted scalars (numbers, true, false) are copied as they are; quoted ones become
/// strings. In strings, bytes that are not UTF-8 become U+FFFD.
std::string to_json(const Tree& tree);
/// Returns a row as an indented JSON object, nested by the dots in its names. Numbers are formatted as in csv_cell();
/// numbers that are not finite become null.
std::string to_json(const Row& row);

/// Returns the same JSON in one line, without a line end.
std::string to_json_line(const Tree& tree);
std::string to_json_line(const Row& row);

}  // namespace palpate
