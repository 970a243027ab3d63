// SPDX-License-Identifier: MIT
// Simplifies PLY files for code that supports only a part of the format.
#pragma once

#include "reading/binary_number.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Returns the type with this name in a PLY header, such as "uchar" or "uint8"; null for an unknown name.
const BinaryNumberType* ply_scalar(std::string_view name);

/// Returns the file with only these `elements`, if present, in this order. In the result, words of the header are
/// separated by single blanks, and the byte order mark is removed. For a malformed or incomplete file, only the byte
/// order mark is removed, so that the code that reads the result reports the fault. Lines may end in LF or CRLF. In an
/// ascii file, each row is one line.
/// Source: Turk, The PLY polygon file format, 1994.
std::string plain_ply(std::string bytes, const std::vector<std::string>& elements);

}  // namespace palpate
