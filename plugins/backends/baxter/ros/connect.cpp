// SPDX-License-Identifier: MIT
#include "baxter/ros/connect.hpp"

#include "baxter/error_texts.hpp"
#include "baxter/ros/connection.hpp"
#include "baxter/urdf.hpp"

#include <set>
#include <thread>

#include <boost/asio/ip/host_name.hpp>

namespace palpate::baxter {
namespace {

using std::chrono::milliseconds;

// Deadlines since the start of connect(). The rest of the promised five seconds is for disconnecting.
constexpr milliseconds kMasterDeadline(2500);     ///< until the master has answered
constexpr milliseconds kListedDeadline(3000);     ///< until all required topics are listed at the master
constexpr milliseconds kReceivedDeadline(3800);   ///< until all required streams have arrived
constexpr milliseconds kExplainedDeadline(4200);  ///< until the cause of missing streams is known

constexpr milliseconds kLookUp(1000);       ///< longest look-up of the name of the robot's host
constexpr milliseconds kOnePublisher(300);  ///< longest wait for the answer of one publisher
constexpr milliseconds kAskAgain(100);      ///< pause between queries to the master, which serves one at a time
constexpr milliseconds kLook(2);

constexpr const char* kVersionParameter = "/rethink/software_version";
constexpr const char* kDescriptionParameter = "/robot_description";
/// All topics that this program receives or sends.
constexpr const char* kTopics[] = {kJointTopic,     kEndpointTopic,    kStateTopic,      kCollisionTopic,
                                   kAvoidanceTopic, kEndEffectorTopic, kSpeedRatioTopic, kCommandTimeoutTopic,
                                   kCommandTopic,   kClockTopic};
/// Topics that must have exactly one sender. The topic of the joints may have two, because the node of a gripper sends
/// its own joints.
constexpr const char* kOfOneNode[] = {kStateTopic, kEndpointTopic, kCollisionTopic, kAvoidanceTopic, kClockTopic};

/// One attempt to join the network.
class ConnectionAttempt {
 public:
  explicit ConnectionAttempt(const ConnectionOptions& options)
      : options_(options), begin_(Steady::now()), network_(find_network(begin_ + kMasterDeadline)) {}

  std::unique_ptr<Robot> join() {
    try {
      const Graph graph = await_all_listed();
      expect_one_robot(graph);
      expect_hosts(graph);
      start_node(network_);
      std::unique_ptr<RosConnection> connection = make_connection(network_, options_.commands, tool_mass());
      if (options_.commands) expect_no_other_driver();
      expect_all_heard(*connection);
      return connection;
    } catch (const NetworkError& reason) {
      throw robot_error(network_.where(), fmt::format("the master no longer answers: {}", reason.what()),
                        "start it again");
    }
  }

 private:
  Deadline until(milliseconds since_begin) const { return begin_ + since_begin; }

  /// Returns an Error if a required topic, parameter or service is missing at the master, else nullopt.
  std::optional<Error> not_listed(const Graph& graph) const {
    std::vector<std::string> missing;
    for (const Topic& needed : RosConnection::needed()) {
      if (Graph::of(graph.publishers, needed.name).empty()) missing.emplace_back(needed.name);
    }
    const Error nobody = robot_error(network_.where(), "no node publishes " + join_words(missing),
                                     missing.size() == RosConnection::needed().size()
                                         ? "check that it is the master of a Baxter"
                                         : "wait until the robot has started, or restart it if a node has ended");
    if (missing.size() == RosConnection::needed().size()) return nobody;
    const auto version = network_.master.query("getParam", kVersionParameter, until(kExplainedDeadline));
    if (!version)
      return robot_error(kVersionParameter, "is not set at the master", "check that it is the master of a Baxter");
    if (version->rfind("1.2.", 0) != 0)
      throw robot_error(kVersionParameter, "the robot's software is " + *version,
                        "install software 1.2 on the robot, which this driver needs");
    if (!missing.empty()) return nobody;
    if (options_.inverse_kinematics && Graph::of(graph.services, kSolverService).empty())
      return robot_error(kSolverService, "no node offers this service",
                         "set inverse_kinematics: own, or start the robot again");
    return {};
  }

  Graph await_all_listed() const {
    for (;;) {
      Graph graph = network_.master.graph(until(kExplainedDeadline));
      const std::optional<Error> missing = not_listed(graph);
      if (!missing) return graph;
      if (Steady::now() > until(kListedDeadline)) throw *missing;
      std::this_thread::sleep_for(kAskAgain);
    }
  }

  /// Throws Error if two nodes publish the same stream, for example a forgotten mock. Nodes that ended without
  /// unregistering count, too.
  static void expect_one_robot(const Graph& graph) {
    for (const char* topic : kOfOneNode) {
      const auto& nodes = Graph::of(graph.publishers, topic);
      if (nodes.size() < 2) continue;
      throw robot_error(topic, "comes from more than one node, " + join_words(nodes),
                        "end the nodes that are not the robot; rosnode cleanup removes ended ones");
    }
  }

