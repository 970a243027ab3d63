// SPDX-License-Identifier: MIT
#include "baxter/ros/connect.hpp"

#include "baxter/description.hpp"
#include "baxter/ros/link.hpp"
#include "baxter/words.hpp"

#include <set>
#include <thread>

#include <boost/asio/ip/host_name.hpp>

namespace palpate::baxter {
namespace {

using std::chrono::milliseconds;

// Deadlines since the start of connect(). The rest of the promised five seconds is for disconnecting.
constexpr milliseconds kReach(2500);   ///< until the master has answered
constexpr milliseconds kListed(3000);  ///< until all required topics are listed at the master
constexpr milliseconds kHeard(3800);   ///< until all required streams have arrived
constexpr milliseconds kTold(4200);    ///< until the cause of missing streams is known

constexpr milliseconds kLookUp(1000);       ///< for the name of the robot's host
constexpr milliseconds kOnePublisher(300);  ///< for the answer of one publisher
constexpr milliseconds kAskAgain(100);      ///< between queries to the master, which serves one at a time
constexpr milliseconds kLook(2);

constexpr const char* kVersionParameter = "/rethink/software_version";
constexpr const char* kDescriptionParameter = "/robot_description";
/// All topics that this program receives or sends.
constexpr const char* kTopics[] = {kJointTopic,     kEndpointTopic,    kStateTopic,      kCollisionTopic,
                                   kAvoidanceTopic, kEndEffectorTopic, kSpeedRatioTopic, kCommandTimeoutTopic,
                                   kCommandTopic,   kClockTopic};
/// Topics that must have exactly one sender. Joints have two, because a gripper's node sends its own.
constexpr const char* kOfOneNode[] = {kStateTopic, kEndpointTopic, kCollisionTopic, kAvoidanceTopic, kClockTopic};

/// One attempt to join the network.
class Visit {
 public:
  explicit Visit(const Wishes& wishes)
      : wishes_(wishes), begin_(Steady::now()), network_(find_network(begin_ + kReach)) {}

  std::unique_ptr<Robot> join() {
    try {
      const Graph graph = await_all_listed();
      expect_one_robot(graph);
      expect_hosts(graph);
      start_node(network_);
      std::unique_ptr<Link> link = make_link(network_, wishes_.commands, tool_mass());
      if (wishes_.commands) expect_no_other_driver();
      expect_all_heard(*link);
      return link;
    } catch (const Unreached& reason) {
      throw trouble(network_.where(), fmt::format("the master no longer answers: {}", reason.what()), "start it again");
    }
  }

 private:
  Deadline until(milliseconds since_begin) const { return begin_ + since_begin; }

  /// Returns an Error if a required topic, parameter or service is missing at the master, else nullopt.
  std::optional<Error> not_listed(const Graph& graph) const {
    std::vector<std::string> missing;
    for (const Topic& needed : Link::needed()) {
      if (Graph::of(graph.publishers, needed.name).empty()) missing.emplace_back(needed.name);
    }
    const Error nobody = trouble(network_.where(), "no node publishes " + listed(missing),
                                 missing.size() == Link::needed().size()
                                     ? "check that it is the master of a Baxter"
                                     : "wait until the robot has started, or restart it if a node has ended");
    if (missing.size() == Link::needed().size()) return nobody;
    const auto version = network_.master.told("getParam", kVersionParameter, until(kTold));
    if (!version)
      return trouble(kVersionParameter, "is not set at the master", "check that it is the master of a Baxter");
    if (version->rfind("1.2.", 0) != 0) {
      throw trouble(kVersionParameter, "the robot's software is " + *version,
                    "install software 1.2 on the robot, which this driver needs");
    }
    if (!missing.empty()) return nobody;
    if (wishes_.inverse_kinematics && Graph::of(graph.services, kSolverService).empty()) {
      return trouble(kSolverService, "no node offers this service",
                     "set inverse_kinematics: own, or start the robot again");
    }
    return {};
  }

  Graph await_all_listed() const {
    for (;;) {
      Graph graph = network_.master.graph(until(kTold));
      const std::optional<Error> missing = not_listed(graph);
      if (!missing) return graph;
      if (Steady::now() > until(kListed)) throw *missing;
      std::this_thread::sleep_for(kAskAgain);
    }
  }

  /// Throws Error if two nodes publish the same stream, for example a forgotten mock. Nodes that ended without
  /// unregistering count, too.
  static void expect_one_robot(const Graph& graph) {
    for (const char* topic : kOfOneNode) {
      const auto& nodes = Graph::of(graph.publishers, topic);
      if (nodes.size() < 2) continue;
      throw trouble(topic, "comes from more than one node, " + listed(nodes),
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
          look_up(place->host, place->port, within(kLookUp, until(kTold)));
        } catch (const Unreached& reason) {
          throw no_publisher(topic, node, *place, reason);
        }
      }
    }
  }

