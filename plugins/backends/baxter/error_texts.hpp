// SPDX-License-Identifier: MIT
// Errors and lists in messages of the driver.
#pragma once

#include <palpate/error.hpp>

#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace palpate::baxter {

/// Returns an error of kind `run`: a problem of the robot or its network that a person can fix.
inline Error robot_error(const std::string& where, const std::string& reason, const std::string& hint = {}) {
  return {where, reason, hint, Error::Kind::run};
}

/// Joins words: "a", "a and b", "a, b and c".
inline std::string join_words(const std::vector<std::string>& words) {
  if (words.size() < 2) return words.empty() ? std::string() : words.front();
  return fmt::format("{} and {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

}  // namespace palpate::baxter
