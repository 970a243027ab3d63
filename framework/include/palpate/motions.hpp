// SPDX-License-Identifier: MIT
// Motions of a backend's taps, with their durations and accuracies, without the backend itself. So a replayed or
// explained run has the same motions without a robot.
#pragma once

#include <palpate/backend.hpp>

namespace palpate {

/// A backend with a choice of motions has a function in its class,
///
///     static std::unique_ptr<Motions> motions(const Options& options, const Scene& scene);
///
/// which returns null if the options allow only one motion. Otherwise the strategy chooses a motion for each tap, in
/// TapRequest::motion, by information and time. Law: all are pure functions of their arguments.
class Motions {
 public:
  virtual ~Motions() = default;

  /// Returns the number of motions, at least 2. Their indices start at 0.
  virtual int count() const = 0;

  /// Returns the robot time, seconds, of a requested tap whose contact is at the height `surface`, metres in the frame
  /// of the scene. Called for every candidate before every tap, so it should take microseconds.
  virtual double seconds(const TapRequest& request, double surface) const = 0;

  /// Returns the prior standard deviation, metres, of a height by a motion. Taps on the desk correct it.
  virtual double deviation(int motion) const = 0;
};

}  // namespace palpate
