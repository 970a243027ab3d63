// SPDX-License-Identifier: MIT
// Comparisons that the config of a sweep plans before the first run: its block `compare:`.
#pragma once

#include "analysis/compare.hpp"
#include "config/tree.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// The checked block. Example:
///
///     compare:
///       metric: rmse_m             column of results.csv, or a list: the first decides, the others are secondary
///       by: acquisition            swept key, or a list of keys, whose values define the groups
///       baseline: uncertainty      group with which the others are compared; default: all pairs
///       where: first_hit_tap <= 3  condition on the jobs; default: none
///       seeds: 40                  number of seeds of each group
///       difference: 1 mm           smallest difference of the first metric that matters; default: none
struct ComparePlan {
  /// Throws Error, with the source location, for an invalid block. Swept keys, groups and seeds are checked by check().
  explicit ComparePlan(const Tree& block);

  /// Throws Error unless the keys of `by` form groups in this sweep, the baseline is one of the groups, and each group
  /// has the planned number of seeds. The jobs need no results.
  void check(const Sweep& sweep) const;

  /// Returns "rmse_m by acquisition, baseline uncertainty, 40 seeds, differences from 1 mm matter".
  std::string words() const;

  std::vector<std::string> metrics;
  std::vector<std::string> by;
  std::optional<std::string> baseline;
  std::optional<std::string> where;
  std::size_t seeds = 0;
  std::optional<double> difference;  ///< in the unit of the first metric (SI); above 0
  std::string hash;                  ///< 12 hex digits: hash of the block
  Tree written;                      ///< the block
};

/// Returns the plan in the config of a sweep; nullopt if there is none, or `none`. Throws Error for an invalid plan.
std::optional<ComparePlan> plan_in(const Tree& config);

/// Returns the plan that all `records` (sweeps and runs) have in their configs; nullopt if a record has no plan or
/// another one. Throws Error for a damaged config.
std::optional<ComparePlan> recorded_plan(const std::vector<std::filesystem::path>& records);

/// Stores the plan of the records in the comparisons, and returns a line that states whether they were planned.
/// `comparisons`: one per metric. `is_planned`: whether they are the comparison of the plan.
std::string mark_planned(std::vector<Comparison>& comparisons, const std::optional<ComparePlan>& plan, bool is_planned);

}  // namespace palpate
