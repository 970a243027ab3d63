// SPDX-License-Identifier: MIT
#include "baxter/motion_guard.hpp"

#include "baxter/error_texts.hpp"

#include <cmath>
#include <utility>

namespace palpate::baxter {
namespace {

using AllowedAction = Fault::AllowedAction;
using Button = StateReading::Button;

/// Minimum set_speed_ratio: 0.27 * 1.5 rad/s (the maximum speed of a joint) = 0.4 rad/s, the largest speed that the
/// driver commands.
constexpr double kLeastRatio = 0.27;
constexpr double kLeastTimeout = 0.05;  ///< s: duration of five set-points
constexpr double kMostTimeout = 0.5;    ///< s; an arm may move on for this time after the last set-point

double degrees(double radians) { return radians * 180.0 / 3.14159265358979323846; }

constexpr double kPeriod = 0.01;  ///< s between two reads

constexpr const char* kReset =
    "reset it (rosrun baxter_tools enable_robot.py -r) and enable it (rosrun baxter_tools enable_robot.py -e)";

/// Returns a fault for the first forbidden state of the robot, else nullopt.
std::optional<Fault> state_fault(const StateReading& state, const std::optional<JointReading>& joints, bool moving) {
  const bool stays_disabled = moving && !state.enabled;
  const double shoulder = joints ? joints->position(1) : 0.0;
  const struct {
    bool broken;
    const char* words;
  } rules[] = {
      {state.estop_button == Button::pressed, "the emergency stop is pressed: release it, then {reset}"},
      {state.estop_button == Button::released, "the emergency stop was pressed and is released: {reset}"},
      // An enabled robot may report an error and still move, according to Rethink's reference. So an error alone is not
      // a fault.
      {state.error && !state.enabled, "the robot reports an error and is disabled: check its screen, then {reset}"},
      {state.stopped && state.estop_button == Button::unknown,
       "a program, perhaps a safety node, stopped the robot (/robot/set_super_stop): find out why, then {reset}"},
      {state.stopped, "the robot is stopped: {reset}"},
      {stays_disabled && shoulder < -1.6,
       "the robot is disabled and its arm is tucked (left_s1 at {shoulder:.1f} deg): untuck it, which enables it"},
      {stays_disabled,
       "the robot is disabled: enable it (rosrun baxter_tools enable_robot.py -e), palpate never does that itself"},
      {moving && !state.ready, "the robot is not ready: wait until it has started"},
  };
  for (const auto& [broken, words] : rules) {
    if (!broken) continue;
    return Fault{fmt::format(fmt::runtime(words), fmt::arg("reset", kReset), fmt::arg("shoulder", degrees(shoulder)))};
  }
  return std::nullopt;
}

constexpr const char* kOwnSlowness =
    ": end other programs that keep this computer busy, and allow real-time scheduling (see baxter.txt of the run)";

/// Returns a fault if `age` exceeds `most`. `gap`: seconds since the driver's last read. If the gap explains the age,
/// the fault blames this computer.
std::optional<Fault> stale_fault(const char* stream, double age, double most, double gap,
                                 AllowedAction then = AllowedAction::silence) {
  if (age <= most) return std::nullopt;
  if (gap > most && age <= gap + most)
    return Fault{fmt::format("this computer could not serve the arm for {:.2f} s{}", gap, kOwnSlowness), then};
  return Fault{fmt::format("{} did not arrive for {:.2f} s: check the network and the robot's processes", stream, age),
               then};
}

std::optional<Fault> lateness_fault(const char* stream, const MessageArrival& arrival, MotionGuard::Delay& best,
                                    AllowedAction then) {
  const double delay = arrival.received - arrival.stamp;
  if (!std::isfinite(delay)) return Fault{fmt::format("{} has a time stamp that is not a number", stream), then};
  // Unsynchronised clocks drift apart by more than kLate within hours, so the smallest delay may grow slowly.
  best.least = std::min(delay, best.least + MotionGuard::kDrift * std::max(0.0, arrival.received - best.at));
  best.at = arrival.received;
  best.excess = delay - best.least;
  if (best.excess <= MotionGuard::kLate) return std::nullopt;
  return Fault{fmt::format("{} arrives with time stamps {:.2f} s older than before: its data are stale, check the "
                           "network and the robot's processes",
                           stream, best.excess),
               then};
}

constexpr const char* kJoints = "/robot/joint_states of the left arm";
constexpr const char* kEndpoint = "endpoint_state of the left arm";

/// Returns a fault if two nodes send the same stream. Checks only the streams whose fault has the action `then`.
std::optional<Fault> duplicate_sender_fault(const Senders& senders, AllowedAction then) {
  const struct {
    const char* stream;
    const std::vector<std::string>& nodes;
    AllowedAction then;
  } streams[] = {{"/robot/state", senders.state, AllowedAction::silence},
                 {kJoints, senders.joints, AllowedAction::silence},
                 {"/clock", senders.clock, AllowedAction::silence},
                 {kEndpoint, senders.endpoint, AllowedAction::hold},
                 {"collision_detection_state of the left arm", senders.collision, AllowedAction::hold},
                 {"collision_avoidance_state of the left arm", senders.avoidance, AllowedAction::hold}};
  for (const auto& one : streams) {
    if (one.then != then || one.nodes.size() < 2) continue;
    return Fault{fmt::format("{} comes from more than one node, {}: end the node that is not the robot", one.stream,
                             join_words(one.nodes)),
                 then};
  }
  return std::nullopt;
}

}  // namespace

std::string Workspace::breach(const Eigen::Vector3d& tip) const {
  const auto beyond = [](double value, double least, double most) { return !(value >= least && value <= most); };
  const Eigen::Vector3d at = 100 * tip;
  const std::string where =
      fmt::format("the tip is at ({:.1f}, {:.1f}, {:.1f}) cm of the scene, ", at.x(), at.y(), at.z());
  if (beyond(tip.x(), -kSideways, width + kSideways) || beyond(tip.y(), -kSideways, depth + kSideways))
    return fmt::format("{}more than {:.0f} cm outside the area", where, 100 * kSideways);
  if (!(tip.z() >= floor)) return fmt::format("{}below the floor of {:.1f} cm", where, 100 * floor);
  if (!(tip.z() <= ceiling)) return fmt::format("{}above the ceiling of {:.1f} cm", where, 100 * ceiling);
  return {};
}

void MotionGuard::begin() {
  joint_stream_.begin();
  endpoint_stream_.begin();
  motion_ = {};
}

double MotionGuard::lateness() const {
  const std::size_t looks = motion_.looks.size();
  const double own = looks < 2 ? 0.0 : motion_.looks[looks - 1] - motion_.looks[looks - 2] - kPeriod;
  return std::max({0.0, own, 2.0 * joint_delay_.excess, 2.0 * endpoint_delay_.excess});
}

void MotionGuard::record_command(double time, const Joints& target) {
  motion_.sent.push_back({time, target, motion_.joints ? motion_.joints->position : target});
  while (motion_.sent.front().time < time - kTrail) motion_.sent.pop_front();
}

std::optional<Fault> MotionGuard::check_readiness(const Snapshot& seen, bool moving) {
  if (auto fault = check_state(seen, moving, 0.0)) return fault;
  if (auto fault = check_force_data(seen, 0.0)) return fault;
  return moving ? check_settings(seen) : std::nullopt;
}

/// Returns the time in s for which this program did not read or receive messages.
double MotionGuard::own_gap(const Snapshot& seen) const {
  const double looked = motion_.looks.empty() ? 0.0 : seen.now - motion_.looks.back();
  return seen.simulated ? looked : std::max(looked, seen.own_gap);
}

std::optional<Fault> MotionGuard::check_rates(const Snapshot& seen) {
  mark_new_readings(seen);
  return rate_fault(seen);
}

/// Counts the new messages and reads, and sets fresh_.
void MotionGuard::mark_new_readings(const Snapshot& seen) {
  if (motion_.looks.empty()) motion_.began = seen.now;
  motion_.looks.push_back(seen.now);
  while (motion_.looks.front() < seen.now - ReadingCounter::kWindow) motion_.looks.pop_front();
  if (seen.joints) joint_stream_.take(*seen.joints, seen.now);
  fresh_ = false;
  if (!seen.endpoint) return;
  const EndpointReading& endpoint = *seen.endpoint;
  endpoint_stream_.take(endpoint, seen.now);
  fresh_ = renewals_.take(endpoint, seen.now);
}

/// Returns a fault if messages arrive too rarely to detect a contact in time, or if this program reads them too rarely.
/// A simulated clock continues while this program is late. With a simulated clock, the number of messages is therefore
/// compared with the number of reads.
std::optional<Fault> MotionGuard::rate_fault(const Snapshot& seen) const {
  if (seen.now - motion_.began < ReadingCounter::kWindow) return std::nullopt;
  const int looks = static_cast<int>(motion_.looks.size());
  const auto in_window = [](int times, int needed = ReadingCounter::kFewest) {
    return fmt::format("{} times in the last {:.1f} s, {} are needed", times, ReadingCounter::kWindow, needed);
  };
  if (looks < ReadingCounter::kFewest && !seen.simulated)
    return Fault{fmt::format("this computer served the arm {}{}", in_window(looks), kOwnSlowness), AllowedAction::hold};
  const int fewest = seen.simulated ? std::min(ReadingCounter::kFewest, looks / 2) : ReadingCounter::kFewest;
  for (const auto& [name, stream] : {std::pair{kJoints, &joint_stream_}, std::pair{kEndpoint, &endpoint_stream_}}) {
    if (stream->count() >= fewest) continue;
    return Fault{fmt::format("{} arrived only {}: check the network, and that /robot/joint_state_publish_rate is 100",
                             name, in_window(stream->count())),
                 AllowedAction::hold};
  }
  const int needed = std::min(fewest, renewals_.needed());
  if (renewals_.count() >= needed) return std::nullopt;
  return Fault{fmt::format("endpoint_state arrived {} times, but with a new force only {}: contacts would be detected "
                           "too late. Check what filters or repeats the force, or restart the robot",
                           endpoint_stream_.count(), in_window(renewals_.count(), needed)),
               AllowedAction::hold};
}

/// Checks the rules whose violation forbids every set-point, even one that equals the measured joints.
std::optional<Fault> MotionGuard::check_state(const Snapshot& seen, bool moving, double gap) {
  if (!seen.malformed.empty()) return Fault{seen.malformed};
  if (!seen.state || !seen.joints || !seen.endpoint) return Fault{"joints, endpoint and state were not all received"};
  if (auto fault = stale_fault("/robot/state", seen.now - seen.state->received, kStateFresh, gap)) return fault;
  if (auto fault = state_fault(*seen.state, seen.joints, moving)) return fault;
  if (auto fault = duplicate_sender_fault(seen.senders, AllowedAction::silence)) return fault;
  if (!seen.commanders.empty())
    return Fault{fmt::format("the arm is also commanded by {}: end that program first", join_words(seen.commanders))};
  if (auto fault = stale_fault(kJoints, seen.now - seen.joints->received, kFresh, gap)) return fault;
  if (seen.joints->position.allFinite()) return std::nullopt;
  return Fault{"/robot/joint_states has a position that is not a number: restart the robot"};
}

/// Checks the rules after whose violation the arm may still be held, because its position is known.
std::optional<Fault> MotionGuard::check_force_data(const Snapshot& seen, double gap) {
  const EndpointReading& endpoint = *seen.endpoint;
  if (auto fault = duplicate_sender_fault(seen.senders, AllowedAction::hold)) return fault;
  if (auto fault = stale_fault(kEndpoint, seen.now - endpoint.received, kFresh, gap, AllowedAction::hold)) return fault;
  if (!endpoint.force.allFinite() || !endpoint.pose.position.allFinite())
    return Fault{"endpoint_state has a force or a position that is not a number: restart the robot",
                 AllowedAction::hold};
  if (!endpoint.force.isZero(0.0)) return std::nullopt;
  return Fault{
      "endpoint_state has a force of exactly zero: this robot, perhaps a Gazebo simulation, measures no forces",
      AllowedAction::hold};
}

/// Checks settings that other programs left on the robot and that change how it follows set-points.
std::optional<Fault> MotionGuard::check_settings(const Snapshot& seen) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  const struct {
    const char* topic;
    const std::optional<ReceivedSetting>& setting;
    double least, most;
    const char* reason;
    const char* own;
  } rules[] = {{"set_speed_ratio", seen.speed_ratio, kLeastRatio, kAny, ", too low for the arm to follow", "0.3"},
               {"joint_command_timeout", seen.command_timeout, kLeastTimeout, kMostTimeout,
                " s; the arm must stop by itself soon after the last set-point, but not before the next one", "0.2"}};
  for (const auto& [topic, setting, least, most, reason, own] : rules) {
    if (!setting || (setting->value >= least && setting->value <= most)) continue;
    return Fault{fmt::format("{0}: {1} has set it to {2:g}{3}: set it to {4}, on /robot/limb/left/{0}", topic,
                             setting->sender, setting->value, reason, own),
                 AllowedAction::hold};
  }
  return std::nullopt;
}

