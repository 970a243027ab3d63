// SPDX-License-Identifier: MIT
#include "cli/sweep_execution.hpp"

#include "cli/display.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "cli/sweep_display.hpp"
#include "cli/watcher.hpp"
#include "config/catch_error.hpp"
#include "launch/mounts.hpp"
#include "launch/parallel_children.hpp"
#include "launch/slurm_launcher.hpp"
#include "record/files.hpp"
#include "report/words/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <memory>

namespace palpate::cli {
namespace {

bool is_on_cluster(const SweepExecution& execution) { return is_cluster(execution.launch.launcher); }

LaunchOptions launch_options(const SweepExecution& execution) {
  const LaunchArguments& launch = execution.launch;
  const int workers = launch.workers.value_or(is_on_cluster(execution) ? 1 : cores());
  return {execution.one_at_a_time ? 1 : workers,
          execution.options,
          launch.attempts,
          execution.only.empty(),
          execution.one_at_a_time,
          launch.cluster,
          launch.jobs_per_task.value_or(1)};
}

/// Prints the commands that show, resume and stop the jobs on a cluster.
void print_next_commands(const SweepExecution& execution, const Launcher& launcher) {
  const std::string directory = shell_word(std::filesystem::absolute(execution.sweep.directory).string());
  print_out("watch progress with: palpate status {}\n", directory);
  if (execution.next.empty())
    print_out("run missing jobs afterwards with: palpate resume {} --launcher {}\n", directory,
              execution.launch.launcher);
  print_out("stop: {}\n", launcher.stop_command());
}

}  // namespace

std::vector<std::size_t> jobs_of(const SweepExecution& execution) {
  return execution.only.empty() ? all_jobs(execution.sweep) : execution.only;
}

std::optional<ResolvedConfig> readable_config(const SweepExecution& execution, std::size_t job) {
  std::optional<ResolvedConfig> config;
  catch_error(
      [&] { config = load_run(execution.program.host, job_directory(execution.sweep, execution.sweep.jobs[job])); });
  return config;
}

std::vector<std::size_t> jobs_not_done(const JobStates& standing) {
  std::vector<std::size_t> out = standing.open;
  for (const FailedJob& one : standing.failures) out.push_back(one.job);
  std::sort(out.begin(), out.end());
  return out;
}

void check_builds(SweepExecution& execution, const std::vector<std::size_t>& jobs) {
  for (const std::size_t job : jobs) {
    const std::filesystem::path directory = job_directory(execution.sweep, execution.sweep.jobs[job]);
    const std::optional<ResolvedConfig> config = readable_config(execution, job);
    if (!config) continue;
    execution.one_at_a_time = execution.one_at_a_time || execution.program.host.one_at_a_time(config->notes.plugins);
    std::optional<Error> objection;
    catch_error([&] { objection = objection_to_build(execution.program, *config, read_run_record(directory)); });
    if (objection && !execution.options.force) throw *objection;
  }
}

const LauncherType& checked_launcher(const LaunchArguments& launch) {
  const LauncherType& out = launcher_type(launch.launcher);
  if (out.check_options != nullptr) out.check_options(launch.cluster);
  return out;
}

void check_taps_are_own(const ResolvedConfig& config, const std::string& place) {
  if (config.options.backend.type != kCaller) return;
  throw Error(place, "the taps of this sweep are made by the caller's own program, not by palpate",
              "create it with palpate.begin_sweep() in Python, and run its jobs with experiments()");
}

void begin_execution(const SweepExecution& execution) {
  const std::filesystem::path& directory = execution.sweep.directory;
  check_locks(directory);
  // A node that runs a part of the jobs may mount the folder with other options than the node that submitted the jobs.
  if (is_on_cluster(execution) || !execution.only.empty()) check_shared_locks(directory);
  listen_for_interrupts();
  outlive_reader();
  set_record_line("resume with: palpate resume " + directory.string());
  if (execution.one_at_a_time && execution.sweep.jobs.size() > 1 && !execution.launch.quiet)
    print_message("jobs run one at a time, because the backend moves only one arm\n");
  if (execution.launch.watch) start_watcher(execution.program, directory);
}

LaunchOutcome launch_open(const SweepExecution& execution, const JobStates& begun) {
  const auto print_array = [](const TaskArray& array) {
    print_out("array {}: {}, {}, logs in {}\n", array.id, counted(array.tasks, "task"), counted(array.jobs, "job"),
              array.logs.string());
    if (!array.doubt.empty())
      print_message(fmt::format("no node can run array {} now: {}; 'sinfo' shows the nodes\n", array.id, array.doubt));
    flush_output();
  };
  const CommandEnvironment& program = execution.program;
  const std::unique_ptr<Launcher> launcher =
      launcher_type(execution.launch.launcher).make({program, execution.sweep, launch_options(execution), print_array});
  if (is_on_cluster(execution)) {
    if (begun.open.empty() || program.interrupted->load()) return LaunchOutcome::ended;  // There is nothing to submit.
    if (!execution.launch.wait) {
      launcher->submit(begun.open);
      if (!execution.next.empty()) launcher->continue_with(execution.next);
      print_next_commands(execution, *launcher);
      return LaunchOutcome::submitted;
    }
    // If the terminal is closed, the program stops waiting, but the jobs continue. Under nohup, the program continues
    // to wait.
    if (std::signal(SIGHUP, SIG_DFL) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  }
  SweepLine line(execution.launch.quiet);
  bool blocked = false;
  const bool all_recorded =
      execute_jobs(*launcher, execution.sweep, begun, program.interrupted, [&](const SweepProgress& progress) {
        blocked = progress.blocked;
        line.show(progress);
      });
  return blocked ? LaunchOutcome::blocked : all_recorded ? LaunchOutcome::ended : LaunchOutcome::ended_unrecorded;
}

}  // namespace palpate::cli
