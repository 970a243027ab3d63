// SPDX-License-Identifier: MIT
// The experiment: tap, absorb, fit, infer, score, choose, tap again.
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/forecast.hpp"
#include "experiment/policy.hpp"
#include "experiment/search.hpp"
#include "experiment/tap_belief.hpp"
#include "experiment/tap_record.hpp"

#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>

#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// One run of one config. Owns the loop and the objects in it; writes nothing.
class Experiment {
 public:
  /// Builds scene, candidates, strategy and, unless one is given, backend. `factory` and `interrupted` (may be null)
  /// must outlive it; `directory` is that of the record, "" if none is kept. Throws Error for what only building can
  /// find out.
  Experiment(const ExperimentOptions& options, const PluginFactory& factory, const std::atomic<bool>* interrupted,
             std::shared_ptr<Backend> backend = nullptr, const std::string& directory = {});

  Experiment(const Experiment&) = delete;
  Experiment& operator=(const Experiment&) = delete;

  /// Takes over the taps of an earlier process, in their order. Call before run().
  void resume(const std::vector<PastTap>& past);

  /// Taps until a stop rule holds, or `most_taps` are made, and tells `journal` of every tap. Throws Error when the
  /// backend cannot go on; the last tap is then told already.
  void run(Journal& journal, int most_taps = std::numeric_limits<int>::max());

  /// What was counted so far, without errors: builds and computes nothing.
  const RunResult& counts() const { return result_; }

  /// The result as of now. Where the truth is known, with the errors of the final models, whoever has read them.
  RunResult result();

  /// Chooses the next tap as run() does, whatever the budget, and describes the state that it is chosen from; makes
  /// none. None if no candidate is left.
  std::optional<TapRecord> choose_next();

  /// What is known of a tap that choose_next() chose. The backend is asked; no model is built for it.
  Preview preview(const TapRecord& tap) const;

  /// What the acquisition gives each candidate as of now: asked again, which changes nothing (its law).
  Eigen::VectorXd scores();

  /// Every reader of every model, before any is built. What is recorded of a tap are the models that these have asked
  /// for until then.
  std::vector<ModelReader> readers() const;

  /// Has the belief hold these quantities from now on, and choose_next() describe them, as if the strategy read them.
  void ask(Quantities quantities);

  /// The errors as of now, none where no truth is known. For people who watch: what is recorded, times included, is the
  /// same without them, because models that nobody else reads are kept apart.
  Errors errors();

  const Candidates& candidates() const { return candidates_; }
  const Scene& scene() const { return *scene_; }
  const Backend& backend() const { return *backend_; }
  const TapBelief& belief() const { return belief_; }
  /// The quantities of the belief that belong to the record.
  Quantities recorded() const { return belief_.known(asked_); }
  PhaseClock& clock() { return clock_; }
  /// The scene at the candidates; null where the backend taps another world.
  const Truth* truth();

 private:
  std::optional<std::string> stop_reason();
  bool stop_wished() const { return context_.interrupted != nullptr && context_.interrupted->load(); }
  void stop(const std::string& reason) { result_.stop_reason = reason; }
  /// Whether the next tap is the initial design's. A search is over with the first hit, or when it has looked
  /// everywhere.
  bool starting() const;
  void choose_by_score(TapRecord& tap);
  Pick pick_best();
  void describe_state(TapRecord& tap);
  /// Makes the tap and takes it in. False: it was broken off and can be made again, so it is as if never chosen, and a
  /// run that is carried on equals the unbroken one.
  bool perform(TapRecord& tap);
  Prediction predict(int candidate) const;
  TapRequest request_of(const TapRecord& tap) const;
  Contact touch(const TapRecord& tap);
  void absorb(const Target& target, const Contact& contact, Source source);
  /// Throws Error where the backend cannot go on, by its own word or because one tap after the other came to nothing.
  void check_backend(const Contact& last);
  void show_belief();
  /// Throws Error where an acquisition's product() has what its reads() does not name.
  void check_product() const;
  static constexpr Quantities kFallbackReads = Quantity::uncertainty;
  /// What the strategy and stop.max_standard_deviation read, from the first tap on that is not the initial design's.
  /// What forecast() reads it asks for itself, from the first hit on.
  Quantities strategy_reads() const;
  void ask_for_strategy() { ask(strategy_reads()); }
  /// What the surface is made of.
  Quantities surface_reads() const;
  std::optional<Forecast> forecast();
  void count(const Contact& contact, Source source);

  ExperimentOptions options_;
  std::unique_ptr<const Scene> scene_;
  Context context_;
  Candidates candidates_;
  std::vector<int> initial_;      ///< of a design that counts its taps
  std::optional<Search> search_;  ///< the other one
  PhaseClock clock_;
  TapBelief belief_;
  Quantities asked_;                      ///< by those whose models are recorded
  std::vector<PastTap> made_;             ///< all taps, those of an earlier process included
  PhaseClock unrecorded_;                 ///< of the models that only people who watch have asked for
  std::unique_ptr<TapBelief> watched_;    ///< these
  std::optional<Forecaster> forecaster_;  ///< where a stop rule asks for it
  std::shared_ptr<Acquisition> acquisition_;
  std::shared_ptr<Backend> backend_;

  Chooser chooser_;
  Eigen::VectorXd scores_;
  std::vector<bool> allowed_;  ///< candidates that may be tapped
  std::vector<bool> tapped_;   ///< candidates where there was a contact
  std::optional<Target> previous_;
  std::optional<Truth> truth_;
  std::int64_t budget_ = 0;  ///< of taps
  int failed_in_a_row_ = 0;  ///< of this process: somebody has looked at the arm before a run is carried on
  RunResult result_;
};

}  // namespace palpate
