// SPDX-License-Identifier: MIT
// The robot's own inverse kinematics, asked with a deadline.
#pragma once

#include "baxter/robot.hpp"
#include "baxter/ros/graph.hpp"

#include <optional>
#include <string>

namespace palpate::baxter {

class Solver {
 public:
  explicit Solver(const Master& master) : master_(master) {}

  /// See Robot::solve(). The node must have been started.
  Robot::Answer solve(const Pose& gripper, const Joints& seed);

 private:
  std::string answer(const std::string& request, Deadline deadline);

  Master master_;
  std::optional<Address> address_;  ///< where IKService was found
};

}  // namespace palpate::baxter
