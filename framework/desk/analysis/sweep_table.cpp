// SPDX-License-Identifier: MIT
#include "analysis/sweep_table.hpp"

#include "analysis/column.hpp"
#include "analysis/groups.hpp"
#include "analysis/readable.hpp"
#include "analysis/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

std::string spread(std::vector<double> values, const char* format, double scale) {
  if (values.empty()) return "-";
  std::sort(values.begin(), values.end());
  const auto shown = [&](double share) { return fmt::format(fmt::runtime(format), quantile(values, share) * scale); };
  return fmt::format("{} ({}-{})", shown(0.5), shown(0.1), shown(0.9));
}

}  // namespace

std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results,
                        const std::function<std::optional<int>(std::size_t job)>& initial_taps) {
  const std::vector<std::string> keys = setting_keys(sweep);
  std::vector<std::vector<std::string>> lines{
      {"group", "runs", "dead starts", "found", "failed", "on-surface, live", "on-surface, all", "height cm, live"}};
  std::size_t longest = 0;
  for (const JobGroup& group : group_jobs(sweep, results, keys)) {
    std::optional<int> initial;  // taps of those that are done
    int runs = 0;
    int dead = 0;
    int found = 0;
    int failed = 0;
    std::vector<double> on_surface_live, on_surface_all, height_live;
    for (const auto& [job, row] : group.jobs) {
      if (row == nullptr) continue;
      ++runs;
      if (!is_done(*row)) {
        ++failed;
        continue;
      }
      if (!initial) initial = initial_taps(static_cast<std::size_t>(job->index));
      const std::optional<double> hit = row->number("first_hit_tap");
      const bool is_dead = !hit || !initial || *hit > *initial;
      dead += is_dead ? 1 : 0;
      found += hit ? 1 : 0;
      const std::optional<double> on_surface = row->number("on_surface_taps");
      if (on_surface) on_surface_all.push_back(*on_surface);
      if (is_dead) continue;
      if (on_surface) on_surface_live.push_back(*on_surface);
      if (const auto error = row->number("rmse_height_m")) height_live.push_back(*error);
    }
    if (runs == 0) continue;
    std::string name = key_words(sweep, *group.jobs.front().job, keys, sweep.keys.size() > 2);
    // Where the seed alone is swept there is but one, and it has no value of its own.
    if (name.empty()) name = keys.empty() ? "all seeds" : "(none)";
    longest = std::max(longest, name.size());
    const int done = runs - failed;
    const auto share = [&](int count) { return done > 0 ? fmt::format("{:.1f}%", 100.0 * count / done) : "-"; };
    lines.push_back({name, std::to_string(runs), initial ? share(dead) : "-", share(found), std::to_string(failed),
                     spread(on_surface_live, "{:.0f}", 1.0), spread(on_surface_all, "{:.0f}", 1.0),
                     spread(height_live, "{:.1f}", 100.0)});
  }
  // Long names stand at the end of their lines, so that the numbers keep to the width of a screen.
  constexpr std::size_t kLongest = 32;
  for (std::vector<std::string>& line : lines) {
    if (longest > kLongest) std::rotate(line.begin(), line.begin() + 1, line.end());
  }
  return aligned(lines, longest > kLongest ? "rrrrrrrl" : "lrrrrrrr") +
         "dead start: no tap on the object among the initial ones; live: all others. Median (10 %-90 %).\n";
}

}  // namespace palpate
