// SPDX-License-Identifier: MIT
// Runs the open jobs of a sweep with a launcher: the part that `palpate sweep`, `palpate tune` and `palpate resume`
// share.
#pragma once

#include "cli/command_context.hpp"
#include "cli/launch_options.hpp"
#include "launch/execute_jobs.hpp"
#include "launch/launcher.hpp"
#include "record/resolved_config.hpp"
#include "sweep/sweep.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace palpate::cli {

/// A sweep that is being started or resumed.
struct SweepExecution {
  const CommandEnvironment& program;
  const Sweep& sweep;
  ResumeOptions options;
  const LaunchArguments& launch;
  std::vector<std::size_t> only;  ///< numbers of the jobs to run; if empty, all jobs
  bool one_at_a_time = false;     ///< whether a backend moves something that exists only once, such as an arm
  /// For `palpate sweep`, the config of the first job with the current expectations; nullopt for `palpate resume`.
  std::optional<ResolvedConfig> first = std::nullopt;
  /// Words of a `palpate` command that a cluster executes after the jobs; empty if there is none.
  std::vector<std::string> next = {};
};

/// Returns all jobs for which this process is responsible, including finished ones.
std::vector<std::size_t> jobs_of(const SweepExecution& execution);

/// Returns the config of a job. Returns nullopt if the config is damaged. A job with a damaged config fails when it is
/// run, and then reports the reason.
std::optional<ResolvedConfig> readable_config(const SweepExecution& execution, std::size_t job);

/// Returns all jobs that are not done, ascending.
std::vector<std::size_t> jobs_not_done(const JobStates& standing);

/// Sets `one_at_a_time` if a config requires it. Without --force, throws Error if another build started one of these
/// jobs.
void check_builds(SweepExecution& execution, const std::vector<std::size_t>& jobs);

/// Returns the entry of the launcher in the table of launchers. Throws Error for options that the launcher rejects.
const LauncherType& checked_launcher(const LaunchArguments& launch);

/// Throws Error if the taps of the sweep are made by a Python program (backend `caller`).
void check_taps_are_own(const ResolvedConfig& config, const std::string& place);

/// Checks the locks of the file system, starts the watcher if it is wanted, and prepares the program for interrupts and
/// for the end of its reader. Call it once before launch_open().
void begin_execution(const SweepExecution& execution);

/// State of the jobs after the launch. `ended_unrecorded`: all jobs have ended, but some ends or files could not be
/// recorded. `blocked`: a job could not begin, for a reason that applies to all jobs and was printed on stderr.
enum class LaunchOutcome { submitted, ended, ended_unrecorded, blocked };

/// Runs all open jobs and returns when they have ended. On a cluster without --wait, returns after the jobs are
/// submitted.
LaunchOutcome launch_open(const SweepExecution& execution, const JobStates& begun);

}  // namespace palpate::cli
