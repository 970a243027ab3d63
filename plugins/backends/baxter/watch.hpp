// SPDX-License-Identifier: MIT
// The rules under which the arm may move, looked at in every period. The first that is broken stops it.
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

/// A rule that was broken: why, what may still be done, and whether the run may go on.
struct Fault {
  /// What is left to do, from least to most.
  enum class Then {
    silence,  ///< send nothing more: the arm holds where it is by itself, or is not ours to move
    hold,     ///< send the measured joints for a moment, then nothing
    retreat,  ///< hold, and when the arm stands still and all other rules hold, go straight up
  };
  std::string reason;  ///< cause and remedy, one line
  Then then = Then::silence;
  bool ends_run = true;
  bool reflex = false;  ///< it was the arm's own, which ends by itself
};

/// The space in which the tip may be, in the frame of the scene, metres.
struct Workspace {
  double width, depth;  ///< the area; the tip may leave it sideways by kSideways
  double floor, ceiling;
  static constexpr double kSideways = 0.1;
  /// What is wrong with the place of a tip; empty if nothing is.
  std::string breach(const Eigen::Vector3d& tip) const;
};

/// How often something new comes: the new readings of one stream within the last half second. The robot sends a hundred
/// times a second and the driver looks as often; but either may be late, and then the latest reading is one that was
/// looked at before. What counts readings must count new ones; of the force see Renewals.
class Stream {
 public:
  static constexpr double kWindow = 0.5;  ///< s
  /// The fewest in a window: 50 Hz. Three readings, which make a contact, then take 60 ms; at 2 cm/s that is 1.2 mm.
  static constexpr int kFewest = 25;

  /// Takes what is the latest at `now` (s); whether it is new, that is, has another stamp than the one before.
  bool hear(const Arrival& arrival, double now) {
    while (!heard_.empty() && heard_.front().time < now - kWindow - kSlack) heard_.pop_front();
    if (stamp_ == arrival.stamp) return false;
    stamp_ = arrival.stamp;
    heard_.push_back({now, arrival.count});
    return true;
  }

  /// How many were new within the last kWindow seconds, with those that came and went between two looks, where the
  /// arrivals are counted.
  int heard() const {
    if (heard_.empty()) return 0;
    const long counted = heard_.back().count - heard_.front().count + 1;
    return static_cast<int>(std::max(counted, static_cast<long>(heard_.size())));
  }

  /// Counts anew. What was heard last is still not new.
  void begin() { heard_.clear(); }

  /// s: a stream of exactly the fewest has as many in every window, whatever the sums of its times round to.
  static constexpr double kSlack = 1e-6;

 private:
  struct Heard {
    double time;
    long count;
  };
  std::optional<double> stamp_;
  std::deque<Heard> heard_;
};

/// How often the robot renews its force: it may send one estimate again and again. The renewals within the last half
/// second of a stream of EndpointReadings.
class Renewals {
 public:
  /// The fewest in Stream::kWindow: three readings, which make a contact, then take 0.4 s.
  static constexpr int kFewest = 4;

  /// Takes the latest reading at `now` (s); returns whether its force is new.
  bool hear(const EndpointReading& endpoint, double now);

  /// Returns the number of renewals within the last Stream::kWindow seconds.
  int heard() const;
  /// Returns how many are needed in Stream::kWindow: half of the most that there were, at least kFewest, at most
  /// Stream::kFewest.
  int needed() const { return std::clamp(most_ / 2, kFewest, Stream::kFewest); }
  /// Returns whether the period is known, which takes three renewals.
  bool known() const { return known_; }
  double messages() const { return messages_; }  ///< per renewal, as measured
  double seconds() const { return seconds_; }    ///< per renewal, as measured
  /// Returns the number of messages since the latest renewal that was seen, and their time in seconds.
  long equal(const EndpointReading& endpoint) const {
    return heard_at_.count == 0 ? 0 : endpoint.count - heard_at_.count;
  }
  double equal_for(double now) const { return now - heard_at_.time; }

