// SPDX-License-Identifier: MIT
#include "sweep/plan.hpp"

#include "sweep/expand.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Whether the swept key is one of `expect:`.
bool is_expectation(const Axis& axis) { return axis.key == "expect" || axis.key.compare(0, 7, "expect.") == 0; }

}  // namespace

SweepPlan plan_sweep(Composer& composer, const PluginHost& host, const fs::path& file,
                     const std::vector<std::string>& words, const fs::path& runs, const JobSink& sink) {
  SweepPlan plan;
  plan.file = file;
  std::vector<Axis> axes;
  for (const std::string& text : words) axes.push_back(parse_axis(text));
  // What is expected holds for the whole sweep: it is no axis, and it enters no id.
  std::vector<Override> expectations;
  for (const Axis& axis : axes) {
    if (!is_expectation(axis)) continue;
    if (axis.values.size() != 1) {
      throw Error(axis.values.front().place.text(), fmt::format("{}: what is expected cannot be swept", axis.key),
                  "give it one value");
    }
    expectations.push_back({axis.key, axis.values.front()});
  }
  const Tree base = composer.compose(file, expectations);
  std::vector<Axis> all;
  if (const Tree* described = base.find("sweep")) all = config_axes(*described);
  for (const Axis& axis : axes) {
    if (is_expectation(axis)) continue;
    const auto same = std::find_if(all.begin(), all.end(), [&](const Axis& one) { return one.key == axis.key; });
    if (same != all.end()) {
      *same = axis;
    } else {
      all.push_back(axis);
    }
  }
  if (all.empty()) throw Error(file.string(), "nothing to sweep", "give KEY=V1,V2 or a 'sweep:' in the config");
  Tree grid = Tree::map();
  for (const Axis& axis : all) {
    plan.sweep.keys.push_back(axis.key);
    Tree& values = grid.at(axis.key);
    values = Tree::list();
    values.items = axis.values;
  }

  std::map<std::string, int> seen;
  for (const Combination& combination : product(all)) {
    // The sweep's own record decides whether surfaces are kept: not by default.
    std::vector<Override> overrides = combination;
    overrides.insert(overrides.end(), expectations.begin(), expectations.end());
    if (base.find_path("log.surface") == nullptr) {
      Tree off = Tree::scalar("false");
      off.set_layer(kGroupLayer);
      overrides.push_back({"log.surface", off});
    }
    ResolvedConfig config = load_experiment(composer, host, file, overrides);
    Job job{static_cast<int>(plan.sweep.jobs.size()), config.id, {}};
    for (const Override& one : combination) job.values.push_back(value_text(one.value));
    const auto [twin, is_new] = seen.emplace(job.id, job.index);
    if (!is_new) {
      throw Error(file.string(), fmt::format("jobs {} and {} of the sweep are the same run", twin->second, job.index),
                  "a swept key has no effect in one of them, or a value stands twice");
    }
    if (sink) sink(job, config);
    if (plan.sweep.jobs.empty()) {
      plan.name = config.options.name;
      plan.config = std::move(config.tree);
    }
    plan.sweep.jobs.push_back(std::move(job));
    plan.overrides.push_back(std::move(overrides));
  }
  plan.config.at("sweep").at("grid") = std::move(grid);
  plan.sweep.directory = runs / slug(plan.name) / sweep_id(plan.config, plan.sweep.jobs);
  return plan;
}

ResolvedConfig planned_config(const SweepPlan& plan, Composer& composer, const PluginHost& host, std::size_t index) {
  return load_experiment(composer, host, plan.file, plan.overrides[index]);
}

}  // namespace palpate
