// SPDX-License-Identifier: MIT
#include "baxter/watch.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

namespace palpate::baxter {
namespace {

using Then = Fault::Then;
using Button = StateReading::Button;

std::string number(double value, int digits = 1) {
  std::ostringstream out;
  out.precision(digits);
  out << std::fixed << value;
  return out.str();
}

std::string degrees(double radians) { return number(radians * 180.0 / 3.14159265358979323846) + " deg"; }

std::string names(const std::vector<std::string>& all) {
  std::string out;
  for (const std::string& one : all) out += (out.empty() ? "" : " and ") + one;
  return out;
}

constexpr const char* kReset =
    "reset it (rosrun baxter_tools enable_robot.py -r) and enable it (rosrun baxter_tools enable_robot.py -e)";

/// What the robot's state forbids.
std::optional<Fault> state_forbids(const StateReading& state, const std::optional<JointReading>& joints, bool moving) {
  if (state.estop_button == Button::pressed) {
    return Fault{std::string("the emergency stop is pressed: release it, then ") + kReset, Then::silence, true};
  }
  if (state.estop_button == Button::released) {
    return Fault{std::string("the emergency stop was pressed and is released: ") + kReset, Then::silence, true};
  }
  // An error alone stops nothing, by Rethink's own reference: an enabled robot may report one and move.
  if (state.error && !state.enabled) {
    return Fault{std::string("the robot reports an error and is disabled: see its screen, then ") + kReset,
                 Then::silence, true};
  }
  if (state.stopped && state.estop_button == Button::unknown) {
    return Fault{
        std::string("a program stopped the robot (/robot/set_super_stop), a safety node perhaps: see why, then ") +
            kReset,
        Then::silence, true};
  }
  if (state.stopped) return Fault{std::string("the robot is stopped: ") + kReset, Then::silence, true};
  if (!moving) return std::nullopt;
  if (!state.enabled && joints && joints->position(1) < -1.6) {
    return Fault{"the robot is disabled and its arm is tucked (left_s1 at " + degrees(joints->position(1)) +
                     "): untuck it, which enables it",
                 Then::silence, true};
  }
  if (!state.enabled) {
    return Fault{
        "the robot is disabled: enable it (rosrun baxter_tools enable_robot.py -e), palpate never does that itself",
        Then::silence, true};
  }
  if (!state.ready) return Fault{"the robot is not ready: wait until it has started", Then::silence, true};
  return std::nullopt;
}

constexpr const char* kOwnSlowness =
    ": end what else keeps this computer busy, and let palpate have real-time scheduling (see its baxter.txt)";

/// `gap`: how long ago the driver itself looked last. What is old only by that is nobody else's fault.
std::optional<Fault> stale(const char* stream, double age, double most, double gap) {
  if (age <= most) return std::nullopt;
  if (gap > most && age <= gap + most) {
    return Fault{"this computer did not get to the arm for " + number(gap, 2) + " s" + kOwnSlowness, Then::silence,
                 true};
  }
  return Fault{std::string(stream) + " did not come for " + number(age, 2) +
                   " s: see to the network and to the robot's processes",
               Then::silence, true};
}

std::optional<Fault> late(const char* stream, const Arrival& arrival, Watch::Delay& best) {
  const double delay = arrival.received - arrival.stamp;
  if (!std::isfinite(delay)) return Fault{std::string(stream) + " has a stamp that is no number", Then::silence, true};
  // Two clocks that nobody sets drift apart, by more than kLate within hours.
  best.least = std::min(delay, best.least + Watch::kDrift * std::max(0.0, arrival.received - best.at));
  best.at = arrival.received;
  if (delay - best.least <= Watch::kLate) return std::nullopt;
  return Fault{std::string(stream) + " comes with stamps " + number(delay - best.least, 2) +
                   " s older than before: its data are stale, see to the network and to the robot's processes",
               Then::silence, true};
}

}  // namespace

std::string Workspace::breach(const Eigen::Vector3d& tip) const {
  const auto beyond = [](double value, double least, double most) { return !(value >= least && value <= most); };
  const std::string where = "the tip is at (" + number(100 * tip.x()) + ", " + number(100 * tip.y()) + ", " +
                            number(100 * tip.z()) + ") cm of the scene, ";
  if (beyond(tip.x(), -kSideways, width + kSideways) || beyond(tip.y(), -kSideways, depth + kSideways)) {
    return where + "more than " + number(100 * kSideways, 0) + " cm beside the area";
  }
  if (!(tip.z() >= floor)) return where + "below the floor of " + number(100 * floor) + " cm";
  if (!(tip.z() <= ceiling)) return where + "above the ceiling of " + number(100 * ceiling) + " cm";
  return {};
}

Watch::Watch(const Workspace& workspace, double force_stop) : workspace_(workspace), force_stop_(force_stop) {}

void Watch::begin() {
  sent_.clear();
  joint_stream_.begin();
  endpoint_stream_.begin();
  looks_.clear();
  joints_.reset();
  too_strong_ = 0;
  last_force_.reset();
  felt_at_.reset();
  collision_expected_ = false;
  tare_.reset();
}

void Watch::sent(double time, const Joints& target) {
  sent_.push_back({time, target});
  while (sent_.front().time < time - kTrail) sent_.pop_front();
}

std::optional<Joints> Watch::last_sent() const {
  return sent_.empty() ? std::nullopt : std::optional<Joints>(sent_.back().target);
}

std::optional<Fault> Watch::fit(const Snapshot& seen, bool moving) {
  if (auto fault = known(seen, moving, 0.0)) return fault;
  return feels(seen, 0.0);
}

/// For how long this program did not get to the arm: since the look before, or to receive what came.
double Watch::gap(const Snapshot& seen) const {
  const double looked = looks_.empty() ? 0.0 : seen.now - looks_.back();
  return seen.simulated ? looked : std::max(looked, seen.own_gap);
}

std::optional<Fault> Watch::listen(const Snapshot& seen) {
  hear(seen);
  return too_slow(seen);
}

/// Notes which readings are new.
void Watch::hear(const Snapshot& seen) {
  if (looks_.empty()) began_ = seen.now;
  looks_.push_back(seen.now);
  while (looks_.front() < seen.now - Stream::kWindow) looks_.pop_front();
  if (seen.joints) joint_stream_.hear(*seen.joints, seen.now);
  fresh_ = seen.endpoint && endpoint_stream_.hear(*seen.endpoint, seen.now);
}

/// Whoever feels too seldom presses too hard before he notices. A simulated clock runs on while this program is late,
/// which then says nothing about the robot: there the readings are held against the looks.
std::optional<Fault> Watch::too_slow(const Snapshot& seen) const {
  if (seen.now - began_ < Stream::kWindow) return std::nullopt;
  const int looks = static_cast<int>(looks_.size());
  const auto in_window = [](int times) {
    return std::to_string(times) + " times in the last " + number(Stream::kWindow) + " s, " +
           std::to_string(Stream::kFewest) + " are needed";
  };
  if (looks < Stream::kFewest && !seen.simulated) {
    return Fault{"this computer got to the arm " + in_window(looks) + kOwnSlowness, Then::hold, true};
  }
  const int fewest = seen.simulated ? std::min(Stream::kFewest, looks / 2) : Stream::kFewest;
  for (const auto& [name, stream] : {std::pair{"/robot/joint_states of the left arm", &joint_stream_},
                                     std::pair{"endpoint_state of the left arm", &endpoint_stream_}}) {
    if (stream->heard() >= fewest) continue;
    return Fault{std::string(name) + " came only " + in_window(stream->heard()) +
                     ": see to the network, and to /robot/joint_state_publish_rate, which should be 100",
                 Then::hold, true};
  }
  return std::nullopt;
}

/// Whatever forbids to command even the measured joints.
std::optional<Fault> Watch::known(const Snapshot& seen, bool moving, double gap) {
  if (!seen.malformed.empty()) return Fault{seen.malformed, Then::silence, true};
  if (!seen.state || !seen.joints || !seen.endpoint) {
    return Fault{"not all of joints, endpoint and state were heard", Then::silence, true};
  }
  if (auto fault = stale("/robot/state", seen.now - seen.state->received, kStateFresh, gap)) return fault;
  if (auto fault = state_forbids(*seen.state, seen.joints, moving)) return fault;
  if (seen.state_senders.size() > 1) {
    return Fault{"/robot/state comes from more than one node, " + names(seen.state_senders) +
                     ": one of them is no robot, end it",
                 Then::silence, true};
  }
  if (seen.joint_senders.size() > 1) {
    return Fault{"joints of the left arm come from more than one node, " + names(seen.joint_senders) +
                     ": one of them is no robot, end it",
                 Then::silence, true};
  }
  if (!seen.commanders.empty()) {
    return Fault{"the arm is commanded by " + names(seen.commanders) + ", too: end that first", Then::silence, true};
  }
  if (auto fault = stale("/robot/joint_states of the left arm", seen.now - seen.joints->received, kFresh, gap)) {
    return fault;
  }
  if (!seen.joints->position.allFinite()) {
    return Fault{"/robot/joint_states has a position that is no number: restart the robot", Then::silence, true};
  }
  return std::nullopt;
}

/// Where the arm is, is known: it may be held there.
std::optional<Fault> Watch::feels(const Snapshot& seen, double gap) {
  if (auto fault = stale("endpoint_state of the left arm", seen.now - seen.endpoint->received, kFresh, gap)) {
    fault->then = Then::hold;
    return fault;
  }
  if (!seen.endpoint->force.allFinite() || !seen.endpoint->pose.position.allFinite()) {
    return Fault{"endpoint_state has a force or a place that is no number: restart the robot", Then::hold, true};
  }
  if (seen.endpoint->force.isZero(0.0)) {
    return Fault{"endpoint_state has a force of exactly zero: this robot, a Gazebo simulation perhaps, does not feel",
                 Then::hold, true};
  }
  return std::nullopt;
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
    return Fault{std::string(kJointNames[static_cast<std::size_t>(joint)]) + " is at " +
                     degrees(seen.joints->position(joint)) + ", beyond its limit: move the arm by hand",
                 Then::hold, true};
  }
  const std::string breach = workspace_.breach(tip);
  if (!breach.empty())
    return Fault{breach + ": see whether place and tool are as the config has them", Then::hold, true};
  if (auto fault = follows(seen)) return fault;
  if (!collision_expected_ && seen.collision && seen.collision->collision) {
    return Fault{
        "the arm's own reflex stopped it, at 16 N or at an impact: take a lower motion.speed or "
        "motion.threshold, or see what the arm met",
        Then::retreat, true, true};
  }
  return force(seen);
}

