// SPDX-License-Identifier: MIT
#include "baxter/ros/node.hpp"

#include "baxter/error_texts.hpp"

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <future>
#include <optional>

#include <ros/console.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/poll_manager.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcUtil.h>

namespace ros::master {
// Function of roscpp that no header declares. It reads the address of the master.
void init(const M_string& remappings);
}  // namespace ros::master

namespace palpate::baxter {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLookUp(1000);
constexpr milliseconds kAnswer(2000);
constexpr milliseconds kFarewell(500);

/// Returns an empty string if the variable is not set, as roscpp does.
std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

/// Returns whether a server can listen on this address.
bool is_own_address(const std::string& text) {
  namespace asio = boost::asio;
  boost::system::error_code error;
  const Address address(asio::ip::make_address(text, error), 0);
  if (error || address.address().is_unspecified() || address.address().is_multicast()) return false;
  asio::io_context io;
  asio::ip::tcp::socket(io, address.protocol()).bind(address, error);
  return !error;
}

/// Returns the name or address by which other nodes reach this machine. Throws Error.
std::string own_name(Deadline deadline) {
  const std::string ip = variable("ROS_IP");
  const std::string name = variable("ROS_HOSTNAME");
  if (!ip.empty() && !name.empty())
    throw robot_error("ROS_IP=" + ip, "is set together with ROS_HOSTNAME=" + name, "unset one of them");
  if (!ip.empty() && !is_own_address(ip))
    throw robot_error("ROS_IP=" + ip, "is not an address of this machine, so the robot cannot reach it",
                      "set it to the address of the interface on the robot's network (ip -brief address)");
  if (!name.empty()) {
    try {
      look_up(name, 1, within(kLookUp, deadline));
    } catch (const NetworkError& reason) {
      throw robot_error("ROS_HOSTNAME=" + name, fmt::format("does not resolve ({})", reason.what()),
                        "set ROS_IP to this machine's address instead");
    }
  }
  return ip.empty() ? name : ip;
}

/// Drops the messages of roscpp's XML-RPC library on stderr.
class SilentErrorHandler : public XmlRpc::XmlRpcErrorHandler {
  void error(const char*) override {}
};

/// The roscpp node, from the first connection to the end of the process.
class Node {
 public:
  explicit Node(const Network& joined) : network(joined) {
    // roscpp's log is switched off, because its lines, such as reconnections, would appear between palpate's own.
    // connect(), the safety rules and the record report its errors.
    ROSCONSOLE_AUTOINIT;
    ros::console::set_logger_level("ros", ros::console::levels::Fatal);
    ros::console::notifyLoggerLevelsChanged();
    static SilentErrorHandler nothing;
    XmlRpc::XmlRpcErrorHandler::setErrorHandler(&nothing);
    ros::master::setRetryTimeout(ros::WallDuration(1.0));
    try {
      ros::init(ros::M_string(), kNodeName,
                ros::init_options::NoSigintHandler | ros::init_options::AnonymousName | ros::init_options::NoRosout);
      ros::start();
    } catch (const std::exception& exception) {
      throw robot_error(network.where(), fmt::format("roscpp does not start: {}", exception.what()),
                        "check the variables ROS_*");
    }
  }

  ~Node() {
    forget_silent_master();
    ros::PollManager::instance()->shutdown();  // stops the connection thread, see run_on_connection_thread()
    ros::shutdown();
    ros::waitForShutdown();
  }

  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  const Network network;
};

/// The node of this process, for functions that must not start it.
const Node* running = nullptr;

void point_roscpp_at(const std::string& master) { ros::master::init({{"__master", master}}); }

}  // namespace

Network find_network(Deadline deadline) {
  const std::string uri = variable("ROS_MASTER_URI");
  if (uri.empty()) {
    throw robot_error("ROS_MASTER_URI", "is not set",
                      "set it to the robot's master, http://<the robot's name>.local:11311");
  }
  const std::string where = "ROS_MASTER_URI=" + uri;
  const std::optional<HostPort> place = parse_uri(uri, "http");
  if (!place) throw robot_error(where, "is not of the form http://host:port", "as in http://011305P0001.local:11311");
  const std::string name = own_name(deadline);
  try {
    const Master master(look_up(place->host, place->port, within(kLookUp, deadline)));
    master.process_id(within(kAnswer, deadline));
    return {uri, master, name};
  } catch (const NetworkError& reason) {
    throw unreachable(where, "the master", *place, reason, "start the robot, or correct the variable");
  }
}

Error unreachable(const std::string& where, const std::string& who, const HostPort& place, const NetworkError& reason,
                  const std::string& remedy) {
  switch (reason.why) {
    case NetworkError::FailureCause::name:
      return robot_error(
          where, fmt::format("{} is on the host {}, which does not resolve here ({})", who, place.host, reason.what()),
          "check the cable to the robot; names in .local need mDNS (libnss-mdns) or a line in /etc/hosts");
    case NetworkError::FailureCause::silent:
      return robot_error(where, fmt::format("{} at {}:{} does not answer in time", who, place.host, place.port),
                         "check that the robot is on and that no firewall blocks the connection");
    default:
      return robot_error(where, fmt::format("{} is not at {}:{} ({})", who, place.host, place.port, reason.what()),
                         remedy);
  }
}

void start_node(const Network& network) {
  static const Node node(network);
  running = &node;
  if (node.network.uri != network.uri)
    throw robot_error(network.where(),
                      "this process is already a node of " + node.network.uri + " and cannot change its master",
                      "start another process");
  if (!ros::ok())
    throw robot_error(network.where(), "the ROS node of this process was told to shut down", "start it again");
  point_roscpp_at(network.uri);  // an earlier connection may have pointed it at a closed port
}

std::string node_name() { return ros::this_node::getName(); }

void forget_silent_master() {
  if (running == nullptr) return;
  try {
    running->network.master.process_id(Steady::now() + kFarewell);
  } catch (const NetworkError&) {
    point_roscpp_at("http://127.0.0.1:9");  // discard port: no server listens there
  }
}

void run_on_connection_thread(const std::function<void()>& connections) {
  std::atomic<bool> begun = false;
  std::promise<void> done;
  const auto once = [&] {
    if (begun.exchange(true)) return;
    connections();
    done.set_value();
  };
  const ros::PollManagerPtr& thread = ros::PollManager::instance();
  const auto listener = thread->addPollThreadListener(once);
  std::future<void> ended = done.get_future();
  while (ended.wait_for(milliseconds(100)) != std::future_status::ready) {
    if (!ros::ok()) once();  // the connection thread has ended
  }
  thread->removePollThreadListener(listener);
}

}  // namespace palpate::baxter