  std::optional<Place> place_of(const std::string& node) const {
    const auto uri = network_.master.told("lookupNode", node, until(kTold));
    return uri ? parse_uri(*uri, "http") : std::nullopt;
  }

  /// Returns the mass beyond the flange, in kg, from the robot's description. The robot updates it when a tool is
  /// mounted or an object is held.
  std::optional<double> tool_mass() const {
    const auto urdf = network_.master.told("getParam", kDescriptionParameter, until(kTold));
    return urdf ? mass_beyond(*urdf, "left_hand") : std::nullopt;
  }

  /// Throws Error if another palpate commands the arm. Each instance checks after its own registration, so of two
  /// simultaneous starts both throw.
  void expect_no_other_driver() const {
    const Graph graph = network_.master.graph(until(kTold));
    for (const std::string& node : Graph::of(graph.publishers, kCommandTopic)) {
      const bool palpate = node.rfind(std::string("/") + kNodeName + "_", 0) == 0;
      if (!palpate || node == node_name() || !answers(node)) continue;
      throw trouble(kCommandTopic, "another palpate moves this arm, the node " + node,
                    "let it end, or interrupt it; rosnode cleanup removes ended nodes");
    }
  }

  /// Returns whether a node still runs; a killed node stays listed.
  bool answers(const std::string& node) const {
    const auto place = place_of(node);
    if (!place) return false;
    try {
      const Deadline deadline = within(kOnePublisher, until(kTold));
      Wire(look_up(place->host, place->port, deadline), deadline);
      return true;
    } catch (const Unreached& reason) {
      return reason.why != Unreached::Why::refused;
    }
  }

  void expect_all_heard(Link& link) const {
    while (heard(link) != std::array{true, true, true} || (wishes_.commands && !link.listened_to())) {
      if (Steady::now() > until(kHeard)) throw why_not_heard(link);
      std::this_thread::sleep_for(kLook);
    }
  }

  /// Returns for each stream of Link::needed() whether a message has arrived.
  static std::array<bool, 3> heard(Link& link) {
    const Snapshot seen = link.read();
    return {seen.joints.has_value(), seen.endpoint.has_value(), seen.state.has_value()};
  }

  Error why_not_heard(Link& link) const {
    if (link.read().now == 0.0) {
      return trouble("/use_sim_time", "is set, but /clock publishes no time",
                     "start the simulated clock, or delete the parameter and restart all nodes");
    }
    const Graph graph = network_.master.graph(until(kTold));
    const auto came = heard(link);
    for (std::size_t i = 0; i < came.size(); ++i) {
      if (!came[i]) return why_silent(Link::needed()[i], graph, link.read().malformed);
    }
    const auto& nodes = Graph::of(graph.subscribers, kCommandTopic);
    if (nodes.empty()) {
      return trouble(kCommandTopic, "no node subscribes to it",
                     "wait until the robot has started; dry_run: true works without");
    }
    const std::string name = network_.own_name.empty() ? boost::asio::ip::host_name() : network_.own_name;
    return trouble(kCommandTopic,
                   listed(nodes) +
                       " subscribes to it but has not connected to this machine, whose address is announced as " + name,
                   "set ROS_IP to this machine's address on the robot's network");
  }

  Error why_silent(const Topic& needed, const Graph& graph, const std::string& malformed) const {
    std::optional<Error> why;
    std::vector<std::string> mute;
    for (const std::string& node : Graph::of(graph.publishers, needed.name)) {
      const auto place = place_of(node);
      if (!place) continue;
      try {
        const Offer offer = ask_publisher(*place, needed.name, within(kOnePublisher, until(kTold)));
        if (offer.md5 != needed.md5) {
          return trouble(needed.name,
                         fmt::format("{} sends {} with md5 sum {}, but this driver needs {} with {}", node, offer.type,
                                     offer.md5, needed.type, needed.md5),
                         "install the robot's software 1.2");
        }
        mute.push_back(node);
      } catch (const Unreached& reason) {
        why = no_publisher(needed.name, node, *place, reason);
      }
    }
    if (!malformed.empty()) return trouble(network_.where(), malformed, "check that it is a Baxter");
    if (mute.empty() && why) return *why;
    return trouble(needed.name, listed(mute) + " publishes it, but no message has arrived",
                   "check it with rostopic echo; the robot may still be starting");
  }

  static Error no_publisher(const std::string& topic, const std::string& node, const Place& place,
                            const Unreached& reason) {
    return unreachable(topic, "its publisher " + node, place, reason,
                       "restart it, or remove its remains with rosnode cleanup");
  }

  Wishes wishes_;
  Deadline begin_;
  Network network_;
};

}  // namespace

std::unique_ptr<Robot> connect(const Wishes& wishes) { return Visit(wishes).join(); }

}  // namespace palpate::baxter
