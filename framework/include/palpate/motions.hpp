// SPDX-License-Identifier: MIT
// The motions that a backend can choose for a tap, with their durations and accuracies. Motions are separate from the
// backend, so a run can be replayed or explained without a robot.
#pragma once

#include <palpate/backend.hpp>

namespace palpate {

/// A backend with a choice of motions has a function in its class,
///
///     static std::unique_ptr<Motions> motions(const Options& options, const Scene& scene);
///
/// which returns null if the options allow only one motion. Otherwise the framework chooses the motion of each tap
/// (TapRequest::motion), with the most information per second. Law: all methods are pure functions of their arguments.
class Motions {
 public:
  virtual ~Motions() = default;

  /// Returns the number of motions, at least 2. Their indices start at 0.
  virtual int count() const = 0;

  /// Returns the robot time, seconds, of a requested tap whose contact is at the height `surface`, metres in the frame
  /// of the scene. Called for every candidate before every tap, so it should take microseconds.
  virtual double seconds(const TapRequest& request, double surface) const = 0;

  /// Returns the expected standard deviation, metres, of a height that is measured with a motion. Taps on the desk
  /// correct this value during the run.
  virtual double deviation(int motion) const = 0;
};

}  // namespace palpate
