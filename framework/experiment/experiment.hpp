// SPDX-License-Identifier: MIT
// The main loop of a run: tap, read the result, fit, infer, score, choose the next tap.
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

/// Parts that an experiment needs in addition to its options. All references must outlive the experiment.
struct ExperimentSetup {
  const PluginFactory& factory;
  const std::atomic<bool>* interrupted = nullptr;  ///< set when the user asks to stop; may be null
  std::shared_ptr<Backend> backend = nullptr;      ///< replaces the backend of the config; null for none
  std::string directory = {};                      ///< folder of the record; "" without a record
  /// Further readers (parts that read the belief) in addition to the readers of the config: displays, pages and a
  /// calling program. Displays and pages read a replay of the run. If `readers.surface_from` is set, it replaces the
  /// stage `summary` as the stage from which on the surface is read.
  ReadPlan readers = {{}, std::nullopt};
};

/// The readers of a run (acquisition, stop rules and outputs, which read the belief), and the models to build, each
/// with a reader that needs it.
struct ModelPlan {
  ReadPlan read;
  std::vector<PlannedModel> models;
};

/// One run of one config. An Experiment owns scene, backend and belief, and writes no files. If another program makes
/// the taps, it calls the two halves of the loop: begin() chooses a tap, and end() processes its result.
class Experiment final {
 public:
  /// Creates all plugins of the run. Throws Error for faults of the config that appear only when the plugins are
  /// created.
  Experiment(const ExperimentOptions& options, const ExperimentSetup& setup);

  /// Makes taps until a stop rule holds or the run has `most_taps` taps. Throws Error if the backend cannot continue;
  /// the last tap is then already recorded.
  void run(Observer& observer, int most_taps = std::numeric_limits<int>::max());

  /// Chooses the next tap, asks `observer` for permission, and announces the tap. Returns nullopt if the run ends
  /// before this tap; counts() then contains the reason.
  std::optional<TapRecord> begin(Observer& observer, int most_taps = std::numeric_limits<int>::max(),
                                 const TapOverride* override = nullptr);

  /// Reads and records the result of the tap that begin() chose, and adds it to the belief. Throws Error as run() does.
  void end(TapRecord& tap, Observer& observer);

  /// Returns the reason why the run stops before the next tap; nullopt if it continues. Updates the models, unless the
  /// counts alone give the reason.
  std::optional<std::string> reason_to_stop(int most_taps = std::numeric_limits<int>::max(),
                                            const TapOverride* override = nullptr);

  /// Chooses the next tap, even if the budget is spent, and stores the state of the belief in the result. Until the
  /// next take_in(), every call returns the same tap. Returns nullopt if no candidate is left.
  std::optional<TapRecord> choose_next(const TapOverride* override = nullptr);

  /// Adds a tap that was made to the belief and to the counts. The models are updated only when the next tap is chosen.
  void take_in(const TapRecord& tap);

  /// Adds the taps that an earlier process made, in their order. Stages begin and models are updated as in the earlier
  /// process.
  void resume(const std::vector<TapRecord>& taps);

  /// Begins the stage `first_tap` and computes the arrays of all begun stages, for displays and exports that make no
  /// taps.
  void look();

  /// Ends the run for this reason, before the tap budget is spent.
  void stop(const std::string& reason) { monitor_.stop(reason); }

  /// Returns the counts so far, without state and errors. Builds and updates no model.
  const RunResult& counts() const { return monitor_.counts(); }
  /// Returns the result after the taps so far, with the errors of the final models if the truth is known.
  RunResult result();

  /// Returns the acquisition's scores after the taps so far, M values.
  Eigen::VectorXd scores();
  /// Returns a preview of a tap that choose_next() chose: the predicted height and the backend's description. Builds no
  /// model.
  Preview preview(const TapRecord& tap) const;
  /// Returns the parts of the run that read the belief, and the models that these parts need.
  const ModelPlan& plan() const { return plan_; }

  Belief& belief() { return *belief_; }
  const Belief& belief() const { return *belief_; }
  /// Returns the true scene in its current state; null if the truth is not known.
  const Scene* truth() { return monitor_.truth(*belief_); }
  const Scene& scene() const { return *scene_; }
  const Backend& backend() const { return *backend_; }
  PhaseClock& clock() { return clock_; }

 private:
  std::shared_ptr<Backend> make_backend(const ExperimentSetup& setup);
  ReadPlan make_plan(const ReadPlan& more) const;
  /// Begins all stages of the belief that must begin before a tap chosen by `source`.
  void begin_stages(Source source);
  void draw_candidates();
  /// Passes the belief to Backend::show(). Does nothing before the first tap.
  void show();
  /// Updates the models and arrays of all begun stages, and draws the lines for the next tap.
  void infer();
  /// Sets the fields of a request that follow from the previous taps.
  void complete(TapRequest& request) const;
  /// Begins the stages of the next tap, and updates the models and arrays.
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
  std::optional<MotionSelector> motions_;  ///< only if the backend has several motions
  ModelPlan plan_;
  RunMonitor monitor_;
  std::optional<TapLine> previous_;  ///< line of the previous tap
  std::string unreached_;            ///< drawn lines that the backend rejected; see TapRecord::unreached
  /// counts only taps of this process, because a person checks the arm before a run is resumed
  int failed_in_a_row_ = 0;
  int refused_in_a_row_ = 0;  ///< taps with an impossible result: see is_refused()
};

}  // namespace palpate
