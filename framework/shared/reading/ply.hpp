// SPDX-License-Identifier: MIT
// Simplifies PLY files for readers that support only a part of the format.
#pragma once

#include "reading/binary_number.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Returns the type with this name in a PLY header, such as "uchar" or "uint8"; null for an unknown name.
const BinaryNumber* ply_scalar(std::string_view name);

/// Returns the file with only these `elements`, if present, in this order. Header lines have single blanks, and a byte
/// order mark is removed. A malformed or incomplete file is returned unchanged except for the mark, so that the reader
/// reports the fault. Lines may end in LF or CRLF; a row of an ascii file is a line.
/// Source: Turk, The PLY polygon file format, 1994.
std::string plain_ply(std::string bytes, const std::vector<std::string>& elements);

}  // namespace palpate
