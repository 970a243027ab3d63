// SPDX-License-Identifier: MIT
// A small node that looks at a robot on the network of ROS_MASTER_URI, for the tests of fake_baxter.
//   md5                        name and md5 sum of every message, a line each; needs no network
//   listen SECONDS             of the robot's time: sender, topic, messages, rate, a line each
//   switches                   stop, enable, reset, enable: what /robot/state says after each
//   drive SECONDS STALL        sends a set-point every 10 ms of the robot's time, STALL s of real time late each
//   inverse                    asks IKService for the pose where the arm is
#include "fake_baxter/old_state.hpp"

#include <baxter_core_msgs/AssemblyState.h>
#include <baxter_core_msgs/CollisionAvoidanceState.h>
#include <baxter_core_msgs/CollisionDetectionState.h>
#include <baxter_core_msgs/EndEffectorProperties.h>
#include <baxter_core_msgs/EndpointState.h>
#include <baxter_core_msgs/JointCommand.h>
#include <baxter_core_msgs/SolvePositionIK.h>
#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
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
using baxter_core_msgs::EndEffectorProperties;
using baxter_core_msgs::EndpointState;
using baxter_core_msgs::JointCommand;
using baxter_core_msgs::SolvePositionIK;
using sensor_msgs::JointState;

constexpr const char* kService = "/ExternalTools/left/PositionKinematicsNode/IKService";
constexpr double kPatience = 20.0;  // s of real time for anything to come

template <class Message>
void print_md5(const char* name) {
  fmt::print("{} {}\n", name, ros::message_traits::md5sum<Message>());
}

int md5() {
  print_md5<EndpointState>("EndpointState");
  print_md5<JointCommand>("JointCommand");
  print_md5<AssemblyState>("AssemblyState");
  fmt::print("OldAssemblyState {}\n", old_state_md5());
  print_md5<CollisionDetectionState>("CollisionDetectionState");
  print_md5<CollisionAvoidanceState>("CollisionAvoidanceState");
  print_md5<EndEffectorProperties>("EndEffectorProperties");
  fmt::print("SolvePositionIK {}\n", ros::service_traits::md5sum<SolvePositionIK>());
  print_md5<SolvePositionIK::Request>("SolvePositionIKRequest");
  print_md5<SolvePositionIK::Response>("SolvePositionIKResponse");
  return 0;
}

class Probe {
 public:
  Probe() {
    hear<EndpointState>("/robot/limb/left/endpoint_state", [this](const auto& m) { endpoint = m; });
    hear<JointState>("/robot/joint_states", [this](const auto& m) {
      if (m.name.size() > 1) joints = m;
    });
    hear<AssemblyState>("/robot/state", [this](const auto& m) { state = m; });
    hear<CollisionDetectionState>("/robot/limb/left/collision_detection_state", [](const auto&) {});
    hear<CollisionAvoidanceState>("/robot/limb/left/collision_avoidance_state", [](const auto&) {});
  }

  /// Takes what comes until `holds`; false if that lasts too long.
  bool until(const std::function<bool()>& holds) {
    const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kPatience);
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

  ros::NodeHandle& node() { return node_; }
  std::map<std::string, long> counts;  ///< of messages, by sender, topic and, of joints, how many
  std::optional<EndpointState> endpoint;
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
  probe.wait(0.5);  // until all are connected
  probe.counts.clear();
  const double begin = ros::Time::now().toSec();
  probe.wait(seconds);
  const double took = ros::Time::now().toSec() - begin;
  for (const auto& [name, count] : probe.counts) {
    fmt::print("{} {} {:.1f}\n", name, count, static_cast<double>(count) / took);
  }
  return 0;
}

/// Repeats a message as Rethink's tools do, until the state is as wanted or half a second of the robot's time is over.
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
    // A driver on a busy machine: what the robot must wait for.
    ros::WallDuration(stall).sleep();
    const double now = ros::Time::now().toSec();
    // Before it has heard the first command, the robot cannot wait.
    if (due > begin + 0.1 && now > due + 0.035) ++late;
    due = std::max(due, now - 0.005);
  }
  fmt::print("late {}\n", late);
  return 0;
}

int inverse(Probe& probe) {
  if (!probe.until([&] { return probe.endpoint.has_value() && probe.joints.has_value(); })) return 1;
  SolvePositionIK call;
  call.request.pose_stamp.resize(1);
  call.request.pose_stamp[0].header.frame_id = "base";
  call.request.pose_stamp[0].pose = probe.endpoint->pose;
  if (!ros::service::exists(kService, false)) {
    fmt::print("absent\n");
  } else if (!ros::service::call(kService, call)) {
    fmt::print("failed\n");
  } else if (call.response.isValid.at(0) == 0 || call.response.result_type.at(0) == 0) {
    fmt::print("invalid\n");
  } else {
    double gap = 0.0;
    const JointState& found = call.response.joints.at(0);
    for (std::size_t i = 0; i < found.name.size(); ++i) {
      for (std::size_t j = 0; j < probe.joints->name.size(); ++j) {
        if (found.name[i] != probe.joints->name[j]) continue;
        gap = std::max(gap, std::abs(found.position[i] - probe.joints->position[j]));
      }
    }
    fmt::print("{} joints, {}\n", found.name.size(), gap < 1e-4 ? "where they are" : "elsewhere");
  }
  return 0;
}

/// The topics of a rosbag, a line each: topic, type, md5 sum, messages.
int bag(const std::string& file) {
  const rosbag::Bag read(file, rosbag::bagmode::Read);
  std::map<std::string, int> counts;
  for (const rosbag::MessageInstance& message : rosbag::View(read)) {
    ++counts[message.getTopic() + " " + message.getDataType() + " " + message.getMD5Sum()];
  }
  for (const auto& [topic, count] : counts) fmt::print("{} {}\n", topic, count);
  return 0;
}

int run(const std::vector<std::string>& words) {
  if (words.size() == 1 && words[0] == "md5") return md5();
  if (words.size() == 2 && words[0] == "bag") return bag(words[1]);
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
    if (words.size() == 1 && words[0] == "inverse") status = inverse(probe);
  }
  ros::shutdown();
  return status;
}

}  // namespace
}  // namespace palpate::fake_baxter

int main(int argc, char** argv) { return palpate::fake_baxter::run({argv + 1, argv + argc}); }
