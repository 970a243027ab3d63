// SPDX-License-Identifier: MIT
#include "fake_baxter/old_state.hpp"

#include <ros/ros.h>

// Generated from a definition of the same name as today's. Its C++ types get a namespace of their own, so that one
// program may have both; what goes over the wire are texts, which a macro leaves alone.
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
