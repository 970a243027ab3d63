// SPDX-License-Identifier: MIT
// What a camera saw of the scene before the first tap, as heights and labels that the models can learn from. It may
// have seen little: what it did not see, or saw without being clear, is left to the taps.
#pragma once

#include "view/points.hpp"

#include <palpate/options.hpp>
#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Where the frame of the points lies in that of the area: first turned about the area's x by `roll`, then y by
/// `pitch`, then z by `yaw`, then moved.
struct ViewPose : Options {
  double x = 0.0, y = 0.0, z = 0.0;           ///< metres; z = 0 is the frame's in which the desk has its height
  double roll = 0.0, pitch = 0.0, yaw = 0.0;  ///< radians
  void list(Fields& fields) override;
};

/// `prior:` of a config.
struct PriorOptions : Options {
  std::string depth;     ///< the file of the points
  double unit = 1.0;     ///< of the file, metres
  double noise = 0.003;  ///< metres
  double bias = 0.005;   ///< metres
  std::optional<ViewPose> pose;
  std::string checksum;  ///< so that the id of a run follows the content of the file

  /// Reads the file for its checksum. One that cannot be read is refused, unless the checksum is given: then the file
  /// is needed only where its points are, and records are read without it.
  void list(Fields& fields) override;
};

/// A square of the desk that was seen, as clearly as a touch would tell it.
struct ViewedSquare {
  Touch touch;             ///< at the mean place of its points
  double deviation = 0.0;  ///< of the height, metres: noise, unevenness, and what is left of the bias
};

/// Squares that are seen are at most so many along the longer side of the area: as many touches cost what so many taps
/// do, and neighbours tell the same.
inline constexpr int kSquaresAcross = 14;

/// Points as they lie in the frame of the area, metres.
PointCloud in_area_frame(const PointCloud& points, const PriorOptions& options);

/// What these points say, square by square. All heights may be wrong by one offset, of which `bias` is the standard
/// deviation; the desk, whose height is known, tells most of it where it is seen. A square counts as an object's where
/// it is clearly above the desk and `scene.on_object()`, as the desk's where it is not above it; one that shows
/// neither, as at an edge, is left out, and so are points outside the area. Sorted by rows from below. Throws Error
/// where no point lies in the area.
std::vector<ViewedSquare> viewed_squares(const PointCloud& points, const PriorOptions& options, const Scene& scene);

/// Those of the file of `options`, or none without. Throws Error, its `where` "prior.depth" or "prior.checksum", for a
/// file that cannot be read, or is another than the checksum says.
std::vector<ViewedSquare> viewed_squares(const std::optional<PriorOptions>& options, const Scene& scene);

}  // namespace palpate