 private:
  struct Renewal {
    double time;  ///< s
    long count;   ///< of the message
    long renewals;
  };
  std::deque<Renewal> heard_;
  Renewal heard_at_{0.0, 0, -1};  ///< the latest
  int most_ = 0;
  bool known_ = false;
  double messages_ = 1.0;
  double seconds_ = 0.01;
};

/// Sources of the numbers: the robot's own limits and times where they are known (its firmware stops at 16 N, forgets
/// commands after 0.2 s, trails its set-point by 0.3 to 0.4 s), else several times what a sound robot shows.
class Watch {
 public:
  static constexpr double kFresh = 0.1;         ///< s, greatest age of joints and endpoint, sent every 0.01 s
  static constexpr double kStateFresh = 0.5;    ///< s, greatest age of /robot/state
  static constexpr double kLate = 0.3;          ///< s by which a stamp may lie farther back than the best so far
  static constexpr double kDrift = 1e-3;        ///< s per second by which the robot's clock and ours may drift apart
  static constexpr int kFrozen = 10;            ///< times in which the robot renews its force, with the same force; or
  static constexpr int kFewestFrozen = 4;       ///< such times, if they have taken kFrozenFor
  static constexpr double kFrozenFor = 0.1;     ///< s
  static constexpr double kJump = 0.06;         ///< rad between two readings; 4 rad/s of the wrist are 0.04 in a period
  static constexpr double kFollowing = 0.2;     ///< rad from the set-point
  static constexpr double kOffTheWay = 0.06;    ///< rad from every set-point of the last kTrail seconds
  static constexpr double kTrail = 0.8;         ///< s
  static constexpr double kZeroFollows = 0.5;   ///< s
  static constexpr double kRiseFollows = 0.25;  ///< s, of an arm that goes up
  static constexpr double kMostDrift = 50.0;    ///< N/m by which the zero may change on the way up
  /// How much more force counts the same sideways, where the robot's estimate is at its worst, while the arm goes up or
  /// down: friction of 0.4 Nm makes 12 N of it.
  static constexpr double kSideways = 1.5;
  static constexpr int kForceSamples = 3;  ///< new ones, above force_stop: one or two may be noise

  /// The least that receipt has come after the stamp, seconds, and when it was last looked at.
  struct Delay {
    double least = std::numeric_limits<double>::infinity();
    double at = 0.0;
    double excess = 0.0;  ///< by which the latest came later than that
  };

  Watch(const Workspace& workspace, double force_stop) : workspace_(workspace), force_stop_(force_stop) {}

  /// Forgets what was commanded and felt: before a motion, after a pause in which nothing was sent.
  void begin();
  /// Whether the force from which force_stop counts stays, as in a tap, or goes after what is felt as the pose of the
  /// arm, and with it the bias of the force, changes: then only what rises within kZeroFollows stops.
  enum class Zero { stays, follows };
  /// The force (N) from which force_stop counts; until it is set no force stops.
  void set_tare(const Eigen::Vector3d& force, Zero zero = Zero::stays) {
    motion_.tare = force;
    zero_ = zero;
  }
  /// No force stops from now on, but one that pulls.
  void forget_tare() { motion_.tare.reset(); }
  /// While the arm goes up nothing presses against it, and what pulls holds the tool: `zero` (N) of the force along z,
  /// the sign of it when something presses the tool upwards, and the pull (N) from which it stops the arm. The joints
  /// rub the other way than when the zero was felt, which reads as a pull of up to 13 N at 0.4 Nm; so where the arm has
  /// begun to go up freely the zero is felt anew, and `follows` as in Zero, but by no more than a pose can change it:
  /// kMostDrift times the way up, which is less than what is allowed on the way down: the limit has room for the rest.
  /// A force that changes faster is that of a spring.
  struct Rise {
    double zero;
    double sign;
    double limit;
    Zero follows = Zero::stays;
  };
  /// From now on until begin() or the next call; nullopt: the arm does not go up.
  void expect_rise(const std::optional<Rise>& rise) {
    motion_.rise = rise;
    motion_.anchor.reset();
    motion_.pulled = 0;
  }
  /// Whether a collision felt by the robot's firmware is a fault; not while one waits for its end.
  void expect_collision(bool expected) { motion_.collision_expected = expected; }

