// SPDX-License-Identifier: MIT
// Arguments of `palpate tune`, and the race that `palpate resume` continues.
#pragma once

#include "cli/command_line.hpp"
#include "cli/launch_options.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace palpate::cli {

struct TuneArguments {
  std::string config;
  std::vector<std::string> keys;
  std::optional<std::string> metric, cost, time, within, where;
  std::optional<int> jobs, fresh;
  std::vector<std::string> scenes;
  std::string runs = "runs";
  LaunchArguments launch;
};
PALPATE_WHOLE int tune(CommandEnvironment& program, const TuneArguments& arguments);

/// Runs the rounds of the race in `directory` until it ends. Returns the exit status.
int run_race(CommandEnvironment& program, const std::filesystem::path& directory, const LaunchArguments& launch,
             const ResumeOptions& options);

/// Checks the block `tune:` of the file `config`. Returns the number of settings of its first round. Throws Error.
PALPATE_WHOLE std::size_t check_tune(CommandEnvironment& program, const std::string& config);

inline void add_tune(CommandLine& line) {
  auto [command, tune_arguments] =
      line.add<TuneArguments>("tune", "Find the best setting of some keys with few runs", tune, kNeedsEverything);
  command.argument("CONFIG", tune_arguments.config, "CONFIG",
                   "YAML file of the experiment, optionally with a 'tune:' block", {required()});
  command.argument("KEY", tune_arguments.keys, "KEY=VALUES",
                   "key and the values among which the best one is searched, for example "
                   "kernel.length_scale=log_uniform(5mm,10cm) or acquisition=weighted,random. A single value, such as "
                   "seed=1000, applies to all runs");
  command.argument("--metric", tune_arguments.metric, "COLUMN",
                   "field of the summary whose mean over the seeds decides, for example rmse_m");
  command.argument("--cost", tune_arguments.cost, "COLUMN",
                   "second field, of which less is better, for example robot_seconds. Keep the Pareto front of both "
                   "instead of one setting");
  const Argument jobs = command.argument("--jobs", tune_arguments.jobs, "N",
                                         "budget: number of runs. The runs of --fresh are not counted", {at_least(1)});
  command.argument("--time", tune_arguments.time, "TIME", "budget in wall time instead, for example 10min",
                   {not_with(jobs)});
  command.argument("--within", tune_arguments.within, "DIFFERENCE",
                   "end when all settings left differ from the best one by at most this, for example 0.5mm");
  command.argument("--fresh", tune_arguments.fresh, "N",
                   "number of further seeds on which the best setting is compared with the config as it stands; "
                   "default: 100");
  command.argument("--over", tune_arguments.scenes, "SCENES",
                   "scenes that alternate from seed to seed, for example block,ring; default: the scene of the config",
                   {comma_separated()});
  command.argument("--where", tune_arguments.where, "CONDITION",
                   "try only settings that satisfy this condition, for example \"kernel.length_scale > 1cm\"");
  command.argument("--runs", tune_arguments.runs, "FOLDER", kRunsHelp, {with_default()});
  add_launch(command, tune_arguments.launch);
  command.examples(
      {"palpate tune configs/default.yaml \"kernel.length_scale=uniform(1cm,9cm)\" --metric rmse_m --jobs 200",
       "palpate tune configs/default.yaml belief.height.noise=2mm,6mm --metric rmse_m --jobs 90 --over t,ring"});
}

}  // namespace palpate::cli
