// SPDX-License-Identifier: MIT
// Connection to a Baxter over ROS 1. No ROS header is visible outside this folder.
#pragma once

#include "baxter/options.hpp"
#include "baxter/robot.hpp"

#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <memory>

namespace palpate::baxter {

/// Requirements of a connection.
struct ConnectionOptions {
  bool commands = true;             ///< send set-points; without them nothing moves
  bool inverse_kinematics = false;  ///< use the robot's IKService
};

/// Joins the network of ROS_MASTER_URI. Waits until joints, endpoint and state have arrived, and until the robot has
/// subscribed to the commands. roscpp starts with the first connection and runs until the process ends, because it
/// cannot start twice. All other parts of a connection end with the returned object. Throws Error (kind `run`) with
/// cause and remedy within five seconds of real time. Causes: no master, unresolvable host names, missing data, another
/// robot or software version, messages with another md5 sum.
std::unique_ptr<Robot> connect(const ConnectionOptions& options);

/// Display of the experiment for a spectator: estimated surface, taps, area, and next target. Arguments are in metres
/// in the scene's frame; the display uses the robot's frame `base`.
class SpectatorDisplay {
 public:
  virtual ~SpectatorDisplay() = default;

  /// Shows the target of the arm's motion.
  virtual void target(const Target& place) = 0;

  /// Replaces the displayed contacts, and removes the target.
  virtual void contacts(const std::vector<TapReading>& readings) = 0;

  /// Shows the surface: one height and one standard deviation per position.
  virtual void surface(const Points& places, const VectorView& height, const VectorView& deviation) = 0;
};

/// Creates a publisher of latched topics in frame `base`. palpate/surface is a PointCloud2 with x, y, z, and intensity
/// = standard deviation. palpate/taps is a MarkerArray with taps on objects and on the desk, the area, and the next
/// target. `robot` must come from connect().
std::unique_ptr<SpectatorDisplay> make_view(Robot& robot, const ScenePoseOptions& place, const Area& area, double desk);

}  // namespace palpate::baxter
