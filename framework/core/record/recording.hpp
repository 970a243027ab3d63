// SPDX-License-Identifier: MIT
// A run as its directory tells it, and its models brought back to any of its taps: for replay, reports, explanations,
// and for what it had come to after fewer taps.
#pragma once

#include "record/fields.hpp"
#include "record/resolved.hpp"
#include "record/row.hpp"
#include "record/session.hpp"
#include "space/from_any_side.hpp"

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

namespace palpate {

/// What a run directory holds. The run may be under way, or have failed.
struct Recording {
  std::filesystem::path directory;
  ResolvedConfig config;
  std::vector<Row> rows;          ///< of its record, a tap each
  std::vector<PastTap> taps;      ///< the same as the models see them
  std::vector<TapTimes> timings;  ///< of most of them
  std::optional<Tree> manifest;   ///< none before a run has begun
  std::optional<Row> summary;     ///< of a run that ended

  /// Whether the scene of the config is what was tapped.
  bool truth_known() const;
  /// Whether the run ended because it could not go on.
  bool failed() const;
  /// Whether a program scored: what it would say now nobody asks, because who reads a record starts nothing.
  bool scored_by_program() const;
};

/// Throws Error for a directory without a recorded tap, a damaged one, and one whose config is not that of its id.
Recording read_recording(const Workshop& workshop, const std::filesystem::path& directory);

/// Stands in for a backend where nothing is tapped: tap() throws.
std::shared_ptr<Backend> no_backend(bool truth_known);

/// What was read of the belief when the tap of `row` was chosen, by the models that the row tells of.
Quantities recorded_quantities(const Row& row);

/// Brings the models of a recorded run to the state that they had after any of its taps, from the taps alone: what is
/// read of them there is what the run would have read. Writes nothing, moves nothing, builds no backend: which
/// approaches that of a run from any side reached is recorded with each tap. Behind the last tap it counts as reaching
/// all. Where a program scored, taps are chosen as the record has it, and none behind the last.
class Playback {
 public:
  /// Before the first tap. `workshop` and `recording` must outlive it. Throws Error for what only building finds out.
  ///
  /// The objects of the scene serve the truth alone. Where they cannot be built any more, because a file of theirs is
  /// gone or another by now, the desk is bare: the models are the same, and no truth is known.
  Playback(const Workshop& workshop, const Recording& recording);

  /// Why the truth, which the run knew, is not known any more; none where it is, or where the run did not know it.
  const std::optional<Error>& truth_lost() const { return truth_lost_; }

  /// Takes in the recorded taps up to the `taps`-th, from 0 to all; never back.
  void advance_to(int taps);
  int taps() const { return taps_; }

  /// The result as of now. Where the truth is lost, with the errors that the record has of this state.
  RunResult result();

  /// The experiment as of now: beliefs, errors, and the tap that it would choose next. Not to be run.
  Experiment& experiment() { return *experiment_; }
  /// The same, of a run that taps from above. Throws Error for another.
  FromAbove& from_above() { return from_above_of(*experiment_, recording_.directory.string()); }

 private:
  const Recording& recording_;
  std::optional<Error> truth_lost_;
  std::unique_ptr<Experiment> experiment_;
  int taps_ = 0;
};

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
  /// Why those that need the truth are left out; none where they are not: see Playback::truth_lost().
  std::optional<Error> truth_lost;
  std::vector<Difference> differences;
};

/// Sends the recorded taps of a run through the same models and compares every number but clocks, memory and host, as
/// text, bit for bit.
/// Writes nothing, moves nothing: see Playback.
ReplayReport replay_run(const Workshop& workshop, const std::filesystem::path& directory);

/// Returns the summaries that a run, which ended well, would have had after each of its taps but the last. Each equals
/// that of a run whose budget ends there, in all that depends on the config alone: choosing a tap looks at no budget,
/// and reading a model changes none. Only the engines are those that `engine: {type: auto}` took for the run's own
/// budget; where it would take another for less, numbers may differ as far as `engine.accuracy` lets them. Throws Error
/// where the run knew the truth and that is lost, see Playback.
///
/// Of the rest the record knows this much: `compute.*` are the sums of the recorded times so far; `wall_seconds` and
/// `compute_seconds` the share of the run's own that these sums have in those of all taps; the memory, which nobody
/// measured then, is null. The id is that of the run.
std::vector<Row> earlier_summaries(const Workshop& workshop, const Recording& recording);

}  // namespace palpate
