// SPDX-License-Identifier: MIT
// A sweep before it begins: from the description in the config and on the command line to the jobs, every one of them
// resolved and checked.
#pragma once

#include "config/compose.hpp"
#include "experiment/resolved.hpp"
#include "plugin/host.hpp"
#include "sweep/sweep.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// What a sweep will run. Configs are not kept, because they are large and there may be very many: a job's is composed
/// again when it is needed.
struct SweepPlan {
  std::filesystem::path file;                    ///< the config
  std::string name;                              ///< of the experiment
  Sweep sweep;                                   ///< its directory is where it would be
  Tree config;                                   ///< the resolved base with its `sweep:`
  std::vector<std::vector<Override>> overrides;  ///< what each job lays over `file`
};

/// Called for each job of a plan, in their order, once it is checked.
using JobSink = std::function<void(const Job& job, const ResolvedConfig& config)>;

/// Composes, resolves and checks every job of `file`, with `words` as typed behind `palpate sweep`: KEY=VALUES, which
/// take the place of the same key in the config's `sweep:`. Jobs that resolve to the same run are refused. Throws
/// Error; touches nothing.
SweepPlan plan_sweep(Composer& composer, const PluginHost& host, const std::filesystem::path& file,
                     const std::vector<std::string>& words, const std::filesystem::path& runs,
                     const JobSink& sink = nullptr);

/// The config of the job at `index`, as it was checked.
ResolvedConfig planned_config(const SweepPlan& plan, Composer& composer, const PluginHost& host, std::size_t index);

}  // namespace palpate
