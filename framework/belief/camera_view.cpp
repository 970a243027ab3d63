// SPDX-License-Identifier: MIT
#include "belief/camera_view.hpp"

#include "config/catch_error.hpp"
#include "config/hash.hpp"
#include "reading/read_file.hpp"
#include "scene/rotation.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {
namespace {

std::string bytes_of(const std::string& file) {
  FileReading reading = read_bounded(file, kMostViewBytes, FileOrigin::user);
  if (reading) return std::move(reading.text);
  if (reading.kind == FileReading::Kind::absent)
    throw Error(file, "no such file", "a relative path starts in the current folder");
  if (reading.kind == FileReading::Kind::not_regular) throw Error(file, "not a regular file", "name a PLY");
  if (reading.kind == FileReading::Kind::too_large)
    throw Error(file, "is too large for a view: at most 64 MiB are read", "reduce the number of points");
  throw Error(file, words_of(reading, kMostViewBytes).reason);
}

// Limits of a square's height above the desk, in standard deviations of this height. Above kObjectSigmas, the square is
// on an object; up to kDeskSigmas, it is on the desk. A height in between may be a low object or noise.
constexpr double kObjectSigmas = 2.5;
constexpr double kDeskSigmas = 1.0;

/// Moments of the points in one square of the desk.
struct Square {
  int count = 0;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0.0;  ///< sum of the squared heights

  void add(const Eigen::Vector3d& point) {
    ++count;
    sum += point;
    squares += point.z() * point.z();
  }
  Eigen::Vector3d mean() const { return sum / count; }
  double variance() const { return std::max(0.0, squares / count - mean().z() * mean().z()); }
};

/// Posterior of the offset of all heights, metres.
struct Offset {
  double mean = 0.0;
  double variance = 0.0;
};

/// Computes the offset from the heights of squares on the desk. `noise`: standard deviation of a height; `bias`: prior
/// standard deviation of the offset, metres.
Offset offset_of(const std::vector<double>& desk_heights, double noise, double bias) {
  if (bias == 0.0) return {};
  if (noise == 0.0 && !desk_heights.empty()) return {desk_heights.front(), 0.0};
  double precision = 1.0 / (bias * bias);
  double sum = 0.0;
  for (const double height : desk_heights) {
    precision += 1.0 / (noise * noise);
    sum += height / (noise * noise);
  }
  return {sum / precision, 1.0 / precision};
}

}  // namespace

void ViewPose::list(Fields& fields) {
  fields.real(x, Field("x", "x of the point cloud's origin in the frame of the area").in(Unit::metre));
  fields.real(y, Field("y", "y of the point cloud's origin in the frame of the area").in(Unit::metre));
  fields.real(z, Field("z", "z (upwards) of the point cloud's origin in the frame of the area").in(Unit::metre));
  fields.real(roll,
              Field("roll", "rotation of the point cloud about the area's x axis, applied first").in(Unit::radian));
  fields.real(pitch,
              Field("pitch", "rotation of the point cloud about the area's y axis, applied second").in(Unit::radian));
  fields.real(yaw, Field("yaw", "rotation of the point cloud about the area's z axis, applied last").in(Unit::radian));
}

void PriorOptions::list(Fields& fields) {
  fields.text(depth, Field("depth",
                           "PLY file with the points of a depth camera. A relative path starts in the working folder "
                           "or in the folder of the config")
                         .needed()
                         .names_file()
                         .not_identifying());
  fields.real(unit, Field("unit", "length of one unit of the PLY file").in(Unit::metre).above(0));
  fields.real(noise, Field("noise", "standard deviation of a height measured by the camera")
                         .in(Unit::metre)
                         .at_least(0)
                         .from("3 mm: structured light at 1 m, an estimate"));
  fields.real(bias, Field("bias", "standard deviation of the camera's height offset, which is the same for all points")
                        .in(Unit::metre)
                        .at_least(0)
                        .from("5 mm: error of the camera's assumed position, an estimate"));
  fields.section(
      pose,
      Field(
          "pose",
          "pose of the point cloud in the frame of the area; not given: the point cloud is in the frame of the area"));
  const auto trouble = catch_error([&] { checksum = depth.empty() ? "" : hash_of(bytes_of(depth)); });
  fields.text(checksum, Field("checksum", "checksum of the file content; not given: computed from the file"));
  // A record has the checksum, so the file is not needed. The text of the error already contains the file name.
  fields.require(!trouble || !checksum.empty(), "depth", trouble ? trouble->what() : "");
}

