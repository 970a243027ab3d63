// SPDX-License-Identifier: MIT
// Sobol points in continuous ranges. They fill a space of several keys more evenly than a grid or random points.
#pragma once

#include "config/expand.hpp"

#include <cstddef>
#include <string_view>
#include <vector>

namespace palpate {

/// Reads `{samples: 64, keys: {kernel.length_scale: "log_uniform(1 cm, 10 cm)", belief.height.noise: "uniform(0.1 mm, 1
/// mm)"}}`. Returns one axis per key with `samples` values (1 to 100000). The i-th values of all axes are the i-th
/// point of a Sobol sequence. The digital shift of the sequence is fixed, so that all calls return the same points. A
/// smaller sample is the beginning of a larger sample. Throws Error.
std::vector<SweepAxis> sobol_axes(const Tree& described, ValueCount& count);

/// Returns `count` points of a Sobol sequence, with coordinates from 0 (included) to 1 (excluded). `purpose` decides
/// the digital shift of the sequence. `dimensions` is at most 3667.
std::vector<std::vector<double>> sobol_points(std::size_t count, std::size_t dimensions, std::string_view purpose);

}  // namespace palpate
