// SPDX-License-Identifier: MIT
// The simulated arm: dynamics of an axis, geometry of the tool, and measured force.
#pragma once

#include "tapping/guarded_tap.hpp"

#include <palpate/effects.hpp>
#include <palpate/math.hpp>
#include <palpate/random.hpp>
#include <palpate/scene.hpp>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace palpate::backends {

/// Standard normal numbers from a stream, by Box and Muller's method. Numbers are made in pairs; the second is kept for
/// the next call.
class Normal {
 public:
  explicit Normal(Random random) : random_(random) {}

  double operator()() {
    if (spare_) return *std::exchange(spare_, std::nullopt);
    const double radius = std::sqrt(-2.0 * math::log(1.0 - random_.uniform()));
    const double angle = 2.0 * 3.14159265358979323846 * random_.uniform();
    spare_ = radius * math::sin(angle);
    return radius * math::cos(angle);
  }

  /// Returns the underlying stream, for draws from other distributions.
  Random& uniform() { return random_; }

 private:
  Random random_;
  std::optional<double> spare_;
};

/// One axis that follows a set-point: a second-order system, integrated exactly for a set-point that is constant in
/// each period. Without `lag` the axis reaches each set-point at once.
class Arm {
 public:
  /// Starts at rest at `position` (m). `period` is in seconds.
  Arm(const std::optional<JointLag>& lag, double period, double position);

  /// Simulates one period with this set-point (m).
  void follow(double set_point);

  double position() const { return position_; }

 private:
  bool lags_;
  double position_;
  double velocity_ = 0.0;
  /// Transition of deviation from the set-point and velocity over one period.
  double from_deviation_[2]{}, from_velocity_[2]{};
};

/// Returns the height in metres of the tool's lowest point at its first contact during a vertical descent at (x, y).
/// For a point tool it is the height of the scene. It is higher where the side of a round tip or the shaft touches a
/// taller part nearby. The maximum over the tool's disc is searched on rings and then around the best point. Its
/// accuracy is 0.1 um where the scene is smooth or has one edge; details below an eighth of the radius may be missed.
double contact_height(const Scene& scene, const Effects& effects, double x, double y);

/// Returns the distance in metres along `line` at which the tool first touches an object or the desk, or infinity. The
/// shaft lies on the line behind the tip.
double contact_along(const Scene& scene, const Effects& effects, const Line& line);

/// As contact_along(), over the bare desk.
double desk_along(const Scene& scene, const Effects& effects, const Line& line);

/// Returns the height in metres of a foreign object at (x, y), nearly everywhere 0. The value depends only on seed and
/// position.
double foreign_object_height(const ForeignObjects& effect, std::uint64_t seed, double x, double y);

/// Model of contact and force sensor in one tap: a spring at `surface`, and a sensor with noise, drift, latency, missed
/// and false contacts.
class ContactModel {
 public:
  /// `surface`: height in metres at which the tool touches; `desk`: whether the bare desk is touched; `hover`: start of
  /// the descent. `random` is the source of all draws.
  ContactModel(const Effects& effects, double surface, bool desk, double hover, double threshold, Random random);

  /// Returns the measured height (m) and force (N) if the joints would put the tip at `position` (m).
  tapping::Sample measure(double position);

  /// Return the present and the largest true force, N, even of a contact that the sensor misses.
  double force() const { return force_; }
  double peak() const { return peak_; }

 private:
  double delayed(double force);

  double surface_;
  double hover_;
  double stiffness_;    ///< N/m, object and arm in series
  double give_ = 0.0;   ///< m/N, compliance of the touched object
  double noise_ = 0.0;  ///< N, standard deviation
  double drift_ = 0.0;  ///< N/m, drawn per tap
  bool blind_ = false;
  /// Height of a false contact; without one below any floor
  double jerk_at_ = -std::numeric_limits<double>::infinity();
  double jerk_;        ///< N, force of a false contact
  int jerk_left_ = 5;  ///< remaining periods of a false contact: 50 ms in total
  double force_ = 0.0;
  double peak_ = 0.0;
  double late_ = 0.0;           ///< latency of the force in periods
  std::vector<double> forces_;  ///< forces of all periods, if there is a latency
  Normal normal_;
};

}  // namespace palpate::backends
