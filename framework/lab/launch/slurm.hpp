// SPDX-License-Identifier: MIT
// The only door to Slurm: its commands sbatch, squeue, scontrol and scancel, and what they print. Nothing here knows of
// jobs; a task is one index of an array.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace palpate::slurm {

/// How many tasks the controller takes as one array, numbered from 0: from what `scontrol show config` prints. Throws
/// Error when it says nothing of arrays, or takes none.
int parse_most_tasks(const std::string& config);

/// A task in the queue: it waits, runs, or is about to be gone.
struct Task {
  int array = 0;
  bool waiting = false;
};
/// From lines "ARRAY STATE" with the short names of states; other lines are skipped.
std::vector<Task> parse_queue(const std::string& lines);

/// The array's id in what `sbatch --parsable` printed, warnings around it or not.
std::optional<int> parse_array_id(const std::string& output);

/// What a program of Slurm said, in one line without its name before each.
std::string words_of(const std::string& output);

/// Throws Error where Slurm's commands are not installed; asks no daemon.
void check_installed();

/// Asks the controller. Throws Error when Slurm is not installed or does not answer.
int most_tasks();

struct Submission {
  int array = 0;
  std::string doubt;  ///< why no node can run it now, in sbatch's words; "" if one can
};
/// Submits by `sbatch` with `words` behind it. Throws Error in sbatch's words. What no node can ever run and what waits
/// for nodes that are drained look the same, so both are submitted, with a doubt.
Submission submit(const std::vector<std::string>& words);

/// This user's tasks. Throws Error when squeue does not answer.
std::vector<Task> queue();

/// Takes these arrays out of the queue; what runs is told to end. Throws Error.
void cancel(const std::vector<int>& arrays);

}  // namespace palpate::slurm
