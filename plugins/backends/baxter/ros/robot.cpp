// SPDX-License-Identifier: MIT
#include "baxter/ros/arm_part.hpp"
#include "baxter/ros/bag.hpp"
#include "baxter/ros/link.hpp"
#include "baxter/ros/pulse.hpp"
#include "baxter/ros/solver.hpp"

#include <algorithm>
#include <atomic>
#include <csignal>
#include <mutex>
#include <thread>

#include <baxter_core_msgs/AssemblyState.h>
#include <baxter_core_msgs/CollisionAvoidanceState.h>
#include <baxter_core_msgs/CollisionDetectionState.h>
#include <baxter_core_msgs/EndEffectorProperties.h>
#include <baxter_core_msgs/EndpointState.h>
#include <baxter_core_msgs/JointCommand.h>
#include <pthread.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/this_node.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Float64.h>

namespace palpate::baxter {
namespace {

namespace msgs = baxter_core_msgs;
namespace traits = ros::message_traits;

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// How long a simulated clock may stand still.
constexpr seconds kStandstill(2);
/// A simulated second may pass in a twentieth of a real one: looked at so often, it is not overslept by 4 ms.
constexpr microseconds kSimulatedNap(150);
/// A simulated clock goes in steps, and who waits for the next must not miss it by the rounding of sums, seconds.
constexpr double kRounding = 1e-6;
/// In simulated time the clock may overtake the messages of an instant, on a busy machine by far; so much real time
/// they are given to catch up, to within so much simulated time.
constexpr milliseconds kCatchUp(50);
constexpr double kAlmostNow = 0.03;

/// What came while this program did not get to it is counted, not dropped: at 100 Hz that of a tenth of a second, and
/// no more, which would take even longer to get through.
constexpr std::uint32_t kBacklog = 10;
/// Without messages the spinner looks up so often.
const ros::WallDuration kSpin(0.5 * Pulse::kNoted);

void add_once(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

/// Protocol time, seconds: the simulated clock, or that of this machine as it was at the beginning, which then goes on
/// evenly. Who sets the clock meanwhile, by hand or by NTP, neither makes data old nor the arm wait.
class Clock {
 public:
  double now() const {
    if (ros::Time::isSimTime()) return ros::Time::now().toSec();
    return begin_ + std::chrono::duration<double>(Steady::now() - steady_begin_).count();
  }

  /// When a message was received, which roscpp tells by the clock of this machine.
  double received(const ros::Time& receipt) const {
    if (ros::Time::isSimTime()) return receipt.toSec();
    return now() - std::max(0.0, (ros::Time::now() - receipt).toSec());
  }

 private:
  double begin_ = ros::WallTime::now().toSec();
  Steady::time_point steady_begin_ = Steady::now();
};

double steady_seconds() { return std::chrono::duration<double>(Steady::now().time_since_epoch()).count(); }

class RosRobot final : public Link {
 public:
  RosRobot(const Network& network, bool commands, std::optional<double> tool_mass)
      : bag_(std::make_shared<Bag>()), solver_(network.master), pulse_(steady_seconds()) {
    latest_.end_effector.mass = tool_mass;
    set_current_bag(bag_);
    handle_.setCallbackQueue(&queue_);
    subscribe<sensor_msgs::JointState>(kJointTopic, &RosRobot::on_joints);
    subscribe<msgs::EndpointState>(kEndpointTopic, &RosRobot::on_endpoint);
    subscribe<msgs::AssemblyState>(kStateTopic, &RosRobot::on_state);
    subscribe<msgs::CollisionDetectionState>(kCollisionTopic, &RosRobot::on_collision);
    subscribe<msgs::CollisionAvoidanceState>(kAvoidanceTopic, &RosRobot::on_avoidance);
    subscribe<msgs::EndEffectorProperties>(kEndEffectorTopic, &RosRobot::on_end_effector);
    subscribe<std_msgs::Float64>(kSpeedRatioTopic, &RosRobot::on_speed_ratio);
    subscribe<std_msgs::Float64>(kCommandTimeoutTopic, &RosRobot::on_command_timeout);
    if (commands) {
      subscribe<msgs::JointCommand>(kCommandTopic, &RosRobot::on_command);
      command_publisher_ = handle_.advertise<msgs::JointCommand>(kCommandTopic, 1);
      command_.mode = msgs::JointCommand::POSITION_MODE;
      command_.names.assign(kJointNames.begin(), kJointNames.end());
      command_.command.resize(kArm);
    }
    // Signals are for the threads that were there before.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    spinner_ = std::thread([this] { spin(); });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
  }

  ~RosRobot() override {
    forget_silent_master();
    stop_ = true;
    queue_.disable();
    spinner_.join();
    give_up([this] {
      for (ros::Subscriber& subscriber : subscribers_) subscriber.shutdown();
      command_publisher_.shutdown();
    });
  }

  Snapshot read() override {
    const std::lock_guard lock(mutex_);
    Snapshot snapshot = latest_;
    snapshot.now = clock_.now();
    snapshot.simulated = ros::Time::isSimTime();
    snapshot.own_gap = pulse_.longest(steady_seconds());
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
    if (!command_publisher_) return;  // not wished for
    std::copy(target.begin(), target.end(), command_.command.begin());
    command_publisher_.publish(command_);
    bag_->write_own(kCommandTopic, command_, false);
  }

  void record(const std::string& file) override { bag_->open(file); }

  Answer solve(const Pose& gripper, const Joints& seed) override { return solver_.solve(gripper, seed); }

  std::array<bool, 3> heard() override {
    const std::lock_guard lock(mutex_);
    return {latest_.joints.has_value(), latest_.endpoint.has_value(), latest_.state.has_value()};
  }

  bool clock_runs() override { return !ros::Time::now().isZero(); }
  /// This program listens, too: see on_command().
  bool listened_to() override { return command_publisher_.getNumSubscribers() > 1; }

 private:
  template <class Message>
  using Event = ros::MessageEvent<const Message>;

  template <class Message>
  void subscribe(const char* topic, void (RosRobot::*take)(const Event<Message>&, Snapshot&)) {
    const boost::function<void(const Event<Message>&)> heard = [this, topic, take](const Event<Message>& event) {
      if (event.getPublisherName() == ros::this_node::getName()) return;
      // Before a simulated clock was heard nothing has an age, and what was latched comes then and never again.
      const bool timed = !event.getReceiptTime().isZero();
      if (timed) {
        bag_->write<Message>(topic, event.getReceiptTime(), event.getConstMessage(), event.getConnectionHeaderPtr());
      } else if (traits::HasHeader<Message>::value || std::is_same_v<Message, msgs::AssemblyState>) {
        return;
      }
      const std::lock_guard lock(mutex_);
      (this->*take)(event, latest_);
    };
    subscribers_.push_back(handle_.subscribe<const Event<Message>&>(topic, kBacklog, heard, ros::VoidConstPtr(),
                                                                    ros::TransportHints().tcpNoDelay()));
  }

  /// That of a stream's next message.
  template <class Message>
  Arrival arrival(const Event<Message>& event, long before) const {
    return {clock_.received(event.getReceiptTime()), event.getConstMessage()->header.stamp.toSec(), before + 1};
  }
  template <class Reading>
  static long count_of(const std::optional<Reading>& latest) {
    return latest ? latest->count : 0;
  }

  void on_joints(const Event<sensor_msgs::JointState>& event, Snapshot& latest) {
    const sensor_msgs::JointState& message = *event.getConstMessage();
    const ArmPart part = arm_part(message);
    if (part.count == 0) return;  // the gripper's, or the other arm's
    if (part.count != kArm || message.position.size() != message.name.size()) {
      malformed(latest, std::string(kJointTopic) + " has " + std::to_string(part.count) +
                            " of the left arm's seven joints, " + counts(message));
      return;
    }
    latest.joints = JointReading{arrival(event, count_of(latest.joints)), part.position};
    add_once(latest.joint_senders, event.getPublisherName());
  }

  void on_endpoint(const Event<msgs::EndpointState>& event, Snapshot& latest) {
    const msgs::EndpointState& message = *event.getConstMessage();
    const auto& position = message.pose.position;
    const auto& turn = message.pose.orientation;
    const auto& force = message.wrench.force;
    latest.endpoint = EndpointReading{arrival(event, count_of(latest.endpoint)),
                                      {{position.x, position.y, position.z}, {turn.w, turn.x, turn.y, turn.z}},
                                      {force.x, force.y, force.z}};
  }

  void on_state(const Event<msgs::AssemblyState>& event, Snapshot& latest) {
    const msgs::AssemblyState& message = *event.getConstMessage();
    add_once(latest.state_senders, event.getPublisherName());
    if (message.estop_button > msgs::AssemblyState::ESTOP_BUTTON_RELEASED ||
        message.estop_source > msgs::AssemblyState::ESTOP_SOURCE_BRAIN) {
      malformed(latest, std::string(kStateTopic) + " has estop_button " + std::to_string(message.estop_button) +
                            " and estop_source " + std::to_string(message.estop_source));
      return;
    }
    StateReading state;
    state.received = clock_.received(event.getReceiptTime());
    state.count = count_of(latest.state) + 1;
    state.ready = message.ready != 0;
    state.enabled = message.enabled != 0;
    state.stopped = message.stopped != 0;
    state.error = message.error != 0;
    state.estop_button = static_cast<StateReading::Button>(message.estop_button);
    state.estop_source = static_cast<StateReading::Source>(message.estop_source);
    latest.state = state;
  }

  void on_collision(const Event<msgs::CollisionDetectionState>& event, Snapshot& latest) {
    latest.collision =
        CollisionReading{arrival(event, count_of(latest.collision)), event.getConstMessage()->collision_state != 0};
  }

  void on_avoidance(const Event<msgs::CollisionAvoidanceState>& event, Snapshot& latest) {
    const msgs::CollisionAvoidanceState& message = *event.getConstMessage();
    latest.avoidance =
        AvoidanceReading{arrival(event, count_of(latest.avoidance)), message.other_arm != 0, message.collision_object};
  }

  void on_end_effector(const Event<msgs::EndEffectorProperties>& event, Snapshot& latest) {
    const msgs::EndEffectorProperties& message = *event.getConstMessage();
    const bool both = !message.manufacturer.empty() && !message.product.empty();
    latest.end_effector.product = message.manufacturer + (both ? " " : "") + message.product;
  }

  void on_speed_ratio(const Event<std_msgs::Float64>& event, Snapshot& latest) {
    latest.speed_ratio = Setting{event.getConstMessage()->data, event.getPublisherName()};
  }

  void on_command_timeout(const Event<std_msgs::Float64>& event, Snapshot& latest) {
    latest.command_timeout = Setting{event.getConstMessage()->data, event.getPublisherName()};
  }

  /// Whoever else sends set-points drives the same arm elsewhere.
  void on_command(const Event<msgs::JointCommand>& event, Snapshot& latest) {
    add_once(latest.commanders, event.getPublisherName());
  }

  static void malformed(Snapshot& latest, const std::string& words) {
    if (latest.malformed.empty()) latest.malformed = words;
  }

  /// Woken by every message and by the end.
  void spin() {
    while (!stop_) {
      queue_.callAvailable(kSpin);
      const std::lock_guard lock(mutex_);
      pulse_.beat(steady_seconds());
    }
  }

  void await_messages() {
    const auto begin = Steady::now();
    const auto there = [&] {
      const std::lock_guard lock(mutex_);
      const double enough = ros::Time::now().toSec() - kAlmostNow;
      return latest_.joints && latest_.joints->received >= enough && latest_.endpoint &&
             latest_.endpoint->received >= enough && latest_.state && latest_.state->received >= enough;
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
  Solver solver_;
  std::mutex mutex_;
  Snapshot latest_;  ///< guarded by mutex_; its `now` and `own_gap` are not used
  Pulse pulse_;      ///< of the spinner; guarded by mutex_
  std::atomic<bool> stop_{false};
  std::thread spinner_;
};

}  // namespace

const std::array<Stream, 3>& Link::needed() {
  using JointState = sensor_msgs::JointState;
  using EndpointState = msgs::EndpointState;
  using AssemblyState = msgs::AssemblyState;
  static const std::array<Stream, 3> streams = {
      Stream{kJointTopic, traits::datatype<JointState>(), traits::md5sum<JointState>()},
      Stream{kEndpointTopic, traits::datatype<EndpointState>(), traits::md5sum<EndpointState>()},
      Stream{kStateTopic, traits::datatype<AssemblyState>(), traits::md5sum<AssemblyState>()}};
  return streams;
}

std::unique_ptr<Link> make_link(const Network& network, bool commands, std::optional<double> tool_mass) {
  return std::make_unique<RosRobot>(network, commands, tool_mass);
}

}  // namespace palpate::baxter
