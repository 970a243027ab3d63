// SPDX-License-Identifier: MIT
// Reads and writes YAML; no other code uses yaml-cpp. The reader is stricter than yaml-cpp: duplicate keys, merge keys,
// several documents and excessive aliases are errors with a place.
#pragma once

#include "config/tree.hpp"
#include "reading/reading.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Parses one document. An empty document is an empty map. `file` is the name in places. Throws Error.
Tree parse_yaml(const std::string& text, const std::string& file);

/// Reads and parses a regular file of at most 1 MiB. A file of a record must not be a link. Throws Error.
Tree read_yaml(const std::filesystem::path& path, Origin origin = Origin::user);

/// Throws Error, with the place `file`, if read_yaml() would reject the text that to_yaml() writes for this config.
void check_readable(const Tree& config, const std::string& file);

/// Parses the value of an override. Its places have no lines. A value that is not valid YAML is a text.
Tree parse_value(const std::string& text, const std::string& file);

/// Returns block-style YAML that parses to the same tree.
std::string to_yaml(const Tree& tree);
/// Returns YAML like to_yaml(), with a comment at the end of each line that gives the place of the value, or `default`.
/// Example: `length_scale: 0.017 m # configs/kernel/rbf.yaml:3:17`. The places are left out if the text would be too
/// large for a config.
std::string to_yaml_with_places(const Tree& tree);

/// Returns the places in the comments of to_yaml_with_places(), by line number from 1. Index 0 and lines without a
/// comment have "".
std::vector<std::string> places_of_lines(std::string_view text);

}  // namespace palpate
