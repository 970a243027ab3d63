// SPDX-License-Identifier: MIT
#include "fake_baxter/old_state.hpp"

#include <ros/ros.h>

// The definition has the same name as the present one. A macro renames the C++ namespace, so that one program can
// contain both. The name in the message's data type is a string literal and stays.
#define baxter_core_msgs old_baxter_core_msgs
#include <old/baxter_core_msgs/AssemblyState.h>
#undef baxter_core_msgs

namespace palpate::fake_baxter {

std::function<void(const baxter::StateReading&)> advertise_old_state(ros::NodeHandle& node) {
  const ros::Publisher publisher = node.advertise<old_baxter_core_msgs::AssemblyState>("/robot/state", 1);
  return [publisher](const baxter::StateReading& state) {
    old_baxter_core_msgs::AssemblyState message;
    message.enabled = state.enabled;
    message.stopped = state.stopped;
    message.error = state.error;
    message.estop_button = static_cast<std::uint8_t>(state.estop_button);
    message.estop_source = static_cast<std::uint8_t>(state.estop_source);
    publisher.publish(message);
  };
}

std::string old_state_md5() { return ros::message_traits::md5sum<old_baxter_core_msgs::AssemblyState>(); }

}  // namespace palpate::fake_baxter
