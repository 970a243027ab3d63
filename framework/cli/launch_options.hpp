// SPDX-License-Identifier: MIT
// Arguments about the jobs of a sweep, which `palpate sweep` and `palpate resume` share.
#pragma once

#include "cli/command_line.hpp"
#include "launch/launcher.hpp"

namespace palpate::cli {

struct LaunchArguments {
  std::string launcher = kLaunchers.front();
  std::optional<int> workers;  ///< number of parallel jobs; on a cluster: number per task
  int attempts = 3;            ///< maximum number of starts per job
  bool quiet = false;
  bool watch = false;
  std::string junit;
  // The remaining arguments are for clusters only.
  ClusterOptions cluster;
  std::optional<int> jobs_per_task;
  bool wait = false;
};

/// Adds the options, and returns the option --quiet.
Argument add_launch(const Command& command, LaunchArguments& launch);

/// Throws Error for cluster options without a cluster, for --junit on a cluster without --wait, and for a JUnit file
/// that cannot be written.
void check_launch(const LaunchArguments& launch);

}  // namespace palpate::cli
