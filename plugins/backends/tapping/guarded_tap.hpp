// SPDX-License-Identifier: MIT
// The guarded tap: from what the arm feels to where it goes next, a period at a time, and where a contact began, found
// from what was felt before and after it was noticed. It owns no arm: a simulator and a robot run the same one.
#pragma once

#include "tapping/free_force.hpp"
#include "tapping/motion.hpp"

#include <optional>
#include <vector>

namespace palpate::tapping {

/// The height at which the force begins to rise: the kink of the hinge force = zero + slope * max(0, kink - height)
/// that is nearest to `samples` in the sense of least squares, zero and slope being free. The height at which a
/// threshold is crossed lies lower by threshold / stiffness, and by what the arm moves while one makes sure; the kink
/// does not, and the noise of a single sample is averaged out.
/// None when there are fewer than four samples or no slope makes the force rise with the depth. Where every kink within
/// an interval fits as well (a rigid surface, met between two samples), the lowest.
std::optional<double> onset(const std::vector<Sample>& samples);

/// The onset of the contact with which `descent` ends, its samples in the order of time. Only its last part is looked
/// at, since the zero of the force may wander on the way: as much as shows the whole rise, which is long on a soft
/// object, with air above it.
std::optional<double> onset_of_descent(const std::vector<Sample>& descent);

/// Returns how steeply the force rises below a kink, N/m: the slope of the hinge that fits `samples` best; 0 where no
/// sample lies below it.
double slope_below(const std::vector<Sample>& samples, double kink);

/// Why a tap has the outcome `timeout`.
constexpr const char* kTooLong = "the tap took longer than motion.timeout";

/// One descent, from arrival at the height of travel to the end of contact; travel and retreat are the caller's.
///
/// Every period the caller tells the measured height and force, and whether that force is a new reading; it commands
/// the set-point that it gets. A contact is declared when three readings, one after the other, were above the
/// threshold: one reading is one, for however many periods it is the latest. What then follows is the motion's:
/// - paper: the set-point stays (a real arm's does not), the pause passes, and the height is read while the arm still
///   presses: too low by what the contact gives way under the set-point's lead.
/// - two_stage: the set-point is put where the arm is, backs off until the tip is clear, rests and tares, and comes
/// down
///   slowly to a gentler threshold; the height is that of the second contact. No second contact within twice the way
///   back means that the first was none, and the descent goes on.
/// - continuous: the set-point is put where the arm is, and the height is that of the onset.
/// A real arm's contact is believed if the force lasts and rises as on an object: within kFarthestOnset and by at least
/// kSoftestRise. If not, the descent goes on; a second one within kSamePlace of the first is believed.
class GuardedTap {
 public:
  /// Of the control loop: Baxter's joint states come at 100 Hz.
  static constexpr double kPeriod = 0.01;

  /// Whose arm it is. The simulated one of `paper` presses on at a contact, as the paper's did: its set-point stays
  /// ahead. A real one stops at 16 N and its zero wanders: at every contact the set-point is put where the arm is, and
  /// every pause of `paper` tares anew, unless what it feels there may be a contact that begins. Its joints rub, so
  /// that its force at rest depends on the way it came: wherever it tares it has come from above, as it goes on.
  enum class Arm { simulated, real };

  /// The way down, metres, after which an arm rests as one that comes down does: its joints give way by less than a
  /// milliradian until they slip.
  static constexpr double kFromAbove = 0.01;

  /// A real arm's contact begins at most so far above the place where it was noticed, metres, and its force rises by at
  /// least so much, N/m: what rises more slowly is a zero that changes with the pose.
  static constexpr double kFarthestOnset = 0.03;
  static constexpr double kSoftestRise = 200.0;
  /// N/m of the softest contact, whose beginning is kept out of the force of free travel.
  static constexpr double kSoftest = 600.0;
  /// New readings that a real arm's mean takes at least, of a tare and after a contact; a robot may renew its force as
  /// seldom as 8 times a second.
  static constexpr int kFewestTared = 10;
  static constexpr int kFewestWatched = 3;
  /// So many contacts within kFarthestOnset whose force lasts and rises by less than kSoftestRise are one with
  /// something too soft, which ends the tap.
  static constexpr int kMostSoft = 2;
  /// Two contacts within so much, metres, that do not last are one with something soft.
  static constexpr double kSamePlace = 0.002;

