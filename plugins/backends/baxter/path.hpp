// SPDX-License-Identifier: MIT
// Paths of the tool, planned as joint positions before the arm moves. Unreachable positions are found in advance, and
// the control loop only interpolates.
#pragma once

#include "baxter/kinematics.hpp"
#include "baxter/options.hpp"

#include <palpate/scene.hpp>

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate::baxter {

/// Path of the tip with joint positions at increasing distances along it. Joints are interpolated linearly between
/// these points.
class Path {
 public:
  /// Appends `joints`, at `distance` metres after the last point.
  void add(const Joints& joints, double distance);

  /// Returns the length in metres.
  double length() const { return at_.empty() ? 0.0 : at_.back(); }
  /// Returns the joints at `distance` metres from the start, clamped to the ends of the path.
  Joints at(double distance) const;
  /// Returns the distance (m) after one more period of `seconds` at `speed` (m/s). The speed is reduced where a joint
  /// would rotate faster than kJointSpeed.
  double advance(double distance, double speed, double seconds) const;

  /// Returns the reversed path from `distance` metres to the start.
  Path back(double distance) const;
  /// Returns the largest rotation of a joint per metre of the path, rad/m.
  double steepest() const;

  const Joints& front() const { return joints_.front(); }
  const Joints& end() const { return joints_.back(); }

 private:
  std::size_t segment(double distance) const;
  double slope(std::size_t segment) const;

  std::vector<double> at_;
  std::vector<Joints> joints_;
};

/// Largest speed of a joint, rad/s. An arm that trails its set-point by 0.4 s is then 0.16 rad behind, less than
/// MotionGuard::kFollowing.
constexpr double kJointSpeed = 0.4;

/// Thrown if no path exists; `reason` is one line.
struct NoPath {
  std::string reason;
};

/// Returns joints for a pose of the tip, searched near `seed`, or nullopt. May throw the errors of the solver.
using Inverse = std::function<std::optional<Joints>(const Pose& tip, const Joints& seed)>;

/// Plans paths in the frame of the scene. Methods throw NoPath.
class Planner {
 public:
  Planner(const ScenePoseOptions& place, const ArmKinematics& arm, Inverse inverse)
      : frame_(place.frame()), arm_(arm), inverse_(std::move(inverse)) {}

  /// Returns the pose in `base` of a tool that points straight down at the scene position `place` and `height` (m).
  Pose pose(const Target& place, double height) const {
    return {frame_ * Eigen::Vector3d(place.x, place.y, height), straight_down()};
  }
  Eigen::Vector3d to_scene(const Eigen::Vector3d& base) const { return frame_.inverse() * base; }

  /// Plans a column: a path straight down at `place`, from `hover` to `floor` (m). Inverse kinematics at `hover` starts
  /// from the solution at `middle`, and at each lower height from the solution above. So a column depends only on its
  /// position, not on the arm's earlier path. Throws if the tip's `speed` (m/s) requires a joint speed above
  /// kJointSpeed.
  Path column(const Target& place, const Target& middle, double hover, double floor, double speed) const;

  /// Plans a path from `from` to `to` with the tip on a straight line and the hand rotating evenly.
  Path line(const Joints& from, const Joints& to) const;

  /// Plans a path straight up from `from` by `rise` metres, with constant rotation of the hand.
  Path up(const Joints& from, double rise) const;

  /// Raises the scene by `height` metres, after a calibration tap.
  void raise(double height) { frame_.translation().z() += height; }

 private:
  Joints solve(const Pose& tip, const Joints& seed, const char* what) const;
  /// Plans a vertical motion of the tip by `rise` metres (negative: down), starting with joints `from` at pose `tip`.
  /// Inverse kinematics at each height starts from the previous solution. `way` is a phrase for the error.
  Path vertical(const Joints& from, Pose tip, double rise, const char* way) const;

  Eigen::Isometry3d frame_;  ///< pose of the scene's frame in `base`
  const ArmKinematics& arm_;
  Inverse inverse_;
};

/// Calls `plan` on a grid of `spacing` metres over the area and returns the number of positions. Throws Error (kind
/// `run`) with the number of positions where `plan` threw NoPath, and the reason of the first exception.
int check_reach(const Area& area, double spacing, const std::function<void(const Target&)>& plan);

}  // namespace palpate::baxter
