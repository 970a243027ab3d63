// SPDX-License-Identifier: MIT
#include "fake_baxter/node.hpp"

#include "fake_baxter/delivery.hpp"
#include "fake_baxter/ik_service.hpp"
#include "fake_baxter/old_state.hpp"
#include "fake_baxter/urdf.hpp"

#include <palpate/error.hpp>

#include <baxter_core_msgs/AssemblyState.h>
#include <baxter_core_msgs/CollisionAvoidanceState.h>
#include <baxter_core_msgs/CollisionDetectionState.h>
#include <baxter_core_msgs/EndEffectorProperties.h>
#include <baxter_core_msgs/EndpointState.h>
#include <baxter_core_msgs/JointCommand.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Empty.h>
#include <std_msgs/Float64.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>

#include <fmt/format.h>

namespace palpate::fake_baxter {
namespace {

constexpr double kMasterPatience = 5.0;        // s of real time
constexpr double kGripperPeriod = 1.0 / 38.0;  // s
constexpr double kLead = 2.0 * Body::kPeriod;  // s, largest lead of /clock over the driver
constexpr double kSlack = Body::kPeriod / 2;   // s, tolerance when comparing times of periods
constexpr double kShortPatience = 0.02;        // s of real time
constexpr double kNap = 0.005;                 // s of real time between checks for signals
constexpr double kBacklog = 0.1;               // s of real time that may be caught up
constexpr const char* kSoftware = "1.2.0.57";

/// All joints in the robot's joint_states, in its order.
constexpr const char* kAllJoints[] = {"head_nod", "head_pan", "left_e0",  "left_e1",  "left_s0",  "left_s1",
                                      "left_w0",  "left_w1",  "left_w2",  "right_e0", "right_e1", "right_s0",
                                      "right_s1", "right_w0", "right_w1", "right_w2", "torso_t0"};

/// Returns the index of a joint in kAllJoints.
std::size_t place_of(const std::string& joint) {
  return static_cast<std::size_t>(std::find(std::begin(kAllJoints), std::end(kAllJoints), joint) -
                                  std::begin(kAllJoints));
}

ros::Time time_of(double seconds) {
  ros::Time out;
  out.fromSec(seconds);
  return out;
}

template <class Xyz>
void put(Xyz& out, const Eigen::Vector3d& value) {
  out.x = value.x();
  out.y = value.y();
  out.z = value.z();
}

/// Converts a reading to its ROS message.
baxter_core_msgs::EndpointState message_of(const baxter::EndpointReading& reading, const Eigen::Vector3d& speed) {
  baxter_core_msgs::EndpointState out;
  out.header.frame_id = "base";
  out.header.stamp = time_of(reading.stamp);
  put(out.pose.position, reading.pose.position);
  put(out.pose.orientation, reading.pose.rotation.vec());
  out.pose.orientation.w = reading.pose.rotation.w();
  put(out.twist.linear, speed);
  put(out.wrench.force, reading.force);
  return out;
}

sensor_msgs::JointState message_of(const baxter::JointReading& reading, const Joints& speed, const Joints& effort) {
  sensor_msgs::JointState out;
  out.header.stamp = time_of(reading.stamp);
  out.name.assign(std::begin(kAllJoints), std::end(kAllJoints));
  out.position.assign(out.name.size(), 0.0);
  out.velocity.assign(out.name.size(), 0.0);
  out.effort.assign(out.name.size(), 0.0);
  for (std::size_t i = 0; i < baxter::kJointNames.size(); ++i) {
    const std::size_t place = place_of(baxter::kJointNames[i]);
    out.position[place] = reading.position(static_cast<Eigen::Index>(i));
    out.velocity[place] = speed(static_cast<Eigen::Index>(i));
    out.effort[place] = effort(static_cast<Eigen::Index>(i));
  }
  return out;
}

baxter_core_msgs::AssemblyState message_of(const baxter::StateReading& state) {
  baxter_core_msgs::AssemblyState out;
  out.ready = state.ready;
  out.enabled = state.enabled;
  out.stopped = state.stopped;
  out.error = state.error;
  out.estop_button = static_cast<std::uint8_t>(state.estop_button);
  out.estop_source = static_cast<std::uint8_t>(state.estop_source);
  return out;
}

baxter_core_msgs::CollisionDetectionState message_of(const baxter::CollisionReading& reading) {
  baxter_core_msgs::CollisionDetectionState out;
  out.header.stamp = time_of(reading.stamp);
  out.collision_state = reading.collision;
  return out;
}

baxter_core_msgs::CollisionAvoidanceState message_of(const baxter::AvoidanceReading& reading) {
  baxter_core_msgs::CollisionAvoidanceState out;
  out.header.stamp = time_of(reading.stamp);
  out.other_arm = reading.other_arm;
  out.collision_object = reading.objects;
  return out;
}

baxter_core_msgs::EndEffectorProperties properties_of(const std::string& product) {
  baxter_core_msgs::EndEffectorProperties out;
  if (product.empty()) return out;
  out.ui_type = baxter_core_msgs::EndEffectorProperties::ELECTRIC_GRIPPER;
  out.manufacturer = "Rethink Research Robot";
  out.product = product;
  return out;
}

void join_network(bool clock) {
  if (std::getenv("ROS_MASTER_URI") == nullptr) throw Error("ROS_MASTER_URI", "is not set");
  const ros::M_string no_remappings;
  ros::init(no_remappings, "realtime_loop", ros::init_options::NoSigintHandler);
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(kMasterPatience);
  while (!ros::master::check()) {
    if (ros::WallTime::now() > end) {
      throw Error("", "there is no ROS master at " + ros::master::getURI(), {}, Error::Kind::run);
    }
    ros::WallDuration(0.05).sleep();
  }
  // Nodes read the parameter when they start.
  if (clock) ros::param::set("/use_sim_time", true);
}

/// Writes one row per period with the true state. Columns: time, tip (x, y, z in the scene's frame), height of the
/// set-point, contact force, published force along z, mode, number of commands, and whether a fault has begun.
class Trace {
 public:
  /// An empty name writes nothing. Throws Error.
  explicit Trace(const std::string& file) {
    if (file.empty()) return;
    out_.open(file);
    if (!out_) throw Error(file, "cannot be written");
    out_ << "t,x,y,z,set_z,force,said,mode,commands,fault\n";
  }