  /// Looks at what was read; `tip` is where the joints in it have the tip, in the frame of the scene.
  std::optional<Fault> look(const Snapshot& seen, const Eigen::Vector3d& tip);
  /// The part of look() that needs no arm of ours: which readings are new, and whether they come often enough, which is
  /// known half a second after begin().
  std::optional<Fault> listen(const Snapshot& seen);
  /// By how much set-points and readings together may be late now, seconds: twice the time by which the latest joints
  /// or force came later after their stamps than the earliest did, or the time by which this program looked too late.
  double lateness() const;
  /// Whether the force that was looked at last was a new reading: neither that of the look before nor that one sent
  /// again.
  bool fresh() const { return fresh_; }
  /// How often the robot renews its force.
  const Renewals& renewals() const { return renewals_; }
  /// Tells what is sent, so that look() can judge whether the arm follows.
  void sent(double time, const Joints& target);
  /// The last of what was sent; none since begin().
  std::optional<Joints> last_sent() const {
    return motion_.sent.empty() ? std::nullopt : std::optional<Joints>(motion_.sent.back().target);
  }

  /// The rules of the robot's state, of who sends it, of the age and soundness of the data, and, where it is `moving`,
  /// of being enabled and of what other programs have set: what must hold even while nothing moves.
  static std::optional<Fault> fit(const Snapshot& seen, bool moving);

 private:
  static std::optional<Fault> known(const Snapshot& seen, bool moving, double gap);
  static std::optional<Fault> feels(const Snapshot& seen, double gap);
  static std::optional<Fault> settings(const Snapshot& seen);
  double gap(const Snapshot& seen) const;
  void hear(const Snapshot& seen);
  std::optional<Fault> too_slow(const Snapshot& seen) const;
  std::optional<Fault> joints(const Snapshot& seen);
  std::optional<Fault> endpoint(const Snapshot& seen, double gap);
  std::optional<Fault> frozen(const EndpointReading& endpoint, double now) const;
  std::optional<Fault> collision_silent(const Snapshot& seen, double gap);
  std::optional<Fault> follows(const Snapshot& seen) const;
  std::string why_behind(const Joints& now, double time) const;
  std::optional<Fault> reflex(const Snapshot& seen, const Eigen::Vector3d& tip) const;
  std::optional<Fault> pull(const Snapshot& seen, const Eigen::Vector3d& tip, double since);
  std::optional<Fault> force(const Snapshot& seen, const Eigen::Vector3d& tip);

  struct Sent {
    double time;
    Joints target;
    Joints arm;  ///< where it was seen then
  };
  /// What begin() forgets.
  struct Motion {
    std::deque<Sent> sent;
    std::deque<double> looks;            ///< within Stream::kWindow
    double began = 0.0;                  ///< the first look
    std::optional<JointReading> joints;  ///< the reading before
    std::optional<double> felt_at;       ///< when the latest reading of the force was looked at
    std::optional<Eigen::Vector3d> tare;
    int too_strong = 0;
    std::optional<Rise> rise;
    /// Where a zero began to follow: N and m.
    struct Anchor {
      double zero, height;
    };
    std::optional<Anchor> anchor;
    int pulled = 0;  ///< readings, one after the other
    bool collision_expected = false;
  };

  Workspace workspace_;
  double force_stop_;
  Motion motion_;
  Zero zero_ = Zero::stays;
  Stream joint_stream_;
  Stream endpoint_stream_;
  Renewals renewals_;
  bool fresh_ = false;
  double collision_received_ = -std::numeric_limits<double>::infinity();  ///< the latest
  bool collision_streams_ = false;                                        ///< it came twice within kStateFresh
  Delay joint_delay_;
  Delay endpoint_delay_;
};

}  // namespace palpate::baxter
