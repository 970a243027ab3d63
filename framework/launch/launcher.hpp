// SPDX-License-Identifier: MIT
// The interface of launchers, which run the jobs of a sweep on this machine or on a cluster. A launcher accepts jobs
// and reports when they have ended. Only the directory of a job shows whether the job is done, because schedulers may
// report wrong states. The job itself (launch/job.hpp) guarantees that it runs only once, even if several launchers
// have accepted it.
//
// To add a launcher NAME, define the LauncherType NAME_launcher in launch/NAME_launcher.cpp, and add NAME to the table
// in palpate_sweep.cmake.
#pragma once

#include "record/run.hpp"
#include "sweep/sweep.hpp"

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

class Launcher {
 public:
  /// The result of poll().
  struct PollResult {
    std::vector<std::size_t> returned;  ///< jobs that ended or were abandoned since the last call
    bool all_recorded = true;           ///< false: a returned job could not record its end or write its files
    /// Whether a job could not start for a reason that also applies to all waiting jobs. The waiting jobs were dropped.
    bool blocked = false;
    int running = 0;  ///< number of running jobs, as far as the launcher can see
    int waiting = 0;  ///< number of waiting jobs
    bool empty_handed() const { return running == 0 && waiting == 0; }
  };

  virtual ~Launcher() = default;

  /// Accepts jobs (ascending indices into Sweep::jobs, none accepted before) and returns without waiting for them.
  /// Throws Error if no job can be accepted.
  virtual void submit(const std::vector<std::size_t>& jobs) = 0;

  /// Waits for the next event, for at most `seconds`. Returns early after a signal, and at once if no job runs or
  /// waits. Throws Error if the state of the jobs can no longer be determined.
  virtual PollResult poll(double seconds) = 0;

  /// Stops running jobs after their current tap and drops waiting jobs. poll() still returns the running jobs.
  virtual void cancel() = 0;

  /// On a cluster, lets the scheduler execute `palpate` with these words once all accepted jobs have ended. The
  /// environment variable kEndedJobs contains the number of jobs of the sweep that have ended now. Throws Error.
  virtual void continue_with(const std::vector<std::string>&) {}

  /// Returns the shell command with which a user can end the jobs that outlive this process; "" if no job outlives it.
  virtual std::string stop_command() const { return {}; }
};

/// See Launcher::continue_with().
inline constexpr const char* kEndedJobs = "PALPATE_ENDED_JOBS";

/// Options for the scheduler of a cluster.
struct ClusterOptions {
  std::string partition, time, account;  ///< texts for the scheduler; "": the default of the cluster
  std::vector<std::string> words{};      ///< further options of the scheduler, dashes included
};

struct LaunchOptions {
  int workers = 1;              ///< parallel jobs; on a cluster: parallel jobs of one task, each with its own core
  ResumeOptions resume;         ///< options of every job
  int most_attempts = 3;        ///< limit per job; a job killed in its last attempt has failed
  bool wait_for_others = true;  ///< waits for jobs that other processes run, and runs them if those processes die
  // Only for clusters:
  bool one_at_a_time = false;  ///< runs only one task of all arrays at a time
  ClusterOptions cluster{};
  int jobs_per_task = 1;
};

/// An array of tasks in the queue of a cluster.
struct TaskArray {
  int id = 0;
  int tasks = 0;
  int jobs = 0;  ///< number of jobs of all tasks
  std::filesystem::path logs;
  std::string doubt;  ///< message of the scheduler if no node can run the array now; else ""
};

/// Input for the construction of a launcher. `environment` and `sweep` must outlive the launcher.
struct LauncherSetup {
  const RunEnvironment& environment;
  const Sweep& sweep;
  LaunchOptions options;
  std::function<void(const TaskArray&)> submitted;  ///< called with each array once the cluster has accepted it
};

/// An entry of the table of launchers.
struct LauncherType {
  std::unique_ptr<Launcher> (*make)(const LauncherSetup& order);
  /// Throws Error for options that this launcher rejects. Null if the launcher accepts all options.
  void (*check_options)(const ClusterOptions& options) = nullptr;
  /// Throws Error if this machine lacks the programs of the scheduler. Null if the launcher needs no programs.
  void (*check_installed)() = nullptr;
};

/// The names in the table of launchers (palpate_sweep.cmake). A program can use them without linking the launchers.
inline constexpr std::array kLaunchers{
#define PALPATE_LAUNCHER(name, is_cluster) #name,
#include "launch/launcher_table.inc"
#undef PALPATE_LAUNCHER
};

/// Returns whether a launcher is a cluster, where jobs continue without this process.
constexpr bool is_cluster(std::string_view launcher) {
#define PALPATE_LAUNCHER(name, is_cluster) \
  if (launcher == #name) return is_cluster;
#include "launch/launcher_table.inc"
#undef PALPATE_LAUNCHER
  return false;
}

/// Returns the entry with this name, one of kLaunchers.
const LauncherType& launcher_type(const std::string& name);

}  // namespace palpate
