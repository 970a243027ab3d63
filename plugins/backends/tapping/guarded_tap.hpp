// SPDX-License-Identifier: MIT
// The guarded tap. In each period of the control loop, it computes the next set-point from the measured height and
// force. It computes the onset of a contact from the samples before and after the detection. The simulator and the
// robots use the same class.
#pragma once

#include "tapping/free_force.hpp"
#include "tapping/height_result.hpp"
#include "tapping/motion.hpp"

#include <optional>
#include <vector>

namespace palpate::tapping {

/// Returns the height at which the force begins to rise. The result is the kink of the hinge function `force = zero +
/// slope * max(0, kink - height)` that fits `samples` best by least squares. Zero, slope and kink are free. The height
/// at which the force crosses a threshold would be lower: by threshold / stiffness, and by the motion during the
/// detection. The kink has neither of these errors, and the fit averages the noise.
/// Returns nullopt with fewer than four samples or three different heights, or if no kink gives a force that rises with
/// the depth. If all kinks of an interval fit equally (a rigid surface between two samples), the lowest is returned.
std::optional<double> onset(const std::vector<Sample>& samples);

/// Returns the onset of the contact at the end of `descent`, whose samples are in order of time. Only the last part of
/// the descent is used, because the zero of the force may drift. This part contains the whole rise, which is long on
/// soft objects, and some free travel above it.
std::optional<double> onset_of_descent(const std::vector<Sample>& descent);

/// Returns the slope of the force below `kink`, N/m, for the hinge function with this kink that fits `samples` best.
/// Returns 0 without samples below the kink.
double slope_below(const std::vector<Sample>& samples, double kink);

/// Reason of the outcome `timeout`.
constexpr const char* kTooLong = "the tap took longer than motion.timeout";

/// One descent, from the arrival at the height of travel until the result is known. The caller commands the travel
/// before the descent and the retreat after it.
///
/// In each period the caller passes the measured height and force, and whether the force is new. The caller then
/// commands the returned set-point. A contact is detected after three consecutive new readings above the threshold. The
/// reaction depends on the motion:
/// - paper: the set-point of a simulated arm stays until the end of the pause; that of a real arm jumps to the arm's
///   position. The height is measured while the arm still presses. So the height is too low by the distance by which
///   the contact yields.
/// - two_stage: the set-point jumps to the arm's position. The arm backs off until the tip is free, waits and tares. A
///   slow descent with a lower threshold follows; its contact is the result. If there is no second contact within twice
///   the distance of the retreat, the first contact was false, and the descent continues.
/// - continuous: the set-point jumps to the arm's position, and the measured height is the onset.
/// A contact of a real arm is accepted if its force lasts, rises by at least kSoftestRise, and began to rise at most
/// kFarthestOnset above the detection. Otherwise the descent continues. If only the duration was too short, a second
/// contact within kSamePlace of the first is accepted.
class GuardedTap {
 public:
  /// Period of the control loop in s: Baxter's joint states arrive at 100 Hz.
  static constexpr double kPeriod = 0.01;

  /// Kind of arm. The simulated arm with `paper` keeps its set-point at a contact and presses further, as in Sun and
  /// Min 2021. A real arm stops by itself at 16 N, and the zero of its force drifts. At each contact of a real arm, the
  /// set-point jumps to the arm's position. Every pause of `paper` repeats the tare, unless a contact may begin.
  /// Because of friction, the force of a resting real arm depends on the direction of its last motion, so every tare
  /// follows a descent.
  enum class ArmKind { simulated, real };

  /// Descent in metres after which the friction of a resting arm equals the friction of a descending arm: joints
  /// deflect less than a milliradian before they slip.
  static constexpr double kFromAbove = 0.01;

  /// Limits of a real arm's contact: its onset is at most kFarthestOnset (m) above the detection, and its force rises
  /// by at least kSoftestRise (N/m). A slower rise is attributed to a zero that changes with the pose.
  static constexpr double kFarthestOnset = 0.03;
  static constexpr double kSoftestRise = 200.0;
  /// Stiffness in N/m of the softest supported contact; the force of free travel excludes samples that may belong to
  /// its rise.
  static constexpr double kSoftest = 600.0;
  /// For a real arm: minimum number of new readings in the mean of a tare, and in the mean after a contact. A robot may
  /// update its force only 8 times per second.
  static constexpr int kFewestTared = 10;
  static constexpr int kFewestWatched = 3;
  /// The tap ends after this number of contacts within kFarthestOnset whose force lasts but rises by less than
  /// kSoftestRise. The object is then too soft.
  static constexpr int kMostSoft = 2;
  /// If two contacts whose force does not last differ by less than this height (metres), they count as one contact with
  /// a soft object.
  static constexpr double kSamePlace = 0.002;

