// SPDX-License-Identifier: MIT
// Plans a sweep: makes resolved and checked jobs from its description.
#pragma once

#include "config/compose.hpp"
#include "host/plugin_host.hpp"
#include "record/resolved_config.hpp"
#include "sweep/sweep.hpp"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// A planned sweep.
struct SweepPlan {
  Sweep sweep;  ///< contains the directory that the sweep will have
  Tree config;  ///< config from which `palpate sweep` makes the same jobs
};

/// A function that is called with each job after its check, in the order of the jobs.
using JobSink = std::function<void(const Job& job, const ResolvedConfig& config)>;

/// Composes, resolves and checks all jobs of `file` and `words`, the words after `palpate sweep CONFIG`: see
/// SweepDescription. Options that the plugin of a job lacks are dropped, and jobs that become equal in this way are
/// merged. Throws Error for jobs that are equal for another reason, and for a swept option that no job has. Writes
/// nothing.
SweepPlan plan_sweep(Composer& composer, const PluginHost& host, const std::filesystem::path& file,
                     const std::vector<std::string>& words, const std::filesystem::path& runs,
                     const JobSink& sink = nullptr);

}  // namespace palpate
