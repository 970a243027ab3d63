// SPDX-License-Identifier: MIT
// /robot/state as firmware before 1.2 publishes it: under the same name, without `ready`, with another md5 sum.
#pragma once

#include "baxter/robot.hpp"

#include <functional>
#include <string>

namespace ros {
class NodeHandle;
}

namespace palpate::fake_baxter {

/// Advertises it, and returns what publishes one.
std::function<void(const baxter::StateReading&)> advertise_old_state(ros::NodeHandle& node);

/// The md5 sum of that message.
std::string old_state_md5();

}  // namespace palpate::fake_baxter
