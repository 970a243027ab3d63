// SPDX-License-Identifier: MIT
// Results of a race: the table for the terminal, the rows of race.csv, the gain on fresh seeds, and best.yaml.
#pragma once

#include "analysis/statistics.hpp"
#include "record/row.hpp"
#include "tune/tuner.hpp"

#include <optional>
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
  RaceTable table;  ///< race_table() of the metric
  /// Gain of the winner compared with the config as it stands: the mean difference over the fresh seeds, above 0 if the
  /// winner is better. A missing value counts as the worst one of all runs. MeanEstimate::count is 0 on a front, and
  /// without fresh seeds.
  MeanEstimate gain;
  /// The settings whose configs are written: the settings on the front, or the winner. In place of a winner that is
  /// worse on the fresh seeds (95 % interval of the gain below 0), the config as it stands. Empty while the race goes
  /// on.
  std::vector<std::size_t> best;
};

/// Returns one row per setting: number, values of the tuned keys, number of seeds, mean, and for a dropped setting the
/// number of seeds after which it lost, its difference to the best one, and p. The row of the winner has the gain on
/// fresh seeds. In SI units.
std::vector<Row> race_rows(const RaceResults& results);

/// Returns the best settings of a race that has ended in readable units, the config as it stands, the reason of the
/// end, and the gain.
std::string race_text(const RaceResults& results);

/// Texts for the page of a race.
struct RaceOfPage {
  struct Setting {
    std::string words;   ///< values of the keys
    std::string remark;  ///< "config as it stands", "best", or the reason why it lost
    bool lost = false;
    bool best = false;
  };
  std::vector<Setting> settings;
  std::string end;  ///< reason of the end and gain; "" if the race goes on
};
RaceOfPage race_of_page(const RaceResults& results);

/// Returns the config of a setting as YAML, with the course of the race as a comment.
std::string config_of_setting(const RaceResults& results, std::size_t setting);

}  // namespace palpate
