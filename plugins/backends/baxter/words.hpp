// SPDX-License-Identifier: MIT
// How this backend says things.
#pragma once

#include <palpate/error.hpp>

#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace palpate::baxter {

/// What is wrong with the robot or the way to it, which a person can mend; of kind `run`.
inline Error trouble(const std::string& where, const std::string& reason, const std::string& hint = {}) {
  return {where, reason, hint, Error::Kind::run};
}

/// "a", "a and b", "a, b and c".
inline std::string listed(const std::vector<std::string>& words) {
  if (words.size() < 2) return words.empty() ? std::string() : words.front();
  return fmt::format("{} and {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

}  // namespace palpate::baxter
