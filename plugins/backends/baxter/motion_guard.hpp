// SPDX-License-Identifier: MIT
// Safety rules of the arm's motion, checked in every period. The first broken rule stops the arm.
#pragma once

#include "baxter/kinematics.hpp"
#include "baxter/options.hpp"
#include "baxter/robot.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>
#include <string>

namespace palpate::baxter {

/// A broken safety rule: its reason, the action that is still allowed, and whether the run must end.
struct Fault {
  /// Allowed actions after a fault, from least to most motion.
  enum class AllowedAction {
    silence,  ///< send nothing: the arm holds by itself, or another program commands it
    hold,     ///< send the measured joints for a moment, then nothing
    retreat,  ///< hold; when the arm rests and all other rules hold, go straight up
  };
  std::string reason;  ///< cause and remedy, one line
  AllowedAction then = AllowedAction::silence;
  bool ends_run = true;
  bool reflex = false;  ///< whether the firmware's own reflex stopped the arm; the reflex ends by itself
};

/// Allowed space of the tip, in the scene's frame, metres.
struct Workspace {
  double width, depth;  ///< size of the area; the tip may leave it sideways by kSideways
  double floor, ceiling;
  static constexpr double kSideways = 0.1;
  /// Returns an error text if `tip` is outside the space, else an empty string.
  std::string breach(const Eigen::Vector3d& tip) const;
};

/// Counts the new readings of one stream within the last half second. The robot sends 100 per second and the driver
/// reads as often. If either is late, the driver may see a reading twice, which counts once. The force has its own
/// counter, see Renewals.
class ReadingCounter {
 public:
  static constexpr double kWindow = 0.5;  ///< s
  /// Minimum number of readings in a window: 50 Hz. Three readings confirm a contact, in 60 ms at 50 Hz. The arm moves
  /// 1.2 mm in this time at 2 cm/s.
  static constexpr int kFewest = 25;

  /// Takes the latest reading at time `now` (s). Returns whether its stamp differs from that of the previous one.
  bool take(const MessageArrival& arrival, double now) {
    while (!readings_.empty() && readings_.front().time < now - kWindow - kSlack) readings_.pop_front();
    if (stamp_ == arrival.stamp) return false;
    stamp_ = arrival.stamp;
    readings_.push_back({now, arrival.count});
    return true;
  }

  /// Returns the number of new readings within the last kWindow seconds. If MessageArrival::count is set, messages that
  /// were replaced between two reads are included.
  int count() const {
    if (readings_.empty()) return 0;
    const long counted = readings_.back().count - readings_.front().count + 1;
    return static_cast<int>(std::max(counted, static_cast<long>(readings_.size())));
  }

  /// Restarts the count. A repetition of the last reading is still not new.
  void begin() { readings_.clear(); }

  /// Tolerance of the window in s, so that rounding does not change the count of a stream with exactly the least rate.
  static constexpr double kSlack = 1e-6;

 private:
  struct Reading {
    double time;
    long count;
  };
  std::optional<double> stamp_;
  std::deque<Reading> readings_;
};

/// Counts the renewals of the force within the last half second. A robot may send the same estimate in several messages
/// of endpoint_state.
class Renewals {
 public:
  /// Minimum number of renewals in ReadingCounter::kWindow: 8 Hz. Three readings confirm a contact, in 0.4 s at 8 Hz.
  static constexpr int kFewest = 4;

  /// Takes the latest reading at time `now` (s). Returns whether its force is new.
  bool take(const EndpointReading& endpoint, double now);

  /// Returns the number of renewals within the last ReadingCounter::kWindow seconds.
  int count() const;
  /// Returns the required number of renewals in ReadingCounter::kWindow: half of the largest number so far, limited to
  /// the range from kFewest to ReadingCounter::kFewest.
  int needed() const { return std::clamp(most_ / 2, kFewest, ReadingCounter::kFewest); }
  /// Returns whether the period at which the robot renews the force is known; measuring it takes three renewals.
  bool known() const { return known_; }
  double messages() const { return messages_; }  ///< messages per renewal, measured
  double seconds() const { return seconds_; }    ///< seconds per renewal, measured
  /// Returns the number of messages since the last renewal. equal_for() returns the seconds since then.
  long equal(const EndpointReading& endpoint) const { return last_.count == 0 ? 0 : endpoint.count - last_.count; }
  double equal_for(double now) const { return now - last_.time; }

