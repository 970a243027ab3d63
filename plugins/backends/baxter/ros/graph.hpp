// SPDX-License-Identifier: MIT
// The network of ROS as its master and nodes describe it, asked with deadlines: who publishes, whether its host can be
// found from here, what messages it sends; and one call of a service. Over TCP of which no step outlasts its deadline,
// before and beside roscpp, whose own look-ups and calls wait for ever when a host is gone.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

namespace palpate::baxter {

using Steady = std::chrono::steady_clock;
using Deadline = Steady::time_point;
using Address = boost::asio::ip::tcp::endpoint;

/// The earlier of `deadline` and `longest` from now.
Deadline within(std::chrono::milliseconds longest, Deadline deadline);

/// Why nothing came of talking to a host; caught inside ros/, where it becomes an Error for the user.
struct Unreached : std::runtime_error {
  enum class Why {
    name,      ///< the host's name has no address
    refused,   ///< the host, or the way to it, says no
    silent,    ///< nobody answered in time
    nonsense,  ///< somebody answered who does not speak the protocol, or says that it cannot serve
  };
  Unreached(Why reason, const std::string& words) : std::runtime_error(words), why(reason) {}
  Why why;
};

/// A thread that hears no signals: they are for those that were there before.
std::thread deaf_thread(const std::function<void()>& run);

/// The address of a host by its name or number. Throws Unreached (`name`), also when the answer takes too long.
Address look_up(const std::string& host, int port, Deadline deadline);

/// A TCP connection. All members throw Unreached.
class Wire {
 public:
  Wire(const Address& address, Deadline deadline);

  void send(const std::string& bytes, Deadline deadline);

  /// Exactly so many bytes.
  std::string receive(std::size_t bytes, Deadline deadline);

  /// What is there, at least one byte, at most `most`; empty when the other side has ended the connection.
  std::string receive_some(std::size_t most, Deadline deadline);

 private:
  template <class Begin>
  std::size_t finish(Deadline deadline, const Begin& begin);

  boost::asio::io_context io_;
  boost::asio::ip::tcp::socket socket_{io_};
};

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
  /// What it says of a name: the value of a parameter (`getParam`), where a node can be asked (`lookupNode`), where a
  /// service is (`lookupService`). None if it does not know that, or it is no text.
  std::optional<std::string> told(const char* method, const std::string& name, Deadline deadline) const;

 private:
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
