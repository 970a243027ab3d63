// SPDX-License-Identifier: MIT
// Reads the header of an array in NumPy's format NPY, versions 1 to 3.
// Source: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Number of bytes before the text of the header: kNpyStart in version 1, kLongNpyStart in later versions.
constexpr std::size_t kNpyStart = 10;
constexpr std::size_t kLongNpyStart = 12;

/// Position of the header's text, in bytes from the beginning of the file. The values of the array follow the text.
struct NpyHeaderSpan {
  std::size_t begin = 0;
  std::size_t length = 0;
};

/// Reads the position of the header's text from the first bytes of a file. Returns nullopt if there are too few bytes
/// or the file is not an NPY file.
std::optional<NpyHeaderSpan> npy_header_place(std::string_view bytes);

/// Description of an array, as the header of its file contains it. Missing or malformed parts are empty.
struct NpyHeader {
  std::string type;   ///< byte order, kind and size, such as "<f8"; for structured types the text of the header
  std::string order;  ///< "False" for C order (by rows), "True" for Fortran order
  std::string shape;  ///< text of the header without blanks: "(3,4)"
  std::vector<std::uint64_t> sizes;  ///< the numbers of the shape; empty if a number has more than nine digits
};

/// Parses the text of a header, a Python dictionary. Keys may have any order and either kind of quotes.
NpyHeader read_npy_header(std::string_view text);

}  // namespace palpate
