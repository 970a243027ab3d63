// SPDX-License-Identifier: MIT
#include "sweep/plan.hpp"

#include "config/catch_error.hpp"
#include "config/yaml.hpp"
#include "sweep/description.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// The use of one swept key by the jobs planned so far.
struct KeyUse {
  const SweepAxis* asker = nullptr;  ///< axis that sets the key; null if no combination has set it yet
  bool takes_part = false;           ///< whether some job has the option
  std::set<std::string> siblings;    ///< options with the same parent as the key, for the hint of an error
};

/// Makes the jobs of a sweep one by one.
class SweepPlanner {
 public:
  /// `shared`: overrides of all jobs, applied before the overrides of a job's combination.
  SweepPlanner(Composer& composer, const PluginHost& host, const fs::path& file, const std::vector<std::string>& keys,
               const std::vector<Override>& shared)
      : composer_(composer), host_(host), file_(file), shared_(shared), keys_(keys), uses_(keys.size()) {
    for (std::size_t i = 0; i < keys_.size(); ++i) key_numbers_.emplace(keys_[i], i);
  }

  /// Adds the job of a combination. The combination must outlive this object.
  void add(const Combination& combination, const JobSink& sink) {
    std::vector<Override> overrides = shared_;
    for (Override& one : overrides_of(combination)) overrides.push_back(std::move(one));
    const Tree composed = composer_.compose(file_, overrides);
    const ResolvedConfig resolved = resolve_experiment(composed, host_);
    Job job{static_cast<int>(jobs_.size()), resolved.id, values_of(combination, composed, resolved)};
    const auto [twin, is_new] = seen_.emplace(job.id, jobs_.size());
    if (!is_new) {
      if (identities_[twin->second] != resolved.identity) {
        throw Error(
            file_.string(),
            fmt::format("jobs {} and {} of the sweep have the same id {} by chance", twin->second, job.index, job.id),
            "sweep another seed");
      }
      if (differs_by_what_is_left_out(twin->second, job, combination)) return;
      throw same_run(jobs_[twin->second], job);
    }
    sink(job, resolved);
    jobs_.push_back(std::move(job));
    identities_.push_back(resolved.identity);
    combinations_.push_back(&combination);
  }

