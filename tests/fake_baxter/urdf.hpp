// SPDX-License-Identifier: MIT
// URDF of the simulated robot for /robot_description, with only the end of the left arm, which the tests need.
#pragma once

#include <fmt/format.h>

#include <string>

namespace palpate::fake_baxter {

/// Returns a URDF with a tool of this mass, kg. The other links beyond the flange weigh 0.1 g each.
inline std::string urdf(double tool_mass) {
  const auto link = [](const char* name, double mass) {
    return fmt::format("  <link name=\"{}\">\n    <inertial><mass value=\"{}\"/></inertial>\n  </link>\n", name, mass);
  };
  const auto joint = [](const char* name, const char* parent, const char* child) {
    return fmt::format(
        "  <joint name=\"{}\" type=\"fixed\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n  </joint>\n", name,
        parent, child);
  };
  return "<?xml version=\"1.0\"?>\n<robot name=\"baxter\">\n" + link("left_wrist", 0.35093) +
         link("left_hand", 0.19125) + link("left_hand_camera", 0.0001) + link("left_gripper_base", 0.0001) +
         link("left_gripper", tool_mass) + joint("left_hand", "left_wrist", "left_hand") +
         joint("left_hand_camera", "left_hand", "left_hand_camera") +
         joint("left_gripper_base", "left_hand", "left_gripper_base") +
         joint("left_endpoint", "left_gripper_base", "left_gripper") + "</robot>\n";
}

}  // namespace palpate::fake_baxter
