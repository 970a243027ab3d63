// SPDX-License-Identifier: MIT
// Executes a sweep: a launcher runs the open jobs, and the results are read from the directories of the jobs.
#pragma once

#include "launch/launcher.hpp"
#include "sweep/sweep.hpp"

#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace palpate {

/// Progress of the jobs of this launch.
struct SweepProgress {
  int jobs = 0;
  int done = 0;
  int failed = 0;
  int running = 0;
  int before = 0;        ///< jobs done or failed before the launch
  bool blocked = false;  ///< see Launcher::PollResult
  bool last = false;
};

/// A failed job.
struct FailedJob {
  std::size_t job = 0;
  int attempts = 0;
  std::string reason;
};

/// The states of some jobs, according to their directories.
struct JobStates {
  std::map<RunStatus::State, int> counts;
  std::vector<std::size_t> open;    ///< jobs to run: neither done, nor failed, nor known to be running
  std::vector<FailedJob> failures;  ///< failed jobs; like `open`, in the order of the jobs
};

/// Additional checks by read_job_states(). `missing_files`: a done job that lacks some of its files, as after a power
/// cut, counts as open. `running`: an unfinished job that a process runs counts as running.
enum class JobCheck { nothing, missing_files, running };

/// Reads the states of `jobs`. The check `missing_files` is reliable only if this node ran the jobs or if no job runs
/// yet, because NFS may hide files of other nodes for a minute.
JobStates read_job_states(const Sweep& sweep, const std::vector<std::size_t>& jobs,
                          JobCheck also = JobCheck::missing_files);

/// Adds all failed jobs to the open jobs, regardless of their number of attempts.
void reopen_failed(JobStates& standing);

/// Runs the open jobs with `launcher`, and waits until the launcher has returned all of them (Launcher::PollResult). If
/// `interrupted` becomes true, cancels the jobs. `progress` is called after each event and at least every half second.
///
/// Returns whether all ended jobs have a record of their end and, if they ran on this machine, all their files. On a
/// full disk, records or files may be missing. If the sweep's directory is moved or removed meanwhile, cancels the jobs
/// and throws Error.
bool execute_jobs(Launcher& launcher, const Sweep& sweep, JobStates begun, const std::atomic<bool>* interrupted,
                  const std::function<void(const SweepProgress&)>& progress);

}  // namespace palpate
