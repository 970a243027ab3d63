// SPDX-License-Identifier: MIT
// The header of an array in NumPy's format NPY, versions 1 to 3.
// Source: https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

/// Bytes before the text of the header: in version 1, and the most that any version has.
constexpr std::size_t kNpyStart = 10;
constexpr std::size_t kLongNpyStart = 12;

/// Where the text of a header lies, in bytes from the beginning of the file; the values follow it.
struct NpyPlace {
  std::size_t begin = 0;
  std::size_t length = 0;
};

/// Returns the place that the first bytes of a file tell; none where they begin no such file, or are too few.
std::optional<NpyPlace> npy_header_place(std::string_view bytes);

/// What a header says of the values. What it does not say, or not in the words of the format, is empty.
struct NpyHeader {
  std::string type;                  ///< byte order, kind and bytes, such as "<f8"; of a record what is written there
  std::string order;                 ///< "False" for C's, row after row, "True" for Fortran's
  std::string shape;                 ///< as it is written, without blanks: "(3,4)"
  std::vector<std::uint64_t> sizes;  ///< the same as numbers; empty where one has more than nine digits
};

/// Reads the text of a header, a dictionary of Python. Keys may be in any order, and in quotes of either kind.
NpyHeader read_npy_header(std::string_view text);

}  // namespace palpate
