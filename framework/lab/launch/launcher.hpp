// SPDX-License-Identifier: MIT
// Who runs the jobs of a sweep, and where. A launcher takes jobs and lets go of them; whether a job is done it does not
// say, because schedulers err: that stands in the job's directory alone, and the job itself (launch/job.hpp) sees to it
// that nothing runs twice, however many launchers have it in hand.
//
// A new one is a class in files of its own, and stands in kLaunchers and make_launcher() below.
#pragma once

#include "record/session.hpp"
#include "sweep/sweep.hpp"

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace palpate {

class Launcher {
 public:
  /// What poll() saw.
  struct State {
    std::vector<std::size_t> returned;  ///< jobs that it let go since the last call, in whatever state
    bool all_recorded = true;           ///< false where one of them could not record its end or write its files
    bool blocked = false;               ///< a job could not begin, nor could the next, so that none is waiting now
    int running = 0;                    ///< jobs, as far as it knows
    int waiting = 0;                    ///< jobs
    bool empty_handed() const { return running == 0 && waiting == 0; }
  };

  virtual ~Launcher() = default;

  /// Takes these jobs (indices into Sweep::jobs, ascending, none of them in its hands) and returns without waiting for
  /// any. Throws Error when none can be taken.
  virtual void submit(const std::vector<std::size_t>& jobs) = 0;

  /// Waits until something happens, but not for more than `seconds`, nor beyond a signal, nor with empty hands. Throws
  /// Error when nothing can be known any more.
  virtual State poll(double seconds) = 0;

  /// Asks what runs to stop after the tap under way, and forgets what waits; what is running is still returned.
  virtual void cancel() = 0;

  /// The command by which a user ends what goes on without this process; "" where nothing does.
  virtual std::string stop_command() const { return {}; }
};

/// How jobs are to be run.
struct LaunchOptions {
  int workers = 1;              ///< jobs at a time; on a cluster those of a task, each with a core of its own
  ResumeOptions resume;         ///< for every job
  int most_attempts = 3;        ///< a job that was begun so often and always killed has failed
  bool wait_for_others = true;  ///< here: jobs that other processes have in hand are awaited, in case those die
  // On a cluster:
  bool one_at_a_time = false;       ///< tasks, of all arrays together
  std::vector<std::string> more{};  ///< words for sbatch, each with its dashes
  int jobs_per_task = 1;
};

/// An array of tasks in the queue of a cluster.
struct TaskArray {
  int id = 0;
  int tasks = 0;
  int jobs = 0;  ///< that are missing
  std::filesystem::path logs;
  std::string doubt;  ///< why nothing can run it now, in the scheduler's words; "" if something can
};

/// What a launcher is made from. Workshop and sweep must outlive it.
struct LaunchOrder {
  const Workshop& workshop;
  const Sweep& sweep;
  LaunchOptions options;
  std::function<void(const TaskArray&)> submitted;  ///< hears of every array as soon as a cluster has taken it
};

/// The launcher of this machine; all others are clusters, where jobs go on without this process.
inline constexpr const char* kLocal = "local";
/// Their names: what --launcher takes.
inline constexpr std::array<const char*, 2> kLaunchers{kLocal, "slurm"};

std::unique_ptr<Launcher> local_launcher(const LaunchOrder& order);
std::unique_ptr<Launcher> slurm_launcher(const LaunchOrder& order);

/// The launcher of one of the names. Here, because a program that reads the names alone has none of them.
inline std::unique_ptr<Launcher> make_launcher(const std::string& name, const LaunchOrder& order) {
  return name == "slurm" ? slurm_launcher(order) : local_launcher(order);
}

}  // namespace palpate
