// SPDX-License-Identifier: MIT
// Plugin kind `backend`: whatever can be tapped, a simulator, a record or a robot.
#pragma once

#include <palpate/belief.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// What the models expect of a place: mean and standard deviation of the height, metres, in the frame of the scene.
/// For `surface: two_part` of the height that an object would have there.
struct Prediction {
  double height = 0.0;
  double standard_deviation = 0.0;
  std::optional<double> probability = std::nullopt;  ///< of an object there, for a backend that asks for it
};

/// One tap as it is asked for. It says all that a simulated answer may depend on beside options and seed, so that a
/// resumed run goes on exactly as the unbroken one would have.
struct TapRequest {
  int number = 1;                                   ///< of the tap within the run, from 1
  Target target;                                    ///< within the scene's area
  std::optional<Target> previous;                   ///< the target of the tap before, none for the first
  std::optional<Prediction> predicted;              ///< only for a backend that wants it
  double elapsed = 0.0;                             ///< robot time of all taps before, seconds
  int motion = 0;                                   ///< in which way, where the backend has several: see motions.hpp
  std::optional<Approach> approach = std::nullopt;  ///< the way of the tool; none: straight down, at the target
};

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
  /// be the last, in Contact::ends_run. An Error ends the run, too, but the tap is then lost to the record: it is for
  /// trouble in which nothing was tapped.
  virtual Contact tap(const TapRequest& request) = 0;

  /// Whether a tap can be made again at no risk. If not, each tap is announced in the log and synced before it moves.
  virtual bool repeatable() const = 0;

  /// Whether a tap can be made along this approach, as far as that is known before: whether arm and shaft get there and
  /// stay clear of the desk. A backend that only comes from above says no to all.
  virtual bool reaches(const Approach& /*approach*/) const { return false; }

  /// What tap() would do with `request`, for a person who is asked before every tap (`palpate run --step`): a few lines
  /// without line ends, as where the tool comes from, how deep and fast it goes, which forces end it. Empty: nothing is
  /// known beside the place. Never called unless a person is asked; called or not, the taps are the same.
  virtual std::vector<std::string> describe(const TapRequest& /*request*/) { return {}; }

  /// Something that taps have shown of the robot, one line each.
  struct Learnt {
    std::string name;  ///< of the option that left it open
    std::string value;
  };
  /// What the taps of this process have shown of what the config left open, noted in the manifest when the run ends.
  virtual std::vector<Learnt> learnt() const { return {}; }

  /// What taps depend on of all that the models expect, the same from birth to death: nothing, the height, or the
  /// height and the probability of an object. The loop builds the models for it.
  virtual Quantities expects() const { return {}; }

  /// What show() reads, the same from birth to death.
  virtual Quantities reads() const { return {}; }

  /// Called after every tap, once it is recorded and the belief has it, and at the start of a run that is carried on:
  /// for a robot whose surface people watch. Whatever it reads, the taps are the same. An Error ends the run.
  virtual void show(const Belief& /*belief*/) {}

  /// Whether the scene of the config is the very world that is tapped, so that errors against it mean something.
  virtual bool scene_is_truth() const = 0;
};

}  // namespace palpate
