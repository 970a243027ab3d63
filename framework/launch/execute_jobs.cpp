// SPDX-License-Identifier: MIT
#include "launch/execute_jobs.hpp"

#include "launch/job.hpp"
#include "sweep/read_jobs.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <utility>

namespace palpate {
namespace {

constexpr double kPollSeconds = 0.5;

/// Returns whether the sweep's folder no longer exists. Returns false if the file system reports an error.
bool is_gone(const Sweep& sweep) {
  std::error_code trouble;
  return !std::filesystem::exists(sweep.directory / "manifest.jsonl", trouble) && !trouble;
}

/// The state of a job.
struct JobState {
  RunStatus::State state = RunStatus::State::absent;
  int attempts = 0;  ///< number of attempts of a failed job
  std::string reason;
};

JobState look_at(const std::filesystem::path& directory, JobCheck also) {
  RunStatus status = also == JobCheck::running ? read_standing(directory) : read_ending(directory);
  // The job counts as unfinished, so that a process resumes it; run_job() then only restores the missing files.
  if (also == JobCheck::missing_files && status.state == RunStatus::State::done && lacks_files(directory, *status.end))
    status.state = RunStatus::State::unfinished;
  if (status.state != RunStatus::State::failed) return {status.state, 0, ""};
  return {status.state, attempts_of(directory), std::move(status.stop_reason)};
}

}  // namespace

JobStates read_job_states(const Sweep& sweep, const std::vector<std::size_t>& jobs, JobCheck also) {
  JobStates out;
  const auto look = [also](const std::filesystem::path& directory) { return look_at(directory, also); };
  read_jobs(sweep, jobs, look, [&](std::size_t job, JobState one) {
    ++out.counts[one.state];
    if (one.state == RunStatus::State::failed) {
      out.failures.push_back({job, one.attempts, std::move(one.reason)});
    } else if (one.state != RunStatus::State::done && one.state != RunStatus::State::running) {
      out.open.push_back(job);
    }
  });
  return out;
}

void reopen_failed(JobStates& standing) {
  for (const FailedJob& one : standing.failures) standing.open.push_back(one.job);
  standing.failures.clear();
  std::sort(standing.open.begin(), standing.open.end());
}

bool execute_jobs(Launcher& launcher, const Sweep& sweep, JobStates begun, const std::atomic<bool>* interrupted,
                  const std::function<void(const SweepProgress&)>& progress) {
  SweepProgress counts;
  counts.done = begun.counts[RunStatus::State::done];
  counts.failed = static_cast<int>(begun.failures.size());
  counts.before = counts.done + counts.failed;
  counts.jobs = counts.before + static_cast<int>(begun.open.size());
  bool gone = false;
  bool all_recorded = true;
  bool cancelled = false;
  launcher.submit(begun.open);
  Launcher::PollResult state;
  do {
    gone = gone || is_gone(sweep);
    if (!cancelled && (gone || (interrupted != nullptr && interrupted->load()))) {
      launcher.cancel();
      cancelled = true;
    }
    state = launcher.poll(kPollSeconds);
    counts.running = state.running;
    counts.blocked = counts.blocked || state.blocked;
    counts.last = state.empty_handed();
    all_recorded = all_recorded && state.all_recorded;
    if (gone) continue;
    for (const std::size_t job : state.returned) {
      const std::filesystem::path directory = job_directory(sweep, sweep.jobs[job]);
      // Only the record is read, because other files are written after its last line, and NFS may delay them by a
      // minute.
      const RunStatus now = read_ending(directory);
      const bool done = now.state == RunStatus::State::done;
      // On a full disk, not even the failure can be recorded.
      const bool failed = now.state == RunStatus::State::failed;
      const bool lost = !done && !failed && !cancelled && !is_running(directory);
      all_recorded = all_recorded && !lost;
      counts.done += done ? 1 : 0;
      counts.failed += failed || lost ? 1 : 0;
    }
    progress(counts);
  } while (!counts.last);
  if (!gone && !is_gone(sweep)) return all_recorded;
  throw Error(sweep.directory.string(), "was moved or removed while its jobs were running",
              "run 'palpate resume' on its new path, or start it again with 'palpate sweep'", Error::Kind::run);
}

}  // namespace palpate
