// SPDX-License-Identifier: MIT
// The experiment: tap, observe, fit, infer, score, choose, tap again.
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/tap_record.hpp"

#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>

#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

struct Wish;

/// One run of one config: the loop. It owns the scene and the backend, and writes nothing. What is believed and how the
/// next tap is chosen is a derived class's: FromAbove, where the desk is tapped from above; FromAnySide, where the tool
/// comes from any direction.
///
/// The loop has two halves, for those who tap by other means than a backend: begin() says where, end() takes what came
/// of it; choose_next() and observe() do the same and tell nobody.
class Experiment {
 public:
  virtual ~Experiment() = default;
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

  /// Chooses the next tap, whatever the budget, and describes the state that it is chosen from; makes none. The same
  /// again until the next observe(). None if no candidate is left.
  virtual std::optional<TapRecord> choose_next(const Wish* wish = nullptr) = 0;

  /// Has the strategy choose, from now on, as a record says: the next tap is `next`, none where the record ends. The
  /// acquisition is not asked then: for those that cannot be asked again.
  void recall(std::optional<TapRecord> next) {
    recalls_ = true;
    recalled_ = std::move(next);
  }
  /// Whether the acquisition is asked.
  bool has_scores() const { return !recalls_; }

  /// Notes a tap that was made, wherever. The models take it in when next they are asked.
  virtual void observe(const PastTap& tap) = 0;

  /// Takes over the taps of an earlier process, in their order: the record goes on as it was.
  virtual void resume(const std::vector<PastTap>& past) = 0;

  /// Ends the run before its budget, for this reason.
  virtual void stop(const std::string& reason) = 0;

  /// What was counted so far, without errors: builds and computes nothing.
  virtual const RunResult& counts() const = 0;

  /// The result as of now. Where the truth is known, with the errors of the final models, whoever has read them.
  virtual RunResult result() = 0;

  /// The errors as of now, none where no truth is known. For people who watch: what is recorded, times included, is the
  /// same without them, because models that nobody else reads are kept apart.
  virtual Errors errors() = 0;

  /// The RMSE over the candidates that is expected as of now, metres; none where the belief says nothing of it. For
  /// people who watch, too: it builds no model, and needs no truth.
  virtual std::optional<double> expected_rmse() { return std::nullopt; }

  /// Has the models hold what such readers read, from now on, and choose_next() describe it, as if the strategy read
  /// it.
  virtual void ask(Quantities quantities) = 0;

  /// What is known of a tap that choose_next() chose. The backend is asked; no model is built for it.
  virtual Preview preview(const TapRecord& tap) const = 0;

  /// Every reader of every model, before any is built. What is recorded of a tap are the models that these have asked
  /// for until then.
  virtual std::vector<ModelReader> readers() const = 0;

  const Scene& scene() const { return *scene_; }
  const Backend& backend() const { return *backend_; }
  PhaseClock& clock() { return clock_; }

 protected:
  /// Builds scene and, unless one is given, backend. `factory` and `interrupted` (may be null) must outlive it;
  /// `directory` is that of the record, "" if none is kept. Throws Error for what only building can find out.
  Experiment(const ExperimentOptions& options, const PluginFactory& factory, const std::atomic<bool>* interrupted,
             std::shared_ptr<Backend> backend, const std::string& directory);

  /// Fits and infers what anybody has asked for, after the latest tap.
  virtual void update() = 0;
  /// A reason to stop, beside budget and user, before another tap, which `source` would choose; none if there is none.
  virtual std::optional<std::string> stop_rule(Source source) = 0;
  /// Notes in `tap` how its contact is read.
  virtual void read(TapRecord& tap) = 0;

  TapRequest request_of(const TapRecord& tap) const {
    return {tap.number, tap.target, previous_, tap.predicted, counts().robot_seconds, tap.motion, tap.approach};
  }

  ExperimentOptions options_;
  std::unique_ptr<const Scene> scene_;
  Context context_;
  std::shared_ptr<Backend> backend_;
  PhaseClock clock_;
  std::optional<Target> previous_;     ///< of the tap before
  std::optional<TapRecord> recalled_;  ///< see recall()

 private:
  std::optional<std::string> stop_reason(std::int64_t budget, Source source);
  bool stop_wished() const { return context_.interrupted != nullptr && context_.interrupted->load(); }
  Contact touch(const TapRecord& tap);
  bool is_broken_off(const Contact& contact) const;
  void check_backend(const PastTap& tap);

  bool recalls_ = false;
  int failed_in_a_row_ = 0;   ///< of this process: somebody has looked at the arm before a run is carried on
  int refused_in_a_row_ = 0;  ///< taps whose numbers were none
};

}  // namespace palpate
