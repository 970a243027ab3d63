// SPDX-License-Identifier: MIT
// Arguments of `palpate sweep`, and functions about sweeps that other commands call.
#pragma once

#include "cli/command_line.hpp"
#include "cli/launch_options.hpp"

namespace palpate::cli {

struct ResumeArguments;

struct SweepArguments {
  std::string config;
  std::vector<std::string> axes;
  std::string runs = "runs";
  bool list = false;
  LaunchArguments launch;
};
PALPATE_WHOLE int sweep(CommandEnvironment& program, const SweepArguments& arguments);

PALPATE_WHOLE int resume_sweep(CommandEnvironment& program, const ResumeArguments& arguments);
PALPATE_WHOLE int status_of_sweep(CommandEnvironment& program, const std::string& directory);
/// Returns the number of jobs of the sweep in the file `config`. Throws Error for an invalid config.
PALPATE_WHOLE std::size_t jobs_of_sweep(CommandEnvironment& program, const std::string& config);
/// Checks the block `compare:` of a composed config that has no block `sweep:`. Throws Error.
PALPATE_WHOLE void check_compare(CommandEnvironment& program, const Tree& config);

inline void add_sweep(CommandLine& line) {
  auto [command, sweep_arguments] =
      line.add<SweepArguments>("sweep", "Run one experiment per combination of given values", sweep, kNeedsEverything);
  command.argument("CONFIG", sweep_arguments.config, "CONFIG",
                   "YAML file of the experiment, optionally with a 'sweep:' block", {required()});
  command.argument("AXIS", sweep_arguments.axes, "KEY=VALUES",
                   "key and the values that the sweep uses for the key, for example seed=range(0,10) or "
                   "acquisition=weighted,random or kernel.length_scale=logspace(1cm,5cm,8)");
  command.argument("--runs", sweep_arguments.runs, "FOLDER", kRunsHelp, {with_default()});
  command.flag("--list", sweep_arguments.list, "list the jobs and stop");
  add_launch(command, sweep_arguments.launch);
  command.examples({"palpate sweep configs/paper/object_i.yaml acquisition=weighted,uncertainty \"seed=range(0,10)\"",
                    "palpate sweep configs/sweep/kernels.yaml --list"});
}

}  // namespace palpate::cli
