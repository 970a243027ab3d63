// SPDX-License-Identifier: MIT
#include "fake_baxter/extra_node.hpp"

#include "baxter/kinematics.hpp"

#include <palpate/error.hpp>

#include <baxter_core_msgs/AssemblyState.h>
#include <baxter_core_msgs/CollisionAvoidanceState.h>
#include <baxter_core_msgs/CollisionDetectionState.h>
#include <baxter_core_msgs/EndpointState.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64.h>

#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <functional>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::fake_baxter {
namespace {

constexpr int kStartTimeout = 10'000;  // ms

/// Receives the next stamp. Returns false if the other end has closed.
bool told(double& stamp) {
  const ssize_t size = ::recv(STDIN_FILENO, &stamp, sizeof stamp, MSG_WAITALL);
  return size == static_cast<ssize_t>(sizeof stamp);
}

void publish_gripper(const ros::Publisher& publisher, double stamp) {
  sensor_msgs::JointState message;
  message.header.stamp.fromSec(stamp);
  message.name = {"left_gripper"};
  message.position = {0.0};
  message.velocity = {0.0};
  message.effort = {0.0};
  publisher.publish(message);
}

using Act = std::function<void(double stamp)>;

/// Returns a function that publishes a message, filled by `fill` with a stamp.
template <class Message, class Fill>
Act publish(ros::NodeHandle& node, const char* topic, const Fill& fill) {
  const ros::Publisher publisher = node.advertise<Message>(topic, 1);
  return [publisher, fill](double stamp) {
    Message message;
    fill(message, stamp);
    publisher.publish(message);
  };
}

/// Returns a publisher of one stream of a robot at rest without forces.
Act second_sender(const std::string& stream, ros::NodeHandle& node) {
  using namespace baxter_core_msgs;
  const auto calm = [](auto& message, double stamp) { message.header.stamp.fromSec(stamp); };
  if (stream == "state") {
    return publish<AssemblyState>(node, "/robot/state", [](AssemblyState& message, double) {
      message.ready = true;
      message.enabled = true;
    });
  }
  if (stream == "collision") {
    return publish<CollisionDetectionState>(node, "/robot/limb/left/collision_detection_state", calm);
  }
  if (stream == "avoidance") {
    return publish<CollisionAvoidanceState>(node, "/robot/limb/left/collision_avoidance_state", calm);
  }
  if (stream == "joints") {
    return publish<sensor_msgs::JointState>(
        node, "/robot/joint_states", [calm](sensor_msgs::JointState& message, double stamp) {
          calm(message, stamp);
          const baxter::Joints joints = baxter::untucked();
          message.name.assign(baxter::kJointNames.begin(), baxter::kJointNames.end());
          message.position.assign(joints.begin(), joints.end());
        });
  }
  return publish<EndpointState>(node, "/robot/limb/left/endpoint_state", [calm](EndpointState& message, double stamp) {
    calm(message, stamp);
    message.pose.orientation.x = 1.0;
    message.wrench.force.z = 0.1 * std::sin(1000.0 * stamp);
  });
}

/// Returns the name of the node.
std::string name_of(const std::string& role) {
  if (role == "end_effector") return "end_effector_publisher";
  if (role.rfind("second_sender=", 0) == 0) return "second_robot";
  return "other_program_" + role.substr(0, role.find('='));
}

/// Returns the action of a role, called with each received stamp.
Act publisher_of(const std::string& role, ros::NodeHandle& node) {
  if (role == "end_effector") {
    const ros::Publisher publisher = node.advertise<sensor_msgs::JointState>("/robot/joint_states", 1);
    return [publisher](double stamp) { publish_gripper(publisher, stamp); };
  }
  const std::size_t equals = role.find('=');
  if (role.substr(0, equals) == "second_sender") return second_sender(role.substr(equals + 1), node);
  const ros::Publisher publisher =
      node.advertise<std_msgs::Float64>("/robot/limb/left/" + role.substr(0, equals), 1, true);
  std_msgs::Float64 message;
  message.data = std::atof(role.c_str() + equals + 1);
  publisher.publish(message);
  return [publisher](double) {};
}

}  // namespace

ExtraNode::ExtraNode(const std::string& role) {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw Error("", "cannot make a socket");
  std::string program = "/proc/self/exe";
  std::string option = "--companion";
  std::string word = role;
  char* const words[] = {program.data(), option.data(), word.data(), nullptr};
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) throw Error("", "cannot fork");
  if (pid_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);  // the parent ended before prctl()
    ::dup2(ends[1], STDIN_FILENO);
    ::execv(words[0], words);
    ::_exit(127);
  }
  ::close(ends[1]);
  socket_ = ends[0];
}

ExtraNode::~ExtraNode() {
  ::close(socket_);  // the process then unregisters its node and ends
  ::waitpid(pid_, nullptr, 0);
}

void ExtraNode::tell(double stamp) { ::send(socket_, &stamp, sizeof stamp, MSG_DONTWAIT | MSG_NOSIGNAL); }

void ExtraNode::wait_until_up() {
  pollfd wait{socket_, POLLIN, 0};
  char up = 0;
  int ready = -1;
  do {
    ready = ::poll(&wait, 1, kStartTimeout);
  } while (ready < 0 && errno == EINTR);
  if (ready != 1 || ::recv(socket_, &up, 1, 0) != 1) throw Error("", "a companion does not come up");
}

int serve_extra_node(const std::string& role) {
  // Signals to the process group are handled by the robot. When the robot ends, this process unregisters its node and
  // ends, too.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  double stamp = 0.0;
  if (!told(stamp)) return 0;
  const ros::M_string no_remappings;
  ros::init(no_remappings, name_of(role), ros::init_options::NoSigintHandler);
  {
    ros::NodeHandle node;
    const Act publish = publisher_of(role, node);
    ::send(STDIN_FILENO, "u", 1, MSG_NOSIGNAL);
    do {
      publish(stamp);
    } while (told(stamp));
  }
  ros::shutdown();
  return 0;
}

}  // namespace palpate::fake_baxter
