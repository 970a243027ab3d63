// SPDX-License-Identifier: MIT
// Tables for people, whose numbers are formatted by config/scale.hpp, with columns that stand under each other; and
// those for programs, as rows.
#pragma once

#include "analysis/column.hpp"
#include "analysis/statistics.hpp"
#include "config/layout.hpp"
#include "config/scale.hpp"
#include "reading/reading.hpp"

#include <palpate/options.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// "3.21 [3.02, 3.40]" of numbers that `number` writes, "3.21 [-]" where there is no interval.
std::string with_interval(double value, const std::optional<MeanInterval>& ends,
                          const std::function<std::string(double)>& number);

template <class Mean>
std::string Scale::estimate(const Mean& mean) const {
  if (mean.count == 0) return "-";
  return with_interval(mean.mean, mean.interval, [&](double value) { return number(value); });
}

/// "5 seeds", "1 job": units of statistics.
std::string units_words(std::size_t units, bool seeds);
/// "3 to 5 seeds" where not all means have as many.
std::string units_words(std::size_t least, std::size_t most, bool seeds);

/// Fewer seeds, or jobs, are called few: their intervals miss the true mean clearly more often than 5 times in 100.
inline constexpr std::size_t kEnoughUnits = 10;

/// A line that says how few seeds, or jobs, a mean is over and what that means for its interval; "" where they are not
/// few. `least`: from so many on there is an interval.
std::string few_words(std::size_t units, bool seeds, std::size_t least);

/// A line that tells how many of a group's jobs are copies of a run, where jobs are the units.
std::string copies_words(const std::string& name, std::size_t jobs, std::size_t units);

/// Adds `prefix`mean and the ends of its interval, null where there are none.
void add_mean(Row& row, const std::string& prefix, const MeanEstimate& estimate);
/// The same of the ends alone.
void add_interval(Row& row, const std::string& prefix, const std::optional<MeanInterval>& ends);
/// Adds how many jobs there are and what became of them, on request with those that a condition leaves out.
void add_counts(Row& row, const StatusCounts& counts, bool left_out = false);

}  // namespace palpate
