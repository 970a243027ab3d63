// SPDX-License-Identifier: MIT
// Executes one job of a sweep. The job runs to its end at most once, even if several processes try to run it. This
// guarantee does not depend on the launchers:
//
// 1. The process locks the job's record; if another process has the lock, the job is busy.
// 2. The last line of the record shows whether the job has already ended.
// 3. The process appends a line `attempt`, and starts the run or resumes it after its last recorded tap.
// 4. The line `end` is the result, and summary.json is its copy. A process that dies earlier leaves an unfinished run,
//    which can be resumed.
#pragma once

#include "record/run.hpp"

#include <filesystem>
#include <string>

namespace palpate {

/// The end of an attempt, also used as the exit status of the child process.
enum class JobEnd {
  done = 0,           ///< the job is done, by this attempt or an earlier one
  failed = 1,         ///< the job has failed, in this attempt or an earlier one; the record has the reason
  unrecorded = 2,     ///< the end could not be recorded
  blocked = 3,        ///< the arm or the program is not available; the job stays open
  busy = 75,          ///< another process runs the job; nothing was done
  interrupted = 130,  ///< the user interrupted the job, which can be resumed
};

/// Message that a child writes before it ends with `blocked`. It is needed because a plugin may end the child with the
/// same status.
inline constexpr const char* kBlocked = "blocked";

/// Runs the job in `directory`, whose name is the job's id. Does nothing if the job is done, or has failed and
/// options.retry_failed is false. An error is recorded as a failure of the job, unless the config was deleted: `palpate
/// sweep` writes it again, or `palpate resume` in a race.
///
/// Throws Error if nothing can be recorded, or if a missing file of a done job cannot be restored. Throws Error of kind
/// `busy` if another process uses the arm, or if the external program has changed.
JobEnd run_job(const RunEnvironment& environment, const std::filesystem::path& directory, const ResumeOptions& options);

/// Returns whether the job is done or has failed.
bool has_ended(const std::filesystem::path& directory);

/// Returns the number of attempts in the last series of recorded attempts without an `end` between them: see
/// attempts_in_row().
int attempts_of(const std::filesystem::path& directory);

/// Records a failure of a job whose process died, unless the job has ended or another process runs it.
void record_failure(const std::filesystem::path& directory, const std::string& reason);

}  // namespace palpate
