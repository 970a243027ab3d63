// SPDX-License-Identifier: MIT
// Delivery of the robot's messages to subscribers, with simulated delays.
#pragma once

#include "fake_baxter/body.hpp"
#include "fake_baxter/network.hpp"

#include <vector>

namespace palpate::fake_baxter {

class Delivery {
 public:
  /// Returns the messages that arrive in this period, in the order of sending. Without a fault these are the messages
  /// of the period. The faults `delay` and `jitter` delay single messages, `stall` and `bursts` all of them. `received`
  /// becomes the time of arrival; stamps are unchanged. Must be called once per period.
  std::vector<RobotMessages> take(const Body& body);

 private:
  struct Sent {
    RobotMessages said;
    double arrives;  ///< s
  };
  std::vector<Sent> waiting_;
  Network network_{Random(1, "fake_baxter/said")};
  double latest_ = 0.0;  ///< s, time of the last arrival
};

}  // namespace palpate::fake_baxter
