// SPDX-License-Identifier: MIT
#include "fake_baxter/mujoco.hpp"

#include <palpate/error.hpp>

namespace palpate::fake_baxter {

bool has_mujoco() { return false; }

std::unique_ptr<Mechanics> make_mujoco(const Ground&, const Eigen::Vector3d&, double) {
  throw Error("--arm", "mujoco is not in this build", "install libmujoco-dev and build again, or take springs");
}

}  // namespace palpate::fake_baxter
