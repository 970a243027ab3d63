// SPDX-License-Identifier: MIT
// Arguments about the jobs of a sweep that `palpate sweep` and `palpate resume` have in common.
#pragma once

#include "cli/command_line.hpp"
#include "launch/launcher.hpp"

namespace palpate::cli {

struct LaunchArguments {
  std::string launcher = kLocal;
  std::optional<int> workers;  ///< parallel jobs; on a cluster: per task
  int attempts = 3;            ///< starts per job, after which the job counts as failed
  bool quiet = false;
  bool watch = false;
  std::string junit;
  // Only for clusters:
  ClusterOptions cluster;
  std::optional<int> jobs_per_task;
  bool wait = false;
};

/// Adds the options and returns --quiet.
Argument add_launch(const Command& command, LaunchArguments& launch);

/// Throws Error for options that exclude each other, and for a JUnit file that cannot be written.
void check_launch(const LaunchArguments& launch);

}  // namespace palpate::cli