  void write(const Body& body) {
    if (!out_.is_open()) return;
    const Eigen::Vector3d tip = body.tip();
    const auto endpoint = body.messages().endpoint;
    const double said = endpoint ? endpoint->force.z() : std::numeric_limits<double>::quiet_NaN();
    out_ << fmt::format("{:.2f},{:.5f},{:.5f},{:.5f},{:.5f},{:.3f},{:.3f},{},{},{}\n", body.now(), tip.x(), tip.y(),
                        tip.z(), body.set_point_height(), body.pressing(), said, name_of(body.mode()), body.commands(),
                        body.faulty() ? 1 : 0);
    if (++rows_ % 50 == 0) flush();
  }
  void flush() { out_.flush(); }

 private:
  std::ofstream out_;
  long rows_ = 0;
};

class Node {
 public:
  Node(Body& body, const NodeOptions& options, ExtraNode& gripper, std::list<FaultNode>& fault_nodes,
       const baxter::ArmKinematics& arm)
      : body_(body), options_(options), gripper_(gripper), fault_nodes_(fault_nodes), trace_(options.trace) {
    join_network(options.rate > 0.0);
    node_.emplace();
    node_->setCallbackQueue(&queue_);
    const Fault* software = body.active(FaultKind::software);
    node_->setParam("/rethink/software_version", software != nullptr ? software->text : std::string(kSoftware));
    node_->setParam("/robot_description", urdf(options.tool_mass));
    advertise();
    if (body.active(FaultKind::ik_absent) == nullptr) inverse_.emplace(arm);
    subscribe();
    gripper_.tell(body.now());
    gripper_.wait_until_up();
  }
  ~Node() {
    trace_.flush();
    inverse_.reset();
    node_.reset();
    ros::shutdown();
  }

