// SPDX-License-Identifier: MIT
// What `sweep` and `resume` do alike once they know the jobs: choose a launcher, show progress, tell the result.
#pragma once

#include "cli/commands.hpp"
#include "sweep/conduct.hpp"
#include "sweep/local_launcher.hpp"
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

/// Throws Error if a job of the sweep was begun by another build: by its first tap, for none of them.
void check_builds(const Program& program, const Campaign& campaign);

/// Runs what is missing, prints the result and judges it. Returns the exit status.
int run_campaign(Program& program, const Campaign& campaign);

/// The jobs in "0-7,12", ascending, each once. Throws Error for what is none of `count`.
std::vector<std::size_t> parse_jobs(const std::string& text, std::size_t count);

}  // namespace palpate::cli
