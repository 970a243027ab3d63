// SPDX-License-Identifier: MIT
// How long a sweep will compute, before it begins: a few of its jobs are tried out on the scene itself. No backend is
// made, nothing moves, nothing is written.
#pragma once

#include "experiment/resolved.hpp"

#include <palpate/plugin.hpp>

#include <cstddef>
#include <functional>
#include <optional>

namespace palpate {

/// What a job computes and writes, on this machine, in the mean over those that were tried.
struct Estimate {
  double job_seconds = 0.0;
  bool at_least = false;  ///< some were broken off and their rest was taken to be like their beginning
};

/// Tries up to sixteen of the jobs 0 to `jobs` - 1, spread over all, for a twentieth of a second each, in a child
/// process. None when that child broke down or took too long over it. What a backend takes, be it a robot or a
/// simulator that keeps pace, is not in it.
std::optional<Estimate> estimate_job(const PluginFactory& factory,
                                     const std::function<ResolvedConfig(std::size_t job)>& config_of, std::size_t jobs);

}  // namespace palpate
