// SPDX-License-Identifier: MIT
// The models of a recorded run brought back to any of its taps: for replay, reports, explanations, and summaries after
// fewer taps.
#pragma once

#include "experiment/experiment.hpp"
#include "record/recorded_run.hpp"
#include "record/run.hpp"

#include <palpate/error.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

class RecordedBackend;

/// Takes in the recorded taps of a run, one after the other. It writes nothing, moves nothing and builds no backend:
/// the drawn lines that the run's backend rejected are recorded with each tap. Where a program scored, taps are chosen
/// as the record has them, and none after the last.
class RunReplay {
 public:
  /// Before the first tap. `environment` and `run` must outlive it; `readers`: those who look, beside the run's own.
  /// Throws Error for whatever only building finds out.
  ///
  /// The objects of the scene serve the truth alone. If they cannot be built any more, because a file is gone or has
  /// changed, the desk is bare: the models are the same, and no truth is known.
  RunReplay(const RunEnvironment& environment, const RecordedRun& run, const ReadPlan& readers = {{}, std::nullopt});
  ~RunReplay();

  /// Returns why the truth, which the run knew, is not known any more; nullopt if it is, or if the run did not know it.
  const std::optional<Error>& truth_lost() const { return truth_lost_; }

  /// Takes in the recorded taps up to the `taps`-th, from 0 to all; never back.
  void advance_to(int taps);
  int taps() const { return taps_; }

  /// Returns the tap that would be chosen next, by the strategy or, where a program scored, by the record.
  std::optional<TapRecord> next();

  /// Runs the next recorded tap as the loop does: chooses it, takes the recorded result, and tells `observer`. Returns
  /// false if the loop chooses none.
  bool run_next(Observer& observer);

  /// Returns the result as of now. Where the truth is lost, it has the recorded errors of this state.
  RunResult result();

  /// The experiment as of now. Not to be run.
  Experiment& experiment() { return *experiment_; }

 private:
  std::optional<TapOverride> recorded_choice(int tap) const;

  const RecordedRun& run_;
  std::optional<Error> truth_lost_;
  std::shared_ptr<RecordedBackend> backend_;
  std::unique_ptr<Experiment> experiment_;
  int taps_ = 0;
};

/// Returns a plan whose one reader, by its name, reads these quantities and the surface from the first tap on.
/// `is_optional`: ReadPlan::Reader::is_optional.
ReadPlan readers_from_first_tap(const std::string& name, const QuantitySet& quantities, bool is_optional = false);

/// A number that came out differently in a replay.
struct Difference {
  int tap = 0;  ///< 0: of the summary
  std::string field;
  std::string recorded;
  std::string replayed;
};

struct ReplayReport {
  int taps = 0;
  int numbers = 0;  ///< compared
  /// Why numbers that need the truth are left out; nullopt if they are not: see RunReplay::truth_lost().
  std::optional<Error> truth_lost;
  std::vector<Difference> differences;
};

/// Chooses and takes in the recorded taps of a run with the same models, and compares every number but clocks, memory
/// and host, as text, bit for bit.
ReplayReport replay_run(const RunEnvironment& environment, const std::filesystem::path& directory);

/// Returns the summaries that a run, which ended well, would have had after each of its taps but the last. Each equals
/// that of a run whose budget ends there, in all that depends on the config alone: choosing a tap looks at no budget,
/// and reading a model changes none. Only the engines are those that `engine: {type: auto}` took for the run's own
/// budget; where it would take another for less, numbers may differ as far as `belief.engine.accuracy` lets them.
/// Throws Error where the run knew the truth and that is lost.
///
/// Of the rest the record knows this much: `compute.*` are the sums of the recorded times so far; `wall_seconds` and
/// `compute_seconds` the share of the run's own that these sums have in those of all taps; the memory, which nobody
/// measured then, is null. The id is that of the run.
std::vector<Row> earlier_summaries(const RunEnvironment& environment, const RecordedRun& run);

}  // namespace palpate
