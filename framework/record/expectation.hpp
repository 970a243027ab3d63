// SPDX-License-Identifier: MIT
// `expect:` of a config, read strictly: what the summary of a run, or the summaries of a sweep, must say for the
// program to end with 0. What is expected does not change what a run computes, so it stays out of the id.
// record/gate.hpp judges runs by it.
#pragma once

#include "config/relation.hpp"
#include "config/resolve.hpp"
#include "config/tree.hpp"

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// The key that stands for the number of runs that failed; it is no field of the summary.
inline constexpr const char* kFailedRuns = "failed_runs";

/// One line of `expect:`: a field of the summary, or a statistic of it over the runs, compared with a value.
struct Expectation {
  enum class Statistic { each, mean, quantile };  ///< `each`: every single run has to fulfil it

  std::string key;  ///< as written: "found", "median(object_taps)"
  std::string field;
  Statistic statistic = Statistic::each;
  double share = 0.5;                     ///< of a quantile: 0 for min, 0.5 for median, 1 for max
  Relation comparison = Relation::equal;  ///< never `unequal`
  double bound = 0.0;                     ///< SI; of a flag 1 or 0
  std::string text;                       ///< of a field that is text: what it has to be
  std::string unit;                       ///< in which the bound was written, "" for none
  std::string wanted;                     ///< ">= 12", as messages quote it
  std::string place;                      ///< "file:line:column" or "command line"
};

/// Reads the map behind `expect:` (null for none): KEY: COMPARISON, or a list of comparisons which must all hold. A key
/// is `failed_runs`, a field of the summary, or STATISTIC(field). Nested maps are keys joined by dots. Throws Error
/// with place, reason and the nearest known name for anything else.
std::vector<Expectation> read_expectations(const Tree* expect);

/// The same as a flat map of texts, which reads back as the same expectations, and where each was written.
Tree resolved_expect(const Tree& expect, ResolveNotes& notes);

/// The names that a statistic may have: mean, median, min, max, p5, ...
std::vector<std::string> statistic_names();

}  // namespace palpate
