// SPDX-License-Identifier: MIT
#include "baxter/error_texts.hpp"
#include "baxter/ros/bag.hpp"
#include "baxter/ros/connection.hpp"
#include "baxter/ros/thread_gaps.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <thread>

#include <baxter_core_msgs/AssemblyState.h>
#include <baxter_core_msgs/CollisionAvoidanceState.h>
#include <baxter_core_msgs/CollisionDetectionState.h>
#include <baxter_core_msgs/EndEffectorProperties.h>
#include <baxter_core_msgs/EndpointState.h>
#include <baxter_core_msgs/JointCommand.h>
#include <baxter_core_msgs/SolvePositionIK.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/this_node.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64.h>
#include <boost/algorithm/string/trim.hpp>

namespace palpate::baxter {
namespace {

namespace msgs = baxter_core_msgs;
namespace traits = ros::message_traits;

using namespace std::chrono_literals;

/// Longest time for which a simulated clock may stand still.
constexpr auto kStandstill = 2s;
/// Sleep between reads of a simulated clock. With a clock 20 times as fast as real time, a waiting loop is at most 4 ms
/// late.
constexpr auto kSimulatedNap = 150us;
/// Tolerance in s for rounding, because a simulated clock advances in steps.
constexpr double kRounding = 1e-6;
/// Longest real time to wait for messages that lag behind a simulated clock on a busy machine. kAlmostNow is the age in
/// s of simulated time up to which messages are recent enough.
constexpr auto kCatchUp = 50ms;
constexpr double kAlmostNow = 0.03;

/// Length of the message queue: a tenth of a second at 100 Hz. Messages that wait while this program is busy are
/// counted, not dropped. A longer queue would take longer to process.
constexpr std::uint32_t kBacklog = 10;
/// Longest wait of the spinner thread for a message.
const ros::WallDuration kSpin(0.5 * Heartbeat::kNoted);

/// Time for an answer of the robot's inverse kinematics, within the promised second.
constexpr auto kSolve = 900ms;

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

/// Protocol time in s: the simulated clock, or a steady clock that starts at the system time. Changes of the system
/// time, by hand or by NTP, neither make data old nor delay the arm.
class Clock {
 public:
  double now() const {
    if (ros::Time::isSimTime()) return ros::Time::now().toSec();
    return begin_ + std::chrono::duration<double>(Steady::now() - steady_begin_).count();
  }

  /// Converts the reception time of roscpp, which uses the system clock, to protocol time.
  double received(const ros::Time& receipt) const {
    if (ros::Time::isSimTime()) return receipt.toSec();
    return now() - std::max(0.0, (ros::Time::now() - receipt).toSec());
  }

 private:
  double begin_ = ros::WallTime::now().toSec();
  Steady::time_point steady_begin_ = Steady::now();
};

double steady_seconds() { return std::chrono::duration<double>(Steady::now().time_since_epoch()).count(); }

constexpr std::size_t kArm = kJointNames.size();

/// Joints of the left arm in a message with named joints.
struct ArmJoints {
  std::size_t count = 0;  ///< number of the arm's joints in the message
  std::string malformed;  ///< error text if joints or positions are missing; else empty
  Joints position = Joints::Zero();
};

ArmJoints arm_joints(const sensor_msgs::JointState& message) {
  ArmJoints part;
  for (std::size_t joint = 0; joint < kArm; ++joint) {
    const auto found = std::find(message.name.begin(), message.name.end(), kJointNames[joint]);
    if (found == message.name.end()) continue;
    ++part.count;
    const auto at = static_cast<std::size_t>(found - message.name.begin());
    if (at < message.position.size()) part.position[static_cast<Eigen::Index>(joint)] = message.position[at];
  }
  if (part.count != kArm || message.position.size() != message.name.size())
    part.malformed = fmt::format("{} of the left arm's seven joints, {} names and {} positions", part.count,
                                 message.name.size(), message.position.size());
  return part;
}

class RosRobot final : public RosConnection {
 public:
  RosRobot(const Network& network, bool commands, std::optional<double> tool_mass)
      : bag_(std::make_shared<Bag>()), master_(network.master), heartbeat_(steady_seconds()) {
    latest_.end_effector.mass = tool_mass;
    handle_.setCallbackQueue(&queue_);
    listen();
    if (commands) {
      // Another sender of set-points would move the same arm.
      subscribe<msgs::JointCommand>(kCommandTopic, [](const auto&, const MessageInfo& heard, Snapshot& latest) {
        add_once(latest.commanders, heard.sender);
      });
      command_publisher_ = handle_.advertise<msgs::JointCommand>(kCommandTopic, 1);
      command_.mode = msgs::JointCommand::POSITION_MODE;
      command_.names.assign(kJointNames.begin(), kJointNames.end());
      command_.command.resize(kArm);
    }
    spinner_ = thread_without_signals([this] { spin(); });
  }

