// SPDX-License-Identifier: MIT
// JSON in, and trees as JSON out. The only door to the JSON library.
#pragma once

#include "config/tree.hpp"
#include "record/row.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// One JSON object as a row: nested objects joined by dots. None for anything that is not one valid object without
/// lists.
std::optional<Row> parse_json_row(const std::string& text);

/// The objects of a file, one a line. A last line without its line end was cut off by a kill and is left out; `bytes`
/// then says where it begins. Throws Error for any other line that is no object.
struct JsonLines {
  std::vector<Row> rows;
  std::uintmax_t bytes = 0;  ///< of the complete lines
};
JsonLines read_json_lines(const std::filesystem::path& file);

/// A tree as indented JSON: unquoted scalars stand as they are (numbers, true, false), quoted ones become strings.
std::string to_json(const Tree& tree);

/// Whether `text` is valid JSON.
bool is_json(const std::string& text);

}  // namespace palpate
