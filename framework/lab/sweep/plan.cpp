// SPDX-License-Identifier: MIT
#include "sweep/plan.hpp"

#include "config/trouble.hpp"
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

/// What has become of a swept key in the jobs so far.
struct KeyUse {
  const Axis* asker = nullptr;  ///< once a job sets it
  bool takes_part = false;
  std::set<std::string> siblings;  ///< options that stand where the key would
};

/// Makes the jobs one by one.
class Planner {
 public:
  /// `shared` is what all jobs lay over `file` before their combination.
  Planner(Composer& composer, const PluginHost& host, const fs::path& file, const std::vector<std::string>& keys,
          const std::vector<Override>& shared)
      : composer_(composer), host_(host), file_(file), shared_(shared), keys_(keys), uses_(keys.size()) {
    for (std::size_t i = 0; i < keys_.size(); ++i) key_numbers_.emplace(keys_[i], i);
  }

  /// `combination` must outlive this.
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

  /// Throws Error for a key that no job has.
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
  /// What each key came to in a job.
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
    // Where other combinations set a key and this one does not, the table says what this one has there.
    for (std::size_t key = 0; key < keys_.size(); ++key) {
      if (!said[key]) values[key] = unswept_text(keys_[key], composed, resolved.tree);
    }
    return values;
  }

  /// Whether plugins chosen later do not have the option, neither where it stands nor where it is inherited.
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

  /// Whether two jobs that are the same run are so because of options that were left out, and for no other reason.
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
        // The same value of another place in one list is a value that stands twice.
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
  std::vector<std::string> identities_;           ///< of each job
  std::vector<const Combination*> combinations_;  ///< of each job
  std::unordered_map<std::string, std::size_t> key_numbers_;
  std::unordered_map<std::string, std::size_t> seen_;  ///< the job of each id
  std::vector<KeyUse> uses_;                           ///< of each key
};

/// Top-level keys, in the order in which a resolved config has them.
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

/// Whether what stands below the top-level key depends on what is chosen in a combination.
bool is_touched(const std::string& top, const std::vector<std::string>& swept) {
  return std::any_of(swept.begin(), swept.end(), [&](const std::string& key) {
    if (key == kStrategy) return true;
    for (const std::string& heir : config_keys().heirs_of(key)) {
      if (first_key(heir) == top) return true;
    }
    return is_choice(key) && config_keys().is_decided(top, first_key(key));
  });
}

/// A config from which `palpate sweep` makes the same jobs again. What the sweep leaves alone stands there in full,
/// groups included; where it chooses groups or types, there stands what `file` itself says, because what a group brings
/// must not outlive another choice. `base` is `file` composed without any combination, `alone` the same
/// resolved, if it is a whole config; `first` the first job, whose order of keys is taken.
Tree written_config(const std::filesystem::path& file, const Tree& base, const std::optional<ResolvedConfig>& alone,
                    const SweepDescription& description, const ResolvedConfig& first) {
  const Tree own = read_yaml(file);
  // Without the options that its own plugins leave out.
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
  // What of the groups below is a strategy's cannot be told any more: where any of it is needed all of it is.
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

}  // namespace

SweepPlan plan_sweep(Composer& composer, const PluginHost& host, const fs::path& named,
                     const std::vector<std::string>& words, const fs::path& runs, const JobSink& sink) {
  const SweepWords read = parse_sweep_words(words);
  const fs::path file = composer.found(named);
  const Tree base = composer.compose(file, read.expectations);
  const SweepDescription description(base.find("sweep"), read);
  if (description.keys().empty()) {
    throw Error(file.string(), "nothing to sweep", "give KEY=V1,V2 or a 'sweep:' in the config");
  }
  std::vector<Override> shared = read.expectations;
  if (base.find_path("log.surface") == nullptr) {
    // The sweep's own record decides whether surfaces are kept: not by default.
    shared.push_back({"log.surface", Tree::scalar("false")});
    shared.back().value.set_layer(kGroupLayer);
  }

  // The config without any combination; none if it is no whole config, as when all that it lacks is swept. What is
  // wrong with it beside that, its jobs say.
  std::optional<ResolvedConfig> alone;
  trouble_in([&] { alone = resolve_experiment(base, host); });
  const Condition::Values base_value = [&](const std::string& name) -> std::optional<Condition::Value> {
    if (first_key(name) == "sweep") return std::nullopt;
    const Tree* found = base.find_path(name);
    if (found == nullptr && alone) found = alone->tree.find_path(name);
    return found != nullptr ? std::optional(Condition::Value{condition_text(*found)}) : std::nullopt;
  };
  std::optional<ResolvedConfig> first;
  Planner planner(composer, host, file, description.keys(), shared);
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
