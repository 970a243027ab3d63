// SPDX-License-Identifier: MIT
#include "sweep/results_after_taps.hpp"

#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace palpate {
namespace {

/// Returns the row of a job at the checkpoint `occasion`, or the last row if the job does not reach it. `rows` has one
/// row per tap.
Row row_at(const Checkpoint& occasion, const std::vector<Row>& rows) {
  std::size_t taps = 1;
  while (taps < rows.size() && !occasion.has_come(static_cast<int>(taps), rows[taps - 1])) ++taps;
  Row row = rows[taps - 1];
  if (!occasion.taps()) row.add(kReached, occasion.has_come(static_cast<int>(taps), row));
  return row;
}

}  // namespace

std::optional<std::vector<std::vector<Row>>> results_at(const Sweep& sweep, const std::vector<Checkpoint>& occasions,
                                                        const std::function<bool(const TapSummaries&)>& complete) {
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const Checkpoint& one : occasions) fewest = std::min(fewest, static_cast<std::size_t>(one.taps().value_or(0)));
  std::vector<std::vector<std::optional<Row>>> at(occasions.size(), std::vector<std::optional<Row>>(sweep.jobs.size()));
  const TapSummaries summaries(
      sweep,
      [&](std::size_t job, const std::vector<Row>& rows) {
        for (std::size_t i = 0; i < occasions.size(); ++i) at[i][job] = row_at(occasions[i], rows);
      },
      fewest);
  std::size_t most = 0;
  for (const std::optional<Row>& summary : summaries.whole()) most = std::max(most, summary ? taps_made(*summary) : 0);
  for (const Checkpoint& one : occasions) {
    if (most == 0 || static_cast<std::size_t>(one.taps().value_or(0)) <= most) continue;
    throw Error("command line", fmt::format("--at: no job made {} taps", *one.taps()),
                fmt::format("the most are {}", most));
  }
  if (!complete(summaries)) return std::nullopt;
  summaries.read_missing();
  std::vector<std::vector<Row>> out;
  for (std::size_t i = 0; i < occasions.size(); ++i) {
    for (std::size_t job = 0; job < sweep.jobs.size(); ++job) {
      if (!at[i][job]) at[i][job] = summaries.whole()[job];
    }
    out.push_back(sweep_results(sweep, std::move(at[i])));
    write_file(sweep.directory / fmt::format("results_{}.csv", occasions[i].key()), to_csv(out.back()));
  }
  return out;
}

}  // namespace palpate
