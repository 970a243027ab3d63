// SPDX-License-Identifier: MIT
// A camera's view of a scene from one side, before the first tap. Each ray is stored as a touch whose path is free up
// to its end.
#pragma once

#include "solids/solids_options.hpp"
#include "solids/surface_touch.hpp"

#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <vector>

namespace palpate {

/// Returns the rays of a camera at a distance of 60 cm from `centre`, or of twice `radius` if that is more. The rays
/// form a square image of the ball around `centre`, row by row. Heights are relative to the desk, metres. Each ray ends
/// on an object, on the desk, or, if it meets neither, behind the ball.
std::vector<SurfaceTouch> side_view(const SideViewOptions& options, const Scene& scene, const Eigen::Vector3d& centre,
                                    double radius, Random random);

/// Returns whether a ray ends on an object.
bool shows_object(const std::vector<SurfaceTouch>& view);

/// Returns at most `most` rays of a view. Most of them end on an object, at most one per cube of 6 mm or larger. Others
/// are neighbours of such rays in the image, and the rest are selected evenly.
std::vector<SurfaceTouch> thinned_view(const std::vector<SurfaceTouch>& view, std::size_t most);

}  // namespace palpate
