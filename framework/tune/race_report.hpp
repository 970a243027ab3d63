// SPDX-License-Identifier: MIT
// Results of a race: the table for the terminal, the rows of race.csv, the gain on fresh seeds, and best.yaml.
#pragma once

#include "analysis/statistics.hpp"
#include "config/display_units.hpp"
#include "record/row.hpp"
#include "tune/tuner.hpp"

#include <string>
#include <vector>

namespace palpate {

/// A race that has ended or goes on, and its results. All arguments of the constructor must outlive the object.
struct RaceResults {
  /// `race_values`: the results of all jobs (read_results()).
  RaceResults(const Sweep& race_sweep, const TuneDescription& tuned, const RaceRecord& record,
              const RaceValues& race_values);

  const Sweep& sweep;
  const TuneDescription& description;
  const RaceRecord& race;
  const RaceValues& values;
  std::vector<double> means;  ///< mean of each setting over its seeds in the race; missing values count as in the race
  DisplayScale scale;         ///< of the means
  /// Gain of the winner compared with the config as it stands: the mean difference over the fresh seeds, above 0 if the
  /// winner is better. A missing value counts as the worst one of all runs. MeanEstimate::count is 0 on a front, and
  /// without fresh seeds or before their end.
  MeanEstimate gain;
  /// The settings whose configs are written: the settings on the front, or the winner. In place of a winner that is
  /// worse on the fresh seeds (95 % interval of the gain below 0), the config as it stands. Empty while the race goes
  /// on.
  std::vector<std::size_t> best;

  bool is_best(std::size_t setting) const;
};

/// Returns one row per setting: number, values of the tuned keys, number of seeds, mean, and for a setting that left
/// the race the number of seeds after which it left. A setting that lost also has its difference to the best one and p.
/// The row of the winner has the gain on fresh seeds. In SI units.
std::vector<Row> race_rows(const RaceResults& results);

/// Returns the best settings of a race that has ended in readable units, the config as it stands, the reason of the
/// end, and the gain.
std::string race_text(const RaceResults& results);

/// Returns the tuned keys of a setting with their values, for example "taps=17 kernel=rbf".
std::string settings_words(const RaceResults& results, std::size_t setting);

/// Returns "config as it stands", "best" or the reason why a setting left the race; "" if there is nothing to remark.
std::string remark_about(const RaceResults& results, std::size_t setting);

/// Returns the sentence about the fresh seeds of a race that has ended, or the reason why there are none. With a cost,
/// returns the number of settings on the front.
std::string fresh_words(const RaceResults& results);

/// Returns the config of a setting as YAML, with the course of the race as a comment.
std::string config_of_setting(const RaceResults& results, std::size_t setting);

}  // namespace palpate
