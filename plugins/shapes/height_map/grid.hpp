// SPDX-License-Identifier: MIT
// Reader for heights on a grid, from a CSV table, a NumPy array or an image.
#pragma once

#include <Eigen/Core>

#include <string>

namespace palpate::shapes {

constexpr Eigen::Index kMostNodes = 4'000'000;

/// Values in the order of the file. The first row is the top of an image.
using Grid = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Reads `bytes` in the format of the extension of `file`:
///
/// - .csv: one row of numbers per line, separated by commas; a byte order mark and blank lines at the end are ignored;
/// - .npy: a two-dimensional array of integers of 8 to 64 bits, or of single or double precision (numpy.lib.format,
///   versions 1 to 3);
/// - .png: grey levels of 8 or 16 bits, unscaled, 0 to 255 or 65535.
///
/// Throws Error with the file as its place for another format, a damaged file, and rows of different lengths. Also
/// throws Error for fewer than 2 x 2 or more than kMostNodes values, a negative or infinite value, or no value above 0.
Grid read_grid(const std::string& bytes, const std::string& file);

}  // namespace palpate::shapes
