// SPDX-License-Identifier: MIT
// The interface to Slurm: calls of sbatch, squeue, scontrol and scancel, and the parsing of their output. A task is one
// index of a job array. Nothing in this file depends on the jobs of a sweep.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace palpate::slurm {

/// Returns the maximum number of tasks in an array, from the output of `scontrol show config`. Throws Error if the
/// output has no limit, or if the cluster accepts no arrays.
int parse_most_tasks(const std::string& config);

/// A task in the queue. A task that does not wait runs or is about to end.
struct Task {
  int array = 0;
  bool waiting = false;
};
/// Parses lines "ARRAY STATE" with short state names. Other lines are skipped.
std::vector<Task> parse_queue(const std::string& lines);

/// Returns the array's id in the output of `sbatch --parsable`, which may contain warnings.
std::optional<int> parse_array_id(const std::string& output);

/// Returns the messages of a Slurm command as one line, without the name of the command.
std::string words_of(const std::string& output);

/// Throws Error if Slurm's commands are not installed. Does not contact the Slurm daemons.
void check_installed();

/// Asks the controller for the maximum number of tasks in an array. Throws Error if Slurm is not installed or does not
/// answer.
int most_tasks();

struct Submission {
  int array = 0;
  std::string doubt;  ///< message of sbatch if no node can run the array now; else ""
};
/// Submits an array: `sbatch` with `words`. Throws Error with the message of sbatch. sbatch does not distinguish an
/// array that can never run from an array that waits for drained nodes. In both cases, the array is submitted, and
/// `doubt` contains the message of sbatch.
Submission submit(const std::vector<std::string>& words);

/// Returns this user's tasks. Throws Error if squeue does not answer.
std::vector<Task> queue();

/// Removes arrays from the queue and ends their running tasks. Throws Error.
void cancel(const std::vector<int>& arrays);

}  // namespace palpate::slurm
