// SPDX-License-Identifier: MIT
// Random objects: `scene.objects: {draw: {least: 2, most: 6, of: [...]}}` is replaced by a list of objects before any
// other code reads the config. The seed determines the list, and the list is stored in the record.
#pragma once

#include "config/resolve.hpp"
#include "config/tree.hpp"

#include <cstdint>

namespace palpate {

/// Returns whether `scene.objects` of a composed config is a map without `type`: a random draw, valid or invalid.
bool draws_objects(const Tree& config);

/// Replaces `draw` by a list of random objects that depend only on `seed`. Their number is uniform between `least` and
/// `most`. Each object is one of `of`, with equal probabilities, and each `uniform(a, b)` or `log_uniform(a, b)` in it
/// becomes a number in that range. Each object has its own random stream. So if the same seed draws more objects, the
/// first objects stay the same.
///
/// Throws Error for invalid objects in `of`, even if these are not drawn. Each item of `of` is checked with all ranges
/// at their lower ends and with all ranges at their upper ends. Both checks are repeated with each single range at its
/// opposite end.
void draw_objects(Tree& config, std::uint64_t seed, const PluginSource& plugins);

}  // namespace palpate
