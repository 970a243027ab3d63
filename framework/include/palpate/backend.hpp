// SPDX-License-Identifier: MIT
// Plugin kind `backend`: whatever can be tapped, a simulator, a record or a robot.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/tap.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Laws, of which the contract tests check those that need no robot: a failed tap is an outcome, never a made-up
/// height; the destructor leaves a robot in a safe state; no method moves anything but tap(); a repeatable backend
/// answers the same request alike, whatever it was asked before.
class Backend {
 public:
  static constexpr const char* kKind = "backend";

  /// Whether there is but one of what the backend moves, as of a robot's arm. A backend that says true, by a constant
  /// of this name in its own class, has the jobs of a sweep run one after another, however many workers there are.
  static constexpr bool kOneAtATime = false;

  virtual ~Backend() = default;

  /// Taps the world and returns when the tool is clear again. A tap that failed says so in its outcome, and if it must
  /// be the last, in TapResult::ends_run. An Error ends the run, too, but the tap is then lost to the record: it is for
  /// trouble in which nothing was tapped.
  virtual TapResult tap(const TapRequest& request) = 0;

  /// Whether a tap can be made again at no risk. If not, each tap is announced in the log and synced before it moves.
  virtual bool repeatable() const = 0;

  /// Whether the backend taps along lines that are not from above. If not, beliefs with such lines are rejected.
  virtual bool taps_any_line() const { return false; }

  /// Returns for each line that is not from above whether a tap can be made along it, as far as that is known before
  /// the tap: whether arm and shaft reach it and stay clear of the desk.
  virtual void reaches(const Candidates& /*lines*/, BoolOut out) const { out.setConstant(true); }

  /// What tap() would do with `request`, for a person who is asked before every tap (`palpate run --step`): a few lines
  /// without line ends, as where the tool comes from, how deep and fast it goes, which forces end it. Empty: nothing is
  /// known beside the place. Never called unless a person is asked; called or not, the taps are the same.
  virtual std::vector<std::string> describe(const TapRequest& /*request*/) { return {}; }

  /// A property of the robot that taps have determined.
  struct Learnt {
    std::string name;  ///< name of the option that left the value open
    std::string value;
  };
  /// Returns the values that the config left open and that the taps of this process have determined. At the end of the
  /// run, a line `note` of the record stores each of them.
  virtual std::vector<Learnt> learnt() const { return {}; }

  /// Returns the quantities of TapRequest::predicted on which taps depend, the same from birth to death: none,
  /// `height_mean` and `height_std`, or these and `object_probability`.
  virtual QuantitySet predicts() const { return {}; }

  /// Returns the quantities that show() reads, the same from birth to death.
  virtual QuantitySet reads() const { return {}; }

  /// Called after every tap, once it is recorded and the belief has it, and at the start of a run that is carried on:
  /// for a robot whose surface people watch. Whatever it reads, the taps are the same. An Error ends the run.
  virtual void show(const BeliefView& /*belief*/) {}

  /// Whether the scene of the config is the very world that is tapped, so that errors against it mean something.
  virtual bool scene_is_truth() const = 0;
};

}  // namespace palpate
