// SPDX-License-Identifier: MIT
#include "fake_baxter/companion.hpp"

#include <palpate/error.hpp>

#include <baxter_core_msgs/AssemblyState.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::fake_baxter {
namespace {

constexpr int kPatience = 10'000;  // ms

/// Reads the next stamp; false when the other end is gone.
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

void publish_state(const ros::Publisher& publisher) {
  baxter_core_msgs::AssemblyState message;
  message.ready = true;
  message.enabled = true;
  publisher.publish(message);
}

}  // namespace

Companion::Companion(const std::string& role) {
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
    if (::getppid() != parent) ::_exit(1);  // it was gone before the line above
    ::dup2(ends[1], STDIN_FILENO);
    ::execv(words[0], words);
    ::_exit(127);
  }
  ::close(ends[1]);
  socket_ = ends[0];
}

Companion::~Companion() {
  ::close(socket_);  // upon which it unregisters its node and ends
  ::waitpid(pid_, nullptr, 0);
}

void Companion::tell(double stamp) { ::send(socket_, &stamp, sizeof stamp, MSG_DONTWAIT | MSG_NOSIGNAL); }

void Companion::wait_until_up() {
  pollfd wait{socket_, POLLIN, 0};
  char up = 0;
  int ready = -1;
  do {
    ready = ::poll(&wait, 1, kPatience);
  } while (ready < 0 && errno == EINTR);
  if (ready != 1 || ::recv(socket_, &up, 1, 0) != 1) throw Error("", "a companion does not come up");
}

int serve_companion(const std::string& role) {
  // A signal to the whole group is the robot's to answer; when that ends, so does this, and unregisters its node.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  double stamp = 0.0;
  if (!told(stamp)) return 0;
  const bool gripper = role == "end_effector";
  const ros::M_string no_remappings;
  ros::init(no_remappings, gripper ? "end_effector_publisher" : "second_robot", ros::init_options::NoSigintHandler);
  {
    ros::NodeHandle node;
    const ros::Publisher publisher = gripper ? node.advertise<sensor_msgs::JointState>("/robot/joint_states", 1)
                                             : node.advertise<baxter_core_msgs::AssemblyState>("/robot/state", 1);
    ::send(STDIN_FILENO, "u", 1, MSG_NOSIGNAL);
    do {
      if (gripper) publish_gripper(publisher, stamp);
      if (!gripper) publish_state(publisher);
    } while (told(stamp));
  }
  ros::shutdown();
  return 0;
}

}  // namespace palpate::fake_baxter
