// SPDX-License-Identifier: MIT
// What a command line says of a config: KEY=VALUE, a dotted path and a value in YAML.
#pragma once

#include "config/tree.hpp"

#include <string>
#include <vector>

namespace palpate {

/// One `KEY=VALUE`.
struct Override {
  std::string path;
  Tree value;
};

/// Splits and reads `KEY=VALUE` as typed. Throws Error for a missing '=', an empty key and a value with a comment.
Override parse_override(const std::string& text);

/// Throws Error where two of these KEY=VALUE are of the same key: nobody could tell which one is meant.
void check_given_once(const std::vector<std::string>& texts);

/// Throws Error, with `place`, for what is no dotted path, and for one of more than 100 levels or 1024 characters.
void check_path(const std::string& path, const std::string& place);

}  // namespace palpate