  /// Resolves all host names with a deadline, because roscpp resolves them without one while it subscribes.
  void expect_hosts(const Graph& graph) const {
    std::set<std::string> found;
    for (const char* topic : kTopics) {
      for (const std::string& node : Graph::of(graph.publishers, topic)) {
        const auto place = place_of(node);
        if (!place || !found.insert(place->host).second) continue;
        try {
          look_up(place->host, place->port, within(kLookUp, until(kExplainedDeadline)));
        } catch (const NetworkError& reason) {
          throw no_publisher(topic, node, *place, reason);
        }
      }
    }
  }

  std::optional<HostPort> place_of(const std::string& node) const {
    const auto uri = network_.master.query("lookupNode", node, until(kExplainedDeadline));
    return uri ? parse_uri(*uri, "http") : std::nullopt;
  }

  /// Returns the mass beyond the flange, in kg, from the robot's description. The robot updates it when a tool is
  /// mounted or an object is held.
  std::optional<double> tool_mass() const {
    const auto urdf = network_.master.query("getParam", kDescriptionParameter, until(kExplainedDeadline));
    return urdf ? mass_beyond(*urdf, "left_hand") : std::nullopt;
  }

  /// Throws Error if another palpate commands the arm. Each instance checks after its own registration, so two
  /// instances that start at the same time both throw.
  void expect_no_other_driver() const {
    const Graph graph = network_.master.graph(until(kExplainedDeadline));
    for (const std::string& node : Graph::of(graph.publishers, kCommandTopic)) {
      const bool palpate = node.rfind(std::string("/") + kNodeName + "_", 0) == 0;
      if (!palpate || node == node_name() || !answers(node)) continue;
      throw robot_error(kCommandTopic, "another palpate moves this arm, the node " + node,
                        "let it end, or interrupt it; rosnode cleanup removes ended nodes");
    }
  }

  /// Returns whether a node still runs; a killed node stays listed.
  bool answers(const std::string& node) const {
    const auto place = place_of(node);
    if (!place) return false;
    try {
      const Deadline deadline = within(kOnePublisher, until(kExplainedDeadline));
      TcpConnection(look_up(place->host, place->port, deadline), deadline);
      return true;
    } catch (const NetworkError& reason) {
      return reason.why != NetworkError::FailureCause::refused;
    }
  }

  void expect_all_heard(RosConnection& connection) const {
    while (heard(connection) != std::array{true, true, true} || (options_.commands && !connection.listened_to())) {
      if (Steady::now() > until(kReceivedDeadline)) throw why_not_heard(connection);
      std::this_thread::sleep_for(kLook);
    }
  }

  /// Returns for each stream of RosConnection::needed() whether a message has arrived.
  static std::array<bool, 3> heard(RosConnection& connection) {
    const Snapshot seen = connection.read();
    return {seen.joints.has_value(), seen.endpoint.has_value(), seen.state.has_value()};
  }

  Error why_not_heard(RosConnection& connection) const {
    if (connection.read().now == 0.0)
      return robot_error("/use_sim_time", "is set, but /clock publishes no time",
                         "start the simulated clock, or delete the parameter and restart all nodes");
    const Graph graph = network_.master.graph(until(kExplainedDeadline));
    const auto came = heard(connection);
    for (std::size_t i = 0; i < came.size(); ++i) {
      if (!came[i]) return why_silent(RosConnection::needed()[i], graph, connection.read().malformed);
    }
    const auto& nodes = Graph::of(graph.subscribers, kCommandTopic);
    if (nodes.empty())
      return robot_error(kCommandTopic, "no node subscribes to it",
                         "wait until the robot has started; dry_run: true works without");
    const std::string name = network_.own_name.empty() ? boost::asio::ip::host_name() : network_.own_name;
    return robot_error(kCommandTopic,
                       join_words(nodes) +
                           " subscribes to it but has not connected to this machine, whose address is announced as " +
                           name,
                       "set ROS_IP to this machine's address on the robot's network");
  }

  Error why_silent(const Topic& needed, const Graph& graph, const std::string& malformed) const {
    std::optional<Error> why;
    std::vector<std::string> mute;
    for (const std::string& node : Graph::of(graph.publishers, needed.name)) {
      const auto place = place_of(node);
      if (!place) continue;
      try {
        const MessageType offer =
            query_publisher(*place, needed.name, within(kOnePublisher, until(kExplainedDeadline)));
        if (offer.md5 != needed.md5)
          return robot_error(needed.name,
                             fmt::format("{} sends {} with md5 sum {}, but this driver needs {} with {}", node,
                                         offer.type, offer.md5, needed.type, needed.md5),
                             "install the robot's software 1.2");
        mute.push_back(node);
      } catch (const NetworkError& reason) {
        why = no_publisher(needed.name, node, *place, reason);
      }
    }
    if (!malformed.empty()) return robot_error(network_.where(), malformed, "check that it is a Baxter");
    if (mute.empty() && why) return *why;
    return robot_error(needed.name, join_words(mute) + " publishes it, but no message has arrived",
                       "check it with rostopic echo; the robot may still be starting");
  }

  static Error no_publisher(const std::string& topic, const std::string& node, const HostPort& place,
                            const NetworkError& reason) {
    return unreachable(topic, "its publisher " + node, place, reason,
                       "restart it, or remove its remains with rosnode cleanup");
  }

  ConnectionOptions options_;
  Deadline begin_;
  Network network_;
};

}  // namespace

std::unique_ptr<Robot> connect(const ConnectionOptions& options) { return ConnectionAttempt(options).join(); }

}  // namespace palpate::baxter
