// SPDX-License-Identifier: MIT
// Importance of the swept keys for a metric: the share of the variance between settings that each key and each pair of
// keys explains. A setting is the set of jobs that differ only in the seed.
#pragma once

#include "analysis/table.hpp"
#include "sweep/sweep.hpp"
#include "sweep/where_condition.hpp"

#include <string>
#include <vector>

namespace palpate {

struct Importance {
  /// One row per share: first each key alone, then the interaction of each pair of keys, then the interactions of three
  /// or more keys together; each kind with its largest share first. The fields of a row:
  /// - `metric`; `keys`, joined by commas ("" for the interactions of three or more keys);
  /// - `share`, 0 to 1; the shares of all rows sum to 1, or are null if the settings differ by no more than the noise;
  /// - `low_95` and `high_95` of the share; null unless `exact`, and below kLeastForInterval seeds;
  /// - `exact`: whether every combination of the keys' values has run;
  /// - `noise`: estimated share of noise in the variance of the settings' means, which can exceed 1.
  Table table;
  std::string text;  ///< the table, with lines about the method, the seeds and the noise
};

/// Computes the importance of all keys that have several values, except the seed. `where`: condition on the jobs, or
/// null. Uses the settings and seeds that form the largest table without a gap: the settings of the seed with the
/// second largest number of settings (at least two seeds are needed), and all seeds on which each of them has a value.
///
/// If every combination of values has run, the shares are those of the functional analysis of variance over this grid
/// (Efron and Stein 1981, The jackknife estimate of variance, The Annals of Statistics 9). The mean of each seed over
/// all settings is subtracted first. A variance is the mean product of effects on two different seeds, so noise does
/// not bias it. If it is below 0, it counts as 0. Intervals are percentiles of a bootstrap over seeds, widened like
/// those of bootstrap_mean().
///
/// Otherwise, the shares are those of the mean of a Gaussian process, fitted to the means of the settings (Oakley and
/// O'Hagan 2004, Probabilistic sensitivity analysis of complex models, Journal of the Royal Statistical Society B 66).
/// Each key is averaged over its values in all settings. Time: about 7 s for 1000 settings of four keys.
///
/// Throws the errors of compare(), and Error with the place "command line" for fewer than two keys, and if no two seeds
/// have values in the same two settings.
Importance compute_importance(const Sweep& sweep, const std::vector<Row>& results, const std::string& metric,
                              const WhereCondition* where = nullptr);

}  // namespace palpate
