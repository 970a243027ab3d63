// SPDX-License-Identifier: MIT
// Counts of a run, and the truth along its taps. It decides nothing.
#pragma once

#include "experiment/tap_record.hpp"

#include <palpate/plugin.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

class RunMonitor {
 public:
  /// `is_truth`: the config's scene is what is tapped. `scene` must outlive it.
  RunMonitor(const Scene& scene, bool is_truth);

  /// Takes in a tap, which `belief` has: contacts count as they are read now.
  void take_in(const TapRecord& tap, Belief& belief);
  void stop(const std::string& reason) { result_.stop_reason = reason; }

  /// Returns the counts so far; state and errors are left out.
  const RunResult& counts() const { return result_; }

  /// Sets in `tap` the state of the belief before it, and the truth along its line.
  void describe(TapRecord& tap, Belief& belief);

  /// Returns the scene as it stands now; null if it is not known.
  const Scene* truth(Belief& belief);

  /// Returns the result as of now. The stage `summary` has begun.
  RunResult result(Belief& belief);

 private:
  void note_object(const TapRecord& tap, const Scene& scene);

  const Scene& scene_;
  bool is_truth_;
  std::unique_ptr<const Scene> pushed_;  ///< the scene, if objects were pushed
  int truth_taps_ = -1;                  ///< taps after which the belief has the truth
  RunResult result_;
  std::vector<bool> first_labels_;      ///< of each tap: on an object, as it was read then
  std::vector<ObjectTouches> touches_;  ///< of each object
};

/// Throws Error, so that the run fails, for an error that is not a finite number after `taps` taps.
void require_finite(const Errors& errors, int taps);

}  // namespace palpate
