// SPDX-License-Identifier: MIT
// Measures the time from a contact to standstill while the arm taps, and derives the largest safe speed of a descent.
//
// The joints hold the tip through springs. An arm that descends with speed v onto a rigid object presses with
//     F = threshold + k * v * T,    T = noticing + stopping + lateness,
// where k is the vertical stiffness of the springs. None of these times is published, and each depends on the robot,
// its firmware and its network:
// - noticing: from the moment when the true force equals the threshold to the set-point that stops the arm. It includes
//   the filter of the force, the delay of messages, and the readings that make a contact. During a contact, the true
//   force is computed from positions, which no filter delays. It is k times the distance by which the tip lags behind
//   its free descent. If the force rises slowly, as on a soft object, noise moves the detection much earlier or later.
//   So contacts are weighted by the slope of their force.
// - stopping: from that set-point to standstill. It includes the delay of commands and joints, and the further motion
//   of the joints. All of these make the arm lag behind its set-point. The bound is therefore the time by which the arm
//   lags, minus the least lag of the joints themselves, plus their further motion.
// - lateness: the additional delay of messages, or of this program, compared with the delay during the measured
//   contacts.
#pragma once

#include <Eigen/Core>

#include <deque>
#include <optional>
#include <vector>

namespace palpate::baxter {

class ReactionTime {
 public:
  /// Time and height of the tip in one period of a descent.
  struct Period {
    double time;    ///< s
    double height;  ///< height of the tip, m
  };

  /// Largest expected force of a contact, N. The firmware stops the arm at 16 N, and noise delays the detection.
  static constexpr double kGreatestForce = 13.5;
  /// m/s: the run is rejected if the arm would have to be slower.
  static constexpr double kSlowest = 0.002;
  /// m/s: limit until the first measured contact. Until then the delays of the slowest supported robot are assumed.
  static constexpr double kSlowestFirst = 0.001;
  static constexpr double kLookedAt = 1.5;      ///< s; only this last part of a descent is used
  static constexpr double kShortestWay = 0.06;  ///< m; shorter motions are ignored
  /// Number of renewals of the force until a contact is detected: the three readings of a contact, and one spoilt by
  /// noise.
  static constexpr double kRenewals = 4.0;
  /// Noticing time (see above) and trailing time (lag of the arm behind its set-point) in s that are assumed until they
  /// are measured. The values belong to the slowest supported robot with a force renewed 100 times a second.
  static constexpr double kFirstNoticing = 0.23;
  static constexpr double kFirstTrailing = 0.55;
  /// Standard deviation of the force at which a contact is detected, N. Noise of 1.5 N causes 0.5 to 0.9 N, and more if
  /// the force rises faster.
  static constexpr double kNoise = 0.7;

  /// Records that messages or this program are `seconds` late at time `now`. lateness() returns the largest value so
  /// far, which decays with the time constant kFades.
  void late(double seconds, double now);

  /// Records the period in seconds in which the robot renews its force. A detection takes at least kRenewals periods.
  void renewed_every(double seconds) { renewal_ = seconds; }

  /// Commanded and measured position of the tip in one period of a free motion from rest to rest, metres.
  struct MotionSample {
    double time;  ///< s
    Eigen::Vector3d commanded;
    Eigen::Vector3d reached;
  };

  /// Learns the trailing time from a motion along a straight line. The area between the commanded and the measured
  /// position as functions of time, divided by the length, is the mean delay. This holds for any linear system and any
  /// velocity profile. Offsets at rest are subtracted. Motions shorter than kShortestWay are ignored.
  void learn_trailing(const std::vector<MotionSample>& motion);

  /// Learns the noticing time from a contact that was detected in the last of `periods`. `began` is the height (m)
  /// where the contact began, if known. `stiffness` is in N/m, `threshold` in N. Descents that are too short are
  /// ignored.
  void learn_noticing(const std::vector<Period>& periods, std::optional<double> began, double threshold,
                      double stiffness);

  /// Returns whether the measured contacts have at least the weight of the initial assumption. One contact with a hard
  /// object is enough, one with a soft object is not.
  bool measured() const;
  /// Returns the lower limit of the speed in m/s. A robot that would have to be slower is rejected.
  double slowest() const { return measured() ? kSlowest : kSlowestFirst; }
  /// Returns an upper bound of the noticing time, seconds: one period plus the largest of
  /// - the mean of the last kContacts contacts and the initial assumption, weighted by inverse variances, plus two
  ///   standard deviations of this mean;
  /// - the largest measured value minus two of its own standard deviations, because a robot may become slower;
  /// - kRenewals renewals of the force.
  double noticing() const;
  double trailing() const;  ///< s by which the arm lags behind its set-point, the maximum of the last kMotions motions
  double stopping() const;  ///< s
  double lateness() const { return late_; }
  /// Returns T = noticing + stopping + lateness, seconds.
  double seconds() const { return noticing() + stopping() + late_; }

  /// Returns the largest speed (m/s) at which a contact with a rigid object stays below kGreatestForce.
  double greatest_speed(double threshold, double stiffness) const;
  /// Returns the expected force (N) of a contact with a rigid object.
  double expected_force(double threshold, double speed, double stiffness) const;

 private:
  /// Delay of the detection of a contact, s, and slope of its force at that moment, N/s.
  struct ContactDetection {
    double seconds;
    double rise;
  };

  double deviation(const ContactDetection& one) const;
  double weight() const;

  std::deque<ContactDetection> noticing_;
  std::deque<double> trailing_;
  double late_ = 0.0;
  double late_at_ = 0.0;
  double renewal_ = 0.01;
};

}  // namespace palpate::baxter
