// SPDX-License-Identifier: MIT
// Objects drawn from the seed: `scene.objects: {draw: {least: 2, most: 6, of: [...]}}` stands for a list of objects,
// and is that list before anything else reads the config. The record of a run, and all that comes after, knows the list
// alone.
#pragma once

#include "config/resolve.hpp"
#include "config/tree.hpp"

#include <cstdint>

namespace palpate {

/// Whether the objects of a composed config are drawn, or meant to be.
bool draws_objects(const Tree& config);

/// Puts the objects that `seed` draws in the place of `draw`. Their number is uniform in least..most; each is one of
/// `of`, any as likely as another, and each `uniform(a, b)` or `log_uniform(a, b)` in it a number of that range. Every
/// object has a stream of its own, so that the first of many are those of few.
///
/// Throws Error for what no object may be, whether it is drawn or not: all of `of` are read with every range at its
/// lower and at its upper end, and with each range alone at the other end.
void draw_objects(Tree& config, std::uint64_t seed, const PluginSource& plugins);

}  // namespace palpate
