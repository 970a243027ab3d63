// SPDX-License-Identifier: MIT
// The arrays that an acquisition program can read, and its scores. Their format is the NPY format of NumPy, version
// 1.0, little-endian, in C order (https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html).
#pragma once

#include <palpate/belief.hpp>
#include <palpate/types.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::program {

/// An array that a program can read.
struct ProgramMap {
  const char* name;
  QuantitySet reads;
  /// returns an NPY file; `desk`: height of the desk, metres
  std::string (*npy)(const BeliefView& belief, double desk);
};

/// Returns all arrays that programs can read.
const std::vector<ProgramMap>& maps();
/// Returns the array with this name. Returns null if there is none.
const ProgramMap* find_map(const std::string& name);

/// Returns the length of the header that follows the first kNpyStart bytes of an NPY file. Throws std::runtime_error
/// unless the bytes start an NPY file of version 1. The message continues the text "the program answered with ".
std::size_t header_length(const std::string& start);
/// Throws std::runtime_error, with a message like that of header_length(), unless the header describes `count` numbers
/// of type '<f8'.
void check_header(const std::string& text, Eigen::Index count);

}  // namespace palpate::program
