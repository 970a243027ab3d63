// SPDX-License-Identifier: MIT
// The seven joints of the left arm among the named ones of a message.
#pragma once

#include "baxter/robot.hpp"

#include <algorithm>
#include <string>

#include <sensor_msgs/JointState.h>

namespace palpate::baxter {

constexpr std::size_t kArm = kJointNames.size();

/// The arm's joints among named ones: all of them, or none; a message with only some of them is malformed.
struct ArmPart {
  std::size_t count = 0;
  Joints position = Joints::Zero();
};

inline ArmPart arm_part(const sensor_msgs::JointState& message) {
  ArmPart part;
  for (std::size_t joint = 0; joint < kArm; ++joint) {
    const auto found = std::find(message.name.begin(), message.name.end(), kJointNames[joint]);
    if (found == message.name.end()) continue;
    ++part.count;
    const auto at = static_cast<std::size_t>(found - message.name.begin());
    if (at < message.position.size()) part.position[static_cast<Eigen::Index>(joint)] = message.position[at];
  }
  return part;
}

/// For the words about a message that does not fit.
inline std::string counts(const sensor_msgs::JointState& message) {
  return std::to_string(message.name.size()) + " names and " + std::to_string(message.position.size()) + " positions";
}

}  // namespace palpate::baxter
