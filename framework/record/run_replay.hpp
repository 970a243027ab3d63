// SPDX-License-Identifier: MIT
// Restores the models of a recorded run after any of its taps, for replay, reports, explanations, and summaries after
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

/// Passes the recorded taps of a run to new models, one after the other. The class writes no files, moves no arm and
/// builds no backend. The record lists, for each tap, which of the drawn lines the backend rejected. If an external
/// program scored the candidates, the choices come from the record, and no tap is chosen after the last recorded tap.
class RunReplay {
 public:
  /// Starts before the first tap. `environment` and `run` must outlive the replay. `readers` are additional parts of
  /// the program that read the models, besides the parts of the run. Throws Error if the experiment cannot be built.
  ///
  /// The objects of the scene are needed only for the truth. If they can no longer be built, because a file was removed
  /// or changed, the replay uses an empty desk. The models are then the same, but the truth is not known.
  RunReplay(const RunEnvironment& environment, const RecordedRun& run, const ReadPlan& readers = {{}, std::nullopt});
  ~RunReplay();

  /// Returns the reason why the truth, which was known during the run, is no longer known. Returns nullopt if the truth
  /// is still known, or was not known during the run.
  const std::optional<Error>& truth_lost() const { return truth_lost_; }

  /// Processes recorded taps until the first `taps` taps are processed (0 to all taps). If more taps are already
  /// processed, the models do not change.
  void advance_to(int taps);
  int taps() const { return taps_; }

  /// Returns the tap that the strategy would choose next, or nullopt if it would choose none. If a program scored the
  /// candidates, returns the recorded tap instead.
  std::optional<TapRecord> next();

  /// Repeats the next recorded tap as in the original run: chooses the tap, uses the recorded result, and calls
  /// `observer`. Returns false if no tap is chosen.
  bool run_next(Observer& observer);

  /// Returns the result after the taps processed so far. If the truth is lost, the result contains the recorded errors.
  RunResult result();

  /// Returns the experiment after the taps processed so far. Do not call its run().
  Experiment& experiment() { return *experiment_; }

 private:
  std::optional<TapOverride> recorded_choice(int tap) const;

  const RecordedRun& run_;
  std::optional<Error> truth_lost_;
  std::shared_ptr<RecordedBackend> backend_;
  std::unique_ptr<Experiment> experiment_;
  int taps_ = 0;
};

/// Returns a plan with one reader, called `name`. It reads these quantities and the surface from the first tap on. For
/// `is_optional` see ReadPlan::Reader.
ReadPlan readers_from_first_tap(const std::string& name, const QuantitySet& quantities, bool is_optional = false);

/// A number that differs between the record and the replay.
struct ReplayDifference {
  int tap = 0;  ///< 0 for a field of the summary
  std::string field;
  std::string recorded;
  std::string replayed;
};

struct ReplayReport {
  int taps = 0;
  int numbers = 0;  ///< number of compared values
  /// Reason why numbers that need the truth are not compared; nullopt if they are. See RunReplay::truth_lost().
  std::optional<Error> truth_lost;
  std::vector<ReplayDifference> differences;
};

/// Replays a run: chooses each recorded tap again with the same models, and compares all numbers bit for bit, as text.
/// Times, memory and host are not compared.
ReplayReport replay_run(const RunEnvironment& environment, const RecordedRun& run);

/// Returns the summaries that a successful run would have had after each of its taps except the last. In all fields
/// that depend only on the config, each summary equals that of a run whose budget is this number of taps, because
/// choices do not depend on the budget. There is one exception: the engines are those that `engine: {type: auto}` chose
/// for the full budget. Where `auto` would choose another engine for a smaller budget, numbers may differ within
/// `belief.engine.accuracy`. Throws Error if the truth was known during the run and is no longer known.
///
/// Measured fields are estimates: `compute.*` are sums of the recorded times so far. `wall_seconds` and
/// `compute_seconds` are the values of the whole run, multiplied by the recorded times so far and divided by the
/// recorded times of all taps. The memory was not measured after each tap and is null. The field `id` is the id of the
/// run.
std::vector<Row> earlier_summaries(const RunEnvironment& environment, const RecordedRun& run);

}  // namespace palpate
