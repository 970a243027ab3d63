// SPDX-License-Identifier: MIT
// Polygons raised to a height: any outline without crossings, with at most one hole.
#pragma once

#include "scene/scene_options.hpp"

#include <palpate/shape.hpp>

#include <memory>
#include <string>

namespace palpate {

std::unique_ptr<const Shape> make_polygon(const PolygonOptions& options);
std::unique_ptr<const Shape> make_l(const BarsOptions& options);
std::unique_ptr<const Shape> make_t(const BarsOptions& options);

/// Why `outline` is not that of a solid: too few points, two edges that meet where they should not, no extent. Empty if
/// it is. Counts edges and points from 1, as people do.
std::string trouble_of_outline(const Outline& outline);

/// Why `hole` is not within `outline`, both without trouble of their own; empty if it is.
std::string trouble_of_hole(const Outline& outline, const Outline& hole);

}  // namespace palpate
