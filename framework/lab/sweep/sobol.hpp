// SPDX-License-Identifier: MIT
// Quasi-random points of continuous ranges: they fill a space of several keys far more evenly than a product of as many
// values, or random ones, would.
#pragma once

#include "config/expand.hpp"

#include <vector>

namespace palpate {

/// Reads `{samples: 64, keys: {kernel.length_scale: "log_uniform(1 cm, 10 cm)", height.noise: "uniform(0.1 mm, 1
/// mm)"}}`: one axis a key with as many values as samples, the i-th values of all keys being the i-th point. A Sobol
/// sequence with a fixed digital shift, so the same points every time, and fewer samples are the first of more.
/// `samples` is 1 to 100000; of a range both ends have the same unit, and the first lies below the last (above 0 if
/// logarithmic). Throws Error.
std::vector<Axis> sobol_axes(const Tree& described, ValueCount& count);

}  // namespace palpate
