// SPDX-License-Identifier: MIT
// roscpp in this process. It aborts or waits for ever where the environment is wrong or a host is gone, so everything
// is looked at first.
#pragma once

#include "baxter/ros/graph.hpp"

#include <palpate/error.hpp>

#include <functional>
#include <string>

namespace palpate::baxter {

/// The network that the environment names, with a master that has answered.
struct Network {
  std::string uri;  ///< of the master
  Master master;
  std::string own_name;  ///< what others reach this machine by, if the environment says; else empty

  /// For the place of an Error: "ROS_MASTER_URI=http://...".
  std::string where() const { return "ROS_MASTER_URI=" + uri; }
};

/// Checks ROS_MASTER_URI, ROS_IP and ROS_HOSTNAME and asks the master. Throws Error (kind `run`) before `deadline`.
Network find_network(Deadline deadline);

/// Why nothing came of talking to `who` at `place`, and what to do: `remedy` if nobody is there who speaks ROS.
Error unreachable(const std::string& where, const std::string& who, const Place& place, const Unreached& reason,
                  const std::string& remedy);

/// Starts roscpp, once a process; it leaves the network when the process ends. Throws Error if it cannot, or was
/// started with another master, or has been told to go.
void start_node(const Network& network);

/// Nodes of palpate are called so, with a number after it that tells them apart.
constexpr const char* kNodeName = "palpate";
/// This process' node at the master; it must have been started.
std::string node_name();

/// Before subscribers and publishers go: taking leave of a master that does not answer would wait for minutes, so if it
/// does not do so within half a second roscpp takes it for gone from now on.
void forget_silent_master();

/// Does this on roscpp's thread of connections, and waits for it: a header that arrives there, or a peer that goes,
/// while another thread gives up what it belongs to, would end the program (ros_comm, issues 1939 and 2032).
void give_up(const std::function<void()>& connections);

}  // namespace palpate::baxter