std::optional<Fault> Watch::joints(const Snapshot& seen) {
  if (auto fault = late("/robot/joint_states", *seen.joints, joint_delay_)) return fault;
  if (joints_) {
    const double jump = (seen.joints->position - joints_->position).cwiseAbs().maxCoeff();
    if (jump > kJump) {
      return Fault{"/robot/joint_states jumped by " + degrees(jump) + ": no joint turns so fast, restart the robot",
                   Then::silence, true};
    }
  }
  joints_ = seen.joints;
  return std::nullopt;
}

std::optional<Fault> Watch::endpoint(const Snapshot& seen, double gap) {
  if (auto fault = late("endpoint_state", *seen.endpoint, endpoint_delay_)) {
    fault->then = Then::hold;
    return fault;
  }
  const Eigen::Vector3d& now = seen.endpoint->force;
  if (!last_force_ || now != *last_force_) {
    last_force_ = now;
    force_changed_ = seen.now;
  }
  if (seen.now - force_changed_ > kFrozen) {
    return Fault{"endpoint_state has had the same force to the last digit for " + number(seen.now - force_changed_, 2) +
                     " s: its sender is frozen, restart the robot",
                 Then::hold, true};
  }
  return collision_silent(seen, gap);
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
  auto fault = stale("collision_detection_state of the left arm", seen.now - received, kStateFresh, gap);
  if (fault) fault->then = Then::hold;
  return fault;
}