 private:
  struct Renewal {
    double time;  ///< s
    long count;   ///< count of the message
    long renewals;
  };
  std::deque<Renewal> readings_;
  Renewal last_{0.0, 0, -1};  ///< last renewal
  int most_ = 0;
  bool known_ = false;
  double messages_ = 1.0;
  double seconds_ = 0.01;
};

/// Checks all safety rules. Limits come from published properties of the robot. Its firmware stops the arm at 16 N and
/// drops commands after 0.2 s, and the arm lags behind its set-point by 0.3 to 0.4 s. Other limits are several times
/// the values of a sound robot.
class MotionGuard {
 public:
  static constexpr double kFresh = 0.1;       ///< s, largest age of joints and endpoint, which arrive every 0.01 s
  static constexpr double kStateFresh = 0.5;  ///< s, largest age of /robot/state
  static constexpr double kLate = 0.3;        ///< s by which the delay of a message may exceed the least delay so far
  static constexpr double kDrift = 1e-3;  ///< s per second, largest drift between the robot's clock and this computer's
  static constexpr int kFrozen = 10;      ///< a force that is equal for this number of renewal periods is a fault
  /// from this number of periods on, an equal force is a fault if it lasts kFrozenFor
  static constexpr int kFewestFrozen = 4;
  static constexpr double kFrozenFor = 0.1;  ///< s
  /// rad, largest change between two readings; 4 rad/s of the wrist are 0.04 rad per period
  static constexpr double kJump = 0.06;
  static constexpr double kFollowing = 0.2;  ///< rad, largest distance from the last set-point
  /// rad, largest distance from the nearest set-point of the last kTrail seconds
  static constexpr double kOffTheWay = 0.06;
  static constexpr double kTrail = 0.8;         ///< s
  static constexpr double kZeroFollows = 0.5;   ///< s, time constant of a zero that follows the force
  static constexpr double kRiseFollows = 0.25;  ///< s, time constant of that zero while the arm rises
  static constexpr double kMostDrift = 50.0;    ///< N/m, largest change of the zero during a rise
  /// Factor of the limit for sideways forces during vertical motion. The robot's estimate of these forces is worst:
  /// friction of 0.4 Nm causes 12 N.
  static constexpr double kSideways = 1.5;
  /// number of new readings above force_stop that are a fault; one or two may be noise
  static constexpr int kForceSamples = 3;

  /// Least delay between stamp and reception so far, seconds, and the time of its last update.
  struct Delay {
    double least = std::numeric_limits<double>::infinity();
    double at = 0.0;
    double excess = 0.0;  ///< s, delay of the latest message minus `least`
  };

  MotionGuard(const Workspace& workspace, double force_stop) : workspace_(workspace), force_stop_(force_stop) {}

  /// Resets commands and forces before a motion that follows a pause without set-points.
  void begin();
  /// Kind of the reference of force_stop. With `stays`, the reference is constant, as in a tap. With `follows`, it
  /// follows the force, because the bias changes with the pose. Only changes within kZeroFollows seconds then stop the
  /// arm.
  enum class ZeroMode { stays, follows };
  /// Sets the force (N) that is the reference of force_stop. Before the first call no force stops the arm.
  void set_tare(const Eigen::Vector3d& force, ZeroMode zero = ZeroMode::stays) {
    motion_.tare = force;
    zero_ = zero;
  }
  /// Disables force_stop. Pulls are still detected.
  void forget_tare() { motion_.tare.reset(); }
  /// Limits of the pull while the arm rises: nothing presses against a rising arm, so a pull means that something
  /// holds the tool. `zero`: force along z without contact, N. `sign`: sign of the force when an object presses the
  /// tool upwards. `limit`: pull in N that stops the arm.
  /// During a rise, friction of 0.4 Nm appears as a pull of up to 13 N. So once the arm rises freely, the zero is
  /// measured again and `follows` the force. The change of the zero is limited to kMostDrift * (height of the rise),
  /// the largest effect of a changing pose. A larger change is the force of a spring.
  struct RiseLimits {
    double zero;
    double sign;
    double limit;
    ZeroMode follows = ZeroMode::stays;
  };
  /// Sets the limits until begin() or the next call; nullopt: the arm does not rise.
  void expect_rise(const std::optional<RiseLimits>& rise) {
    motion_.rise = rise;
    motion_.anchor.reset();
    motion_.pulled = 0;
  }
  /// Sets whether a collision that the firmware detects is expected; then it is not a fault.
  void expect_collision(bool expected) { motion_.collision_expected = expected; }