PointCloud in_area_frame(const PointCloud& points, const PriorOptions& options) {
  PointCloud out = options.unit * points;
  if (!options.pose) return out;
  const ViewPose& pose = *options.pose;
  const Eigen::Matrix3d turn = rotation_about(Eigen::Vector3d::UnitZ(), pose.yaw) *
                               rotation_about(Eigen::Vector3d::UnitY(), pose.pitch) *
                               rotation_about(Eigen::Vector3d::UnitX(), pose.roll);
  return (turn * out).colwise() + Eigen::Vector3d(pose.x, pose.y, pose.z);
}

std::vector<ViewedSquare> viewed_squares(const PointCloud& points, const PriorOptions& options, const Scene& scene) {
  const Area area = scene.area();
  const double side = std::max(area.width, area.depth) / kSquaresAcross;
  const auto columns = static_cast<std::size_t>(std::ceil(area.width / side - 1e-9));
  const auto rows = static_cast<std::size_t>(std::ceil(area.depth / side - 1e-9));
  std::vector<Square> squares(columns * rows);
  for (const auto& point : points.colwise()) {
    if (point.x() < 0.0 || point.x() > area.width || point.y() < 0.0 || point.y() > area.depth) continue;
    const std::size_t column = std::min(columns - 1, static_cast<std::size_t>(point.x() / side));
    const std::size_t row = std::min(rows - 1, static_cast<std::size_t>(point.y() / side));
    squares[row * columns + column].add({point.x(), point.y(), point.z() - scene.desk()});
  }
  squares.erase(std::remove_if(squares.begin(), squares.end(), [](const Square& one) { return one.count == 0; }),
                squares.end());
  if (squares.empty())
    throw Error("prior.depth", fmt::format("none of its {} points is in the area", points.cols()),
                "check unit and pose");
  const double noise = options.noise;
  const double reach = kObjectSigmas * math::hypot(noise, options.bias);
  std::vector<double> desk_heights;
  for (const Square& one : squares) {
    if (std::abs(one.mean().z()) <= reach && one.variance() <= 4.0 * noise * noise)
      desk_heights.push_back(one.mean().z());
  }
  const Offset offset = offset_of(desk_heights, noise, options.bias);
  std::vector<ViewedSquare> out;
  for (const Square& one : squares) {
    const Eigen::Vector3d mean = one.mean();
    const double unevenness = std::max(0.0, one.variance() - noise * noise);
    const double deviation = std::sqrt(noise * noise + unevenness + offset.variance);
    const double height = mean.z() - offset.mean;
    const bool on = height > kObjectSigmas * deviation && scene.on_object(scene.desk() + height);
    if (!on && height > kDeskSigmas * deviation) continue;
    out.push_back({{{mean.x(), mean.y()}, on ? height : 0.0, on}, on ? deviation : noise});
  }
  return out;
}

std::vector<ViewedSquare> viewed_squares(const std::optional<PriorOptions>& options, const Scene& scene) {
  if (!options) return {};
  std::string bytes;
  if (const auto trouble = catch_error([&] { bytes = bytes_of(options->depth); }))
    throw Error("prior.depth", trouble->what(), {}, trouble->kind());
  if (const std::string found = hash_of(bytes); !options->checksum.empty() && found != options->checksum)
    throw Error("prior.checksum", "does not match " + options->depth + ", whose checksum is " + found);
  return viewed_squares(in_area_frame(read_points(bytes, options->depth), *options), *options, scene);
}

}  // namespace palpate
