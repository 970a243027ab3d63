// SPDX-License-Identifier: MIT
// What a camera saw of a scene from one side before the first tap: rays through the scene, as touches whose way is free
// up to what was seen.
#pragma once

#include "solids/solids_options.hpp"
#include "solids/surface_touch.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace palpate {

/// The rays of a camera 60 cm from `centre`, a square of them over the ball of this radius around it, row by row; in
/// lengths relative to the desk. Each ends on an object, on the desk, or, where it meets neither, behind the ball.
std::vector<SurfaceTouch> side_view(const SideViewOptions& options, const Scene& scene, const Eigen::Vector3d& centre,
                                    double radius, Random random);

/// Whether one of them ends on an object.
bool shows_object(const std::vector<SurfaceTouch>& view);

/// At most `most` rays of a view: those that end on an object, one in a cube of 6 mm or larger; those that pass by one,
/// beside them in the picture; and some of all others, evenly.
std::vector<SurfaceTouch> thinned_view(const std::vector<SurfaceTouch>& view, std::size_t most);

}  // namespace palpate
