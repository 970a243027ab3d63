// SPDX-License-Identifier: MIT
// The simulated arm: how it follows its set-point, the shape of its tool, and what it feels.
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

/// Standard normal numbers from a stream, by Box and Muller's method: in pairs, of which the second waits.
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

  /// The stream itself, for what is not normal.
  Random& uniform() { return random_; }

 private:
  Random random_;
  std::optional<double> spare_;
};

/// One axis that follows a set-point: a second-order system, exact for a set-point that is constant over each period.
/// Without lag it is where it is told to be.
class Arm {
 public:
  /// At rest at `position` (m); `period` in seconds.
  Arm(const std::optional<JointLag>& lag, double period, double position);

  /// One period with this set-point.
  void follow(double set_point);

  double position() const { return position_; }

 private:
  bool lags_;
  double position_;
  double velocity_ = 0.0;
  /// Deviation from the set-point and velocity after one period, from those before it.
  double from_deviation_[2]{}, from_velocity_[2]{};
};

/// Height of the tool's lowest point when it first meets something on its way straight down at (x, y), metres: that of
/// the scene for a point; higher where the side of a round tip, or the shaft above it, meets a taller place nearby.
/// The largest value over the tool's disc is searched on rings and then around the best point, to 0.1 um where the
/// scene is smooth or has one edge there; details smaller than an eighth of the radius may be missed.
double contact_height(const Scene& scene, const Effects& effects, double x, double y);

/// The same of a tool that comes along a line, its shaft straight behind it: how far along its foremost point is when
/// any of it first meets an object or the desk, metres; infinity if nothing does.
double contact_along(const Scene& scene, const Effects& effects, const Line& line);

/// The same over the bare desk.
double desk_along(const Scene& scene, const Effects& effects, const Line& line);

/// What lies at (x, y) beside the scene, metres of height: 0 nearly everywhere. A function of seed and place alone.
double outlier(const ForeignObjects& effect, std::uint64_t seed, double x, double y);

/// What the arm meets and feels during one tap: a spring at `surface`, a sensor with noise, drift, blindness and jerks.
class Touch {
 public:
  /// `surface`: height at which the tool meets something, metres, and whether that is the bare desk; `hover`: where the
  /// arm comes from. All that is drawn comes from `random`.
  Touch(const Effects& effects, double surface, bool desk, double hover, double threshold, Random random);

  /// Takes the place at which the joints would have the tip (m), and tells where it is then and the force (N).
  tapping::Sample feel(double position);

  /// The force of the contact now and the largest so far, N, whether it was felt or not.
  double force() const { return force_; }
  double peak() const { return peak_; }

 private:
  double heard(double force);

  double surface_;
  double hover_;
  double stiffness_;    ///< of object and arm in series, N/m
  double give_ = 0.0;   ///< of what is touched, m/N
  double noise_ = 0.0;  ///< N
  double drift_ = 0.0;  ///< N/m, of this tap
  bool blind_ = false;
  double jerk_at_ = -std::numeric_limits<double>::infinity();  ///< height, below any floor if there is none
  double jerk_;                                                ///< N
  int jerk_left_ = 5;                                          ///< periods: 50 ms
  double force_ = 0.0;
  double peak_ = 0.0;
  double late_ = 0.0;           ///< periods by which the force is heard late
  std::vector<double> forces_;  ///< of all periods so far, where it is
  Normal normal_;
};

}  // namespace palpate::backends
