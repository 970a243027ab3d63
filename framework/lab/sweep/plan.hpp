// SPDX-License-Identifier: MIT
// A sweep before it begins: from the description in the config and on the command line to the jobs, every one of them
// resolved and checked.
#pragma once

#include "config/compose.hpp"
#include "plugin/host.hpp"
#include "record/resolved.hpp"
#include "sweep/sweep.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// What a sweep will run.
struct SweepPlan {
  Sweep sweep;  ///< its directory is where it would be
  Tree config;  ///< what `palpate sweep` would make the same jobs of: whole where the sweep leaves it alone
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

}  // namespace palpate
