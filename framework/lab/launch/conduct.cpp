// SPDX-License-Identifier: MIT
#include "launch/conduct.hpp"

#include "launch/job.hpp"

#include <palpate/error.hpp>

namespace palpate {
namespace {

constexpr double kPollSeconds = 0.5;

RunStatus::State state_of(const Sweep& sweep, std::size_t job) {
  return read_ending(job_directory(sweep, sweep.jobs[job])).state;
}

/// Whether the sweep's folder is no longer there. A file system that cannot tell just now has not lost it.
bool is_gone(const Sweep& sweep) {
  std::error_code trouble;
  return !std::filesystem::exists(sweep.directory / "manifest.jsonl", trouble) && !trouble;
}

}  // namespace

Missing find_missing(const Sweep& sweep, const std::vector<std::size_t>& jobs, bool retry_failed, int most_attempts) {
  Missing out;
  for (const std::size_t job : jobs) {
    const RunStatus::State state = state_of(sweep, job);
    const bool again = state == RunStatus::State::failed && retry_failed &&
                       attempts_of(job_directory(sweep, sweep.jobs[job])) < most_attempts;
    if (state == RunStatus::State::done) {
      ++out.done;
    } else if (state == RunStatus::State::failed && !again) {
      ++out.failed;
    } else {
      out.jobs.push_back(job);
    }
  }
  return out;
}

void conduct(Launcher& launcher, const Sweep& sweep, const Missing& missing, const std::atomic<bool>* interrupted,
             const std::function<void(const SweepProgress&)>& progress) {
  SweepProgress counts;
  counts.done = missing.done;
  counts.failed = missing.failed;
  counts.before = missing.done + missing.failed;
  counts.jobs = counts.before + static_cast<int>(missing.jobs.size());
  bool gone = false;
  bool cancelled = false;
  launcher.submit(missing.jobs);
  Launcher::State state;
  do {
    gone = gone || is_gone(sweep);
    if (!cancelled && (gone || (interrupted != nullptr && interrupted->load()))) {
      launcher.cancel();
      cancelled = true;
    }
    state = launcher.poll(kPollSeconds);
    counts.running = state.running;
    if (gone) {
      counts.last = state.empty_handed();
      continue;
    }
    for (const std::size_t job : state.returned) {
      const RunStatus::State now = state_of(sweep, job);
      const bool done = now == RunStatus::State::done;
      // Where not even a failure could be recorded, as on a full disk, there is none to be read.
      const bool lost = !done && !cancelled && !is_running(job_directory(sweep, sweep.jobs[job]));
      counts.done += done ? 1 : 0;
      counts.failed += now == RunStatus::State::failed || lost ? 1 : 0;
    }
    counts.last = state.empty_handed();
    progress(counts);
  } while (!counts.last);
  if (!gone && !is_gone(sweep)) return;
  throw Error(sweep.directory.string(), "was moved or removed while its jobs were under way",
              "where it was moved to, 'palpate resume' carries on; otherwise begin it again with 'palpate sweep'",
              Error::Kind::run);
}

SweepReport report_on(const Sweep& sweep, const std::vector<std::size_t>& jobs) {
  SweepReport report;
  for (const std::size_t job : jobs) {
    const std::filesystem::path directory = job_directory(sweep, sweep.jobs[job]);
    const RunStatus status = read_ending(directory);
    if (status.state == RunStatus::State::failed) {
      report.failures.push_back({job, attempts_of(directory), status.stop_reason});
    } else if (status.state != RunStatus::State::done) {
      ++report.unfinished;
    }
  }
  return report;
}

}  // namespace palpate