  ~RosRobot() override {
    forget_silent_master();
    stop_ = true;
    queue_.disable();
    spinner_.join();
    run_on_connection_thread([this] {
      for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
      command_publisher_.shutdown();
    });
  }

  Snapshot read() override {
    const std::lock_guard lock(mutex_);
    Snapshot snapshot = latest_;
    snapshot.now = clock_.now();
    snapshot.simulated = ros::Time::isSimTime();
    snapshot.own_gap = heartbeat_.longest(steady_seconds());
    return snapshot;
  }

  bool wait_until(double time) override {
    double last = clock_.now();
    auto moved = Steady::now();
    for (double now = last; now < time - kRounding; now = clock_.now()) {
      if (now != last) {
        last = now;
        moved = Steady::now();
      } else if (Steady::now() - moved > kStandstill) {
        return false;
      }
      if (ros::Time::isSimTime()) {
        std::this_thread::sleep_for(kSimulatedNap);
      } else {
        std::this_thread::sleep_for(std::chrono::duration<double>(time - now));
      }
    }
    if (ros::Time::isSimTime()) await_messages();
    return true;
  }

  void command(const Joints& target) override {
    if (!command_publisher_) return;  // commands were not requested
    std::copy(target.begin(), target.end(), command_.command.begin());
    command_publisher_.publish(command_);
    bag_->write_own(kCommandTopic, command_, false);
  }

  void record(const std::string& file) override { bag_->open(file); }

  std::optional<Joints> solve(const Pose& gripper, const Joints& seed) override {
    msgs::SolvePositionIKRequest request;
    request.seed_mode = msgs::SolvePositionIKRequest::SEED_USER;
    request.pose_stamp.resize(1);
    geometry_msgs::PoseStamped& pose = request.pose_stamp[0];
    pose.header.stamp = ros::Time::now();
    pose.header.frame_id = "base";
    pose.pose.position.x = gripper.position.x();
    pose.pose.position.y = gripper.position.y();
    pose.pose.position.z = gripper.position.z();
    pose.pose.orientation.x = gripper.rotation.x();
    pose.pose.orientation.y = gripper.rotation.y();
    pose.pose.orientation.z = gripper.rotation.z();
    pose.pose.orientation.w = gripper.rotation.w();
    request.seed_angles.resize(1);
    request.seed_angles[0].header = pose.header;
    request.seed_angles[0].name.assign(kJointNames.begin(), kJointNames.end());
    request.seed_angles[0].position.assign(seed.begin(), seed.end());

    msgs::SolvePositionIKResponse response;
    try {
      const ros::SerializedMessage asked = ros::serialization::serializeMessage(request);
      std::string bytes =
          answer({reinterpret_cast<const char*>(asked.buf.get()), asked.num_bytes}, Steady::now() + kSolve);
      ros::serialization::IStream stream(reinterpret_cast<std::uint8_t*>(bytes.data()),
                                         static_cast<std::uint32_t>(bytes.size()));
      ros::serialization::deserialize(stream, response);
    } catch (const NetworkError& reason) {
      throw robot_error(kSolverService, reason.what());
    } catch (const ros::Exception& exception) {
      throw robot_error(kSolverService, std::string("its answer cannot be read: ") + exception.what());
    }
    if (response.isValid.size() != 1 || response.joints.size() != 1 || response.result_type.size() != 1)
      throw robot_error(kSolverService, "its answer has not one part for one pose");
    if (response.isValid[0] == 0 || response.result_type[0] == msgs::SolvePositionIKResponse::RESULT_INVALID) return {};
    const ArmJoints part = arm_joints(response.joints[0]);
    if (!part.malformed.empty()) throw robot_error(kSolverService, "its answer has " + part.malformed);
    return part.position;
  }

  std::shared_ptr<Bag> bag() override { return bag_; }

  /// One subscriber is this program itself.
  bool listened_to() override { return command_publisher_.getNumSubscribers() > 1; }

