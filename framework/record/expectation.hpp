// SPDX-License-Identifier: MIT
// Reads `expect:` of a config: conditions on the summary of a run, or on the summaries of a sweep. The program exits
// with status 0 only if all conditions hold. Expectations do not change the results of a run, so they are not part of
// its id. record/gate.hpp checks them.
#pragma once

#include "config/comparison.hpp"
#include "config/resolve.hpp"
#include "config/tree.hpp"

#include <string>
#include <vector>

namespace palpate {

/// The key of the number of failed runs, which is not a field of the summary.
inline constexpr const char* kFailedRuns = "failed_runs";

/// One line of `expect:`. It compares a field of the summary, or a statistic of this field over the runs, with a value.
struct Expectation {
  enum class Statistic { each, mean, quantile };  ///< `each`: every single run must fulfil the condition

  std::string key;  ///< as written: "found", "median(object_taps)"
  std::string field;
  Statistic statistic = Statistic::each;
  double share = 0.5;                     ///< share of the quantile: 0 for min, 0.5 for median, 1 for max
  Relation comparison = Relation::equal;  ///< never `unequal`
  double bound = 0.0;                     ///< SI; for a flag 1 or 0
  std::string text;                       ///< required value of a text field
  std::string unit;                       ///< unit in which the bound was written; "" for none
  std::string wanted;                     ///< ">= 12", as messages quote it
  std::string place;                      ///< "file:line:column" or "command line"
};

/// Reads the map `expect:` (may be null). An entry is KEY: COMPARISON, or KEY: [COMPARISON, ...], where all comparisons
/// must hold. A key is `failed_runs`, a field of the summary, or STATISTIC(field). The keys of nested maps are joined
/// by dots. For anything else, throws Error with the source location, the reason and the most similar known name.
std::vector<Expectation> read_expectations(const Tree* expect);

/// Returns the expectations as a flat map of texts. read_expectations() converts this map to the same expectations.
/// Adds the source location of each expectation to `notes`.
Tree resolved_expect(const Tree& expect, ResolveNotes& notes);

/// Returns the names of the statistics: mean, median, min, max, p5, ...
std::vector<std::string> statistic_names();

}  // namespace palpate
