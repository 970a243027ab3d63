// SPDX-License-Identifier: MIT
// Random objects: `scene.objects: {draw: {least: 2, most: 6, of: [...]}}` is replaced by a list of objects before any
// other code reads the config. The seed determines the list, and the record contains it.
#pragma once

#include "config/resolve.hpp"
#include "config/tree.hpp"

#include <cstdint>

namespace palpate {

/// Returns whether the objects of a composed config are drawn. Returns true also for an invalid draw.
bool draws_objects(const Tree& config);

/// Replaces `draw` by the objects that `seed` draws. Their number is uniform between `least` and `most`. Each object is
/// one of `of`, with equal probabilities, and each `uniform(a, b)` or `log_uniform(a, b)` in it becomes a number in
/// that range. Each object has its own random stream, so a larger number of objects begins with the same objects.
///
/// Throws Error for invalid objects, also if they are not drawn. Each item of `of` is read with all ranges at their
/// lower ends, with all at their upper ends, and with each single range at the opposite end.
void draw_objects(Tree& config, std::uint64_t seed, const PluginSource& plugins);

}  // namespace palpate
