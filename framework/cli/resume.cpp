// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/gate.hpp"
#include "record/run_directory.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <utility>

namespace palpate::cli {

void check_launch(const LaunchArguments& launch) {
  const bool on_cluster = launch.launcher != kLocal;
  const std::pair<const char*, bool> given[]{{"--partition", !launch.partition.empty()},
                                             {"--time", !launch.time.empty()},
                                             {"--account", !launch.account.empty()},
                                             {"--sbatch", !launch.sbatch.empty()},
                                             {"--jobs-per-task", launch.jobs_per_task.has_value()},
                                             {"--wait", launch.wait}};
  for (const auto& [name, is_given] : given) {
    if (!is_given || on_cluster) continue;
    throw Error("command line", fmt::format("{} needs a cluster, but the launcher is '{}'", name, launch.launcher),
                "add --launcher slurm, or leave it out");
  }
  if (on_cluster && !launch.junit.empty() && !launch.wait) {
    throw Error("command line", "--junit: results exist only after all jobs have ended",
                "add --wait, or use --junit with 'palpate resume' afterwards");
  }
  check_junit(launch.junit);
}

int resume(Program& program, const ResumeArguments& arguments) {
  check_launch(arguments.launch);
  if (is_sweep(arguments.directory)) return resume_sweep(program, arguments);
  if (!arguments.jobs.empty()) {
    throw Error("command line", "--jobs: " + arguments.directory + " is not a sweep", "leave it out");
  }
  if (arguments.launch.launcher != kLocal) {
    throw Error("command line",
                fmt::format("--launcher {}: {} is not a sweep", arguments.launch.launcher, arguments.directory),
                "leave it out");
  }
  const ResolvedConfig config = load_run(program.host, arguments.directory);
  RunOutput output{!arguments.launch.quiet, false, arguments.launch.junit, arguments.step};
  if (arguments.launch.watch) output.watched = arguments.directory;
  return conduct_run(program, config, output, [&](Journal* display, Supervisor* step) {
    return resume_run(program, arguments.directory, arguments.options, display, step);
  });
}

}  // namespace palpate::cli