  GuardedTap(const MotionOptions& motion, const Descent& descent, ArmKind arm = ArmKind::simulated);

  /// Takes the measured height of the tip (m) and the raw force against it (N), and returns the next set-point (m). A
  /// force that is not `fresh` is ignored, but the time passes.
  double next(double height, double force, bool fresh = true);

  /// Limits the speed of the descent from now on, m/s, and extends the timeout accordingly.
  void slow_to(double speed);

  /// Handles a stop of the arm by its own force limit: the set-point jumps up from `height` (m). If the measured force
  /// also shows the contact, perhaps later, the result is a normal contact. Otherwise the tap is aborted.
  void give_up(double height);

  bool done() const { return stage_ == Stage::done; }
  /// Returns whether the next force belongs to a tare: the first tare, or the second tare of two_stage.
  bool taring() const { return stage_ == Stage::tare || stage_ == Stage::settle; }
  /// Returns whether a contact was detected and the arm is stopping.
  bool stopping() const { return stage_ == Stage::stop; }
  /// Returns whether a contact was detected and the arm stops, rests or backs off.
  bool presses_no_further() const {
    return stage_ == Stage::stop || stage_ == Stage::rest || stage_ == Stage::back_off;
  }
  /// Returns the number of detected contacts, accepted or not.
  int noticed() const { return noticed_; }
  /// Returns whether the arm descends or stops at a contact. The force then includes the effects of motion.
  bool coming_down() const;
  /// Returns the reference of the force, newtons: the mean of the tare, or the force of free travel once it is known.
  double zero() const { return zero_; }
  /// Returns for how many seconds the set-point has descended at constant speed in this stage.
  double even_for() const;
  /// Returns the result of a finished tap, without its duration: `contact` with the largest force above the tare,
  /// `no_contact` at the floor, `timeout` or `aborted`.
  const tapping::HeightResult& result() const { return result_; }
  /// Returns the seconds since the start of the descent.
  double seconds() const { return static_cast<double>(periods_) * kPeriod; }

 private:
  enum class Stage { tare, approach, clear, descend, pause, rest, back_off, unwind, settle, fine, stop, bottom, done };

  void evaluate(double height, double force);
  bool react(double height);
  void advance(double height);
  void finish_tare();
  void tare_in_pause();
  void conclude_at_rest(double height);
  void enter(Stage stage);
  void start_reaction(double height);
  void conclude_at_onset();
  struct Rise {
    double height;  ///< m, onset
    bool is_contact;
    double slope;  ///< N/m below the onset
  };
  Rise rise() const;
  void conclude(const Rise& found);
  bool too_soft();
  bool ramp(double goal, double speed);
  bool arrived(double height);
  bool waited(double seconds) const;
  /// Returns whether the mean of a stage has enough readings.
  bool averaged(int fewest) const { return arm_ == ArmKind::simulated || summed_ >= fewest; }
  void finish(const tapping::HeightResult& result);
  double threshold() const { return stage_ == Stage::fine ? motion_.fine_threshold : motion_.threshold; }

  MotionOptions motion_;
  Descent descent_;
  ArmKind arm_;
  Stage stage_ = Stage::tare;
  long periods_ = 0;
  long entered_ = 0;  ///< period in which the stage began
  double set_point_;
  double goal_ = 0.0;  ///< m, end of the stage's ramp
  double zero_ = 0.0;  ///< force without a contact, N
  FreeForce free_;     ///< force of free travel, of a real arm
  double sum_ = 0.0;   ///< N, sum of the forces for a mean
  int summed_ = 0;     ///< number of forces in sum_
  double peak_ = 0.0;
  double first_ = 0.0;             ///< m, height at the last detection
  std::optional<double> refused_;  ///< `first_` of the last rejected contact
  double soft_ = 0.0;              ///< `first_` of the first contact that was too soft
  int softs_ = 0;                  ///< number of contacts that were too soft
  double gap_ = 0.0;               ///< m, least distance between arm and set-point in this stage
  long nearer_ = 0;                ///< period of the last decrease of gap_
  bool given_up_ = false;
  int noticed_ = 0;
  int above_ = 0;              ///< consecutive readings above the threshold
  std::vector<Sample> trace_;  ///< samples of the descent, for the onset
  tapping::HeightResult result_;
};

}  // namespace palpate::tapping
