// SPDX-License-Identifier: MIT
// Counts the taps of a run and determines the true scene at each tap. The monitor makes no decisions.
#pragma once

#include "experiment/tap_record.hpp"

#include <palpate/plugin.hpp>

#include <memory>
#include <string>
#include <vector>

namespace palpate {

class RunMonitor {
 public:
  /// `is_truth`: whether the taps are made on the config's scene. `scene` must outlive the monitor.
  RunMonitor(const Scene& scene, bool is_truth);

  /// Counts a tap that `belief` already contains. Object and desk contacts are counted again for all taps, by their
  /// current readings.
  void take_in(const TapRecord& tap, Belief& belief);
  void stop(const std::string& reason) { result_.stop_reason = reason; }

  /// Returns the counts so far, without state and errors.
  const RunResult& counts() const { return result_; }

  /// Stores in `tap` the state and the errors of the belief before the tap, and whether the tap's line ends on an
  /// object of the true scene.
  void describe(TapRecord& tap, Belief& belief);

  /// Returns the scene in its current state; null if unknown.
  const Scene* truth(Belief& belief);

  /// Returns the current result. Requires that the stage `summary` has begun.
  RunResult result(Belief& belief);

 private:
  void note_object(const TapRecord& tap, const Scene& scene);

  const Scene& scene_;
  bool is_truth_;
  std::unique_ptr<const Scene> pushed_;  ///< current scene if objects were pushed, else null
  int truth_taps_ = -1;                  ///< number of taps when the belief last received the truth; -1 for never
  RunResult result_;
  std::vector<bool> first_labels_;      ///< per tap: whether its first reading was a contact with an object
  std::vector<ObjectTouches> touches_;  ///< per object
};

/// Throws Error, so that the run fails, if an error after `taps` taps is not a finite number.
void require_finite(const Errors& errors, int taps);

}  // namespace palpate
