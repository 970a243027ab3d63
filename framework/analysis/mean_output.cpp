// SPDX-License-Identifier: MIT
#include "analysis/mean_output.hpp"

#include <fmt/format.h>

namespace palpate {

std::string with_interval(double value, const std::optional<MeanInterval>& ends,
                          const std::function<std::string(double)>& number) {
  return number(value) + (ends ? fmt::format(" [{}, {}]", number(ends->low), number(ends->high)) : " [-]");
}

std::string units_words(std::size_t units, bool seeds) {
  return fmt::format("{} {}{}", units, seeds ? "seed" : "job", units == 1 ? "" : "s");
}

std::string units_words(std::size_t least, std::size_t most, bool seeds) {
  return (least < most ? fmt::format("{} to ", least) : "") + units_words(most, seeds);
}

std::string copies_words(const std::string& name, std::size_t jobs, std::size_t units) {
  return fmt::format("{}: {} of {} jobs are copies of another run; copies count once in intervals and p\n", name,
                     jobs - units, jobs);
}

std::string few_words(std::size_t units, bool seeds, std::size_t least) {
  if (units >= kEnoughUnits) return {};
  if (units < least)
    return fmt::format("only {}: too few for an interval; run {} or more\n", units_words(units, seeds), kEnoughUnits);
  return fmt::format(
      "only {}: an interval over so few (Student's t) can miss the true mean in more than 5 of 100 cases; run {} or "
      "more\n",
      units_words(units, seeds), kEnoughUnits);
}

void add_mean(Row& row, const std::string& prefix, const MeanEstimate& estimate) {
  row.add(prefix + "mean", estimate.count > 0 ? std::optional(estimate.mean) : std::nullopt);
  add_interval(row, prefix, estimate.interval);
}

void add_interval(Row& row, const std::string& prefix, const std::optional<MeanInterval>& ends) {
  row.add(prefix + "low_95", ends ? std::optional(ends->low) : std::nullopt);
  row.add(prefix + "high_95", ends ? std::optional(ends->high) : std::nullopt);
}

void add_counts(Row& row, const StatusCounts& counts, bool left_out) {
  row.add("jobs", counts.all());
  if (left_out) row.add("left_out", counts.of(ValueStatus::left_out));
  row.add("failed", counts.of(ValueStatus::failed));
  row.add("unfinished", counts.of(ValueStatus::unfinished));
  row.add("without_value", counts.of(ValueStatus::without_value));
}

}  // namespace palpate
