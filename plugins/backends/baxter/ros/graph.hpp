// SPDX-License-Identifier: MIT
// The network of ROS as its master and nodes describe it, asked with deadlines: who publishes, whether its host can be
// found from here, what messages it sends; and one call of a service. In plain sockets, before and beside roscpp.
#pragma once

#include "baxter/ros/socket.hpp"

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::baxter {

/// A host and a port, as in http://host:port/ and rosrpc://host:port.
struct Place {
  std::string host;
  int port = 0;
};

/// None if `uri` is not of the form scheme://host:port, with or without a slash at the end.
std::optional<Place> parse_uri(const std::string& uri, const std::string& scheme);

/// Who does what on the network: for each name the nodes.
struct Graph {
  using Nodes = std::map<std::string, std::vector<std::string>, std::less<>>;
  Nodes publishers;   ///< of a topic
  Nodes subscribers;  ///< of a topic
  Nodes services;     ///< who offers it

  static const std::vector<std::string>& of(const Nodes& nodes, std::string_view name);
};

/// The network in a master's own words: its answer to getSystemState, XML-RPC. Throws Unreached.
Graph read_graph(const std::string& xml);

/// The master. All members throw Unreached.
class Master {
 public:
  explicit Master(const Address& address) : address_(address) {}

  /// Whether it is one: its process.
  int greet(Deadline deadline) const;
  Graph graph(Deadline deadline) const;
  /// A parameter; none if it is not set or is no text.
  std::optional<std::string> parameter(const std::string& name, Deadline deadline) const {
    return told("getParam", name, deadline);
  }
  /// Where a node can be asked; none if the master does not know it.
  std::optional<std::string> node(const std::string& name, Deadline deadline) const {
    return told("lookupNode", name, deadline);
  }
  /// Where a service is; none if nobody offers it.
  std::optional<std::string> service(const std::string& name, Deadline deadline) const {
    return told("lookupService", name, deadline);
  }

 private:
  std::optional<std::string> told(const char* method, const std::string& name, Deadline deadline) const;

  Address address_;
};

/// What a publisher says of its messages.
struct Offer {
  std::string type;
  std::string md5;
};

/// Subscribes at a publisher, whose node is at `node`, to messages of any kind, hears what kind it has, and leaves.
/// Throws Unreached.
Offer ask_publisher(const Place& node, const std::string& topic, Deadline deadline);

/// Calls a service once: `request` and the result are messages as ROS serialises them, the request with its length
/// before it. Throws Unreached; what the
/// service says when it fails is in its words.
std::string call_service(const Address& address, const std::string& name, const std::string& md5,
                         const std::string& request, Deadline deadline);

}  // namespace palpate::baxter
