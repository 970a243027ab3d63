// SPDX-License-Identifier: MIT
// Converts a camera's view of the scene before the first tap to heights and labels, from which the models learn. Unseen
// and unclear parts of the desk give no data.
#pragma once

#include "belief/point_cloud.hpp"

#include <palpate/options.hpp>
#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Pose of the point cloud in the frame of the area: a rotation about the area's x axis by `roll`, then y by `pitch`,
/// then z by `yaw`, then a translation.
struct ViewPose : Options {
  double x = 0.0, y = 0.0, z = 0.0;           ///< metres, z in the frame of Scene::desk()
  double roll = 0.0, pitch = 0.0, yaw = 0.0;  ///< radians
  void list(Fields& fields) override;
};

/// The options `prior:` of a belief in a config.
struct PriorOptions : Options {
  std::string depth;     ///< file name of the point cloud
  double unit = 1.0;     ///< length of one unit of the file, metres
  double noise = 0.003;  ///< standard deviation of a height, metres
  double bias = 0.005;   ///< standard deviation of the offset of all heights, metres
  std::optional<ViewPose> pose;
  std::string checksum;  ///< checksum of the file's content, so that the content enters the id of a run

  /// Reads the file for its checksum. A file that cannot be read is an error, unless the checksum is given, so that
  /// records can be read without the file.
  void list(Fields& fields) override;
};

/// Data of one square of the desk that the camera saw clearly. The models use these data like a contact.
struct ViewedSquare {
  Touch touch;             ///< touch at the mean position of the square's points
  double deviation = 0.0;  ///< standard deviation of the height, metres: noise, unevenness and remaining bias
};

/// Number of squares along the longer side of the area. Each square costs as much computing time as a tap, and
/// neighbouring squares carry nearly the same information.
inline constexpr int kSquaresAcross = 14;

/// Transforms points into the frame of the area, metres.
PointCloud in_area_frame(const PointCloud& points, const PriorOptions& options);

/// Computes the data of each square from points in the frame of the area. The offset of all heights is estimated from
/// the squares on the bare desk, whose height is known; `bias` is its prior standard deviation. A square is on an
/// object if it is clearly above the desk and satisfies `scene.on_object()`, and on the desk if it is not above the
/// desk. Other squares, for example at an edge, are left out. The result is sorted by rows, in ascending y. Throws
/// Error if no point is in the area.
std::vector<ViewedSquare> viewed_squares(const PointCloud& points, const PriorOptions& options, const Scene& scene);

/// Reads the file of `options` and computes the data of its squares. Returns no squares if `options` is nullopt. Throws
/// Error with the place "prior.depth" or "prior.checksum" if the file cannot be read or does not match the checksum.
std::vector<ViewedSquare> viewed_squares(const std::optional<PriorOptions>& options, const Scene& scene);

}  // namespace palpate
