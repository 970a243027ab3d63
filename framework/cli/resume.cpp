// SPDX-License-Identifier: MIT
#include "cli/resume.hpp"

#include "cli/execute_run.hpp"
#include "cli/sweep.hpp"
#include "record/run_directory.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

namespace palpate::cli {
namespace {

int resume(CommandEnvironment& program, const ResumeArguments& arguments) {
  check_launch(arguments.launch);
  if (is_sweep(arguments.directory)) return call_in_whole(resume_sweep, program, arguments);
  if (!arguments.jobs.empty())
    throw Error("command line", "--jobs: " + arguments.directory + " is not a sweep", "leave it out");
  if (arguments.launch.launcher != kLaunchers.front())
    throw Error("command line",
                fmt::format("--launcher {}: {} is not a sweep", arguments.launch.launcher, arguments.directory),
                "leave it out");
  const ResolvedConfig config = load_run(program.host, arguments.directory);
  RunOutput output{!arguments.launch.quiet, false, arguments.launch.junit, arguments.step};
  if (arguments.launch.watch) output.watched = arguments.directory;
  return execute_run(program, config, output, [&](const std::vector<Observer*>& observers) {
    ResumeOptions options = arguments.options;
    options.asks_before_taps = arguments.step;
    return resume_run(program, arguments.directory, options, observers);
  });
}

}  // namespace

void add_resume(CommandLine& line) {
  auto [command, arguments] = line.add<ResumeArguments>("resume", "Resume an interrupted run or sweep", resume,
                                                        [](NeededParts& needs, const ResumeArguments& given) {
                                                          if (given.launch.watch) needs.whole();
                                                          needs.record(given.directory);
                                                        });
  command.record("DIR", arguments.directory, RecordKind::any, "run or sweep");
  command.flag("--retry-failed", arguments.options.retry_failed, "also resume failed runs");
  command.flag("--force", arguments.options.force,
               "resume even if another build of palpate or its plugins started the run");
  command.argument(
      "--jobs", arguments.jobs, "NUMBERS",
      "numbers of the sweep's jobs to resume, for example 0-7,12. Jobs that another process runs are skipped");
  const Argument quiet = add_launch(command, arguments.launch);
  command.flag("--step", arguments.step, kStepHelp, {not_with(quiet)});
  command.examples(
      {"palpate resume runs/object_i/422cd70eb5f7", "palpate resume runs/many/5b0c4e1d77aa --retry-failed -j 2"});
}

}  // namespace palpate::cli
