// SPDX-License-Identifier: MIT
// The shape of the tapping tool, as far as the scene's effects give it one.
#pragma once

#include <palpate/effects.hpp>
#include <palpate/scene.hpp>

namespace palpate::backends {

/// Height of the tool's lowest point when it first meets something on its way straight down at (x, y), metres: that of
/// the scene for a point; higher where the side of a round tip, or the shaft above it, meets a taller place nearby.
/// The largest value over the tool's disc is searched on rings and then around the best point, to 0.1 um where the
/// scene is smooth or has one edge there; details smaller than an eighth of the radius may be missed.
double contact_height(const Scene& scene, const Effects& effects, double x, double y);

}  // namespace palpate::backends