  GuardedTap(const MotionOptions& motion, const Descent& descent, Arm arm = Arm::simulated);

  /// Takes the measured height of the tip (m) and the raw force against it (N), and returns the next set-point (m). A
  /// force that is not `fresh` was told before: time goes on, but it counts for nothing.
  double next(double height, double force, bool fresh = true);

  /// Comes down no faster than this from now on, m/s, and has as much more time.
  void slow_to(double speed);

  /// The arm has stopped by itself, at a force that it has felt: what it presses on with is let go. Where that force is
  /// seen here, too, if late, it was a contact like any other; else the tap comes to nothing.
  void give_up(double height);

  bool done() const { return stage_ == Stage::done; }
  /// Whether the force of the next period belongs to a tare, the first or that of two_stage.
  bool taring() const { return stage_ == Stage::tare || stage_ == Stage::settle; }
  /// Whether a contact was noticed and the arm is being stopped.
  bool stopping() const { return stage_ == Stage::stop; }
  /// Whether a contact was noticed and the arm presses no further: it is being stopped, rests, or backs off.
  bool presses_no_further() const {
    return stage_ == Stage::stop || stage_ == Stage::rest || stage_ == Stage::back_off;
  }
  /// How many contacts were noticed so far, believed or not.
  int noticed() const { return noticed_; }
  /// Whether the arm comes down, or is being stopped at a contact: its force then is that of an arm that moves.
  bool coming_down() const;
  /// The force that a reading is compared with, newtons: that of the tare, or of free travel as far as it is known.
  double zero() const { return zero_; }
  /// For how long the set-point has been coming down evenly in this stage, seconds.
  double even_for() const;
  /// When done, what came of it, but for the time: `contact`, with the largest force above the tare, `no_contact` (the
  /// floor was reached) or `timeout`.
  const Contact& result() const { return result_; }
  /// Since arrival.
  double seconds() const { return static_cast<double>(periods_) * kPeriod; }

 private:
  enum class Stage { tare, approach, clear, descend, pause, rest, back_off, unwind, settle, fine, stop, bottom, done };

  void feel(double height, double force);
  void enter(Stage stage);
  void touched(double height);
  void conclude_at_onset();
  struct Rise {
    double height;  ///< where it begins, m
    bool is_contact;
    double slope;  ///< N/m below it
  };
  Rise rise() const;
  void conclude(const Rise& found);
  bool too_soft();
  bool ramp(double goal, double speed);
  bool arrived(double height);
  bool waited(double seconds) const;
  /// Whether the mean of a stage has enough readings.
  bool averaged(int fewest) const { return arm_ == Arm::simulated || summed_ >= fewest; }
  void finish(const Contact& result);
  double threshold() const { return stage_ == Stage::fine ? motion_.fine_threshold : motion_.threshold; }

  MotionOptions motion_;
  Descent descent_;
  Arm arm_;
  Stage stage_ = Stage::tare;
  long periods_ = 0;
  long entered_ = 0;  ///< the period in which the stage began
  double set_point_;
  double goal_ = 0.0;  ///< of the ramp of this stage
  double zero_ = 0.0;  ///< force without a contact, N
  FreeForce free_;     ///< the same of a real arm that comes down
  double sum_ = 0.0;   ///< of forces while taring
  int summed_ = 0;     ///< how many
  double peak_ = 0.0;
  double first_ = 0.0;             ///< height at which the latest contact was noticed
  std::optional<double> refused_;  ///< `first_` of the latest that was not believed
  double soft_ = 0.0;              ///< `first_` of the first contact with something too soft
  int softs_ = 0;                  ///< how many there were since
  double gap_ = 0.0;               ///< least distance of arm and set-point in this stage
  long nearer_ = 0;                ///< the period in which it last became less
  bool given_up_ = false;
  int noticed_ = 0;
  int above_ = 0;              ///< readings above the threshold, without a break
  std::vector<Sample> trace_;  ///< of the descent, for the onset
  Contact result_;
};

}  // namespace palpate::tapping
