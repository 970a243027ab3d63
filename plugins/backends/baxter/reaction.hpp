// SPDX-License-Identifier: MIT
// How long an arm takes from a contact to standstill, measured while it taps; and how fast it may come down, then.
//
// The tip is held by springs. An arm that comes down with speed v onto something rigid presses with
//     F = threshold + k v T,    T = noticing + stopping + lateness,
// k being the vertical stiffness of its springs. None of the times is published, and each depends on the robot, its
// firmware and its network:
// - noticing: from the true force being at the threshold to the set-point that stops the arm. It holds the filter of
//   the force, the delay of its messages and the readings that make a contact. Within a contact the true force follows
//   from positions alone, which no filter delays: k times the distance by which the tip stays behind its free descent.
//   The force is noisy. Where it rises slowly, as on something soft, noise makes a notice much too early or too late.
//   So each contact counts by how steeply its force rose.
// - stopping: from that set-point to standstill. It holds the delay of commands and of joints, and how far the joints
//   go on. All of them make the arm trail its set-point, so it is bounded by the time by which the arm trails, less
//   what is certain to be the lag of its joints.
// - lateness: by how much messages, or this program, may come later than they did then.
#pragma once

#include <Eigen/Core>

#include <deque>
#include <optional>
#include <vector>

namespace palpate::baxter {

class Reaction {
 public:
  /// One period of a descent.
  struct Period {
    double time;    ///< s
    double height;  ///< of the tip, m
  };

  /// N, which a contact is to reach at most: the arm's firmware stops it at 16 N, and noise delays a notice.
  static constexpr double kGreatestForce = 13.5;
  /// m/s: an arm that would have to be slower is rejected.
  static constexpr double kSlowest = 0.002;
  /// m/s: the same until a contact was measured; it is then assumed to be noticed and stopped as late as by the slowest
  /// robot that is driven.
  static constexpr double kSlowestFirst = 0.001;
  static constexpr double kLookedAt = 1.5;      ///< s of a descent
  static constexpr double kShortestWay = 0.06;  ///< m
  /// Renewals of the force that a notice may take: the three readings of a contact, and one that noise spoils.
  static constexpr double kRenewals = 4.0;
  /// s of noticing and trailing until they were measured: those of the slowest robot that is driven and that renews its
  /// force a hundred times a second.
  static constexpr double kFirstNoticing = 0.23;
  static constexpr double kFirstTrailing = 0.55;
  /// N, the standard deviation of the force at which a contact is noticed: noise of 1.5 N makes 0.5 to 0.9, the more
  /// the steeper the force rises.
  static constexpr double kNoise = 0.7;

  /// Takes how late messages or this program are at `now`, seconds; the worst counts, and fades within kFades.
  void late(double seconds, double now);

  /// Takes the period in which the robot renews its force, seconds: no contact is noticed within fewer than kRenewals.
  void renewed_every(double seconds) { renewal_ = seconds; }

  /// One period of a free motion from rest to rest: where the tip was sent and where it was, metres.
  struct Step {
    double time;  ///< s
    Eigen::Vector3d commanded;
    Eigen::Vector3d reached;
  };

  /// Learns from a motion along a straight line: the area between both curves, divided by the way, is the mean delay of
  /// any linear system, whatever the profile of the motion. Offsets at rest do not count. A way below kShortestWay
  /// shows nothing.
  void learn_trailing(const std::vector<Step>& motion);

  /// Learns from a contact that was noticed in the last of `periods` and began at the height `began` (m), if that is
  /// known. `stiffness` in N/m, `threshold` in N. Too short a descent shows nothing.
  void learn_noticing(const std::vector<Period>& periods, std::optional<double> began, double threshold,
                      double stiffness);

  /// Whether contacts have shown as much of how late they are noticed as is assumed before: one with something hard is
  /// enough, one with something soft is not.
  bool measured() const;
  /// m/s, of which an arm that would have to be slower is rejected.
  double slowest() const { return measured() ? kSlowest : kSlowestFirst; }
  /// s, and one period, which a measured time may be too short. The largest of
  /// - the mean of the latest kContacts contacts and of what is assumed before them, each by the inverse of its
  /// variance,
  ///   and two standard deviations of that mean;
  /// - what one contact shows beyond two of its own deviations, since a robot may become later;
  /// - kRenewals renewals.
  double noticing() const;
  double trailing() const;  ///< s, the longest of the latest kMotions motions
  double stopping() const;  ///< s
  double lateness() const { return late_; }
  /// T, seconds.
  double seconds() const { return noticing() + stopping() + late_; }

  /// The greatest speed (m/s) at which a contact with something rigid stays within kGreatestForce.
  double greatest_speed(double threshold, double stiffness) const;
  /// The force (N) that a contact with something rigid is expected to reach.
  double expected_force(double threshold, double speed, double stiffness) const;

 private:
  /// A contact: how late it was noticed, s, and how fast its force rose then, N/s.
  struct Notice {
    double seconds;
    double rise;
  };

  double deviation(const Notice& one) const;
  double weight() const;

  std::deque<Notice> noticing_;
  std::deque<double> trailing_;
  double late_ = 0.0;
  double late_at_ = 0.0;
  double renewal_ = 0.01;
};

}  // namespace palpate::baxter
