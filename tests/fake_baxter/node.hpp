// SPDX-License-Identifier: MIT
// The simulated robot on a ROS network: topics, service and parameters of a Baxter with software 1.2.
#pragma once

#include "fake_baxter/body.hpp"
#include "fake_baxter/extra_node.hpp"

#include <atomic>
#include <list>
#include <string>

namespace palpate::fake_baxter {

struct NodeOptions {
  /// Seconds of robot time per second of real time, published on /clock. 0: real time without /clock.
  double rate = 0.0;
  double patience = 0.1;  ///< s of real time that /clock waits for a driver that was sending commands
  /// Length of the streams' queues. Only bursts need longer queues; with short ones a late subscriber has less to
  /// process.
  std::uint32_t queue = 1;
  std::string trace;       ///< CSV file of the true state with one row per period; empty: none
  std::string gripper;     ///< product name of the recognised gripper; empty: none
  double tool_mass = 0.0;  ///< kg, configured mass of the tool
};

/// Additional node that starts with a fault.
struct FaultNode {
  FaultNode(FaultKind kind, const std::string& role) : with(kind), node(role) {}
  FaultKind with;
  ExtraNode node;
};

/// Publishes the messages of `body` 100 times per second of its time and passes received messages to it, until `stop`.
/// Waits up to five seconds for a master. Prints "ready" after all topics are advertised. Throws Error.
///
/// With /clock, the time waits for the driver: while commands arrive, it is at most two periods ahead of the last one,
/// unless none arrives for `patience`. So a driver on a busy machine is not late, and the end of a driver is still
/// noticed.
void serve(Body& body, const NodeOptions& options, ExtraNode& gripper, std::list<FaultNode>& fault_nodes,
           const baxter::ArmKinematics& arm, const std::atomic<bool>& stop);

}  // namespace palpate::fake_baxter
