// SPDX-License-Identifier: MIT
// The motions that a backend can tap with, without the backend: what each takes and how well it tells a height. A run
// that is replayed or explained asks the same and gets the same, and no robot is there.
#pragma once

#include <palpate/backend.hpp>

namespace palpate {

/// A backend whose taps may be made in several ways says so by a function of its class,
///
///     static std::unique_ptr<Motions> motions(const Options& options, const Scene& scene);
///
/// null where the options leave but one. Then the strategy chooses for each tap, in TapRequest::motion, and weighs what
/// it would tell against the time that it would take. Law: pure functions of their arguments.
class Motions {
 public:
  virtual ~Motions() = default;

  /// At least 2; they are numbered from 0.
  virtual int count() const = 0;

  /// Robot time, seconds, of the tap as requested, by its motion, if it meets something at `surface`, metres in the
  /// frame of the scene. Asked for every candidate before every tap: it should take no more than microseconds.
  virtual double seconds(const TapRequest& request, double surface) const = 0;

  /// Standard deviation, metres, of the height of one tap by a motion. A first idea: taps on the desk correct it.
  virtual double deviation(int motion) const = 0;
};

}  // namespace palpate
