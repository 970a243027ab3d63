// SPDX-License-Identifier: MIT
// Heights on a grid, from a file: a table of numbers, an array of NumPy or an image.
#pragma once

#include <Eigen/Core>

#include <string>

namespace palpate::shapes {

constexpr Eigen::Index kMostNodes = 4'000'000;

/// Values as the file has them, the row that an image shows at its top first.
using Grid = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Reads `bytes` as the ending of `file` tells:
///
/// - .csv: a row of numbers a line, with commas between them; a byte order mark and blank lines at the end are no part;
/// - .npy: an array of two dimensions, of whole numbers of 8 to 64 bits or of single or double precision
///   (numpy.lib.format, versions 1 to 3);
/// - .png: grey levels of 8 or 16 bits, as they are, 0 to 255 or 65535.
///
/// Throws Error, its `where` the file: another format, damaged, rows of different lengths, less than 2 x 2 or more than
/// kMostNodes values, one that is negative or not finite, none above 0.
Grid read_grid(const std::string& bytes, const std::string& file);

}  // namespace palpate::shapes
