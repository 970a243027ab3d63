// SPDX-License-Identifier: MIT
// Encoding of the drawn lines that a backend rejected, as in TapRecord::unreached.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace palpate {

inline constexpr std::string_view kHexDigits = "0123456789abcdef";

/// Returns whether the line with this index, counted from 0, was rejected.
inline bool is_unreached(const std::string& marks, std::size_t line) {
  return line / 4 < marks.size() && (kHexDigits.find(marks[line / 4]) & (std::size_t{8} >> line % 4)) != 0;
}

/// Marks the line with this index as rejected.
inline void mark_unreached(std::string& marks, std::size_t line) {
  marks.resize(std::max(marks.size(), line / 4 + 1), kHexDigits[0]);
  marks[line / 4] = kHexDigits[kHexDigits.find(marks[line / 4]) | (std::size_t{8} >> line % 4)];
}

}  // namespace palpate