 private:
  /// Calls IKService with a deadline. Its address is looked up for each call, because it may have been restarted
  /// elsewhere.
  std::string answer(const std::string& request, Deadline deadline) {
    const char* md5 = ros::service_traits::MD5Sum<msgs::SolvePositionIK>::value();
    const auto uri = master_.query("lookupService", kSolverService, deadline);
    if (!uri) throw NetworkError(NetworkError::FailureCause::refused, "no node offers it");
    const auto place = parse_uri(*uri, "rosrpc");
    if (!place) throw NetworkError(NetworkError::FailureCause::nonsense, "the master has it at " + *uri);
    return call_service(look_up(place->host, place->port, deadline), kSolverService, md5, request, deadline);
  }

  /// Sender and reception time of a message.
  struct MessageInfo {
    std::string sender;
    double received;

    /// Returns the arrival of the next reading of a stream.
    template <class Message, class Reading>
    MessageArrival next(const Message& message, const std::optional<Reading>& latest) const {
      return {received, message.header.stamp.toSec(), (latest ? latest->count : 0) + 1};
    }
  };

  /// Subscribes to `topic`. `take` stores a message; its arguments are the message, its MessageInfo and the latest
  /// snapshot.
  template <class Message, class Take>
  void subscribe(const char* topic, const Take& take) {
    using Event = ros::MessageEvent<const Message>;
    const boost::function<void(const Event&)> heard = [this, topic, take](const Event& event) {
      if (event.getPublisherName() == ros::this_node::getName()) return;
      // Before the first simulated time, messages have no reception time. Streams are then ignored. Latched messages
      // arrive only once, so they are kept without a time.
      if (!event.getReceiptTime().isZero()) {
        bag_->write<Message>(topic, event.getReceiptTime(), event.getConstMessage(), event.getConnectionHeaderPtr());
      } else if (traits::HasHeader<Message>::value || std::is_same_v<Message, msgs::AssemblyState>) {
        return;
      }
      const std::lock_guard lock(mutex_);
      take(*event.getConstMessage(), MessageInfo{event.getPublisherName(), clock_.received(event.getReceiptTime())},
           latest_);
    };
    subscribers_.push_back(handle_.subscribe<const Event&>(topic, kBacklog, heard, ros::VoidConstPtr(),
                                                           ros::TransportHints().tcpNoDelay()));
  }

  void listen() {
    subscribe<sensor_msgs::JointState>(kJointTopic, take_joints);
    subscribe<msgs::EndpointState>(kEndpointTopic,
                                   [](const msgs::EndpointState& message, const MessageInfo& heard, Snapshot& latest) {
                                     const auto& at = message.pose.position;
                                     const auto& turn = message.pose.orientation;
                                     const auto& force = message.wrench.force;
                                     EndpointReading reading{heard.next(message, latest.endpoint),
                                                             {{at.x, at.y, at.z}, {turn.w, turn.x, turn.y, turn.z}},
                                                             {force.x, force.y, force.z}};
                                     count_after(latest.endpoint, reading);
                                     latest.endpoint = reading;
                                     add_once(latest.senders.endpoint, heard.sender);
                                   });
    subscribe<msgs::AssemblyState>(kStateTopic, take_state);
    subscribe<msgs::CollisionDetectionState>(
        kCollisionTopic, [](const auto& message, const MessageInfo& heard, Snapshot& latest) {
          latest.collision = CollisionReading{heard.next(message, latest.collision), message.collision_state != 0};
          add_once(latest.senders.collision, heard.sender);
        });
    subscribe<msgs::CollisionAvoidanceState>(
        kAvoidanceTopic, [](const auto& message, const MessageInfo& heard, Snapshot& latest) {
          latest.avoidance =
              AvoidanceReading{heard.next(message, latest.avoidance), message.other_arm != 0, message.collision_object};
          add_once(latest.senders.avoidance, heard.sender);
        });
    subscribe<msgs::EndEffectorProperties>(
        kEndEffectorTopic, [](const auto& message, const MessageInfo&, Snapshot& latest) {
          latest.end_effector.product = boost::trim_copy(message.manufacturer + " " + message.product);
        });
    for (const auto& [topic, setting] : {std::pair(kSpeedRatioTopic, &Snapshot::speed_ratio),
                                         std::pair(kCommandTimeoutTopic, &Snapshot::command_timeout)}) {
      subscribe<std_msgs::Float64>(topic,
                                   [kept = setting](const auto& message, const MessageInfo& heard, Snapshot& latest) {
                                     latest.*kept = ReceivedSetting{message.data, heard.sender};
                                   });
    }
    if (ros::Time::isSimTime()) listen_to_clock();
  }

