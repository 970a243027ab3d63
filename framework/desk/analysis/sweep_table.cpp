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

struct Line {
  std::string name;
  std::optional<int> initial_taps;  ///< of those that are done
  int runs = 0;
  int dead = 0;
  int found = 0;
  int failed = 0;
  std::vector<double> on_surface_live, on_surface_all, height_live;
};

}  // namespace

std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results,
                        const std::function<std::optional<int>(std::size_t job)>& initial_taps) {
  const std::vector<std::string> keys = setting_keys(sweep);
  std::vector<Line> groups;
  for (const JobGroup& group : group_jobs(sweep, results, keys)) {
    Line line;
    line.name = key_words(keys, group.values, sweep.keys.size() > 2);
    // Where the seed alone is swept there is but one, and it has no value of its own.
    if (line.name.empty()) line.name = keys.empty() ? "all seeds" : "(none)";
    for (const auto& [job, row] : group.jobs) {
      if (row == nullptr) continue;
      ++line.runs;
      if (!is_done(*row)) {
        ++line.failed;
        continue;
      }
      if (!line.initial_taps) line.initial_taps = initial_taps(static_cast<std::size_t>(job->index));
      const std::optional<double> hit = row->number("first_hit_tap");
      const bool dead = !hit || !line.initial_taps || *hit > *line.initial_taps;
      line.dead += dead ? 1 : 0;
      line.found += hit ? 1 : 0;
      const std::optional<double> on_surface = row->number("on_surface_taps");
      if (on_surface) line.on_surface_all.push_back(*on_surface);
      if (dead) continue;
      if (on_surface) line.on_surface_live.push_back(*on_surface);
      if (const auto error = row->number("rmse_height_m")) line.height_live.push_back(*error);
    }
    if (line.runs > 0) groups.push_back(std::move(line));
  }
  // Long names stand at the end of their lines, so that the numbers keep to the width of a screen.
  constexpr std::size_t kLongest = 32;
  const bool behind =
      std::any_of(groups.begin(), groups.end(), [](const Line& group) { return group.name.size() > kLongest; });
  std::vector<std::vector<std::string>> lines{{behind ? "" : "group", "runs", "dead starts", "found", "failed",
                                               "on-surface, live", "on-surface, all", "height cm, live",
                                               behind ? "group" : ""}};
  for (const Line& group : groups) {
    const int done = group.runs - group.failed;
    const auto share = [&](int count) { return done > 0 ? fmt::format("{:.1f}%", 100.0 * count / done) : "-"; };
    const std::string& name = group.name;
    lines.push_back({behind ? "" : name, std::to_string(group.runs), group.initial_taps ? share(group.dead) : "-",
                     share(group.found), std::to_string(group.failed), spread(group.on_surface_live, "{:.0f}", 1.0),
                     spread(group.on_surface_all, "{:.0f}", 1.0), spread(group.height_live, "{:.1f}", 100.0),
                     behind ? name : ""});
  }
  return aligned(lines, "lrrrrrrrl") +
         "dead start: no tap on the object among the initial ones; live: all others. Median (10 %-90 %).\n";
}

}  // namespace palpate