  void run(const std::atomic<bool>& stop) {
    const double rate = options_.rate > 0.0 ? options_.rate : 1.0;
    const ros::WallDuration period(Body::kPeriod / rate);
    ros::WallTime due = ros::WallTime::now();
    publish();
    for (FaultNode& one : fault_nodes_) {
      if (body_.active(one.with) != nullptr) one.node.wait_until_up();
    }
    std::puts("ready");
    std::fflush(stdout);
    while (!stop) {
      due += period;
      // With /clock nothing needs to be caught up; in real time, up to kBacklog.
      const ros::WallTime oldest = ros::WallTime::now() - ros::WallDuration(options_.rate > 0.0 ? 0.0 : kBacklog);
      due = std::max(due, oldest);
      queue_.callAvailable();
      while (!stop && ros::WallTime::now() < due) {
        queue_.callAvailable(std::min(ros::WallDuration(kNap), due - ros::WallTime::now()));
      }
      wait_for_driver(stop);
      step();
    }
  }

 private:
  void advertise() {
    ros::NodeHandle& node = *node_;
    endpoint_ = node.advertise<baxter_core_msgs::EndpointState>("/robot/limb/left/endpoint_state", options_.queue);
    joints_ = node.advertise<sensor_msgs::JointState>("/robot/joint_states", options_.queue);
    collision_ = node.advertise<baxter_core_msgs::CollisionDetectionState>("/robot/limb/left/collision_detection_state",
                                                                           options_.queue);
    avoidance_ = node.advertise<baxter_core_msgs::CollisionAvoidanceState>("/robot/limb/left/collision_avoidance_state",
                                                                           options_.queue);
    properties_ =
        node.advertise<baxter_core_msgs::EndEffectorProperties>("/robot/end_effector/left_gripper/properties", 1, true);
    properties_.publish(properties_of(options_.gripper));
    if (body_.active(FaultKind::old_state) != nullptr) {
      publish_state_ = advertise_old_state(node);
    } else {
      const ros::Publisher state = node.advertise<baxter_core_msgs::AssemblyState>("/robot/state", options_.queue);
      publish_state_ = [state](const baxter::StateReading& reading) { state.publish(message_of(reading)); };
    }
    if (options_.rate > 0.0) clock_ = node.advertise<rosgraph_msgs::Clock>("/clock", 1);
  }

  template <class Message>
  void listen(const std::string& topic, const std::function<void(const Message&)>& action) {
    const boost::function<void(const boost::shared_ptr<const Message>&)> callback =
        [action](const boost::shared_ptr<const Message>& message) { action(*message); };
    heard_.push_back(node_->subscribe<Message>(topic, 1, callback, {}, ros::TransportHints().tcpNoDelay()));
  }

  void subscribe() {
    listen<baxter_core_msgs::JointCommand>("/robot/limb/left/joint_command", [this](const auto& m) { command(m); });
    listen<std_msgs::Float64>("/robot/limb/left/joint_command_timeout",
                              [this](const auto& m) { body_.set_command_timeout(m.data); });
    listen<std_msgs::Float64>("/robot/limb/left/set_speed_ratio",
                              [this](const auto& m) { body_.set_speed_ratio(m.data); });
    listen<std_msgs::Bool>("/robot/set_super_enable", [this](const auto& m) { body_.enable(m.data != 0); });
    listen<std_msgs::Empty>("/robot/set_super_stop", [this](const auto&) { body_.stop(); });
    listen<std_msgs::Empty>("/robot/set_super_reset", [this](const auto&) { body_.reset(); });
  }