std::optional<Fault> Watch::force(const Snapshot& seen) {
  if (!fresh_) return std::nullopt;
  const double since = felt_at_ ? seen.now - *felt_at_ : 0.0;
  felt_at_ = seen.now;
  if (!tare_) return std::nullopt;
  const Eigen::Vector3d felt = seen.endpoint->force - *tare_;
  const double change =
      zero_ == Zero::follows ? felt.norm() : std::max(std::abs(felt.z()), felt.head<2>().norm() / kSideways);
  if (zero_ == Zero::follows) *tare_ += felt * std::min(1.0, since / kZeroFollows);
  too_strong_ = change > force_stop_ ? too_strong_ + 1 : 0;
  if (too_strong_ < kForceSamples) return std::nullopt;
  return Fault{"the force changed by " + number(change) +
                   " N, more than force_stop allows: take a lower motion.speed "
                   "or motion.threshold, or see what the arm met",
               Then::retreat, true};
}

std::optional<Fault> Watch::follows(const Snapshot& seen) const {
  if (sent_.empty()) return std::nullopt;
  const Joints& now = seen.joints->position;
  const auto from = [&](const Joints& target) { return (now - target).cwiseAbs().maxCoeff(); };
  double nearest = std::numeric_limits<double>::infinity();
  for (const Sent& one : sent_) nearest = std::min(nearest, from(one.target));
  const double behind = from(sent_.back().target);
  if (behind <= kFollowing && nearest <= kOffTheWay) return std::nullopt;
  return Fault{"the arm does not follow, a joint is " + degrees(behind) +
                   " from where it was sent: see what blocks it, and whether others command it",
               Then::hold, true};
}

}  // namespace palpate::baxter
