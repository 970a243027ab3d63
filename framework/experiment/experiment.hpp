// SPDX-License-Identifier: MIT
// The experiment: tap, read, fit, infer, score, choose, tap again.
#pragma once

#include "experiment/check_quantities.hpp"
#include "experiment/experiment_options.hpp"
#include "experiment/motion_selector.hpp"
#include "experiment/run_monitor.hpp"
#include "experiment/tap_record.hpp"
#include "experiment/tap_selector.hpp"

#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>

#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// What an experiment works with, beside its options. All references must outlive it.
struct ExperimentSetup {
  const PluginFactory& factory;
  const std::atomic<bool>* interrupted = nullptr;  ///< set by the user's wish to stop; may be null
  std::shared_ptr<Backend> backend = nullptr;      ///< in the place of the config's
  std::string directory = {};                      ///< of the record; "" if none is kept
  /// Readers beside those of the config: of displays and pages, which look at a copy of the run, and of a calling
  /// program. The surface is read from the earlier of both stages.
  ReadPlan readers = {{}, std::nullopt};
};

/// The readers of a run, and its models, each with the readers because of which it is built.
struct RunPlan {
  ReadPlan read;
  std::vector<PlannedModel> models;
};

/// One run of one config: the loop. It owns scene, backend and belief, and writes nothing. The loop has two halves, for
/// taps that are made elsewhere: begin() chooses, end() takes the result.
class Experiment final {
 public:
  /// Throws Error for whatever only building can find out.
  Experiment(const ExperimentOptions& options, const ExperimentSetup& setup);

  /// Taps until a stop rule holds, or `most_taps` are made. Throws Error when the backend cannot continue; the last tap
  /// is recorded then.
  void run(Observer& observer, int most_taps = std::numeric_limits<int>::max());

  /// Chooses the next tap, asks `observer` for leave and announces it. Returns nullopt when the run is over: counts()
  /// has the reason.
  std::optional<TapRecord> begin(Observer& observer, int most_taps = std::numeric_limits<int>::max(),
                                 const TapOverride* override = nullptr);

  /// Reads, records and takes in the result of the tap that begin() chose. Throws Error as run() does.
  void end(TapRecord& tap, Observer& observer);

  /// Returns why no further tap is to be made, nullopt if one is. Infers, unless the counts alone tell it.
  std::optional<std::string> reason_to_stop(int most_taps = std::numeric_limits<int>::max(),
                                            const TapOverride* override = nullptr);

  /// Chooses the next tap, whatever the budget, and describes the state before it. Returns the same until the next
  /// take_in(); nullopt if no candidate is left.
  std::optional<TapRecord> choose_next(const TapOverride* override = nullptr);

  /// Takes in a tap that was made. The models take it in with the next tap.
  void take_in(const TapRecord& tap);

  /// Takes in the taps of an earlier process, in their order, as the loop did.
  void resume(const std::vector<TapRecord>& taps);

  /// Has the readers of the first tap read, and computes their arrays as of now: for those who only look.
  void look();

  /// Ends the run before its budget, for this reason.
  void stop(const std::string& reason) { monitor_.stop(reason); }

  /// Returns the counts so far, without state and errors: builds and computes nothing.
  const RunResult& counts() const { return monitor_.counts(); }
  /// Returns the result as of now, with the errors of the final models where the truth is known.
  RunResult result();

  /// Returns the acquisition's scores as of now, M values.
  Eigen::VectorXd scores();
  /// Returns what is known of a tap that choose_next() chose. The backend describes it; no model is built.
  Preview preview(const TapRecord& tap) const;
  /// Returns the readers of the run, and its models.
  const RunPlan& plan() const { return plan_; }

  Belief& belief() { return *belief_; }
  const Belief& belief() const { return *belief_; }
  /// Returns the true scene as it stands now; null if it is not known.
  const Scene* truth() { return monitor_.truth(*belief_); }
  const Scene& scene() const { return *scene_; }
  const Backend& backend() const { return *backend_; }
  PhaseClock& clock() { return clock_; }

 private:
  std::shared_ptr<Backend> make_backend(const ExperimentSetup& setup);
  ReadPlan make_plan(const ReadPlan& more) const;
  /// Begins the stages of a tap by `source`.
  void begin_stages(Source source);
  void draw_candidates();
  /// Shows the belief to the backend, after the first tap.
  void show();
  /// Brings the models of all begun stages up to date, in arrays too, and draws the lines of the next tap.
  void infer();
  /// Fills in all of a request that follows from the taps before.
  void complete(TapRequest& request) const;
  /// Begins the stages of the next tap, and brings the models up to date.
  void prepare(const TapOverride* override);
  bool is_stop_wished() const { return context_.interrupted != nullptr && context_.interrupted->load(); }
  TapResult make_tap(const TapRequest& request);
  bool is_broken_off(const TapResult& result) const;
  void check_backend(const TapRecord& tap);

  ExperimentOptions options_;
  std::unique_ptr<const Scene> scene_;
  PhaseClock clock_;
  Context context_;
  std::shared_ptr<Belief> belief_;
  std::shared_ptr<Backend> backend_;
  TapSelector selector_;
  std::optional<MotionSelector> motions_;  ///< if the backend has several
  RunPlan plan_;
  RunMonitor monitor_;
  std::optional<TapLine> previous_;  ///< of the tap before
  std::string unreached_;            ///< of the drawn lines: see TapRecord
  int failed_in_a_row_ = 0;          ///< of this process: somebody has looked at the arm before a run is resumed
  int refused_in_a_row_ = 0;         ///< taps whose numbers are not finite
};

}  // namespace palpate