/// Checks the rules in the order of their actions: rules that demand silence first, rules that allow a rise last. So if
/// several rules are broken, the most restrictive one counts.
std::optional<Fault> MotionGuard::check(const Snapshot& seen, const Eigen::Vector3d& tip) {
  const double own = own_gap(seen);
  mark_new_readings(seen);
  if (auto fault = check_state(seen, true, own)) return fault;
  if (auto fault = check_joints(seen)) return fault;
  if (auto fault = check_force_data(seen, own)) return fault;
  if (auto fault = check_endpoint(seen, own)) return fault;
  if (auto fault = rate_fault(seen)) return fault;
  if (auto fault = check_settings(seen)) return fault;
  if (const int joint = beyond_limits(seen.joints->position, 0.0); joint >= 0)
    return Fault{fmt::format("{} is at {:.1f} deg, beyond its limit: move the arm by hand",
                             kJointNames[static_cast<std::size_t>(joint)], degrees(seen.joints->position(joint))),
                 AllowedAction::hold};
  const std::string breach = workspace_.breach(tip);
  if (!breach.empty())
    return Fault{breach + ": check that position and tool agree with the config", AllowedAction::hold};
  if (auto fault = check_following(seen)) return fault;
  if (!motion_.collision_expected && seen.collision && seen.collision->collision) return reflex_fault(seen, tip);
  return check_force(seen, tip);
}

