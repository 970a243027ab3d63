// SPDX-License-Identifier: MIT
// Real numbers as text: the shortest digits that read back as the same bits.
#pragma once

#include <cstddef>

namespace palpate {

/// The longest text of a number: -2.2250738585072014e-308.
constexpr std::size_t kLongestNumber = 24;

/// Writes a number as rows of records have it, and returns its end: as fmt's "{}", to the letter and in half the time.
char* write_number(char* to, double value);

/// The same as maps have it: as std::to_chars, with an exponent where that is shorter.
char* write_shortest(char* to, double value);

}  // namespace palpate
