// SPDX-License-Identifier: MIT
// /robot/state of firmware before 1.2: the same name without `ready`, and another md5 sum.
#pragma once

#include "baxter/robot.hpp"

#include <functional>
#include <string>

namespace ros {
class NodeHandle;
}

namespace palpate::fake_baxter {

/// Advertises the topic and returns a function that publishes a state.
std::function<void(const baxter::StateReading&)> advertise_old_state(ros::NodeHandle& node);

/// Returns the md5 sum of the old message.
std::string old_state_md5();

}  // namespace palpate::fake_baxter
