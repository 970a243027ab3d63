// SPDX-License-Identifier: MIT
// Decides which settings of a race lose, from paired results on the same seeds.
#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

/// Results of the settings of a race: one row per setting, one column per seed. Less is better. All values are finite.
using RaceTable = std::vector<std::vector<double>>;

/// A setting that lost against the best one.
struct Loser {
  std::size_t row = 0;      ///< its row in the RaceTable
  std::size_t seeds = 0;    ///< number of seeds on which it lost
  double difference = 0.0;  ///< mean of its differences to the best setting, above 0
  double p = 0.0;           ///< probability of such a difference by chance, one-sided
};

/// Returns the mean of each row.
std::vector<double> means_of(const RaceTable& table);

/// Returns the rows in the order of their means, the best first. Of equal means, the earlier row comes first.
std::vector<std::size_t> ranked(const RaceTable& table);

/// Returns the settings whose paired differences to the best setting have p < `alpha`, the worst first, but leaves at
/// least `keep` settings. The table needs at least two columns.
///
/// The test is a t test with a moderated variance (Smyth 2004, Linear models and empirical Bayes methods, Statistical
/// Applications in Genetics and Molecular Biology 3): the variance s^2 of the differences of a setting on k seeds
/// becomes
/// ((k - 1) s^2 + m v) / (k - 1 + m), where v is the median of s^2 over the better half of the settings. It has k - 1 +
/// m degrees of freedom; m is 4, or the number of settings less 2 if this is smaller. A plain t test on 4 seeds drops
/// good settings whose differences vary little by chance.
std::vector<Loser> find_losers(const RaceTable& table, double alpha, std::size_t keep);

/// Returns the settings that another setting dominates: with p < `alpha`, they are worse in one of two tables, and in
/// the other one worse or equal on all seeds. Leaves at least `keep` settings. Loser::difference and p are those of the
/// table in which the setting is worse, `table` first.
std::vector<Loser> find_dominated(const RaceTable& table, const RaceTable& costs, double alpha, std::size_t keep);

/// Returns the settings that no other setting dominates by the means of both tables, in the order of `table`.
std::vector<std::size_t> front_of_means(const RaceTable& table, const RaceTable& costs);

/// Returns an upper bound on the disadvantage of any setting: the largest upper end of the one-sided 95 % interval of
/// the mean difference to the best setting, with the variance of find_losers(). At least 0; 0 for a single setting, and
/// if all settings have equal results.
double largest_disadvantage(const RaceTable& table);

}  // namespace palpate