  /// Returns the fault of the first broken rule, else nullopt. `tip`: position of the tip in the scene's frame, from
  /// the joints in `seen`.
  std::optional<Fault> check(const Snapshot& seen, const Eigen::Vector3d& tip);
  /// Performs only the part of check() that does not depend on the arm's motion: marks new readings and checks their
  /// rates. The rates are known half a second after begin().
  std::optional<Fault> check_rates(const Snapshot& seen);
  /// Returns an upper bound in s of the present lateness of set-points and readings together. It is the maximum of
  /// twice the excess delay of the latest joints or force, and the delay of this program's last read.
  double lateness() const;
  /// Returns whether the last read brought a new force, not a known message or a repeated estimate.
  bool fresh() const { return fresh_; }
  /// Returns the measured renewals of the force.
  const Renewals& renewals() const { return renewals_; }
  /// Records a set-point, so that check() can check whether the arm follows.
  void record_command(double time, const Joints& target);
  /// Returns the last set-point; nullopt if none was sent since begin().
  std::optional<Joints> last_sent() const {
    return motion_.sent.empty() ? std::nullopt : std::optional<Joints>(motion_.sent.back().target);
  }

  /// Checks the rules that also hold without motion: state of the robot, senders, age and validity of the data. With
  /// `moving`, the robot must be enabled and the settings of other programs must allow motion.
  static std::optional<Fault> check_readiness(const Snapshot& seen, bool moving);

 private:
  static std::optional<Fault> check_state(const Snapshot& seen, bool moving, double gap);
  static std::optional<Fault> check_force_data(const Snapshot& seen, double gap);
  static std::optional<Fault> check_settings(const Snapshot& seen);
  double own_gap(const Snapshot& seen) const;
  void mark_new_readings(const Snapshot& seen);
  std::optional<Fault> rate_fault(const Snapshot& seen) const;
  std::optional<Fault> check_joints(const Snapshot& seen);
  std::optional<Fault> check_endpoint(const Snapshot& seen, double gap);
  std::optional<Fault> check_frozen(const EndpointReading& endpoint, double now) const;
  std::optional<Fault> check_collision_stream(const Snapshot& seen, double gap);
  std::optional<Fault> check_following(const Snapshot& seen) const;
  std::string explain_lag(const Joints& now, double time) const;
  std::optional<Fault> reflex_fault(const Snapshot& seen, const Eigen::Vector3d& tip) const;
  std::optional<Fault> check_pull(const Snapshot& seen, const Eigen::Vector3d& tip, double since);
  std::optional<Fault> check_force(const Snapshot& seen, const Eigen::Vector3d& tip);

  struct SentCommand {
    double time;
    Joints target;
    Joints arm;  ///< measured joints at that time
  };
  /// State that begin() resets.
  struct StateSinceBegin {
    std::deque<SentCommand> sent;
    std::deque<double> looks;            ///< times of reads within ReadingCounter::kWindow
    double began = 0.0;                  ///< time of the first read
    std::optional<JointReading> joints;  ///< previous reading
    std::optional<double> felt_at;       ///< time of the last read with a new force
    std::optional<Eigen::Vector3d> tare;
    int too_strong = 0;
    std::optional<RiseLimits> rise;
    /// Zero (N) and height (m) at the time when the zero began to follow the force.
    struct ZeroReference {
      double zero, height;
    };
    std::optional<ZeroReference> anchor;
    int pulled = 0;  ///< number of consecutive readings with a pull above the limit
    bool collision_expected = false;
  };

  Workspace workspace_;
  double force_stop_;
  StateSinceBegin motion_;
  ZeroMode zero_ = ZeroMode::stays;
  ReadingCounter joint_stream_;
  ReadingCounter endpoint_stream_;
  Renewals renewals_;
  bool fresh_ = false;
  double collision_received_ = -std::numeric_limits<double>::infinity();  ///< time of the latest message
  bool collision_streams_ = false;  ///< whether the last two messages arrived within kStateFresh
  Delay joint_delay_;
  Delay endpoint_delay_;
};

}  // namespace palpate::baxter
