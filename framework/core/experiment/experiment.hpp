// SPDX-License-Identifier: MIT
// The experiment: tap, observe, fit, infer, score, choose, tap again.
#pragma once

#include "experiment/chooser.hpp"
#include "experiment/experiment_options.hpp"
#include "experiment/tap_belief.hpp"
#include "experiment/tap_record.hpp"
#include "experiment/watch.hpp"

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
///
/// The loop has two halves, for those who tap by other means than a backend: begin() says where, end() takes what came
/// of it; choose_next() and observe() do the same and tell nobody.
class Experiment {
 public:
  /// Builds scene, candidates, strategy and, unless one is given, backend. `factory` and `interrupted` (may be null)
  /// must outlive it; `directory` is that of the record, "" if none is kept. Throws Error for what only building can
  /// find out.
  Experiment(const ExperimentOptions& options, const PluginFactory& factory, const std::atomic<bool>* interrupted,
             std::shared_ptr<Backend> backend = nullptr, const std::string& directory = {});

  Experiment(const Experiment&) = delete;
  Experiment& operator=(const Experiment&) = delete;

  /// Taps until a stop rule holds, or `most_taps` are made, and tells `journal` of every tap. Throws Error when the
  /// backend cannot go on; the last tap is then told already.
  void run(Journal& journal, int most_taps = std::numeric_limits<int>::max());

  /// Chooses the next tap, by the `wish` if there is one, asks `journal` for leave and announces it. None when the run
  /// is over: counts() says why.
  std::optional<TapRecord> begin(Journal& journal, int most_taps = std::numeric_limits<int>::max(),
                                 const Wish* wish = nullptr);

  /// Takes in what came of the tap that begin() chose, and tells `journal`. Throws Error as run() does.
  void end(TapRecord& tap, Journal& journal);

  /// Ends the run before its budget, for this reason.
  void stop(const std::string& reason) { watch_.stop(reason); }

  /// Chooses the next tap, whatever the budget, and describes the state that it is chosen from; makes none. The same
  /// again until the next observe(). None if no candidate is left.
  std::optional<TapRecord> choose_next(const Wish* wish = nullptr);

  /// Notes a tap that was made, wherever. The models take it in when next they are asked.
  void observe(const PastTap& tap);

  /// Takes over the taps of an earlier process, in their order, and asks for what was read then: the record goes on as
  /// it was.
  void resume(const std::vector<PastTap>& past);

  /// What was counted so far, without errors: builds and computes nothing.
  const RunResult& counts() const { return watch_.counts(); }

  /// The result as of now. Where the truth is known, with the errors of the final models, whoever has read them.
  RunResult result() { return watch_.result(belief_); }

  /// What is known of a tap that choose_next() chose. The backend is asked; no model is built for it.
  Preview preview(const TapRecord& tap) const;

  /// What the acquisition gives each candidate as of now: asked again, which changes nothing (its law).
  Eigen::VectorXd scores();

  /// Every reader of every model, before any is built. What is recorded of a tap are the models that these have asked
  /// for until then.
  std::vector<ModelReader> readers() const;

  /// Has the belief hold these quantities from now on, and choose_next() describe them, as if the strategy read them.
  void ask(Quantities quantities) { belief_.ask(quantities); }

  /// Has the belief hold these quantities as of now, for who looks at it; the record is the same without.
  void build(Quantities quantities) { belief_.build(quantities); }

  /// The errors as of now, none where no truth is known. For people who watch: what is recorded, times included, is the
  /// same without them, because models that nobody else reads are kept apart.
  Errors errors() { return watch_.errors(belief_); }

  const Candidates& candidates() const { return candidates_; }
  const Scene& scene() const { return *scene_; }
  const Backend& backend() const { return *backend_; }
  const TapBelief& belief() const { return belief_; }
  PhaseClock& clock() { return clock_; }
  /// The scene at the candidates; null where the backend taps another world.
  const Truth* truth() { return watch_.truth(); }

 private:
  /// `source`: who would choose the next tap.
  std::optional<std::string> stop_reason(std::int64_t budget, Source source);
  bool stop_wished() const { return context_.interrupted != nullptr && context_.interrupted->load(); }
  /// What a tap of this source reads of the belief: strategy, stop rules and backend. What a forecast reads is asked
  /// for by itself, from the first hit on.
  Quantities reads_for(Source source) const;
  TapRequest request_of(const TapRecord& tap) const {
    return {tap.number, tap.target, previous_, tap.predicted, watch_.counts().robot_seconds, tap.motion};
  }
  Manner manner_of(const PastTap& tap) const {
    return {tap.source == Source::initial, tap.motion, chooser_.roughness(tap.motion)};
  }
  Contact touch(const TapRecord& tap);
  bool is_broken_off(const Contact& contact) const;
  void check_backend(const Contact& last);
  void show_belief();

  ExperimentOptions options_;
  std::unique_ptr<const Scene> scene_;
  Context context_;
  Candidates candidates_;
  PhaseClock clock_;
  TapBelief belief_;
  Chooser chooser_;
  std::shared_ptr<Backend> backend_;
  Watch watch_;
  std::optional<Target> previous_;
  int failed_in_a_row_ = 0;  ///< of this process: somebody has looked at the arm before a run is carried on
};

}  // namespace palpate
