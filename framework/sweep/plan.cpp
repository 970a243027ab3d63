// SPDX-License-Identifier: MIT
#include "sweep/plan.hpp"

#include "config/catch_error.hpp"
#include "config/yaml.hpp"
#include "sweep/description.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Returns the top-level keys in the order of a resolved config.
std::vector<std::string> ordered_keys(const Tree& base, const Tree& resolved) {
  std::vector<std::string> out;
  for (const Tree* tree : {&resolved, &base}) {
    for (const Tree::Entry& entry : tree->entries) {
      if (base.find(entry.key) == nullptr || entry.key == "name" || describes_many_runs(entry.key)) continue;
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

}  // namespace

Tree written_config(const std::filesystem::path& file, const Tree& base, const std::optional<ResolvedConfig>& alone,
                    const std::vector<std::string>& keys, const ResolvedConfig& first) {
  const Tree own = read_yaml(file);
  // The options that the config's own plugins lack are removed.
  Tree settled = base;
  if (alone) {
    for (const ResolveNotes::Origin& one : alone->notes.dropped) settled.erase_path(one.path);
  }
  const auto is_own = [&](const std::string& top) { return top != "expect" && (!alone || is_touched(top, keys)); };
  Tree out = Tree::map();
  const Tree* name = base.find("name");
  out.at("name") = Tree::scalar(name != nullptr ? name->text : first.options.name, true);
  // The groups of a strategy cannot be distinguished here, so the whole strategy is kept if any of them is needed.
  const bool needs_strategy = !alone || std::any_of(keys.begin(), keys.end(), is_choice);
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
  return out;
}

std::vector<Override> shared_overrides(const std::vector<Override>& expectations, const Tree& base) {
  std::vector<Override> out = expectations;
  if (base.find_path("log.surface") == nullptr) {
    out.push_back({"log.surface", Tree::scalar("false")});
    out.back().value.set_layer(kGroupLayer);
  }
  return out;
}

SweepPlan plan_sweep(Composer& composer, const PluginHost& host, const fs::path& named,
                     const std::vector<std::string>& words, const fs::path& runs, const JobSink& sink) {
  const SweepOverrides read = parse_sweep_words(words);
  const fs::path file = composer.found(named);
  const Tree base = composer.compose(file, read.expectations);
  const SweepDescription description(base.find("sweep"), read);
  if (description.keys().empty())
    throw Error(file.string(), "nothing to sweep", "give KEY=V1,V2 or a 'sweep:' in the config");
  const std::vector<Override> shared = shared_overrides(read.expectations, base);
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
  if (!first)
    throw Error(description.where_place(),
                fmt::format("sweep.where: matches none of the {} combinations", description.combinations().size()),
                "relax the condition, or sweep other values");
  planner.finish();
  SweepPlan plan{{{}, description.keys(), planner.take_jobs()},
                 written_config(file, base, alone, description.keys(), *first)};
  plan.config.at("sweep") = description.written();
  if (const Tree* one = base.find("compare"); one != nullptr && one->text != "none") plan.config.at("compare") = *one;
  check_readable(plan.config, file.string());
  plan.sweep.directory = runs / slug(first->options.name) / sweep_id(plan.config, plan.sweep);
  return plan;
}

}  // namespace palpate
