// SPDX-License-Identifier: MIT
// JSON in and out, as rows and as trees. The only door to the JSON library.
#pragma once

#include "config/tree.hpp"
#include "record/row.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// One JSON object as a row: nested objects joined by dots. None for anything that is not one valid object without
/// lists, or whose names take over 1 MiB once they are joined.
std::optional<Row> parse_json_row(const std::string& text);

/// The same of a file of at most 64 MiB; none where there is no file. Throws Error for anything else, with `remedy`.
std::optional<Row> read_json_row(const std::filesystem::path& file, const std::string& remedy);

/// The objects of a file, one a line. A last line without its line end was cut off by a kill and is left out; `bytes`
/// then says where it begins. Throws Error for any other line that is no object.
struct JsonLines {
  std::vector<Row> rows;
  std::uintmax_t bytes = 0;  ///< of the complete lines
};
JsonLines read_json_lines(const std::filesystem::path& file);

/// The JSON object in a file of at most 64 MiB, in which nothing is nested deeper than 100 levels: what to_json() wrote
/// comes back as it was. Throws Error.
Tree read_json(const std::filesystem::path& file);

/// The same of what lies from `begin` to `end` in the text of a file. Throws Error.
Tree parse_json(const std::string& text, std::size_t begin, std::size_t end, const std::filesystem::path& file);

/// A tree as indented JSON: unquoted scalars stand as they are (numbers, true, false), quoted ones become strings.
std::string to_json(const Tree& tree);

/// The same as one line without its end.
std::string to_json_line(const Tree& tree);

/// Whether `text` is valid JSON.
bool is_json(const std::string& text);

}  // namespace palpate
