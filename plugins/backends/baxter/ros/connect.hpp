// SPDX-License-Identifier: MIT
// The way to a Baxter over ROS 1. Nothing of ROS is seen from outside this folder.
#pragma once

#include "baxter/options.hpp"
#include "baxter/robot.hpp"

#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <memory>

namespace palpate::baxter {

/// What is wanted of the robot.
struct Wishes {
  bool commands = true;             ///< send set-points; without it nothing can be moved
  bool inverse_kinematics = false;  ///< ask the robot's IKService
};

/// Joins the network whose master ROS_MASTER_URI names and waits until the robot has been heard in full: joints,
/// endpoint and state, and that it listens to commands.
/// roscpp is started with the first connection of the process and ends with the process, since it cannot be started
/// twice; all that a connection itself begins ends with the object.
/// Throws Error (kind `run`) within five seconds of real time, with what is missing and what to do: no master, names
/// that do not resolve, data that do not come, another robot or software, messages of another md5 sum.
std::unique_ptr<Robot> connect(const Wishes& wishes);

/// What a person watching the experiment sees: the surface as it is believed, the taps, the area, the next target. All
/// lengths are metres in the frame of the scene; what is shown is in the robot's frame `base`.
class View {
 public:
  virtual ~View() = default;

  /// Where the arm goes now.
  virtual void target(const Target& place) = 0;

  /// Shows these contacts, as they are read now, in the place of those before; the target has been reached.
  virtual void contacts(const std::vector<Touch>& touches) = 0;

  /// The surface: one height and its standard deviation for each place.
  virtual void surface(const Points& places, const VectorView& height, const VectorView& deviation) = 0;
};

/// Publishes latched in frame `base`: palpate/surface (PointCloud2 with x, y, z, intensity = standard deviation) and
/// palpate/taps (MarkerArray: taps on and off the object, the area, the next target). `robot` is what connect() has
/// made.
std::unique_ptr<View> make_view(Robot& robot, const ScenePoseOptions& place, const Area& area, double desk);

}  // namespace palpate::baxter
