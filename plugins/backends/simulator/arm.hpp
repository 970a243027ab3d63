// SPDX-License-Identifier: MIT
// The simulated arm: dynamics of an axis, geometry of the tool, and the measured force.
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

/// Standard normal numbers from a random stream, by the method of Box and Muller. The method makes pairs of numbers.
/// The second number of a pair is stored for the next call.
class GaussianNumbers {
 public:
  explicit GaussianNumbers(Random random) : random_(random) {}

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

/// One axis that follows a set-point. It is a second-order system that is integrated exactly, because the set-point is
/// constant in each period. Without `lag`, the axis reaches each set-point at once.
class SimulatedAxis {
 public:
  /// The axis starts at rest at `position` (metres). `period` is in seconds.
  SimulatedAxis(const std::optional<JointLag>& lag, double period, double position);

  /// Simulates one period with this set-point (metres).
  void follow(double set_point);

  double position() const { return position_; }

 private:
  bool lags_;
  double position_;
  double velocity_ = 0.0;
  /// Coefficients of one period. The vector (deviation from the set-point, velocity) becomes `from_deviation_` *
  /// deviation + `from_velocity_` * velocity.
  double from_deviation_[2]{}, from_velocity_[2]{};
};

/// Returns the height in metres of the tool's lowest point at its first contact during a vertical descent at (x, y).
/// For a point tool, this is the height of the scene at (x, y). The contact is higher if the side of a round tip or the
/// shaft touches a taller part nearby. The function searches for the maximum over the disc of the tool, first on rings
/// and then around the best point. The result is accurate to 0.1 um where the scene is smooth or has one edge. Details
/// smaller than an eighth of the radius may be missed.
double contact_height(const Scene& scene, const Effects& effects, double x, double y);

/// Returns the distance in metres along `line` at which the tool first touches an object or the desk. Returns infinity
/// if it touches nothing. The shaft is on the line, behind the tip.
double contact_along(const Scene& scene, const Effects& effects, const Line& line);

/// Returns the same distance as contact_along(), but for the desk without objects.
double desk_along(const Scene& scene, const Effects& effects, const Line& line);

/// Returns the height in metres of a foreign object at (x, y). At most positions it is 0. The height depends only on
/// the seed and the position.
double foreign_object_height(const ForeignObjects& effect, std::uint64_t seed, double x, double y);

/// Model of the contact and of the force sensor in one tap. The contact is a spring at `surface`. The sensor has noise,
/// drift, latency, missed contacts and false contacts.
class ContactModel {
 public:
  /// `surface` is the height in metres at which the tool touches. `desk` is true if the tool touches the desk and no
  /// object. `hover` is the start of the descent. `random` is the source of all draws.
  ContactModel(const Effects& effects, double surface, bool desk, double hover, double threshold, Random random);

  /// Returns the measured height (metres) and force (newtons). `position` is the position in metres at which the joints
  /// would put the tip without a contact.
  tapping::Sample measure(double position);

  /// Return the present and the largest true force, newtons. They also include contacts that the sensor misses.
  double force() const { return force_; }
  double peak() const { return peak_; }

 private:
  double delayed(double force);

  double surface_;
  double hover_;
  double stiffness_;    ///< N/m; stiffness of object and arm in series
  double give_ = 0.0;   ///< m/N; compliance of the touched object
  double noise_ = 0.0;  ///< newtons; standard deviation of the noise
  double drift_ = 0.0;  ///< N/m; drift of the force along the path, drawn per tap
  bool blind_ = false;
  /// Height of a false contact. If there is none, it is below any height that the arm reaches.
  double jerk_at_ = -std::numeric_limits<double>::infinity();
  double jerk_;        ///< newtons; force of a false contact
  int jerk_left_ = 5;  ///< remaining periods of a false contact: 50 ms in total
  double force_ = 0.0;
  double peak_ = 0.0;
  double late_ = 0.0;           ///< latency of the force, in periods
  std::vector<double> forces_;  ///< true forces of all periods; used only if there is a latency
  GaussianNumbers normal_;
};

}  // namespace palpate::backends
