// SPDX-License-Identifier: MIT
// How an arm taps: the options that a simulated and a real arm share, what follows from them before anything moves, and
// a tap in words, for a person who decides whether it is made.
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

/// Begin the slow descent just above the surface that the models expect, instead of at the height of travel.
struct AdaptiveHover : Options {
  double deviations = 2.0;  ///< standard deviations of the expected height that are kept clear
  double clearance = 0.01;  ///< metres, beside them
  double speed = 0.1;       ///< m/s, from the height of travel down to there
  /// How probable an object must be, or none, to be relied on; without it an object is expected everywhere.
  std::optional<double> certainty;
  void list(Fields& fields) override;
};

/// One tap: travel at `hover` above the desk, tare, come down in a way of its own until the force rises, retreat.
struct MotionOptions : Options {
  enum class Type { paper, two_stage, continuous, per_tap };  ///< `per_tap` is a BackendMotion's alone
  Type type = Type::paper;
  double speed = 0.024;         ///< m/s, of the descent
  double step = 0.03;           ///< m, paper
  double pause = 0.5;           ///< s, paper and two_stage
  double back_off = 0.02;       ///< m, two_stage
  double brake = 0.0;           ///< m, continuous
  bool confirm = false;         ///< continuous; a real arm always does
  double fine_speed = 0.02;     ///< m/s, two_stage
  double fine_threshold = 6.0;  ///< N, two_stage
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

/// The same, or several of them, of which the strategy takes one for each tap.
struct BackendMotion : MotionOptions {
  std::vector<MotionOptions> of;  ///< none, or two and more
  void list(Fields& fields) override;

  int count() const { return of.empty() ? 1 : static_cast<int>(of.size()); }
  /// One of them; the one that a request asks for.
  const MotionOptions& at(int number) const { return of.empty() ? *this : of.at(static_cast<std::size_t>(number)); }
  const MotionOptions& of_request(const TapRequest& request) const { return at(request.motion); }
};

/// What a motion, or the choice between several, depends on of all that the models expect.
Quantities expects(const MotionOptions& motion);
Quantities expects(const BackendMotion& motion);

/// The heights of one descent, metres, in the frame of the scene: floor <= start <= hover.
struct Descent {
  double hover;  ///< where the arm arrives, and to where it retreats
  double start;  ///< where the slow descent begins: `hover`, unless that is adaptive and something is predicted
  double floor;  ///< where it ends without a contact: below the desk, or below an object that is certain to be there
};
Descent plan_descent(const MotionOptions& motion, double desk, const std::optional<Prediction>& predicted);

/// Seconds from one place to the next, at the height of travel, and seconds up again from `height`, both at constant
/// speed.
double travel_seconds(const MotionOptions& motion, const TapRequest& request);
double retreat_seconds(const MotionOptions& motion, const Descent& descent, double height);

/// The force at which an arm with a `force_limit` stops by itself, newtons: what it presses on while it brakes is
/// within the limit.
constexpr double kOwnStop = 0.75;
/// Why a tap has the outcome `aborted`, then.
constexpr const char* kStoppedByItself = "the arm stopped by itself, short of motion.force_limit";

/// How long `continuous` watches the arm once it has stopped it, seconds: what the arm presses on meanwhile tells of
/// the onset, too.
constexpr double kWatched = 0.1;

/// Seconds from arrival to contact with a rigid surface at `surface`, for an arm that follows its set-point at once and
/// feels without noise: what GuardedTap needs then, but for whole periods and those that it takes to be sure.
double ideal_seconds(const MotionOptions& motion, const Descent& descent, double surface);

/// What the strategy chooses from; null where there is but one motion.
std::unique_ptr<Motions> motions(const BackendMotion& motion, double desk);

/// Rounded to a millimetre and to a tenth of a newton: "13.5 cm", "6.0 N".
std::string centimetres(double length);
std::string newtons(double force);
/// "(11.5, 3.0) cm"
std::string place(const Target& target);

/// The way there from `from` (none: it is not known), the descent, and the force that ends it; a line each.
std::vector<std::string> describe(const MotionOptions& motion, double desk, const TapRequest& request,
                                  const std::optional<Target>& from);

}  // namespace palpate::tapping