std::optional<Fault> MotionGuard::check_joints(const Snapshot& seen) {
  if (auto fault = lateness_fault("/robot/joint_states", *seen.joints, joint_delay_, AllowedAction::silence))
    return fault;
  const double jump = motion_.joints ? (seen.joints->position - motion_.joints->position).cwiseAbs().maxCoeff() : 0.0;
  if (jump > kJump)
    return Fault{fmt::format(
        "/robot/joint_states jumped by {:.1f} deg, faster than any joint can turn: restart the robot", degrees(jump))};
  motion_.joints = seen.joints;
  return std::nullopt;
}

std::optional<Fault> MotionGuard::check_endpoint(const Snapshot& seen, double gap) {
  if (auto fault = lateness_fault("endpoint_state", *seen.endpoint, endpoint_delay_, AllowedAction::hold)) return fault;
  if (auto fault = check_frozen(*seen.endpoint, seen.now)) return fault;
  return check_collision_stream(seen, gap);
}

/// A robot that repeats its collision state must continue to send it. A robot that sends only changes may be silent.
std::optional<Fault> MotionGuard::check_collision_stream(const Snapshot& seen, double gap) {
  if (!seen.collision) return std::nullopt;
  const double received = seen.collision->received;
  if (received != collision_received_) {
    collision_streams_ = received - collision_received_ <= kStateFresh;
    collision_received_ = received;
  }
  if (!collision_streams_) return std::nullopt;
  return stale_fault("collision_detection_state of the left arm", seen.now - received, kStateFresh, gap,
                     AllowedAction::hold);
}

