// SPDX-License-Identifier: MIT
// A sweep under way: hands what is missing to a launcher and reads from the jobs' directories what became of it.
#pragma once

#include "launch/launcher.hpp"
#include "sweep/sweep.hpp"

#include <atomic>
#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// Counts while a sweep runs, of the jobs in question.
struct SweepProgress {
  int jobs = 0;
  int done = 0;
  int failed = 0;
  int running = 0;
  int before = 0;  ///< of done and failed: those that were so when it began
  bool last = false;
};

/// A job that failed.
struct SweepFailure {
  std::size_t job = 0;
  int attempts = 0;
  std::string reason;
};

struct SweepReport {
  std::vector<SweepFailure> failures;  ///< of all jobs in question, in their order
  int unfinished = 0;                  ///< jobs that nobody ended
  bool interrupted = false;
};

/// Which jobs to run.
struct Missing {
  std::vector<std::size_t> jobs;  ///< neither done nor, unless they may be tried again, failed
  int done = 0;
  int failed = 0;  ///< that stay so
};

/// Looks through `jobs` (indices into Sweep::jobs). Failed ones are missing, too, when they are to be tried again and
/// were begun fewer than `most_attempts` times.
Missing find_missing(const Sweep& sweep, const std::vector<std::size_t>& jobs, bool retry_failed, int most_attempts);

/// Has `launcher` run what is `missing` of `jobs` and waits until it has none in its hands, or until `interrupted`,
/// when it cancels them. `progress` is called when something changed and at least every half second. Throws Error where
/// the sweep's directory is moved or removed meanwhile, when it has cancelled them.
void conduct(Launcher& launcher, const Sweep& sweep, const Missing& missing, const std::atomic<bool>* interrupted,
             const std::function<void(const SweepProgress&)>& progress);

/// What has become of `jobs`, from their directories.
SweepReport report_on(const Sweep& sweep, const std::vector<std::size_t>& jobs);

}  // namespace palpate
