// SPDX-License-Identifier: MIT
#include "baxter/watch.hpp"

#include "baxter/words.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::baxter {
namespace {

using Then = Fault::Then;
using Button = StateReading::Button;

double degrees(double radians) { return radians * 180.0 / 3.14159265358979323846; }

constexpr double kPeriod = 0.01;  ///< s from one look to the next

constexpr const char* kReset =
    "reset it (rosrun baxter_tools enable_robot.py -r) and enable it (rosrun baxter_tools enable_robot.py -e)";

/// What the robot's state forbids; the first rule that is broken counts.
std::optional<Fault> state_forbids(const StateReading& state, const std::optional<JointReading>& joints, bool moving) {
  const bool stays_disabled = moving && !state.enabled;
  const double shoulder = joints ? joints->position(1) : 0.0;
  const struct {
    bool broken;
    const char* words;
  } rules[] = {
      {state.estop_button == Button::pressed, "the emergency stop is pressed: release it, then {reset}"},
      {state.estop_button == Button::released, "the emergency stop was pressed and is released: {reset}"},
      // An error alone stops nothing, by Rethink's own reference: an enabled robot may report one and move.
      {state.error && !state.enabled, "the robot reports an error and is disabled: see its screen, then {reset}"},
      {state.stopped && state.estop_button == Button::unknown,
       "a program stopped the robot (/robot/set_super_stop), a safety node perhaps: see why, then {reset}"},
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
    ": end what else keeps this computer busy, and let palpate have real-time scheduling (see its baxter.txt)";

/// `gap`: how long ago the driver itself looked last. What is old only by that is nobody else's fault.
std::optional<Fault> stale(const char* stream, double age, double most, double gap, Then then = Then::silence) {
  if (age <= most) return std::nullopt;
  if (gap > most && age <= gap + most) {
    return Fault{fmt::format("this computer did not get to the arm for {:.2f} s{}", gap, kOwnSlowness), then};
  }
  return Fault{
      fmt::format("{} did not come for {:.2f} s: see to the network and to the robot's processes", stream, age), then};
}

std::optional<Fault> late(const char* stream, const Arrival& arrival, Watch::Delay& best, Then then) {
  const double delay = arrival.received - arrival.stamp;
  if (!std::isfinite(delay)) return Fault{fmt::format("{} has a stamp that is no number", stream), then};
  // Two clocks that nobody sets drift apart, by more than kLate within hours.
  best.least = std::min(delay, best.least + Watch::kDrift * std::max(0.0, arrival.received - best.at));
  best.at = arrival.received;
  best.excess = delay - best.least;
  if (best.excess <= Watch::kLate) return std::nullopt;
  return Fault{
      fmt::format("{} comes with stamps {:.2f} s older than before: its data are stale, see to the network and "
                  "to the robot's processes",
                  stream, best.excess),
      then};
}

std::optional<Fault> many(const char* stream, const std::vector<std::string>& senders) {
  if (senders.size() < 2) return std::nullopt;
  return Fault{fmt::format("{} from more than one node, {}: one of them is no robot, end it", stream, listed(senders))};
}

}  // namespace

std::string Workspace::breach(const Eigen::Vector3d& tip) const {
  const auto beyond = [](double value, double least, double most) { return !(value >= least && value <= most); };
  const Eigen::Vector3d at = 100 * tip;
  const std::string where =
      fmt::format("the tip is at ({:.1f}, {:.1f}, {:.1f}) cm of the scene, ", at.x(), at.y(), at.z());
  if (beyond(tip.x(), -kSideways, width + kSideways) || beyond(tip.y(), -kSideways, depth + kSideways)) {
    return fmt::format("{}more than {:.0f} cm beside the area", where, 100 * kSideways);
  }
  if (!(tip.z() >= floor)) return fmt::format("{}below the floor of {:.1f} cm", where, 100 * floor);
  if (!(tip.z() <= ceiling)) return fmt::format("{}above the ceiling of {:.1f} cm", where, 100 * ceiling);
  return {};
}

void Watch::begin() {
  joint_stream_.begin();
  endpoint_stream_.begin();
  motion_ = {};
}

double Watch::lateness() const {
  const std::size_t looks = motion_.looks.size();
  const double own = looks < 2 ? 0.0 : motion_.looks[looks - 1] - motion_.looks[looks - 2] - kPeriod;
  return std::max({0.0, own, 2.0 * joint_delay_.excess, 2.0 * endpoint_delay_.excess});
}

void Watch::sent(double time, const Joints& target) {
  motion_.sent.push_back({time, target});
  while (motion_.sent.front().time < time - kTrail) motion_.sent.pop_front();
}

std::optional<Fault> Watch::fit(const Snapshot& seen, bool moving) {
  if (auto fault = known(seen, moving, 0.0)) return fault;
  return feels(seen, 0.0);
}

/// For how long this program did not get to the arm: since the look before, or to receive what came.
double Watch::gap(const Snapshot& seen) const {
  const double looked = motion_.looks.empty() ? 0.0 : seen.now - motion_.looks.back();
  return seen.simulated ? looked : std::max(looked, seen.own_gap);
}

std::optional<Fault> Watch::listen(const Snapshot& seen) {
  hear(seen);
  return too_slow(seen);
}

/// Notes which readings are new.
void Watch::hear(const Snapshot& seen) {
  if (motion_.looks.empty()) motion_.began = seen.now;
  motion_.looks.push_back(seen.now);
  while (motion_.looks.front() < seen.now - Stream::kWindow) motion_.looks.pop_front();
  if (seen.joints) joint_stream_.hear(*seen.joints, seen.now);
  fresh_ = seen.endpoint && endpoint_stream_.hear(*seen.endpoint, seen.now);
}

/// Whoever feels too seldom presses too hard before he notices. A simulated clock runs on while this program is late,
/// which then says nothing about the robot: there the readings are held against the looks.
std::optional<Fault> Watch::too_slow(const Snapshot& seen) const {
  if (seen.now - motion_.began < Stream::kWindow) return std::nullopt;
  const int looks = static_cast<int>(motion_.looks.size());
  const auto in_window = [](int times) {
    return fmt::format("{} times in the last {:.1f} s, {} are needed", times, Stream::kWindow, Stream::kFewest);
  };
  if (looks < Stream::kFewest && !seen.simulated) {
    return Fault{fmt::format("this computer got to the arm {}{}", in_window(looks), kOwnSlowness), Then::hold};
  }
  const int fewest = seen.simulated ? std::min(Stream::kFewest, looks / 2) : Stream::kFewest;
  for (const auto& [name, stream] : {std::pair{"/robot/joint_states of the left arm", &joint_stream_},
                                     std::pair{"endpoint_state of the left arm", &endpoint_stream_}}) {
    if (stream->heard() >= fewest) continue;
    return Fault{
        fmt::format("{} came only {}: see to the network, and to /robot/joint_state_publish_rate, which should be 100",
                    name, in_window(stream->heard())),
        Then::hold};
  }
  return std::nullopt;
}

/// Whatever forbids to command even the measured joints.
std::optional<Fault> Watch::known(const Snapshot& seen, bool moving, double gap) {
  if (!seen.malformed.empty()) return Fault{seen.malformed};
  if (!seen.state || !seen.joints || !seen.endpoint) return Fault{"not all of joints, endpoint and state were heard"};
  if (auto fault = stale("/robot/state", seen.now - seen.state->received, kStateFresh, gap)) return fault;
  if (auto fault = state_forbids(*seen.state, seen.joints, moving)) return fault;
  if (auto fault = many("/robot/state comes", seen.state_senders)) return fault;
  if (auto fault = many("joints of the left arm come", seen.joint_senders)) return fault;
  if (!seen.commanders.empty()) {
    return Fault{fmt::format("the arm is commanded by {}, too: end that first", listed(seen.commanders))};
  }
  if (auto fault = stale("/robot/joint_states of the left arm", seen.now - seen.joints->received, kFresh, gap)) {
    return fault;
  }
  if (seen.joints->position.allFinite()) return std::nullopt;
  return Fault{"/robot/joint_states has a position that is no number: restart the robot"};
}

/// Where the arm is, is known: it may be held there.
std::optional<Fault> Watch::feels(const Snapshot& seen, double gap) {
  const EndpointReading& endpoint = *seen.endpoint;
  if (auto fault = stale("endpoint_state of the left arm", seen.now - endpoint.received, kFresh, gap, Then::hold)) {
    return fault;
  }
  if (!endpoint.force.allFinite() || !endpoint.pose.position.allFinite()) {
    return Fault{"endpoint_state has a force or a place that is no number: restart the robot", Then::hold};
  }
  if (!endpoint.force.isZero(0.0)) return std::nullopt;
  return Fault{"endpoint_state has a force of exactly zero: this robot, a Gazebo simulation perhaps, does not feel",
               Then::hold};
}

/// Of several rules that are broken at once that counts which leaves the least to do: so all that ask for silence are
/// looked at first, and those that allow to retreat last.
std::optional<Fault> Watch::look(const Snapshot& seen, const Eigen::Vector3d& tip) {
  const double own = gap(seen);
  hear(seen);
  if (auto fault = known(seen, true, own)) return fault;
  if (auto fault = joints(seen)) return fault;
  if (auto fault = feels(seen, own)) return fault;
  if (auto fault = endpoint(seen, own)) return fault;
  if (auto fault = too_slow(seen)) return fault;
  if (const int joint = beyond_limits(seen.joints->position, 0.0); joint >= 0) {
    return Fault{fmt::format("{} is at {:.1f} deg, beyond its limit: move the arm by hand",
                             kJointNames[static_cast<std::size_t>(joint)], degrees(seen.joints->position(joint))),
                 Then::hold};
  }
  const std::string breach = workspace_.breach(tip);
  if (!breach.empty()) return Fault{breach + ": see whether place and tool are as the config has them", Then::hold};
  if (auto fault = follows(seen)) return fault;
  if (!motion_.collision_expected && seen.collision && seen.collision->collision) {
    return Fault{
        "the arm's own reflex stopped it, at 16 N or at an impact: take a lower motion.speed or "
        "motion.threshold, or see what the arm met",
        Then::retreat, true, true};
  }
  return force(seen);
}

std::optional<Fault> Watch::joints(const Snapshot& seen) {
  if (auto fault = late("/robot/joint_states", *seen.joints, joint_delay_, Then::silence)) return fault;
  const double jump = motion_.joints ? (seen.joints->position - motion_.joints->position).cwiseAbs().maxCoeff() : 0.0;
  if (jump > kJump) {
    return Fault{fmt::format("/robot/joint_states jumped by {:.1f} deg: no joint turns so fast, restart the robot",
                             degrees(jump))};
  }
  motion_.joints = seen.joints;
  return std::nullopt;
}

std::optional<Fault> Watch::endpoint(const Snapshot& seen, double gap) {
  if (auto fault = late("endpoint_state", *seen.endpoint, endpoint_delay_, Then::hold)) return fault;
  const Eigen::Vector3d& now = seen.endpoint->force;
  if (!motion_.force || now != *motion_.force) {
    motion_.force = now;
    motion_.force_changed = seen.now;
  }
  const double frozen = seen.now - motion_.force_changed;
  if (frozen <= kFrozen) return collision_silent(seen, gap);
  return Fault{
      fmt::format("endpoint_state has had the same force to the last digit for {:.2f} s: its sender is frozen, "
                  "restart the robot",
                  frozen),
      Then::hold};
}

/// A robot that sends it again and again must go on; one that sends it when it changes may be silent.
std::optional<Fault> Watch::collision_silent(const Snapshot& seen, double gap) {
  if (!seen.collision) return std::nullopt;
  const double received = seen.collision->received;
  if (received != collision_received_) {
    collision_streams_ = received - collision_received_ <= kStateFresh;
    collision_received_ = received;
  }
  if (!collision_streams_) return std::nullopt;
  return stale("collision_detection_state of the left arm", seen.now - received, kStateFresh, gap, Then::hold);
}

std::optional<Fault> Watch::force(const Snapshot& seen) {
  if (!fresh_) return std::nullopt;
  const double since = motion_.felt_at ? seen.now - *motion_.felt_at : 0.0;
  motion_.felt_at = seen.now;
  if (!motion_.tare) return std::nullopt;
  const Eigen::Vector3d felt = seen.endpoint->force - *motion_.tare;
  const double change =
      zero_ == Zero::follows ? felt.norm() : std::max(std::abs(felt.z()), felt.head<2>().norm() / kSideways);
  if (zero_ == Zero::follows) *motion_.tare += felt * std::min(1.0, since / kZeroFollows);
  motion_.too_strong = change > force_stop_ ? motion_.too_strong + 1 : 0;
  if (motion_.too_strong < kForceSamples) return std::nullopt;
  return Fault{fmt::format("the force changed by {:.1f} N, more than force_stop allows: take a lower motion.speed or "
                           "motion.threshold, or see what the arm met",
                           change),
               Then::retreat};
}

std::optional<Fault> Watch::follows(const Snapshot& seen) const {
  if (motion_.sent.empty()) return std::nullopt;
  const Joints& now = seen.joints->position;
  const auto from = [&](const Joints& target) { return (now - target).cwiseAbs().maxCoeff(); };
  double nearest = std::numeric_limits<double>::infinity();
  for (const Sent& one : motion_.sent) nearest = std::min(nearest, from(one.target));
  const double behind = from(motion_.sent.back().target);
  if (behind <= kFollowing && nearest <= kOffTheWay) return std::nullopt;
  return Fault{fmt::format("the arm does not follow, a joint is {:.1f} deg from where it was sent: see what blocks it, "
                           "and whether others command it",
                           degrees(behind)),
               Then::hold};
}

}  // namespace palpate::baxter
