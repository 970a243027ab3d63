// SPDX-License-Identifier: MIT
// YAML in and out. The only door to yaml-cpp, and the place where its leniencies end: duplicate keys, merge keys,
// several documents and alias bombs are errors with a place.
#pragma once

#include "config/tree.hpp"
#include "reading/reading.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Parses one document; an empty one is an empty map. `file` is what places will name. Throws Error.
Tree parse_yaml(const std::string& text, const std::string& file);

/// Reads and parses a file, which must be a regular file of at most 1 MiB; that of a record is no link. Throws Error.
Tree read_yaml(const std::filesystem::path& path, Origin origin = Origin::user);

/// Throws Error, naming `file`, for a config that read_yaml() would not read once to_yaml() has written it.
void check_readable(const Tree& config, const std::string& file);

/// A single value as it stands behind the `=` of an override; its places have no lines. What does not parse as YAML is
/// taken as text.
Tree parse_value(const std::string& text, const std::string& file);

/// Block-style YAML that reads back as the same tree.
std::string to_yaml(const Tree& tree);
/// The same, with the place of each value, or `default` where it has none, as a comment at the end of its line:
/// `length_scale: 0.017 m  # configs/kernel/rbf.yaml:3:17`. Without places where it would be too large for a config.
std::string to_yaml_with_places(const Tree& tree);

/// Returns these comments of a text by their lines, from 1, with "" at 0 and where there is none.
std::vector<std::string> places_of_lines(std::string_view text);

}  // namespace palpate
