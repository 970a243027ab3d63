// SPDX-License-Identifier: MIT
#include "analysis/sweep_table.hpp"

#include "analysis/readable.hpp"
#include "analysis/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

std::string text_at(const Row& row, const std::string& name) {
  const Scalar* value = row.find(name);
  return value != nullptr ? csv_cell(*value) : std::string();
}

std::optional<double> number_at(const Row& row, const std::string& name) {
  const Scalar* value = row.find(name);
  if (value == nullptr) return std::nullopt;
  if (const auto* whole = std::get_if<std::int64_t>(value)) return static_cast<double>(*whole);
  const auto* real = std::get_if<double>(value);
  return real != nullptr ? std::optional(*real) : std::nullopt;
}

std::string spread(std::vector<double> values, const char* format, double scale) {
  if (values.empty()) return "-";
  std::sort(values.begin(), values.end());
  const auto shown = [&](double share) { return fmt::format(fmt::runtime(format), quantile(values, share) * scale); };
  return fmt::format("{} ({}-{})", shown(0.5), shown(0.1), shown(0.9));
}

struct Group {
  std::string name;
  std::optional<int> initial_taps;  ///< of those that are done
  int runs = 0;
  int dead = 0;
  int found = 0;
  int failed = 0;
  std::vector<double> on_surface_live, on_surface_all, rmse_live;
};

}  // namespace

std::string sweep_table(const Sweep& sweep, const std::vector<Row>& results,
                        const std::function<std::optional<int>(std::size_t job)>& initial_taps) {
  const bool only_seeds = sweep.keys == std::vector<std::string>{"seed"};
  std::vector<Group> groups;
  for (const Row& row : results) {
    std::string name;
    for (const std::string& key : sweep.keys) {
      const std::string value = text_at(row, key);
      if (key == "seed" || value.empty()) continue;
      name += (name.empty() ? "" : ", ") + (sweep.keys.size() > 2 ? key + "=" : std::string()) + value;
    }
    // Where the seed alone is swept there is but one, and it has no value of its own.
    if (name.empty()) name = only_seeds ? "all seeds" : "(none)";
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& one) { return one.name == name; });
    if (group == groups.end()) {
      group = groups.insert(groups.end(), Group{name, {}, 0, 0, 0, 0, {}, {}, {}});
    }
    ++group->runs;
    if (text_at(row, "status") != "done") {
      ++group->failed;
      continue;
    }
    if (!group->initial_taps)
      group->initial_taps = initial_taps(static_cast<std::size_t>(std::get<std::int64_t>(*row.find("job"))));
    const std::optional<double> hit = number_at(row, "first_hit_tap");
    const bool dead = !hit || !group->initial_taps || *hit > *group->initial_taps;
    group->dead += dead ? 1 : 0;
    group->found += hit ? 1 : 0;
    const std::optional<double> on_surface = number_at(row, "on_surface_taps");
    if (on_surface) group->on_surface_all.push_back(*on_surface);
    if (dead) continue;
    if (on_surface) group->on_surface_live.push_back(*on_surface);
    if (const std::optional<double> error = number_at(row, "rmse_height_m")) group->rmse_live.push_back(*error);
  }
  // Long names stand at the end of their lines, so that the numbers keep to the width of a screen.
  constexpr std::size_t kLongest = 32;
  const bool behind =
      std::any_of(groups.begin(), groups.end(), [](const Group& group) { return group.name.size() > kLongest; });
  std::vector<std::vector<std::string>> lines{{behind ? "" : "group", "runs", "dead starts", "found", "failed",
                                               "on-surface, live", "on-surface, all", "height cm, live",
                                               behind ? "group" : ""}};
  for (const Group& group : groups) {
    const int done = group.runs - group.failed;
    const auto share = [&](int count) { return done > 0 ? fmt::format("{:.1f}%", 100.0 * count / done) : "-"; };
    const std::string name = one_line(group.name);
    lines.push_back({behind ? "" : name, std::to_string(group.runs), group.initial_taps ? share(group.dead) : "-",
                     share(group.found), std::to_string(group.failed), spread(group.on_surface_live, "{:.0f}", 1.0),
                     spread(group.on_surface_all, "{:.0f}", 1.0), spread(group.rmse_live, "{:.1f}", 100.0),
                     behind ? name : ""});
  }
  return aligned(lines, "lrrrrrrrl") +
         "dead start: no tap on the object among the initial ones; live: all others. Median (10 %-90 %).\n";
}

}  // namespace palpate
