// SPDX-License-Identifier: MIT
// Arrays that a program reads, and its scores. Format: NPY of NumPy, version 1.0, little-endian, C order
// (https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html).
#pragma once

#include <palpate/belief.hpp>
#include <palpate/types.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::program {

/// An array that a program may read.
struct Map {
  const char* name;
  QuantitySet reads;
  std::string (*npy)(const BeliefView& belief, double desk);  ///< returns an NPY file; `desk`: its height, metres
};

/// Returns all available arrays.
const std::vector<Map>& maps();
/// Returns the array with this name, or null.
const Map* find_map(const std::string& name);

/// Returns the length of the header after the first kNpyStart bytes of an NPY file. Throws std::runtime_error unless
/// the bytes start an NPY file of version 1; its text continues "the program answered with ".
std::size_t header_length(const std::string& start);
/// Throws std::runtime_error, as above, unless the header describes `count` numbers of type '<f8'.
void check_header(const std::string& text, Eigen::Index count);

}  // namespace palpate::program
