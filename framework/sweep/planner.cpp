// SPDX-License-Identifier: MIT
#include "sweep/planner.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

/// Returns whether the plugins of a job lack the option, both at its own path and at all paths that inherit it.
bool is_left_out(const std::string& key, const Tree& composed, const ResolveNotes& notes) {
  const auto dropped = [&](const std::string& path) {
    return std::any_of(notes.dropped.begin(), notes.dropped.end(), [&](const ResolveNotes::Origin& one) {
      return path == one.path || path.compare(0, one.path.size() + 1, one.path + ".") == 0;
    });
  };
  if (!dropped(key)) return false;
  const std::vector<std::string> heirs = config_keys().heirs_of(key);
  return std::none_of(heirs.begin(), heirs.end(),
                      [&](const std::string& heir) { return composed.find_path(heir) != nullptr && !dropped(heir); });
}

std::string unswept_text(const std::string& key, const Tree& composed, const Tree& resolved) {
  const Tree* has = resolved.find_path(key);
  if (has == nullptr) return {};
  const Tree* said = composed.find_path(key);
  return condition_text(said != nullptr ? *said : *has);
}

}  // namespace

SweepPlanner::SweepPlanner(Composer& composer, const PluginHost& host, const std::filesystem::path& file,
                           const std::vector<std::string>& keys, const std::vector<Override>& shared, Repeats repeats,
                           std::size_t first)
    : composer_(composer),
      host_(host),
      file_(file),
      shared_(shared),
      keys_(keys),
      repeats_(repeats),
      first_(first),
      uses_(keys.size()) {
  for (std::size_t i = 0; i < keys_.size(); ++i) key_numbers_.emplace(keys_[i], i);
}

void SweepPlanner::add(const Combination& combination, const JobSink& sink) {
  std::vector<Override> overrides = shared_;
  for (Override& one : overrides_of(combination)) overrides.push_back(std::move(one));
  const Tree composed = composer_.compose(file_, overrides);
  const ResolvedConfig resolved = resolve_experiment(composed, host_);
  Job job{static_cast<int>(first_ + jobs_.size()), resolved.id, values_of(combination, composed, resolved)};
  const auto [twin, is_new] = seen_.emplace(job.id, jobs_.size());
  if (!is_new) {
    if (identities_[twin->second] != resolved.identity)
      throw Error(
          file_.string(),
          fmt::format("jobs {} and {} of the sweep have the same id {} by chance", twin->second, job.index, job.id),
          "sweep another seed");
    if (repeats_ == Repeats::dropped || differs_by_what_is_left_out(twin->second, job, combination)) return;
    throw same_run(jobs_[twin->second], job);
  }
  sink(job, resolved);
  jobs_.push_back(std::move(job));
  identities_.push_back(resolved.identity);
  combinations_.push_back(&combination);
}

void SweepPlanner::finish() const {
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    const auto& [asker, takes_part, siblings] = uses_[i];
    if (takes_part || asker == nullptr) continue;
    const std::string hint = suggestion(last_key(keys_[i]), {siblings.begin(), siblings.end()});
    throw Error(asker->values.front().place.text(), fmt::format("no job of the sweep has an option '{}'", keys_[i]),
                hint.empty() ? "remove it" : hint);
  }
}

/// Returns the values of a job at all swept keys.
std::vector<std::string> SweepPlanner::values_of(const Combination& combination, const Tree& composed,
                                                 const ResolvedConfig& resolved) {
  std::vector<std::string> values(keys_.size());
  std::vector<bool> said(keys_.size());
  for (const SweptValue& setting : combination) {
    const std::size_t key = key_numbers_.at(setting.axis->key);
    said[key] = true;
    uses_[key].asker = setting.axis;
    if (is_left_out(setting.axis->key, composed, resolved.notes)) {
      note_siblings(key, resolved.notes);
      continue;
    }
    uses_[key].takes_part = true;
    values[key] = value_text(setting.value());
  }
  // A key that only other combinations set keeps the value from the config in this job.
  for (std::size_t key = 0; key < keys_.size(); ++key) {
    if (!said[key]) values[key] = unswept_text(keys_[key], composed, resolved.tree);
  }
  return values;
}

void SweepPlanner::note_siblings(std::size_t key, const ResolveNotes& notes) {
  const std::string scope = keys_[key].substr(0, keys_[key].rfind('.') + 1);
  for (const ResolveNotes::Origin& one : notes.origins) {
    const std::string rest = one.path.compare(0, scope.size(), scope) == 0 ? one.path.substr(scope.size()) : "";
    if (!rest.empty() && rest != "type" && rest.find('.') == std::string::npos) uses_[key].siblings.insert(rest);
  }
}

/// Returns whether the settings of two equal jobs differ only in options that the plugins of the jobs lack.
bool SweepPlanner::differs_by_what_is_left_out(std::size_t twin, const Job& job, const Combination& combination) const {
  if (jobs_[twin].values != job.values) return false;
  bool any = false;
  const Combination& other = *combinations_[twin];
  for (const Combination* one : {&combination, &other}) {
    for (const SweptValue& setting : *one) {
      const bool left_out =
          job.values[key_numbers_.at(setting.axis->key)].empty() && !value_text(setting.value()).empty();
      any = any || left_out;
      if (left_out || one == &other) continue;
      // A repeated value in a list is an error.
      for (const SweptValue& same : other) {
        if (same.axis == setting.axis && same.digit != setting.digit) return false;
      }
    }
  }
  return any;
}

Error SweepPlanner::same_run(const Job& twin, const Job& job) const {
  std::vector<std::string> differing;
  for (std::size_t key = 0; key < keys_.size(); ++key) {
    if (twin.values[key] != job.values[key]) differing.push_back(keys_[key]);
  }
  const std::string reason = fmt::format("jobs {} and {} of the sweep are the same run", twin.index, job.index);
  if (differing.empty()) return {file_.string(), reason, "a value occurs twice: write it once"};
  return {file_.string(), fmt::format("{} though they differ in {}", reason, fmt::join(differing, ", ")),
          "this has no effect there: remove it, or values that are written differently but equal"};
}

}  // namespace palpate
