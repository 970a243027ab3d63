// SPDX-License-Identifier: MIT
// The drawn lines that a backend rejected, as the record has them: TapRecord::unreached.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace palpate {

inline constexpr std::string_view kHexDigits = "0123456789abcdef";

/// Whether the line of that number, from 0, was rejected.
inline bool is_unreached(const std::string& marks, std::size_t line) {
  return line / 4 < marks.size() && (kHexDigits.find(marks[line / 4]) & (std::size_t{8} >> line % 4)) != 0;
}

/// Marks the line of that number.
inline void mark_unreached(std::string& marks, std::size_t line) {
  marks.resize(std::max(marks.size(), line / 4 + 1), kHexDigits[0]);
  marks[line / 4] = kHexDigits[kHexDigits.find(marks[line / 4]) | (std::size_t{8} >> line % 4)];
}

}  // namespace palpate
