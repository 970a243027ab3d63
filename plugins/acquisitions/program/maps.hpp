// SPDX-License-Identifier: MIT
// The arrays that a program reads, and its scores: in the format NPY of NumPy, version 1.0, little-endian, in C order
// (https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html).
#pragma once

#include <palpate/belief.hpp>
#include <palpate/surface_belief.hpp>
#include <palpate/types.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::program {

/// One array that a program may read. What only one kind of belief has is null for the other.
struct Map {
  const char* name;
  Quantities reads;                     ///< of a Belief
  std::string (*above)(const Belief&);  ///< as a file NPY; null: not there where the tool comes from above
  Quantities reads_of_approaches;       ///< of a SurfaceBelief
  std::string (*any_side)(const SurfaceBelief&);
};

/// All of them.
const std::vector<Map>& maps();
/// Null for a name that is none of theirs.
const Map* find_map(const std::string& name);

/// Returns the length of the header that follows the first kNpyStart bytes of a file NPY. Throws std::runtime_error
/// with a clause that follows "the program answered with ", for bytes that begin no file NPY of version 1.
std::size_t header_length(const std::string& start);
/// Throws likewise unless the header is that of `count` numbers of type '<f8'.
void check_header(const std::string& text, Eigen::Index count);

}  // namespace palpate::program
