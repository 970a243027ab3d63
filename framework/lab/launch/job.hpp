// SPDX-License-Identifier: MIT
// One job of a sweep, run at most once to its end however many processes try. The guarantee is here and needs nobody's
// good behaviour:
//
// 1. the lock of the job's record is taken, or the job is busy;
// 2. under it, the last line of the record says whether there is anything to do;
// 3. the attempt is appended, then the run begins or goes on behind its last recorded tap;
// 4. the line `end` is the result, and summary.json its copy. What dies before it leaves an unfinished run, to be
//    carried on.
#pragma once

#include "record/session.hpp"

#include <filesystem>
#include <string>

namespace palpate {

/// How an attempt at a job ended, and the exit status of a process that made it.
enum class JobEnd {
  done = 0,           ///< now or before
  failed = 1,         ///< now or before; the record has the reason
  unrecorded = 2,     ///< not even that could be recorded
  blocked = 3,        ///< its arm or its program cannot be had now, and the child has said kBlocked; the job stays open
  busy = 75,          ///< another process has it in hand; nothing was done
  interrupted = 130,  ///< by the user's wish; it can be carried on
};

/// What a child says before it ends with `blocked`: a plugin may end it with any status.
inline constexpr const char* kBlocked = "blocked";

/// Runs the job in `directory`, whose name is its id, unless it is done, or has failed and is not to be tried again.
/// What goes wrong becomes the reason of its failure; but a config that was deleted is none, as `palpate sweep` puts it
/// back. Throws Error where nothing is recorded, and where a file of a job that is done cannot be written; of kind
/// `busy` where another process has the arm in hand, or the program is not as it was.
JobEnd run_job(const Workshop& workshop, const std::filesystem::path& directory, const ResumeOptions& options);

/// Whether the job is done or has failed.
bool has_ended(const std::filesystem::path& directory);

/// How often the job has been begun since it last came to an end, as its record says.
int attempts_of(const std::filesystem::path& directory);

/// Ends the job as failed, unless it has ended or somebody has it in hand: for processes that died over it.
void record_failure(const std::filesystem::path& directory, const std::string& reason);

}  // namespace palpate
