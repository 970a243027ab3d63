// SPDX-License-Identifier: MIT
// The seven joints of the left arm among the named ones of a message.
#pragma once

#include "baxter/robot.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <sensor_msgs/JointState.h>

namespace palpate::baxter {

constexpr std::size_t kArm = kJointNames.size();

/// The arm's joints among named ones.
struct ArmPart {
  std::size_t count = 0;  ///< how many of them there are
  bool whole = false;     ///< all of them, each with a position; a message with only some of them is malformed
  std::string words;      ///< what is there, of a message that is malformed
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
  part.whole = part.count == kArm && message.position.size() == message.name.size();
  if (!part.whole) {
    part.words = fmt::format("{} of the left arm's seven joints, {} names and {} positions", part.count,
                             message.name.size(), message.position.size());
  }
  return part;
}

}  // namespace palpate::baxter
