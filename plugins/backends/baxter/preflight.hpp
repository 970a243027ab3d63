// SPDX-License-Identifier: MIT
// What must be right before anything moves.
#pragma once

#include "baxter/path.hpp"
#include "baxter/watch.hpp"

#include <string>
#include <vector>

#include <palpate/scene.hpp>

namespace palpate::baxter {

/// Where the tip may be: the area and a little beside it, from below the desk, where descents end, to well above the
/// height of travel.
Workspace workspace_of(const BaxterOptions& options, const Scene& scene);

/// What needs no robot to be wrong. Throws Error (kind `run`): a calibration tap
/// beside the area.
void check_plan(const BaxterOptions& options, const Scene& scene);

/// Compares what the robot says with what the config says of it. With `moving` false the robot may be disabled and the
/// arm anywhere. Throws Error (kind `run`) that names the cause and the remedy: a state in which it must not move, a
/// second sender, stale or unsound data, a joint beyond its limit, left_gripper not where the config has it, an arm
/// that is not above the area with its tool down.
void check_before_flight(const Snapshot& seen, const BaxterOptions& options, const Planner& planner,
                         const Workspace& workspace, bool moving);

/// What others have left on the robot and what it takes to be mounted, one line each for the diary. Throws Error (kind
/// `run`) where that would keep the arm from doing what it is told: a speed ratio at which it could not follow, a
/// time-out of set-points shorter than five periods or longer than half a second, a collision avoidance that pushes it.
std::vector<std::string> check_settings(const Snapshot& seen);

/// The joints that bring the tip to every place of the area, on a grid of `spacing` metres, all the way down. Throws
/// Error (kind `run`) that counts the places which cannot be reached and says why for the first.
/// Returns how many places were looked at.
int check_reach(const Planner& planner, const Area& area, double hover, double floor, double speed, double spacing);

}  // namespace palpate::baxter
