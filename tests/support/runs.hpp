// SPDX-License-Identifier: MIT
// Experiments inside a test: configs from the shipped ones, observers that collect, backends and plugins of the test's
// own, and whole runs.
#pragma once

#include "belief/height_map.hpp"
#include "config/compose.hpp"
#include "experiment/experiment.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"
#include "record/resolved_config.hpp"
#include "support/requests.hpp"
#include "support/support.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

namespace palpate::test {

/// A shipped config (path below configs/) with overrides as typed on the command line.
inline ResolvedConfig shipped_config(const std::string& file, const std::vector<std::string>& overrides = {}) {
  Composer composer(source_folder() / "configs", config_keys());
  std::vector<Override> parsed;
  for (const std::string& text : overrides) parsed.push_back(parse_override(text));
  return resolve_experiment(composer.compose(source_folder() / "configs" / file, parsed), shared_host());
}

/// Keeps every record, and does what the test wants done meanwhile.
class Collector : public Observer {
 public:
  std::vector<TapRecord> taps;
  std::function<bool(const TapRecord&)> permitting;
  std::function<void(const TapRecord&)> announcing;
  std::function<void(const TapRecord&)> recording;

  bool permits(const TapRecord& tap, const Experiment&) override { return !permitting || permitting(tap); }
  void announce(const TapRecord& tap) override {
    if (announcing) announcing(tap);
  }
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override {
    taps.push_back(tap);
    if (recording) recording(tap);
  }
};

/// Returns the result of a contact at `height`, at the corner of the area, in one second.
inline TapResult contact_at(double height) { return contact_on({}, height, 8.0, 1.0); }

/// Returns a number of the state of a belief; nullopt if it is null, or if there is none of this name.
inline std::optional<double> number_of(const BeliefState& state, const std::string& name) {
  return Row{state.fields}.number(name);
}

/// Answers with what the test scripts; a plain desk at 0 once the script has ended. Reads of the belief what `reading`
/// reads when it is shown.
class ScriptedBackend final : public Backend {
 public:
  explicit ScriptedBackend(std::vector<TapResult> answers, bool truth = false)
      : answers_(std::move(answers)), truth_(truth) {}
  std::vector<TapRequest> requests;
  std::function<void(const BeliefView&)> reading;
  QuantitySet read;  ///< by `reading`

  TapResult tap(const TapRequest& request) override {
    requests.push_back(request);
    const auto index = static_cast<std::size_t>(request.number - 1);
    TapResult out = index < answers_.size() ? answers_[index] : contact_at(0.0);
    if (out.contact) out.contact->head<2>() = request.line.start.head<2>();
    return out;
  }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return truth_; }
  QuantitySet reads() const override { return read; }
  void show(const BeliefView& belief) override {
    if (reading) reading(belief);
  }

 private:
  std::vector<TapResult> answers_;
  bool truth_;
};

inline std::shared_ptr<ScriptedBackend> scripted(std::vector<TapResult> answers = {}) {
  return std::make_shared<ScriptedBackend>(std::move(answers));
}

/// Gives out one plugin wherever its kind is asked for; every other comes from the host.
template <class Interface>
class Instead final : public PluginFactory {
 public:
  explicit Instead(std::shared_ptr<Interface> made) : made_(std::move(made)) {}
  std::shared_ptr<void> create(const PluginChoice& choice, const Context& context) const override {
    return choice.kind == Interface::kKind ? std::shared_ptr<void>(made_) : shared_host().create(choice, context);
  }

 private:
  std::shared_ptr<Interface> made_;
};

/// Returns the context of a config's belief. `scene` must outlive it.
inline Context belief_context(const ResolvedConfig& config, const Scene& scene) {
  Context out{shared_host(), scene, static_cast<std::uint64_t>(config.options.seed), nullptr};
  out.run = run_settings(config.options);
  return out;
}

/// The experiment of a shipped config, not yet begun, and the observer of its taps.
struct Prepared {
  explicit Prepared(const std::string& file, const std::vector<std::string>& overrides = {},
                    std::shared_ptr<Backend> backend = nullptr, const PluginFactory& plugins = shared_host(),
                    const QuantitySet& quantities = {})
      : config(shipped_config(file, overrides)),
        experiment(config.options, {plugins, nullptr, std::move(backend), {}, readers(quantities)}) {}

  void run() { experiment.run(journal); }
  /// The belief of a run that taps from above.
  HeightMapBelief& belief() { return static_cast<HeightMapBelief&>(experiment.belief()); }
  const HeightMapBelief& belief() const { return static_cast<const HeightMapBelief&>(experiment.belief()); }
  const HeightModels& models() const { return belief().models(); }
  CandidateGrid grid() const { return grid_of(belief().candidates()); }
  /// Has models of these quantities read from now on, beside those of the run, and their arrays computed.
  void read(const QuantitySet& quantities) {
    ReadPlan plan = experiment.plan().read;
    plan.readers.push_back(readers(quantities).readers.front());
    belief().plan(plan);
    belief().begin(Stage::first_tap);
    belief().update();
    belief().infer();
  }
  /// Returns a plan whose one reader reads these quantities from the first tap on.
  static ReadPlan readers(const QuantitySet& quantities) {
    return {{{"test", quantities, Stage::first_tap}}, std::nullopt};
  }
  /// The first `count` of its taps, as a later process takes them over.
  std::vector<TapRecord> past(std::size_t count) const {
    return {taps.begin(), std::next(taps.begin(), static_cast<std::ptrdiff_t>(count))};
  }

  ResolvedConfig config;
  Experiment experiment;
  Collector journal;
  const std::vector<TapRecord>& taps = journal.taps;
};

/// The same, run to its end.
struct Finished : Prepared {
  explicit Finished(const std::string& file, const std::vector<std::string>& overrides = {},
                    std::shared_ptr<Backend> backend = nullptr, const PluginFactory& plugins = shared_host())
      : Prepared(file, overrides, std::move(backend), plugins) {
    run();
  }
};

/// Resumes what `unbroken` did after its first `cut` taps, and expects the same rows of the others.
inline void expect_resumed(Prepared& rest, const Prepared& unbroken, std::size_t cut) {
  rest.experiment.resume(unbroken.past(cut));
  rest.run();
  ASSERT_EQ(rest.taps.size(), unbroken.taps.size() - cut);
  for (std::size_t i = 0; i < rest.taps.size(); ++i) {
    ASSERT_EQ(to_json_line(tap_row(rest.taps[i])), to_json_line(tap_row(unbroken.taps[cut + i])))
        << "cut " << cut << " tap " << i;
  }
}

}  // namespace palpate::test
