// SPDX-License-Identifier: MIT
// The robot of the tests on a ROS network: the topics, the service and the parameters of a Baxter with software 1.2.
#pragma once

#include "fake_baxter/body.hpp"
#include "fake_baxter/companion.hpp"

#include <atomic>
#include <list>
#include <string>

namespace palpate::fake_baxter {

struct NodeOptions {
  /// Seconds of the robot's time in a second of real time, told on /clock; 0: the robot lives in real time, and there
  /// is no /clock.
  double rate = 0.0;
  double patience = 0.1;  ///< s of real time that /clock waits for a driver that was sending commands
  /// Of the streams: only where messages come in bursts must all of them arrive; who is late has less to catch up with
  /// if they need not.
  std::uint32_t queue = 1;
  std::string trace;       ///< a CSV file of what is so, a row a period; "" for none
  std::string gripper;     ///< its product name, as the robot has recognised it; "" for none
  double tool_mass = 0.0;  ///< kg, as the robot has been told
};

/// Another node that is there from when a fault begins.
struct Beside {
  Beside(FaultKind kind, const std::string& role) : with(kind), node(role) {}
  FaultKind with;
  Companion node;
};

/// Publishes what `body` says 100 times a second of its time and hands it what comes, until `stop`. Needs a master,
/// waits for it for five seconds. Prints "ready" once all is advertised. Throws Error.
///
/// With /clock, time does not run away from a driver: while commands come, it goes no further than two periods past the
/// latest one, unless none comes for `patience`. So a driver on a busy machine is not late, and one that is gone is
/// still noticed.
void serve(Body& body, const NodeOptions& options, Companion& gripper, std::list<Beside>& beside,
           const baxter::Arm& arm, const std::atomic<bool>& stop);

}  // namespace palpate::fake_baxter
