// SPDX-License-Identifier: MIT
// The rounds of a tuned sweep: plans the first one, and decides and appends the next one.
#pragma once

#include "sweep/plan.hpp"
#include "sweep/sweep.hpp"
#include "tune/planner.hpp"
#include "tune/race.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A setting that has run in a race.
struct RacedSetting {
  std::vector<std::string> values;  ///< values of the tuned keys, as in Job::values
  std::vector<std::size_t> jobs;    ///< its jobs on the first seeds, in the order of the seeds
  std::vector<std::size_t> fresh;   ///< its jobs on fresh seeds, likewise
  std::size_t left_out_of = 0;      ///< first stage into which it was not taken although it had not lost; 0: none
};

/// A race as the manifest of its sweep has it.
struct RaceRecord {
  std::vector<RacedSetting> settings;  ///< setting 0 is the config as it stands
  RaceState state;                     ///< after the last round
  std::vector<Loser> losers;           ///< of all rounds; Loser::row is the number of a setting
  std::string end;                     ///< reason why the race ended; "" if it goes on
  std::vector<std::size_t> front;  ///< the winner, or the settings on the front of metric and cost; only if it ended
  std::size_t race_jobs = 0;       ///< number of jobs without those on fresh seeds
  double seconds = 0.0;            ///< wall time until the last decision, if the budget is a time; else 0

  bool has_ended() const { return !end.empty(); }
};

/// Reads the race of a sweep with rounds. Throws Error for a damaged round.
RaceRecord read_race(const Sweep& sweep, const TuneDescription& description);

/// The results of the jobs of a race; nullopt for a run that failed or has no finite value.
struct RaceValues {
  std::vector<std::optional<double>> metric;  ///< the metric, or its negative if more is better: less is better
  std::vector<std::optional<double>> cost;    ///< empty if there is no cost
  std::size_t unfinished = 0;                 ///< number of jobs that had not ended
};

/// Appends the results of the jobs after the first `out.metric.size()`. Before a decision, all jobs must have ended.
void read_results(const Sweep& sweep, const TuneDescription& description, RaceValues& out);

/// Writes configs of jobs again if they were deleted, because a job without its config cannot be run. Throws Error if
/// the groups of such a job were changed since it was planned.
void replace_lost(const TunePlanner& planner, const Sweep& sweep, const RaceRecord& race);

/// Returns one row per setting: its results in the order of the seeds. A missing result counts as the worst result of
/// the whole race, because a setting whose runs fail must not win.
RaceTable race_table(const RaceRecord& race, const std::vector<std::optional<double>>& results);

/// Returns the directory of the race. Its last part is a hash of the config with the block `tune:`.
std::filesystem::path race_directory(const TunePlanner& planner, const std::filesystem::path& runs);

/// Plans the first round: the config as it stands, and settings that fill the space, on the first seeds. `budget`:
/// number of jobs of the whole race. Throws Error if the budget does not suffice for the first round.
SweepPlan plan_first_round(const TunePlanner& planner, std::size_t budget, const std::filesystem::path& runs,
                           const JobSink& sink);

/// Decides the next round from the results, creates the directories of its jobs, and appends the round to the manifest.
/// `rounds`: number of rounds whose jobs have all ended. If another process has added a round meanwhile, does nothing
/// and returns true. `seconds`: wall time of the race so far. `budget`: number of jobs of the whole race. `results`:
/// those that read_results() appended in earlier calls. Returns false if the race has ended.
///
/// Throws Error if most runs so far have no value, or if the groups of the settings in the race were changed since
/// their first run.
bool add_round(const TunePlanner& planner, const std::filesystem::path& directory, std::size_t rounds,
               std::size_t budget, double seconds, RaceValues& results);

}  // namespace palpate
