// SPDX-License-Identifier: MIT
// What watches a run and decides nothing in it: counts, the state that a tap is chosen from, errors, the result.
#pragma once

#include "experiment/forecast.hpp"
#include "experiment/phases.hpp"
#include "experiment/tap_belief.hpp"
#include "experiment/tap_record.hpp"

#include <palpate/plugin.hpp>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

class Watch {
 public:
  /// `truth_known`: the config's scene is the world that is tapped. All else must outlive it.
  Watch(const ExperimentOptions& options, const Candidates& candidates, const Context& context, bool truth_known);

  /// Counts a tap at `candidate`, of which `belief` knows already: contacts with an object as they read now.
  void observe(const PastTap& tap, const Manner& manner, int candidate, const TapBelief& belief);
  void stop(const std::string& reason) { result_.stop_reason = reason; }

  /// What was counted so far, without errors: builds and computes nothing.
  const RunResult& counts() const { return result_; }

  /// What error is expected, where a stop rule asks for it; from the first hit on it asks `belief` for what it reads.
  std::optional<Forecast> forecast(TapBelief& belief) const;

  /// Returns the RMSE over the candidates that is expected of the surface as it would be reconstructed now, metres,
  /// whether or not a stop rule asks for it. Uses the models that `belief` has, or those that errors() keeps apart;
  /// builds their maps and no model. None before the first hit, and where a model is missing that the surface needs.
  std::optional<double> expected_rmse(TapBelief& belief) const;

  /// Notes in `tap` the state that it is chosen from, as far as that belongs to the record.
  void describe(TapRecord& tap, TapBelief& belief);

  /// The scene at the candidates; null where another world is tapped.
  const Truth* truth();

  /// The errors as of now, none where no truth is known. Models that `belief` does not have are kept apart, so that
  /// what is shown decides nothing.
  Errors errors(TapBelief& belief);

  /// The result as of now, where the truth is known with the errors, whoever has read the models.
  RunResult result(TapBelief& belief);

 private:
  /// Counts a contact at `candidate` for the object that is there.
  void note_object(int candidate);

  const ExperimentOptions& options_;
  const Candidates& candidates_;
  const Context& context_;
  bool truth_known_;
  RunResult result_;
  std::vector<bool> touched_;           ///< candidates where there was a contact
  std::vector<ObjectTouches> touches_;  ///< of each object, where the truth is known
  std::optional<Truth> truth_;
  int truth_taps_ = 0;  ///< taps that it stands after
  std::vector<std::pair<PastTap, Manner>> taps_;
  PhaseClock unrecorded_;              ///< of the models that only people who watch have asked for
  std::unique_ptr<TapBelief> beside_;  ///< these
};

}  // namespace palpate
