// SPDX-License-Identifier: MIT
// Convex solids: half-spaces and at most one quadric. A line meets each of them in an interval, and the solid in the
// intervals' intersection, so that the first hit is exact up to rounding.
#pragma once

#include "scene/scene_options.hpp"

#include <palpate/shape.hpp>

#include <memory>

namespace palpate {

std::unique_ptr<const Shape> make_block(const BlockOptions& options);
std::unique_ptr<const Shape> make_slope(const SlopeOptions& options);
std::unique_ptr<const Shape> make_dome(const DomeOptions& options);
std::unique_ptr<const Shape> make_cylinder(const CylinderOptions& options);
std::unique_ptr<const Shape> make_cone(const ConeOptions& options);
std::unique_ptr<const Shape> make_ellipsoid(const EllipsoidOptions& options);
/// Not convex, but a cylinder less a cylinder: the same intervals.
std::unique_ptr<const Shape> make_ring(const RingOptions& options);

}  // namespace palpate
