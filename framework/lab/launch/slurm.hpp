// SPDX-License-Identifier: MIT
// The only door to Slurm: its commands sbatch, squeue, scontrol, sinfo and scancel, and what they print. Nothing here
// knows of jobs; a task is one index of an array.
#pragma once

#include "children/child_process.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate::slurm {

/// How many tasks the controller takes as one array, numbered from 0: from what `scontrol show config` prints. Throws
/// Error when it says nothing of arrays, or takes none.
int parse_most_tasks(const std::string& config);

/// The most CPUs that a node of `partition` has, from lines "PARTITION|CPUS"; other lines are skipped. The cluster's
/// default one, where jobs go that name none, has an asterisk behind it, and is meant by "".
int parse_most_cpus(const std::string& lines, const std::string& partition);

/// A task in the queue: it waits, runs, or is about to be gone.
struct Task {
  int array = 0;
  int index = 0;
  bool waiting = false;
};
/// From lines "ARRAY|INDEX|STATE" with the short names of states; other lines, and jobs that are no arrays, are
/// skipped.
std::vector<Task> parse_queue(const std::string& lines);

/// The array's id in what `sbatch --parsable` printed, warnings around it or not.
std::optional<int> parse_array_id(const std::string& output);

/// What a program of Slurm said, in one line without its name before each.
std::string words_of(const std::string& output);

/// Throws Error where Slurm's commands are not installed; asks no daemon.
void check_installed();

/// Asks the controller. Throws Error when Slurm is not installed or does not answer.
int most_tasks();

/// The most CPUs that a node has in `partition`, or in the cluster's default one for "": 0 when that is not known.
/// Throws Error as most_tasks() does.
int most_cpus(const std::string& partition);

/// Submits by `sbatch` with `words` behind it and returns the array's id. Throws Error in sbatch's words.
int submit(const std::vector<std::string>& words);

/// Takes these arrays out of the queue; what runs is told to end. Throws Error.
void cancel(const std::vector<int>& arrays);

/// Looks at the queue now and then, without waiting for an answer.
class Watch {
 public:
  /// Waits until squeue says something or `seconds` are over, but not beyond a signal; asks at most once a second.
  /// Returns this user's tasks when it has answered, none when it has not yet, or with trouble().
  std::optional<std::vector<Task>> look(double seconds);

  /// Seconds since it last answered, or since the watch began.
  double silence() const;
  /// What it said when it last failed; "" when it did not.
  const std::string& trouble() const { return trouble_; }

 private:
  using Clock = std::chrono::steady_clock;
  std::unique_ptr<ChildProcess> query_;
  Clock::time_point next_ = Clock::now();  ///< question
  Clock::time_point answered_ = Clock::now();
  std::string trouble_;
};

}  // namespace palpate::slurm
