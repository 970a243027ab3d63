// SPDX-License-Identifier: MIT
// Plugin kind `backend`: makes the taps, in a simulator, from a record, or with a robot.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/tap.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Laws of every backend; the contract tests check the laws that can be checked without a robot. A failed tap is
/// reported as an outcome, never as an invented height. The destructor leaves a robot in a safe state. Only tap() moves
/// the robot. A repeatable backend gives the same result for the same request, independent of earlier requests.
class Backend {
 public:
  static constexpr const char* kKind = "backend";

  /// Whether only one run at a time can use the backend's hardware, such as a robot's arm. A backend class may redefine
  /// this constant as true. A sweep then runs its jobs one after another, even with several workers.
  static constexpr bool kOneAtATime = false;

  virtual ~Backend() = default;

  /// Makes a tap and returns when the tool is clear again. The outcome reports a failed tap; TapResult::ends_run is set
  /// if no further tap may follow. An Error also ends the run, but the record then lacks the tap: throw it only if
  /// nothing was tapped.
  virtual TapResult tap(const TapRequest& request) = 0;

  /// Returns whether a tap can be repeated without risk. If not, the request of each tap is written to the record and
  /// synced to disk before the robot moves.
  virtual bool repeatable() const = 0;

  /// Returns whether the backend taps along lines that are not from above. If not, beliefs with such lines are
  /// rejected.
  virtual bool taps_any_line() const { return false; }

  /// Computes for each line that is not from above whether a tap along it is possible, as far as known before the tap.
  /// The arm must reach the line, and the shaft must stay clear of the desk.
  virtual void reaches(const Candidates& /*lines*/, BoolOut out) const { out.setConstant(true); }

  /// Describes what tap() would do with `request`, for a person who must approve every tap (`palpate run --step`). The
  /// lines, without line ends, contain for example the approach, depth, speed and force limits. An empty result means
  /// that the backend knows only the position. Called only for a run with `--step`; must not change the taps.
  virtual std::vector<std::string> describe(const TapRequest& /*request*/) { return {}; }

  /// A property of the robot that taps have determined.
  struct Learnt {
    std::string name;  ///< name of the option that left the value open
    std::string value;
  };
  /// Returns the values that the config left open and that the taps of this process have determined. At the end of the
  /// run, each value is stored in a line `note` of the record.
  virtual std::vector<Learnt> learnt() const { return {}; }

  /// Returns the quantities of TapRequest::predicted on which taps depend, constant over the object's lifetime. The set
  /// is empty, or contains `height_mean` and `height_std`, or these two and `object_probability`.
  virtual QuantitySet predicts() const { return {}; }

  /// Returns the quantities that show() reads, constant over the object's lifetime.
  virtual QuantitySet reads() const { return {}; }

  /// Displays the surface to people who watch a robot. Called after every tap, once record and belief contain the tap,
  /// and when a run is resumed. It must not change the taps. An Error ends the run.
  virtual void show(const BeliefView& /*belief*/) {}

  /// Returns whether the taps are made on the scene of the config, so that errors against this scene are meaningful.
  virtual bool scene_is_truth() const = 0;
};

}  // namespace palpate
