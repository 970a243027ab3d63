// SPDX-License-Identifier: MIT
// The arm of spring_arm.hpp with MuJoCo's own bodies, contacts, friction and steps, for comparison. Available only if
// MuJoCo is installed (heading physics of packages.txt).
#pragma once

#include "fake_baxter/mechanics.hpp"

#include <memory>
#include <string>

namespace palpate::fake_baxter {

/// Returns whether this build has MuJoCo.
bool has_mujoco();

/// `friction`: of every joint, Nm. Throws Error if has_mujoco() is false.
std::unique_ptr<Mechanics> make_mujoco(const SceneFrame& scene_frame, const Eigen::Vector3d& tip, double friction);

/// Returns the MuJoCo model of the arm above a plate on a spring with `stiffness` (N/m). `tip` is in the frame
/// left_hand.
std::string mujoco_model(const Eigen::Vector3d& tip, double stiffness, double friction);

}  // namespace palpate::fake_baxter
