// SPDX-License-Identifier: MIT
// Plans a sweep: makes resolved and checked jobs from its description.
#pragma once

#include "config/compose.hpp"
#include "host/plugin_host.hpp"
#include "record/resolved_config.hpp"
#include "sweep/planner.hpp"
#include "sweep/sweep.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// A planned sweep.
struct SweepPlan {
  Sweep sweep;  ///< contains the directory that the sweep will have
  Tree config;  ///< config from which `palpate sweep` makes the same jobs
};

/// Composes, resolves and checks all jobs of `file` and `words`, the words after `palpate sweep CONFIG`: see
/// SweepDescription. Options that the plugin of a job lacks are dropped, and jobs that become equal in this way are
/// merged. Throws Error for jobs that are equal for another reason, and for a swept option that no job has. Writes
/// nothing.
SweepPlan plan_sweep(Composer& composer, const PluginHost& host, const std::filesystem::path& file,
                     const std::vector<std::string>& words, const std::filesystem::path& runs,
                     const JobSink& sink = nullptr);

/// Returns a config from which the same jobs can be made again, without its blocks `sweep:`, `tune:` and `compare:`.
/// Keys that the jobs do not vary are written in full, groups included. Keys that depend on varied groups or types are
/// written as in `file`, because the options of one choice must not remain with another.
///
/// `base`: `file` composed without the values of a job. `alone`: `base` resolved, or nullopt if it is incomplete.
/// `keys`: all keys that the jobs vary. `first`: the first job, which defines the order of the keys.
Tree written_config(const std::filesystem::path& file, const Tree& base, const std::optional<ResolvedConfig>& alone,
                    const std::vector<std::string>& keys, const ResolvedConfig& first);

/// Returns the overrides of all jobs of a sweep: the expectations, and an override that turns off the recording of
/// surfaces unless `base` sets `log.surface`.
std::vector<Override> shared_overrides(const std::vector<Override>& expectations, const Tree& base);

}  // namespace palpate
