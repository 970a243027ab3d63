// SPDX-License-Identifier: MIT
// Reads and writes YAML; no other code uses yaml-cpp. The reader is stricter than yaml-cpp: duplicate keys, merge keys,
// several documents and excessive aliases are errors with a source location.
#pragma once

#include "config/tree.hpp"
#include "reading/read_file.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Parses one document. An empty document gives an empty map. `file` is the file name in source locations. Throws Error
/// for invalid YAML.
Tree parse_yaml(const std::string& text, const std::string& file);

/// Reads and parses a regular file of at most 1 MiB. A file of a record must not be a link. Throws Error if the file
/// cannot be read or parsed.
Tree read_yaml(const std::filesystem::path& path, FileOrigin origin = FileOrigin::user);

/// Throws Error, with the location `file`, if read_yaml() would reject the text that to_yaml() writes for this config.
void check_readable(const Tree& config, const std::string& file);

/// Parses the value of an override. Its source locations have no line numbers. A value that is not valid YAML is a
/// text.
Tree parse_value(const std::string& text, const std::string& file);

/// Returns block-style YAML that parses to the same tree.
std::string to_yaml(const Tree& tree);
/// Returns YAML like to_yaml(), with a comment at the end of each line: the source location of the value, or `default`.
/// Example: `length_scale: 0.017 m # configs/kernel/rbf.yaml:3:17`. The comments are left out if the text would be too
/// large for a config.
std::string to_yaml_with_places(const Tree& tree);

/// Returns the source locations in the comments that to_yaml_with_places() wrote. Element i belongs to line i, counted
/// from 1. Element 0 and the elements of lines without a comment are "".
std::vector<std::string> places_of_lines(std::string_view text);

}  // namespace palpate
