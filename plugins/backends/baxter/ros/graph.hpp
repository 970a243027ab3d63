// SPDX-License-Identifier: MIT
// Queries to the ROS master and its nodes with deadlines: publishers of a topic, addresses, message types, and one
// service call. They use their own TCP connections, because look-ups and calls of roscpp wait for ever if a host is
// gone.
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

/// Returns the earlier of `deadline` and `longest` from now.
Deadline within(std::chrono::milliseconds longest, Deadline deadline);

/// Network error of a query. Callers inside ros/ convert it to an Error for the user.
struct NetworkError : std::runtime_error {
  enum class FailureCause {
    name,      ///< the host name has no address
    refused,   ///< the host or the network rejected the connection
    silent,    ///< no answer before the deadline
    nonsense,  ///< the answer violates the protocol, or is an error
  };
  NetworkError(FailureCause reason, const std::string& words) : std::runtime_error(words), why(reason) {}
  FailureCause why;
};

/// Starts a thread with all signals blocked, so that signals reach the threads of the program.
std::thread thread_without_signals(const std::function<void()>& run);

/// Returns the address of a host name or number. Throws NetworkError (`name`), also when the deadline passes.
Address look_up(const std::string& host, int port, Deadline deadline);

/// TCP connection with a deadline per operation. All members throw NetworkError.
class TcpConnection {
 public:
  TcpConnection(const Address& address, Deadline deadline);

  void send(const std::string& bytes, Deadline deadline);

  /// Returns exactly `bytes` bytes.
  std::string receive(std::size_t bytes, Deadline deadline);

  /// Returns the available bytes, at least one and at most `most`. Returns an empty string at the end of the
  /// connection.
  std::string receive_some(std::size_t most, Deadline deadline);

 private:
  template <class Begin>
  std::size_t finish(Deadline deadline, const Begin& begin);

  boost::asio::io_context io_;
  boost::asio::ip::tcp::socket socket_{io_};
};

/// Host and port of a URI such as http://host:port/ or rosrpc://host:port.
struct HostPort {
  std::string host;
  int port = 0;
};

/// Returns nullopt unless `uri` has the form scheme://host:port, with an optional slash at the end.
std::optional<HostPort> parse_uri(const std::string& uri, const std::string& scheme);

/// Nodes of the network per topic and service.
struct Graph {
  using Nodes = std::map<std::string, std::vector<std::string>, std::less<>>;
  Nodes publishers;   ///< nodes by topic
  Nodes subscribers;  ///< nodes by topic
  Nodes services;     ///< nodes by offered service

  static const std::vector<std::string>& of(const Nodes& nodes, std::string_view name);
};

/// Parses the master's answer to getSystemState (XML-RPC). Throws NetworkError.
Graph read_graph(const std::string& xml);

/// Queries to the ROS master. All members throw NetworkError.
class Master {
 public:
  explicit Master(const Address& address) : address_(address) {}

  /// Returns the master's process id; an answer proves that it is a ROS master.
  int process_id(Deadline deadline) const;
  Graph graph(Deadline deadline) const;
  /// Returns the answer to a query by name: the value of a parameter (`getParam`), or the URI of a node (`lookupNode`)
  /// or of a service (`lookupService`). Returns nullopt if the name is unknown or the value is not a string.
  std::optional<std::string> query(const char* method, const std::string& name, Deadline deadline) const;

 private:
  Address address_;
};

/// Type and md5 sum of the messages of a publisher.
struct MessageType {
  std::string type;
  std::string md5;
};

/// Subscribes to `topic` at a node with any message type, reads the type from the answer, and disconnects. Throws
/// NetworkError.
MessageType query_publisher(const HostPort& node, const std::string& topic, Deadline deadline);

/// Calls a service once. `request` and the result are serialised ROS messages; the request begins with its length. If
/// the service fails, NetworkError contains its error text. Throws NetworkError.
std::string call_service(const Address& address, const std::string& name, const std::string& md5,
                         const std::string& request, Deadline deadline);

}  // namespace palpate::baxter