  /// Throws Error for a swept key that no job uses.
  void finish() {
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      const auto& [asker, takes_part, siblings] = uses_[i];
      if (takes_part || asker == nullptr) continue;
      const std::string hint = suggestion(last_key(keys_[i]), {siblings.begin(), siblings.end()});
      throw Error(asker->values.front().place.text(), fmt::format("no job of the sweep has an option '{}'", keys_[i]),
                  hint.empty() ? "remove it" : hint);
    }
  }

  std::vector<Job> take_jobs() { return std::move(jobs_); }

 private:
  /// Returns the values of a job at all swept keys.
  std::vector<std::string> values_of(const Combination& combination, const Tree& composed,
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

  /// Returns whether the plugins of a job lack the option, both at its own path and at all paths that inherit it.
  static bool is_left_out(const std::string& key, const Tree& composed, const ResolveNotes& notes) {
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

  void note_siblings(std::size_t key, const ResolveNotes& notes) {
    const std::string scope = keys_[key].substr(0, keys_[key].rfind('.') + 1);
    for (const ResolveNotes::Origin& one : notes.origins) {
      const std::string rest = one.path.compare(0, scope.size(), scope) == 0 ? one.path.substr(scope.size()) : "";
      if (!rest.empty() && rest != "type" && rest.find('.') == std::string::npos) uses_[key].siblings.insert(rest);
    }
  }

  static std::string unswept_text(const std::string& key, const Tree& composed, const Tree& resolved) {
    const Tree* has = resolved.find_path(key);
    if (has == nullptr) return {};
    const Tree* said = composed.find_path(key);
    return condition_text(said != nullptr ? *said : *has);
  }

  /// Returns whether the settings of two equal jobs differ only in options that the plugins of the jobs lack.
  bool differs_by_what_is_left_out(std::size_t twin, const Job& job, const Combination& combination) const {
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

  Error same_run(const Job& twin, const Job& job) const {
    std::vector<std::string> differing;
    for (std::size_t key = 0; key < keys_.size(); ++key) {
      if (twin.values[key] != job.values[key]) differing.push_back(keys_[key]);
    }
    const std::string reason = fmt::format("jobs {} and {} of the sweep are the same run", twin.index, job.index);
    if (differing.empty()) return {file_.string(), reason, "a value occurs twice: write it once"};
    return {file_.string(), fmt::format("{} though they differ in {}", reason, fmt::join(differing, ", ")),
            "this has no effect there: remove it, or values that are written differently but equal"};
  }

  Composer& composer_;
  const PluginHost& host_;
  const fs::path& file_;
  const std::vector<Override>& shared_;
  const std::vector<std::string>& keys_;
  std::vector<Job> jobs_;
  std::vector<std::string> identities_;           ///< by job
  std::vector<const Combination*> combinations_;  ///< by job
  std::unordered_map<std::string, std::size_t> key_numbers_;
  std::unordered_map<std::string, std::size_t> seen_;  ///< job number by id
  std::vector<KeyUse> uses_;                           ///< by key
};

/// Returns the top-level keys in the order of a resolved config.
std::vector<std::string> ordered_keys(const Tree& base, const Tree& resolved) {
  std::vector<std::string> out;
  for (const Tree* tree : {&resolved, &base}) {
    for (const Tree::Entry& entry : tree->entries) {
      if (base.find(entry.key) == nullptr || entry.key == "name" || entry.key == "sweep") continue;
      if (std::find(out.begin(), out.end(), entry.key) == out.end()) out.push_back(entry.key);
    }
  }
  return out;
}

/// Returns whether swept keys affect the options below a top-level key.
bool is_touched(const std::string& top, const std::vector<std::string>& swept) {
  return std::any_of(swept.begin(), swept.end(), [&](const std::string& key) {
    if (key == kStrategy) return true;
    for (const std::string& heir : config_keys().heirs_of(key)) {
      if (first_key(heir) == top) return true;
    }
    return is_choice(key) && config_keys().is_decided(top, first_key(key));
  });
}

/// Returns a config from which `palpate sweep` makes the same jobs again. Keys that the sweep does not affect are
/// written in full, groups included. Keys that depend on swept groups or types are written as in `file`, because the
/// options of one choice must not remain with another.
///
/// `base`: `file` composed without a combination. `alone`: `base` resolved, or nullopt if it is incomplete. `first`:
/// the first job, which defines the order of the keys.
Tree written_config(const std::filesystem::path& file, const Tree& base, const std::optional<ResolvedConfig>& alone,
                    const SweepDescription& description, const ResolvedConfig& first) {
  const Tree own = read_yaml(file);
  // The options that the config's own plugins lack are removed.
  Tree settled = base;
  if (alone) {
    for (const ResolveNotes::Origin& one : alone->notes.dropped) settled.erase_path(one.path);
  }
  const auto is_own = [&](const std::string& top) {
    return top != "expect" && (!alone || is_touched(top, description.keys()));
  };
  Tree out = Tree::map();
  const Tree* name = base.find("name");
  out.at("name") = Tree::scalar(name != nullptr ? name->text : first.options.name, true);
  // The groups of a strategy cannot be distinguished here, so the whole strategy is kept if any of them is needed.
  const bool needs_strategy = !alone || std::any_of(description.keys().begin(), description.keys().end(), is_choice);
  Tree kept = Tree::list();
  if (const Tree* defaults = own.find("defaults")) {
    for (const Tree& item : defaults->items) {
      const std::string group = first_key(item.entries.front().key);
      if (group == kStrategy ? needs_strategy : is_own(group)) kept.items.push_back(item);
    }
  }
  if (const Tree* strategy = own.find(kStrategy); strategy != nullptr && needs_strategy) {
    kept.items.push_back(Tree::map());
    kept.items.back().at(kStrategy) = *strategy;
  }
  if (!kept.items.empty()) out.at("defaults") = std::move(kept);
  for (const std::string& top : ordered_keys(base, first.tree)) {
    const Tree* said = is_own(top) ? own.find(top) : settled.find(top);
    if (said != nullptr) out.at(top) = *said;
  }
  out.at("sweep") = description.written();
  return out;
}

/// Returns the overrides for all jobs: the expectations, and an override that turns off the recording of surfaces
/// unless `base` sets `log.surface`.
std::vector<Override> shared_overrides(const SweepOverrides& words, const Tree& base) {
  std::vector<Override> out = words.expectations;
  if (base.find_path("log.surface") == nullptr) {
    out.push_back({"log.surface", Tree::scalar("false")});
    out.back().value.set_layer(kGroupLayer);
  }
  return out;
}

}  // namespace

SweepPlan plan_sweep(Composer& composer, const PluginHost& host, const fs::path& named,
                     const std::vector<std::string>& words, const fs::path& runs, const JobSink& sink) {
  const SweepOverrides read = parse_sweep_words(words);
  const fs::path file = composer.found(named);
  const Tree base = composer.compose(file, read.expectations);
  const SweepDescription description(base.find("sweep"), read);
  if (description.keys().empty()) {
    throw Error(file.string(), "nothing to sweep", "give KEY=V1,V2 or a 'sweep:' in the config");
  }
  const std::vector<Override> shared = shared_overrides(read, base);
  // The config without a combination. It is nullopt if the config is incomplete because only the sweep sets the missing
  // keys. Other errors in the config are found when the jobs are resolved.
  std::optional<ResolvedConfig> alone;
  catch_error([&] { alone = resolve_experiment(base, host); });
  const WhereCondition::Values base_value = [&](const std::string& name) -> std::optional<WhereCondition::Value> {
    if (first_key(name) == "sweep") return std::nullopt;
    const Tree* found = base.find_path(name);
    if (found == nullptr && alone) found = alone->tree.find_path(name);
    return found != nullptr ? std::optional(WhereCondition::Value{condition_text(*found)}) : std::nullopt;
  };
  std::optional<ResolvedConfig> first;
  SweepPlanner planner(composer, host, file, description.keys(), shared);
  for (const Combination& combination : description.combinations()) {
    if (!description.wanted(combination, base_value)) continue;
    planner.add(combination, [&](const Job& job, const ResolvedConfig& config) {
      if (!first) first = config;
      if (sink) sink(job, config);
    });
  }
  if (!first) {
    throw Error(description.where_place(),
                fmt::format("sweep.where: matches none of the {} combinations", description.combinations().size()),
                "relax the condition, or sweep other values");
  }
  planner.finish();
  SweepPlan plan{{{}, description.keys(), planner.take_jobs()}, written_config(file, base, alone, description, *first)};
  check_readable(plan.config, file.string());
  plan.sweep.directory = runs / slug(first->options.name) / sweep_id(plan.config, plan.sweep);
  return plan;
}

}  // namespace palpate
