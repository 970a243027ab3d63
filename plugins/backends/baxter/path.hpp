// SPDX-License-Identifier: MIT
// The ways of the tool, planned as joints before anything moves: what cannot be reached is known beforehand, and the
// control loop only reads off.
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

/// A way of the tip that the joints can follow: joints at distances along it, straight in between.
class Path {
 public:
  /// Goes on from the last point to `joints`, `distance` metres farther along the way.
  void add(const Joints& joints, double distance);

  /// Metres.
  double length() const { return at_.empty() ? 0.0 : at_.back(); }
  /// The joints `distance` metres from the start; the ends for what lies beyond.
  Joints at(double distance) const;
  /// The next distance after one period of `seconds` at `speed` (m/s), or less where a joint would turn faster than
  /// kJointSpeed.
  double advance(double distance, double speed, double seconds) const;

  /// The way back to the start from `distance` metres along.
  Path back(double distance) const;
  /// Fastest turn of a joint along the way, radians per metre.
  double steepest() const;

  const Joints& front() const { return joints_.front(); }
  const Joints& end() const { return joints_.back(); }

 private:
  std::size_t segment(double distance) const;
  double slope(std::size_t segment) const;

  std::vector<double> at_;
  std::vector<Joints> joints_;
};

/// Fastest turn of a joint, rad/s. An arm that trails by 0.4 s is then 0.16 rad behind, which the watch allows.
constexpr double kJointSpeed = 0.4;

/// Why there is no path; one line.
struct NoPath {
  std::string reason;
};

/// The joints of a pose of the tip from a seed nearby; none if there are none. May throw what asking brings.
using Inverse = std::function<std::optional<Joints>(const Pose& tip, const Joints& seed)>;

/// Plans in the frame of the scene. Throws NoPath.
class Planner {
 public:
  Planner(const ScenePoseOptions& place, const Arm& arm, Inverse inverse)
      : frame_(place.frame()), arm_(arm), inverse_(std::move(inverse)) {}

  /// Of a point of the scene and back, metres; the tool points straight down.
  Pose pose(const Target& place, double height) const {
    return {frame_ * Eigen::Vector3d(place.x, place.y, height), straight_down()};
  }
  Eigen::Vector3d to_scene(const Eigen::Vector3d& base) const { return frame_.inverse() * base; }

  /// From `hover` straight down to `floor` (m) at `place`. Every height is planned from the one above, the first from
  /// the joints at `middle`, so that a column depends on its place alone and not on the way there. No joint turns
  /// faster than kJointSpeed when the tip moves at `speed` (m/s).
  Path column(const Target& place, const Target& middle, double hover, double floor, double speed) const;

  /// From the joints `from` straight to the joints `to`: the tip on a straight line, the hand turning evenly.
  Path line(const Joints& from, const Joints& to) const;

  /// From the joints `from` straight up by `rise` metres, the hand as it is.
  Path up(const Joints& from, double rise) const;

  /// The desk turned out to lie so much higher (m) than the config has it.
  void raise(double height) { frame_.translation().z() += height; }

 private:
  Joints solve(const Pose& tip, const Joints& seed, const char* what) const;
  /// The tip from where the joints `from` have it straight up by `rise`, or down; each height is planned from the last.
  Path vertical(const Joints& from, Pose tip, double rise, const char* way) const;

  Eigen::Isometry3d frame_;  ///< of the scene, in `base`
  const Arm& arm_;
  Inverse inverse_;
};

/// Plans for every place of the area, on a grid of `spacing` metres. Throws Error (kind `run`) that counts the places
/// for which `plan` throws NoPath and says why for the first. Returns how many places were looked at.
int check_reach(const Area& area, double spacing, const std::function<void(const Target&)>& plan);

}  // namespace palpate::baxter
