// SPDX-License-Identifier: MIT
#include "fake_baxter/mujoco_arm.hpp"

#include <palpate/error.hpp>

namespace palpate::fake_baxter {

bool has_mujoco() { return false; }

std::unique_ptr<Mechanics> make_mujoco(const SceneFrame&, const Eigen::Vector3d&, double) {
  throw Error("--arm", "mujoco is not in this build", "install libmujoco-dev and build again, or take springs");
}

}  // namespace palpate::fake_baxter
