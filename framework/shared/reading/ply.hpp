// SPDX-License-Identifier: MIT
// PLY as other programs write it, made plain for readers that know less of it.
#pragma once

#include "reading/binary_number.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Returns the scalar that a PLY calls so, as "uchar" or "uint8"; null for an unknown name.
const BinaryNumber* ply_scalar(std::string_view name);

/// Returns the file with these `elements` alone, those that it has, in this order, each line of its header in single
/// blanks and without a byte order mark. What is no sound PLY, or is cut short, comes back as it is, but for the mark:
/// the reader says what is wrong with it. Lines end in LF or CRLF; a row of an ascii file is a line.
/// Source: Turk, The PLY polygon file format, 1994.
std::string plain_ply(std::string bytes, const std::vector<std::string>& elements);

}  // namespace palpate
