// SPDX-License-Identifier: MIT
// A sweep before it begins: from the description in the config and on the command line to the jobs, every one of them
// resolved and checked.
#pragma once

#include "config/compose.hpp"
#include "plugin/host.hpp"
#include "record/resolved.hpp"
#include "sweep/description.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace palpate {

/// What a sweep will run. Configs are not kept, because they are large and there may be very many: a job's is made
/// again when it is needed.
struct SweepPlan {
  std::filesystem::path file;  ///< the config
  std::string name;            ///< of the experiment
  Sweep sweep;                 ///< its directory is where it would be
  Tree config;                 ///< what `palpate sweep` would make the same jobs of: see written_config()
  SweepDescription description;
  std::vector<std::size_t> combinations;  ///< of each job: its number in the description
  std::vector<Override> shared;           ///< what all jobs lay over `file` before their combination
  /// Configs of a few combinations, by their number with the first seed: those of other seeds are made from them.
  std::map<std::size_t, std::shared_ptr<const ResolvedConfig>> kept;
};

/// Called for each job of a plan, in their order, once it is checked.
using JobSink = std::function<void(const Job& job, const ResolvedConfig& config)>;

/// Composes, resolves and checks every job of `file`, with `words` as typed behind `palpate sweep`: see
/// SweepDescription. An option that the plugin of a job does not have is left out of that job, and jobs that become
/// equal thereby are one; other jobs that resolve to the same run are refused, and so is an option that no job has.
/// Throws Error; touches nothing.
SweepPlan plan_sweep(Composer& composer, const PluginHost& host, const std::filesystem::path& file,
                     const std::vector<std::string>& words, const std::filesystem::path& runs,
                     const JobSink& sink = nullptr);

/// The config of the job at `index`, as it was checked.
ResolvedConfig planned_config(const SweepPlan& plan, Composer& composer, const PluginHost& host, std::size_t index);

}  // namespace palpate
