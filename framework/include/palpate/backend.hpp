// SPDX-License-Identifier: MIT
// Plugin kind `backend`: whatever can be tapped, a simulator, a record or a robot.
#pragma once

#include <palpate/types.hpp>

#include <optional>

namespace palpate {

/// What the models expect of a place: mean and standard deviation of the height, metres, in the frame of the scene.
/// For `surface: two_part` of the height that an object would have there.
struct Prediction {
  double height = 0.0;
  double standard_deviation = 0.0;
};

/// One tap as it is asked for. It says all that a simulated answer may depend on beside options and seed, so that a
/// resumed run goes on exactly as the unbroken one would have.
struct TapRequest {
  int number = 1;                       ///< of the tap within the run, from 1
  Target target;                        ///< within the scene's area
  std::optional<Target> previous;       ///< the target of the tap before, none for the first
  std::optional<Prediction> predicted;  ///< only for a backend that wants it
};

/// Laws, of which the contract tests check those that need no robot: a failed tap is an outcome, never a made-up
/// height; the destructor leaves a robot in a safe state; no method moves anything but tap(); a repeatable backend
/// answers the same request alike, whatever it was asked before.
class Backend {
 public:
  static constexpr const char* kKind = "backend";

  virtual ~Backend() = default;

  /// Taps the world and returns when the tool is clear again. Throws Error only for trouble that ends the run; a tap
  /// that merely failed says so in its outcome.
  virtual Contact tap(const TapRequest& request) = 0;

  /// Whether a tap can be made again at no risk. If not, each tap is announced in the log and synced before it moves.
  virtual bool repeatable() const = 0;

  /// Whether taps depend on what the models expect. If so, the loop builds the process of the heights for it.
  virtual bool wants_prediction() const { return false; }

  /// Whether the scene of the config is the very world that is tapped, so that errors against it mean something.
  virtual bool scene_is_truth() const = 0;
};

}  // namespace palpate
