// SPDX-License-Identifier: MIT
// Node that observes a robot on the network of ROS_MASTER_URI, for the tests of fake_baxter:
//   listen SECONDS             prints sender, topic, number and rate of messages, one line each; SECONDS of robot time
//   switches                   stops, enables, resets, enables, and prints /robot/state after each
//   drive SECONDS STALL        sends a set-point every 10 ms of robot time, each STALL s of real time late
#include <baxter_core_msgs/AssemblyState.h>
#include <baxter_core_msgs/CollisionAvoidanceState.h>
#include <baxter_core_msgs/CollisionDetectionState.h>
#include <baxter_core_msgs/EndpointState.h>
#include <baxter_core_msgs/JointCommand.h>
#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Empty.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <optional>

namespace palpate::fake_baxter {
namespace {

using baxter_core_msgs::AssemblyState;
using baxter_core_msgs::CollisionAvoidanceState;
using baxter_core_msgs::CollisionDetectionState;
using baxter_core_msgs::EndpointState;
using baxter_core_msgs::JointCommand;
using sensor_msgs::JointState;

constexpr double kTimeout = 20.0;  // s of real time

class Probe {
 public:
  Probe() {
    hear<EndpointState>("/robot/limb/left/endpoint_state", [](const auto&) {});
    hear<JointState>("/robot/joint_states", [this](const auto& m) {
      if (m.name.size() > 1) joints = m;
    });
    hear<AssemblyState>("/robot/state", [this](const auto& m) { state = m; });
    hear<CollisionDetectionState>("/robot/limb/left/collision_detection_state", [](const auto&) {});
    hear<CollisionAvoidanceState>("/robot/limb/left/collision_avoidance_state", [](const auto&) {});
  }

  /// Processes messages until `holds` is true. Returns false after kTimeout.
  bool until(const std::function<bool()>& holds) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kTimeout);
    while (!holds()) {
      if (ros::WallTime::now() > end) return false;
      queue_.callAvailable(ros::WallDuration(0.0002));
    }
    return true;
  }

  bool wait(double seconds) {
    const double end = ros::Time::now().toSec() + seconds;
    return until([&] { return ros::Time::now().toSec() >= end; });
  }

  template <class Message>
  ros::Publisher advertise(const std::string& topic) {
    const ros::Publisher out = node_.advertise<Message>(topic, 1);
    if (!until([&] { return out.getNumSubscribers() > 0; })) fmt::print("nobody listens to {}\n", topic);
    return out;
  }

  std::map<std::string, long> counts;  ///< number of messages by sender, topic and, for joints, number of joints
  std::optional<JointState> joints;
  std::optional<AssemblyState> state;

 private:
  static std::size_t size_of(const JointState& message) { return message.name.size(); }
  template <class Message>
  static std::size_t size_of(const Message&) {
    return 1;
  }

  template <class Message>
  void hear(const std::string& topic, const std::function<void(const Message&)>& keep) {
    node_.setCallbackQueue(&queue_);
    const boost::function<void(const ros::MessageEvent<const Message>&)> callback =
        [this, topic, keep](const ros::MessageEvent<const Message>& event) {
          ++counts[fmt::format("{} {} {}", event.getPublisherName(), topic, size_of(*event.getMessage()))];
          keep(*event.getMessage());
        };
    heard_.push_back(node_.subscribe<Message>(topic, 100, callback, {}, ros::TransportHints().tcpNoDelay()));
  }

  ros::NodeHandle node_;
  ros::CallbackQueue queue_;
  std::vector<ros::Subscriber> heard_;
};

int listen(Probe& probe, double seconds) {
  probe.wait(0.5);  // until all connections exist
  probe.counts.clear();
  const double begin = ros::Time::now().toSec();
  probe.wait(seconds);
  const double took = ros::Time::now().toSec() - begin;
  for (const auto& [name, count] : probe.counts) {
    fmt::print("{} {} {:.1f}\n", name, count, static_cast<double>(count) / took);
  }
  return 0;
}

/// Repeats a message for half a second of robot time, as Rethink's tools do, and prints the state.
template <class Message>
void flip(Probe& probe, const char* word, const std::string& topic, const Message& message) {
  const ros::Publisher publisher = probe.advertise<Message>(topic);
  for (int i = 0; i < 10; ++i) {
    publisher.publish(message);
    probe.wait(0.05);
  }
  const AssemblyState& s = *probe.state;
  fmt::print("{}: ready {} enabled {} stopped {} error {} button {} source {}\n", word, s.ready, s.enabled, s.stopped,
             s.error, s.estop_button, s.estop_source);
}

int switches(Probe& probe) {
  probe.until([&] { return probe.state.has_value(); });
  std_msgs::Bool yes;
  yes.data = 1;
  flip(probe, "stop", "/robot/set_super_stop", std_msgs::Empty());
  flip(probe, "enable", "/robot/set_super_enable", yes);
  flip(probe, "reset", "/robot/set_super_reset", std_msgs::Empty());
  flip(probe, "enable", "/robot/set_super_enable", yes);
  return 0;
}

int drive(Probe& probe, double seconds, double stall) {
  if (!probe.until([&] { return probe.joints.has_value(); })) return 1;
  const ros::Publisher publisher = probe.advertise<JointCommand>("/robot/limb/left/joint_command");
  JointCommand message;
  message.mode = JointCommand::POSITION_MODE;
  for (std::size_t i = 2; i < 9; ++i) {
    message.names.push_back(probe.joints->name[i]);
    message.command.push_back(probe.joints->position[i]);
  }
  const double begin = ros::Time::now().toSec();
  double due = begin;
  long late = 0;
  while (due < begin + seconds) {
    message.command.back() += 0.001;  // 0.1 rad/s of left_w2
    publisher.publish(message);
    due += 0.01;
    if (!probe.until([&] { return ros::Time::now().toSec() >= due - 1e-6; })) return 1;
    // Simulates a driver on a busy machine, for which the robot must wait.
    ros::WallDuration(stall).sleep();
    const double now = ros::Time::now().toSec();
    // The robot cannot wait before it has received the first command.
    if (due > begin + 0.1 && now > due + 0.035) ++late;
    due = std::max(due, now - 0.005);
  }
  fmt::print("late {}\n", late);
  return 0;
}

int run(const std::vector<std::string>& words) {
  ros::init(ros::M_string(), "probe", ros::init_options::AnonymousName);
  int status = 2;
  {
    Probe probe;
    ros::Time::waitForValid();
    if (words.size() == 2 && words[0] == "listen") status = listen(probe, std::atof(words[1].c_str()));
    if (words.size() == 1 && words[0] == "switches") status = switches(probe);
    if (words.size() == 3 && words[0] == "drive") {
      status = drive(probe, std::atof(words[1].c_str()), std::atof(words[2].c_str()));
    }
  }
  ros::shutdown();
  return status;
}

}  // namespace
}  // namespace palpate::fake_baxter

int main(int argc, char** argv) { return palpate::fake_baxter::run({argv + 1, argv + argc}); }
