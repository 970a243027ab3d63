// SPDX-License-Identifier: MIT
#include "cli/campaign.hpp"
#include "launch/slurm_launcher.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <csignal>
#include <cstdio>

namespace palpate::cli {
namespace {

/// A terminal that is closed ends the waiting, not the jobs; under nohup not even that.
void leave_jobs_at_hangup() {
  if (std::signal(SIGHUP, SIG_DFL) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

std::string counted(int count, const char* what) { return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s"); }

void print_array(const SlurmArray& array) {
  fmt::print("array {}: {}, {}, logs in {}\n", array.id, counted(array.tasks, "task"), counted(array.jobs, "job"),
             array.logs.string());
  std::fflush(stdout);
}

}  // namespace

bool run_on_slurm(const Program& program, const Campaign& campaign, const Missing& missing) {
  const LaunchArguments& launch = campaign.launch;
  SlurmOptions options;
  options.partition = launch.partition;
  options.time = launch.time;
  options.account = launch.account;
  options.more = launch.sbatch;
  options.jobs_per_task = launch.jobs_per_task.value_or(1);
  options.workers = workers_of(campaign);
  options.tasks_at_once = campaign.one_at_a_time ? 1 : 0;
  options.most_attempts = launch.attempts;
  options.resume = campaign.options;
  std::string ids;
  SlurmLauncher launcher(program.installation.program, campaign.sweep, options, [&](const SlurmArray& array) {
    print_array(array);
    ids += fmt::format(" {}", array.id);
  });
  if (program.workshop.interrupted->load()) return true;  // before anything was submitted
  if (launch.wait) {
    leave_jobs_at_hangup();
    conduct_shown(program, campaign, launcher, missing);
    return true;
  }
  launcher.submit(missing.jobs);
  const std::string directory = shell_word(std::filesystem::absolute(campaign.sweep.directory).string());
  fmt::print("look: palpate status {}\n", directory);
  fmt::print("carry on what is missing then: palpate resume {} --launcher slurm\n", directory);
  fmt::print("stop: scancel{}\n", ids);
  return false;
}

}  // namespace palpate::cli
