// SPDX-License-Identifier: MIT
// A sweep under way: hands what is missing to a launcher and reads from the jobs' directories what became of it.
#pragma once

#include "launch/launcher.hpp"
#include "sweep/sweep.hpp"

#include <atomic>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace palpate {

/// Counts while a sweep runs, of the jobs in question.
struct SweepProgress {
  int jobs = 0;
  int done = 0;
  int failed = 0;
  int running = 0;
  int before = 0;        ///< of done and failed: those that were so when it began
  bool blocked = false;  ///< a job could not begin, for a reason that the others have, too: see Launcher::State
  bool last = false;
};

/// A job that failed.
struct SweepFailure {
  std::size_t job = 0;
  int attempts = 0;
  std::string reason;
};

/// Where some jobs of a sweep stand, by their directories.
struct Standing {
  std::map<RunStatus::State, int> counts;
  std::vector<std::size_t> open;       ///< neither done nor failed, nor known to be running
  std::vector<SweepFailure> failures;  ///< both in the order of the jobs
};

/// What is asked of jobs beside their records: nothing; whether one that is done lacks files, as after a power cut, and
/// so is open; whether a process has an unfinished one in hand.
enum class Also { nothing, missing_files, running };

/// Looks through `jobs`. Only where this node ran the jobs itself, or before any runs, `missing_files` has an answer:
/// NFS may hide files of other nodes for a minute.
Standing standing_of(const Sweep& sweep, const std::vector<std::size_t>& jobs, Also also = Also::missing_files);

/// Makes the failed jobs open again, however often they were begun.
void try_again(Standing& standing);

/// Has `launcher` run what is open, where jobs stand as in `begun`, and waits until it has none in its hands, or until
/// `interrupted`, when it cancels them. `progress` is called when something changed and at least every half second.
/// Returns whether each job that ended has a record of its end, and its files where this machine ran it: on a full disk
/// not even a failure may get one. Throws
/// Error where the sweep's directory is moved or removed meanwhile, when it has cancelled them.
bool conduct(Launcher& launcher, const Sweep& sweep, Standing begun, const std::atomic<bool>* interrupted,
             const std::function<void(const SweepProgress&)>& progress);

}  // namespace palpate
