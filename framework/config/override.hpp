// SPDX-License-Identifier: MIT
// Overrides on the command line: KEY=VALUE, where KEY is a dotted path and VALUE is YAML.
#pragma once

#include "config/tree.hpp"

#include <string>
#include <vector>

namespace palpate {

/// An override of one value.
struct Override {
  std::string path;
  Tree value;
};

/// Parses `KEY=VALUE`. Throws Error for a missing '=', an empty key, and a value with a comment.
Override parse_override(const std::string& text);

/// Throws Error if two overrides have the same key.
void check_given_once(const std::vector<std::string>& texts);

/// Throws Error, with `place`, for an invalid path, and for a path of more than 100 levels or 1024 characters.
void check_path(const std::string& path, const std::string& place);

}  // namespace palpate
