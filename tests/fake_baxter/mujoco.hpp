// SPDX-License-Identifier: MIT
// The same arm as springs.hpp, moved by MuJoCo: bodies, contact, friction and steps are of its own making. It is there
// to be compared with, and only where MuJoCo is installed (heading physics of packages.txt).
#pragma once

#include "fake_baxter/mechanics.hpp"

#include <memory>
#include <string>

namespace palpate::fake_baxter {

/// Whether this build has it.
bool has_mujoco();

/// `friction`: of every joint, Nm. Throws Error where has_mujoco() is false.
std::unique_ptr<Mechanics> make_mujoco(const Ground& ground, const Eigen::Vector3d& tip, double friction);

/// The arm in MuJoCo's language, its tip there in the frame left_hand, over a plate on a spring (N/m): what is pressed.
std::string mujoco_model(const Eigen::Vector3d& tip, double stiffness, double friction);

}  // namespace palpate::fake_baxter
