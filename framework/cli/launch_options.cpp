// SPDX-License-Identifier: MIT
#include "cli/launch_options.hpp"

#include "cli/gate.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <utility>

namespace palpate::cli {

Argument add_launch(const Command& command, LaunchArguments& launch) {
  command.argument("-j", launch.workers, "N",
                   "number of jobs that a sweep runs in parallel; default: number of cores, or 1 in a Slurm task",
                   {between(1, kMaxWorkers)});
  command.argument("--attempts", launch.attempts, "N",
                   "maximum number of starts per job. After this number, the job counts as failed",
                   {at_least(1), with_default()});
  const Argument quiet = command.flag("--quiet", launch.quiet, "show no progress");
  command.flag("--watch", launch.watch, kWatchHelp);
  command.argument("--junit", launch.junit, "FILE", kJunitHelp);
  command.argument("--launcher", launch.launcher, "NAME",
                   "place where the jobs run: this machine, or a cluster under Slurm",
                   {one_of({kLaunchers.begin(), kLaunchers.end()}), with_default()});
  const char* const slurm = "With --launcher slurm";
  command.argument("--partition", launch.cluster.partition, "NAME",
                   "Slurm partition for the jobs; default: the cluster's default partition", {below(slurm)});
  command.argument("--task-time", launch.cluster.time, "TIME",
                   "time limit of a Slurm task, in the format of sbatch, for example 1:30:00", {below(slurm)});
  command.argument("--account", launch.cluster.account, "NAME", "Slurm account that is charged for the jobs",
                   {below(slurm)});
  command.argument("--sbatch", launch.cluster.words, "OPTION",
                   "further option for sbatch, dashes included, for example --sbatch=--mem=4G",
                   {one_per_option(), below(slurm)});
  command.argument("--jobs-per-task", launch.jobs_per_task, "N",
                   "number of jobs per Slurm task; default: 1. Option -j sets how many of these jobs run in parallel",
                   {at_least(1), below(slurm)});
  command.flag("--wait", launch.wait, "wait until all jobs have ended; Ctrl-C cancels the jobs", {below(slurm)});
  return quiet;
}

void check_launch(const LaunchArguments& launch) {
  const bool on_cluster = is_cluster(launch.launcher);
  const std::pair<const char*, bool> given[]{
      {"--partition", !launch.cluster.partition.empty()},    {"--task-time", !launch.cluster.time.empty()},
      {"--account", !launch.cluster.account.empty()},        {"--sbatch", !launch.cluster.words.empty()},
      {"--jobs-per-task", launch.jobs_per_task.has_value()}, {"--wait", launch.wait}};
  for (const auto& [name, is_given] : given) {
    if (!is_given || on_cluster) continue;
    throw Error("command line", fmt::format("{} needs a cluster, but the launcher is '{}'", name, launch.launcher),
                "add --launcher slurm, or leave it out");
  }
  if (on_cluster && !launch.junit.empty() && !launch.wait)
    throw Error("command line", "--junit: results exist only after all jobs have ended",
                "add --wait, or use --junit with 'palpate resume' afterwards");
  check_junit(launch.junit);
}

}  // namespace palpate::cli