  /// Counts the senders of the simulated clock. roscpp accepts the time from any sender. The clock is not recorded,
  /// because the bag stores times itself.
  void listen_to_clock() {
    using Event = ros::MessageEvent<const rosgraph_msgs::Clock>;
    const boost::function<void(const Event&)> heard = [this](const Event& event) {
      const std::lock_guard lock(mutex_);
      add_once(latest_.senders.clock, event.getPublisherName());
    };
    subscribers_.push_back(handle_.subscribe<const Event&>(kClockTopic, 1, heard, ros::VoidConstPtr(),
                                                           ros::TransportHints().tcpNoDelay()));
  }

  static void take_joints(const sensor_msgs::JointState& message, const MessageInfo& heard, Snapshot& latest) {
    const ArmJoints part = arm_joints(message);
    if (part.count == 0) return;  // joints of the gripper or of the other arm
    if (!part.malformed.empty()) return malformed(latest, fmt::format("{} has {}", kJointTopic, part.malformed));
    latest.joints = JointReading{heard.next(message, latest.joints), part.position};
    add_once(latest.senders.joints, heard.sender);
  }

  static void take_state(const msgs::AssemblyState& message, const MessageInfo& heard, Snapshot& latest) {
    add_once(latest.senders.state, heard.sender);
    if (message.estop_button > msgs::AssemblyState::ESTOP_BUTTON_RELEASED ||
        message.estop_source > msgs::AssemblyState::ESTOP_SOURCE_BRAIN) {
      return malformed(latest, fmt::format("{} has estop_button {} and estop_source {}", kStateTopic,
                                           message.estop_button, message.estop_source));
    }
    latest.state = StateReading{heard.received,
                                message.ready != 0,
                                message.enabled != 0,
                                message.stopped != 0,
                                message.error != 0,
                                static_cast<StateReading::Button>(message.estop_button),
                                static_cast<StateReading::EstopSource>(message.estop_source),
                                (latest.state ? latest.state->count : 0) + 1};
  }

  static void malformed(Snapshot& latest, const std::string& words) {
    if (latest.malformed.empty()) latest.malformed = words;
  }

  /// Loop of the spinner thread. Messages and the end of the connection wake it up.
  void spin() {
    while (!stop_) {
      queue_.callAvailable(kSpin);
      const std::lock_guard lock(mutex_);
      heartbeat_.beat(steady_seconds());
    }
  }

  void await_messages() {
    const auto begin = Steady::now();
    const auto there = [&] {
      const std::lock_guard lock(mutex_);
      const double enough = ros::Time::now().toSec() - kAlmostNow;
      const auto came = [&](const auto& latest) { return latest && latest->received >= enough; };
      return came(latest_.joints) && came(latest_.endpoint) && came(latest_.state);
    };
    while (!there() && Steady::now() - begin < kCatchUp) std::this_thread::sleep_for(kSimulatedNap);
  }

  Clock clock_;
  std::shared_ptr<Bag> bag_;
  ros::CallbackQueue queue_;
  ros::NodeHandle handle_;
  std::vector<ros::Subscriber> subscribers_;
  ros::Publisher command_publisher_;
  msgs::JointCommand command_;
  Master master_;
  std::mutex mutex_;
  Snapshot latest_;      ///< guarded by mutex_; `now` and `own_gap` are not used
  Heartbeat heartbeat_;  ///< heartbeat of the spinner thread; guarded by mutex_
  std::atomic<bool> stop_{false};
  std::thread spinner_;
};

}  // namespace

const std::array<Topic, 3>& RosConnection::needed() {
  const auto topic = [](const char* name, auto message) {
    return Topic{name, traits::datatype(message), traits::md5sum(message)};
  };
  static const std::array<Topic, 3> topics = {topic(kJointTopic, sensor_msgs::JointState()),
                                              topic(kEndpointTopic, msgs::EndpointState()),
                                              topic(kStateTopic, msgs::AssemblyState())};
  return topics;
}

std::unique_ptr<RosConnection> make_connection(const Network& network, bool commands, std::optional<double> tool_mass) {
  return std::make_unique<RosRobot>(network, commands, tool_mass);
}

}  // namespace palpate::baxter
