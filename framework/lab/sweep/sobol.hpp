// SPDX-License-Identifier: MIT
// Sobol points in continuous ranges. They fill a space of several keys more evenly than a grid or random points.
#pragma once

#include "config/expand.hpp"

#include <vector>

namespace palpate {

/// Reads `{samples: 64, keys: {kernel.length_scale: "log_uniform(1 cm, 10 cm)", height.noise: "uniform(0.1 mm, 1
/// mm)"}}`. Returns one axis per key with `samples` values (1 to 100000); the i-th values of all axes are the i-th
/// point. The points are those of a Sobol sequence with a fixed digital shift, so that they are the same every time,
/// and fewer samples are the first of more. Throws Error.
std::vector<Axis> sobol_axes(const Tree& described, ValueCount& count);

}  // namespace palpate
