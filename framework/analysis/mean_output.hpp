// SPDX-License-Identifier: MIT
// Output of means and their intervals, as text and as fields of rows. Texts format numbers as in
// config/display_units.hpp.
#pragma once

#include "analysis/column.hpp"
#include "analysis/statistics.hpp"
#include "config/display_units.hpp"
#include "config/text_layout.hpp"
#include "reading/read_file.hpp"

#include <palpate/options.hpp>

#include <functional>
#include <optional>
#include <string>

namespace palpate {

/// Returns "3.21 [3.02, 3.40]", with numbers formatted by `number`. If there is no interval, returns "3.21 [-]".
std::string with_interval(double value, const std::optional<MeanInterval>& ends,
                          const std::function<std::string(double)>& number);

template <class Mean>
std::string DisplayScale::estimate(const Mean& mean) const {
  if (mean.count == 0) return "-";
  return with_interval(mean.mean, mean.interval, [&](double value) { return number(value); });
}

/// Returns the number of units of statistics (StatisticalUnits) as text: "5 seeds", "1 job".
std::string units_words(std::size_t units, bool seeds);
/// Returns "3 to 5 seeds", or "5 seeds" if both numbers are 5.
std::string units_words(std::size_t least, std::size_t most, bool seeds);

/// Least number of seeds or jobs without a remark that there are few. With fewer seeds or jobs, 95 % intervals miss the
/// true mean clearly more often than 5 times in 100.
inline constexpr std::size_t kEnoughUnits = 10;

/// Returns a remark about a mean over few seeds or jobs; "" if `units` is at least kEnoughUnits. `least` is the
/// smallest number of units that gives an interval.
std::string few_words(std::size_t units, bool seeds, std::size_t least);

/// Returns a remark about the number of jobs in a group that are copies of another run. It applies if jobs are the
/// units.
std::string copies_words(const std::string& name, std::size_t jobs, std::size_t units);

/// Adds the fields `prefix`mean, `prefix`low_95 and `prefix`high_95. Missing values are null.
void add_mean(Row& row, const std::string& prefix, const MeanEstimate& estimate);
/// Adds only the two ends of the interval.
void add_interval(Row& row, const std::string& prefix, const std::optional<MeanInterval>& ends);
/// Adds the number of jobs and the numbers per status. If `left_out` is set, also adds the number of jobs that a
/// condition leaves out.
void add_counts(Row& row, const StatusCounts& counts, bool left_out = false);

}  // namespace palpate
