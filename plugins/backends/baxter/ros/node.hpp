// SPDX-License-Identifier: MIT
// The roscpp node of this process. With a wrong environment or an unreachable host, roscpp aborts or waits for ever, so
// both are checked before it starts.
#pragma once

#include "baxter/ros/graph.hpp"

#include <palpate/error.hpp>

#include <functional>
#include <string>

namespace palpate::baxter {

/// Network of the environment variables, with a master that has answered.
struct Network {
  std::string uri;  ///< URI of the master
  Master master;
  std::string own_name;  ///< name or address of this machine for other nodes, from the environment; may be empty

  /// Returns the place for an Error: "ROS_MASTER_URI=http://...".
  std::string where() const { return "ROS_MASTER_URI=" + uri; }
};

/// Checks ROS_MASTER_URI, ROS_IP and ROS_HOSTNAME and queries the master. Throws Error (kind `run`) before `deadline`.
Network find_network(Deadline deadline);

/// Converts a network error to an Error about `who` at `place`. `remedy` is the remedy if the host does not speak ROS.
Error unreachable(const std::string& where, const std::string& who, const HostPort& place, const NetworkError& reason,
                  const std::string& remedy);

/// Starts roscpp, once per process. The node leaves the network at the end of the process. Throws Error if roscpp does
/// not start, uses another master, or was told to shut down.
void start_node(const Network& network);

/// Name of palpate's nodes; ROS appends a unique number.
constexpr const char* kNodeName = "palpate";
/// Returns the name of this process's node, which must be started.
std::string node_name();

/// Prepares the end of subscribers and publishers. If the master does not answer within half a second, roscpp is
/// pointed at a closed port, because unregistering from a silent master would take minutes.
void forget_silent_master();

/// Runs `connections` on roscpp's connection thread and waits for its end. Closing connections on another thread may
/// crash if a header arrives or a peer disconnects meanwhile (ros_comm, issues 1939 and 2032).
void run_on_connection_thread(const std::function<void()>& connections);

}  // namespace palpate::baxter
