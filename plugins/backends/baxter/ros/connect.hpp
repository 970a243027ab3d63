// SPDX-License-Identifier: MIT
// The way to a Baxter over ROS 1. Nothing of ROS is seen from outside this folder.
#pragma once

#include "baxter/options.hpp"
#include "baxter/robot.hpp"
#include "baxter/view.hpp"

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

/// Publishes latched in frame `base`: palpate/surface (PointCloud2 with x, y, z, intensity = standard deviation) and
/// palpate/taps (MarkerArray: taps on and off the object, the area, the next target). `robot` is what connect() has
/// made.
std::unique_ptr<View> make_view(Robot& robot, const PlaceOptions& place, const Area& area, double desk);

}  // namespace palpate::baxter
