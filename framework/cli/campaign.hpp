// SPDX-License-Identifier: MIT
// What `sweep` and `resume` do alike once they know the jobs: choose a launcher, show progress, tell the result.
#pragma once

#include "cli/commands.hpp"
#include "launch/conduct.hpp"
#include "launch/local_launcher.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace palpate::cli {

struct Campaign {
  const Sweep& sweep;
  LocalLauncher::Configs config_of;  ///< of a job
  ResumeOptions options;
  const LaunchArguments& launch;
  std::vector<std::size_t> only;  ///< these jobs; none for all
  bool one_at_a_time = false;     ///< a job's backend moves what exists only once
};

/// Jobs at a time on this machine or, on a cluster, in a task: one where only one can be.
int workers_of(const Campaign& campaign);

/// Throws Error if a job that is to run, or with `done_too` one that is done, was begun by another build, unless that
/// is forced: before the first job runs. Notes whether only one may run at a time.
void check_builds(const Program& program, Campaign& campaign, bool done_too);

/// conduct(), with a line of progress.
void conduct_shown(const Program& program, const Campaign& campaign, Launcher& launcher, const Missing& missing);

/// Submits what is `missing` to Slurm. Then it says how to go on and returns false or, with --wait, waits for the end
/// and returns true.
bool run_on_slurm(const Program& program, const Campaign& campaign, const Missing& missing);

/// Runs what is missing, prints the result and judges it. Returns the exit status.
int run_campaign(Program& program, const Campaign& campaign);

}  // namespace palpate::cli
