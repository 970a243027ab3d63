// SPDX-License-Identifier: MIT
// Motion of a tap: options that simulated and real arms share, planned heights and durations, and descriptions for a
// person who must approve a tap.
#pragma once

#include <palpate/backend.hpp>
#include <palpate/motions.hpp>
#include <palpate/options.hpp>
#include <palpate/scene.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate::tapping {

/// Fast descent to just above the predicted surface; the slow descent begins there instead of at the height of travel.
struct AdaptiveHover : Options {
  double deviations = 2.0;  ///< clearance in standard deviations of the predicted height
  double clearance = 0.01;  ///< additional clearance, metres
  double speed = 0.1;       ///< m/s, speed of the fast descent
  /// Minimum probability of an object, or of the bare desk, at which the descent relies on the prediction. If absent,
  /// an object is expected everywhere.
  std::optional<double> certainty;
  void list(Fields& fields) override;
};

/// One tap: travel at `hover` above the desk, tare, descend until the force rises, retreat.
struct MotionOptions : Options {
  enum class Type { paper, two_stage, continuous, per_tap };  ///< `per_tap` only in BackendMotion
  Type type = Type::paper;
  double speed = 0.024;         ///< m/s, descent
  double step = 0.03;           ///< m, only for `paper`
  double pause = 0.5;           ///< s, only for `paper` and `two_stage`
  double back_off = 0.02;       ///< m, only for `two_stage`
  double brake = 0.0;           ///< m, only for `continuous`
  bool confirm = false;         ///< only for `continuous`; real arms always confirm
  double fine_speed = 0.02;     ///< m/s, only for `two_stage`
  double fine_threshold = 6.0;  ///< N, only for `two_stage`
  double threshold = 10.0;      ///< N
  double hover = 0.135;         ///< m above the desk
  std::optional<AdaptiveHover> adaptive_hover;
  double travel_speed = 0.3;          ///< m/s
  double retreat_speed = 0.3;         ///< m/s
  double tare = 0.2;                  ///< s
  double overrun = 0.03;              ///< m below the desk
  double timeout = 60.0;              ///< s
  std::optional<double> force_limit;  ///< N
  void list(Fields& fields) override;

 protected:
  void list_types(Fields& fields, const std::vector<Case>& more);
  void list_rest(Fields& fields);
};

/// Motion of a backend: one motion, or a list from which the strategy chooses for each tap.
struct BackendMotion : MotionOptions {
  std::vector<MotionOptions> of;  ///< empty, or at least two
  void list(Fields& fields) override;

  int count() const { return of.empty() ? 1 : static_cast<int>(of.size()); }
  /// Return the motion with this index, and the motion of a request.
  const MotionOptions& at(int number) const { return of.empty() ? *this : of.at(static_cast<std::size_t>(number)); }
  const MotionOptions& of_request(const TapRequest& request) const { return at(request.motion); }
};

/// Return the predictions that a motion, or the choice between motions, uses.
QuantitySet predicts(const MotionOptions& motion);
QuantitySet predicts(const BackendMotion& motion);

/// Heights of one descent in the scene's frame, metres: floor <= start <= hover.
struct Descent {
  double hover;  ///< start of the descent and end of the retreat
  double start;  ///< start of the slow descent: `hover`, or lower with adaptive hover and a prediction
  double floor;  ///< end without contact: below the desk, or below an object that is certain
};
Descent plan_descent(const MotionOptions& motion, double desk, const std::optional<Prediction>& predicted);

/// Return the seconds of the travel between two positions, and of the retreat from `height` (m), both at constant
/// speed.
double travel_seconds(const MotionOptions& motion, const TapRequest& request);
double retreat_seconds(const MotionOptions& motion, const Descent& descent, double height);

/// Fraction of `force_limit` at which the arm stops by itself, so that the further rise of the force stays within the
/// limit.
constexpr double kOwnStop = 0.75;
/// Reason of the outcome `aborted` after such a stop.
constexpr const char* kStoppedByItself = "the arm stopped by itself, short of motion.force_limit";

/// Time in s for which `continuous` measures the force after the stop. These samples improve the onset.
constexpr double kWatched = 0.1;

/// Returns the seconds from arrival to contact with a rigid surface at height `surface` (m). The arm follows its
/// set-point without lag, and the force has no noise. The duration of a GuardedTap is the same, except for rounding to
/// periods and for the readings that a detection needs.
double ideal_seconds(const MotionOptions& motion, const Descent& descent, double surface);

/// Returns the motions from which the strategy chooses; null if there is only one.
std::unique_ptr<Motions> motions(const BackendMotion& motion, double desk);

/// Format a length to 0.1 cm and a force to 0.1 N: "13.5 cm", "6.0 N".
std::string centimetres(double length);
std::string newtons(double force);
/// Formats a position: "(11.5, 3.0) cm".
std::string place(const Target& target);

/// Describes travel from `from` (nullopt: unknown), descent, and the force that ends it, one line each.
std::vector<std::string> describe(const MotionOptions& motion, double desk, const TapRequest& request,
                                  const std::optional<Target>& from);

}  // namespace palpate::tapping