std::optional<Fault> MotionGuard::check_following(const Snapshot& seen) const {
  if (motion_.sent.empty()) return std::nullopt;
  const Joints& now = seen.joints->position;
  const auto from = [&](const Joints& target) { return (now - target).cwiseAbs().maxCoeff(); };
  double nearest = std::numeric_limits<double>::infinity();
  for (const SentCommand& one : motion_.sent) nearest = std::min(nearest, from(one.target));
  const double behind = from(motion_.sent.back().target);
  if (behind <= kFollowing && nearest <= kOffTheWay) return std::nullopt;
  return Fault{fmt::format("the arm does not follow: a joint is {:.1f} deg from its target{}", degrees(behind),
                           explain_lag(now, seen.now)),
               AllowedAction::hold};
}

/// Explains why the arm is behind its set-point: too slow, or blocked. The decision uses the speed of the joint that is
/// farthest behind, over the last kRecent seconds.
std::string MotionGuard::explain_lag(const Joints& now, double time) const {
  constexpr double kRecent = 0.2;    // s over which the speed is measured
  constexpr double kTurning = 0.05;  // rad/s: a blocked joint rotates slower
  const SentCommand& last = motion_.sent.back();
  const SentCommand& then = *std::find_if(motion_.sent.begin(), motion_.sent.end() - 1,
                                          [&](const SentCommand& one) { return one.time >= time - kRecent; });
  Eigen::Index joint = 0;
  (last.target - now).cwiseAbs().maxCoeff(&joint);
  const double taken = std::max(time - then.time, 1e-3);
  const double turns = (now(joint) - then.arm(joint)) / taken;
  const double led = (last.target(joint) - then.target(joint)) / taken;
  if (turns * (last.target(joint) - now(joint)) <= 0.0 || std::abs(turns) < kTurning)
    return ": check what blocks it, and whether other programs command it";
  return fmt::format(
      " and turns at {:.0f} deg/s instead of {:.0f}: set its speed ratio to 0.3, a Baxter's default, on "
      "/robot/limb/left/set_speed_ratio, or lower motion.travel_speed",
      degrees(std::abs(turns)), degrees(std::abs(led)));
}

}  // namespace palpate::baxter