  /// Takes set-points by name for some or all joints. Only position modes are simulated.
  void command(const baxter_core_msgs::JointCommand& message) {
    heard_at_ = body_.now();
    allowed_ = std::min(std::max(allowed_, heard_at_) + Body::kPeriod, heard_at_ + kLead);
    gave_up_ = false;
    const bool positions = message.mode == baxter_core_msgs::JointCommand::POSITION_MODE ||
                           message.mode == baxter_core_msgs::JointCommand::RAW_POSITION_MODE;
    if (!positions || message.names.size() != message.command.size()) return;
    body_.command(overlaid(body_.set_point(), message.names, message.command));
  }

  /// Holds /clock until the driver has sent a command. Every command allows one more period, so that a driver that
  /// receives the time late does not fall behind. One period is in reserve. The wait is short for a single missing
  /// command and long if commands have stopped.
  void wait_for_driver(const std::atomic<bool>& stop) {
    const ros::WallTime begin = ros::WallTime::now();
    while (options_.rate > 0.0 && !stop && !gave_up_) {
      const double next = body_.now() + Body::kPeriod;
      const bool streaming = body_.now() - heard_at_ < body_.command_timeout();
      if (!streaming || next < allowed_ + kSlack) return;
      const double waited = (ros::WallTime::now() - begin).toSec();
      if (next < heard_at_ + kLead + kSlack && waited > kShortPatience) return;
      gave_up_ = waited > options_.patience;
      queue_.callAvailable(ros::WallDuration(kNap));
    }
  }

  void step() {
    body_.step();
    trace_.write(body_);
    if (body_.active(FaultKind::die) != nullptr) {
      trace_.flush();
      std::_Exit(1);
    }
    if (inverse_) {
      const Fault* slow = body_.active(FaultKind::ik_slow);
      inverse_->set(
          {body_.joints(), body_.active(FaultKind::ik_invalid) != nullptr, slow != nullptr ? slow->amount : 0});
    }
    publish();
  }

  void publish() {
    for (const RobotMessages& said : delivery_.take(body_)) {
      if (said.endpoint) endpoint_.publish(message_of(*said.endpoint, said.tip_speed));
      if (said.joints) joints_.publish(message_of(*said.joints, said.speed, said.effort));
      if (said.state) publish_state_(*said.state);
      if (said.collision) collision_.publish(message_of(*said.collision));
      if (said.avoidance) avoidance_.publish(message_of(*said.avoidance));
    }
    while (gripper_due_ <= body_.now()) {
      gripper_.tell(body_.now());
      gripper_due_ = std::max(gripper_due_, body_.now() - kGripperPeriod) + kGripperPeriod;
    }
    for (FaultNode& one : fault_nodes_) {
      if (body_.active(one.with) != nullptr) one.node.tell(body_.now());
    }
    // Published last, so that messages usually arrive before the time.
    if (options_.rate > 0.0 && body_.active(FaultKind::freeze_clock) == nullptr) {
      rosgraph_msgs::Clock clock;
      clock.clock = time_of(body_.now());
      clock_.publish(clock);
    }
  }

  Body& body_;
  NodeOptions options_;
  ExtraNode& gripper_;
  std::list<FaultNode>& fault_nodes_;
  Delivery delivery_;
  Trace trace_;
  ros::CallbackQueue queue_;
  std::optional<ros::NodeHandle> node_;
  std::optional<IkService> inverse_;
  ros::Publisher endpoint_, joints_, collision_, avoidance_, properties_, clock_;
  std::function<void(const baxter::StateReading&)> publish_state_;
  std::vector<ros::Subscriber> heard_;
  double heard_at_ = -1e9;  ///< s, time of the last command, even if it was ignored
  double allowed_ = -1e9;   ///< s, limit of the clock without another command
  bool gave_up_ = false;    ///< whether the wait for a command has timed out
  double gripper_due_ = 0.0;
};

}  // namespace

void serve(Body& body, const NodeOptions& options, ExtraNode& gripper, std::list<FaultNode>& fault_nodes,
           const baxter::ArmKinematics& arm, const std::atomic<bool>& stop) {
  Node(body, options, gripper, fault_nodes, arm).run(stop);
}

}  // namespace palpate::fake_baxter
