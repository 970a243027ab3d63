// SPDX-License-Identifier: MIT
#include "tune/planner.hpp"

#include "config/catch_error.hpp"
#include "sweep/plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate {

TunePlanner::TunePlanner(Composer& composer, const PluginHost& host, const std::filesystem::path& file,
                         const TuneDescription& description)
    : composer_(composer),
      host_(host),
      file_(composer.found(file)),
      description_(description),
      base_(composer.compose(file_, {})),
      shared_(shared_overrides({}, base_)),
      keys_(description.job_keys()) {
  own_ = resolved(SettingValues(description.keys.size()), std::nullopt);
  space_.emplace(description.keys, find_whole_keys());
  // A scene that cannot be resolved is an error before the race, not in the round that needs it.
  for (std::size_t scene = 1; description_.scenes && scene < description_.scenes->values.size(); ++scene)
    resolved(SettingValues(description.keys.size()), scene);
}

void TunePlanner::JobValues::add(const std::string& key, const Tree& value) {
  axes.push_back({key, {value}, value});
  combination.push_back({&axes.back(), 0});
}

TunePlanner::JobValues TunePlanner::job_values(const SettingValues& values, std::optional<std::size_t> seed) const {
  JobValues out;
  if (description_.scenes) {
    const std::vector<Tree>& scenes = description_.scenes->values;
    out.add(description_.scenes->key, scenes[seed.value_or(0) % scenes.size()]);
  }
  for (const SweepAxis& one : description_.fixed) {
    if (one.key != "seed" || !seed) out.add(one.key, one.values.front());
  }
  for (std::size_t key = 0; key < values.size(); ++key) {
    if (values[key]) out.add(description_.keys[key].key, *values[key]);
  }
  if (seed) out.add("seed", Tree::scalar(std::to_string(own_->options.seed + static_cast<std::int64_t>(*seed))));
  return out;
}

ResolvedConfig TunePlanner::resolved(const SettingValues& values, std::optional<std::size_t> seed) const {
  const JobValues job = job_values(values, seed);
  std::vector<Override> overrides = shared_;
  for (Override& one : overrides_of(job.combination)) overrides.push_back(std::move(one));
  return resolve_experiment(composer_.compose(file_, overrides), host_);
}

bool TunePlanner::is_valid(const SettingValues& values) const {
  return !catch_error([&] { resolved(values, 0); });
}

/// Returns for each key whether its option takes whole numbers only: it accepts the first whole number of the range,
/// but not the next number that is not whole. Options that only some choices have are tried with several settings.
std::vector<bool> TunePlanner::find_whole_keys() const {
  constexpr std::size_t kTrials = 16;
  std::vector<bool> out(description_.keys.size());
  const SearchSpace space(description_.keys, out);
  const std::vector<Point> points = space.sobol(kTrials);
  for (std::size_t key = 0; key < out.size(); ++key) {
    const auto& range = description_.keys[key].range;
    if (!range || !range->unit.empty() || range->last - range->first < 1.0) continue;
    const Tree& written = description_.keys[key].written;
    out[key] = std::any_of(points.begin(), points.end(), [&](const Point& point) {
      SettingValues values = values_in(space, point);
      for (std::size_t other = 0; other < values.size(); ++other) {
        if (description_.keys[other].range && other != key) values[other].reset();
      }
      values[key] = number(std::ceil(range->first), "", written);
      if (!is_valid(values)) return false;
      values[key] =
          number(0.5 * (std::ceil(range->first) + std::min(std::ceil(range->first) + 1.0, range->last)), "", written);
      return !is_valid(values);
    });
  }
  return out;
}

SettingValues TunePlanner::values_in(const SearchSpace& space, const Point& point) {
  SettingValues out;
  for (std::size_t key = 0; key < point.size(); ++key) out.emplace_back(space.value(key, point[key]));
  return out;
}

bool TunePlanner::is_wanted(const SettingValues& values) const {
  if (description_.where.empty()) return true;
  const Tree setting = resolved(values, 0).tree;
  const WhereCondition::Values value_of = [&](const std::string& name) -> std::optional<WhereCondition::Value> {
    bool is_known = own_->tree.find_path(name) != nullptr;
    for (std::size_t key = 0; key < values.size(); ++key) {
      if (description_.keys[key].key != name) continue;
      if (values[key] && setting.find_path(name) != nullptr) return WhereCondition::Value{condition_text(*values[key])};
      is_known = true;
    }
    const Tree* found = setting.find_path(name);
    if (found != nullptr) return WhereCondition::Value{condition_text(*found)};
    return is_known ? std::optional(WhereCondition::Value{}) : std::nullopt;
  };
  std::vector<std::string> known;
  for (const TunedKey& one : description_.keys) known.push_back(one.key);
  return std::all_of(description_.where.begin(), description_.where.end(),
                     [&](const WhereCondition& one) { return one.holds(value_of, known); });
}

std::vector<Job> TunePlanner::plan(const std::vector<PlannedSetting>& settings, std::size_t first, bool is_first,
                                   const JobSink& sink) const {
  std::deque<JobValues> jobs;
  std::size_t begin = settings.front().first_seed;
  std::size_t end = 0;
  for (const PlannedSetting& one : settings) {
    begin = std::min(begin, one.first_seed);
    end = std::max(end, one.end_seed);
  }
  SweepPlanner planner(composer_, host_, file_, keys_, shared_, SweepPlanner::Repeats::dropped, first);
  for (std::size_t seed = begin; seed < end; ++seed) {
    for (const PlannedSetting& one : settings) {
      if (seed < one.first_seed || seed >= one.end_seed) continue;
      jobs.push_back(job_values(one.values, seed));
      planner.add(jobs.back().combination, sink);
    }
  }
  if (is_first) planner.finish();
  return planner.take_jobs();
}

Tree TunePlanner::written() const {
  Tree out = written_config(file_, base_, own_, keys_, *own_);
  out.at("tune") = description_.written;
  return out;
}

}  // namespace palpate
