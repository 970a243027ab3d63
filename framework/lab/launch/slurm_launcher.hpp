// SPDX-License-Identifier: MIT
// The launcher of clusters under Slurm: arrays whose tasks each carry on a few jobs of the sweep with `palpate resume
// DIR --jobs`. What a task does is decided when it runs, from the directory: jobs that are done or in other hands are
// left alone, so nothing runs twice however often it is submitted, and what Slurm says is only ever a hint.
#pragma once

#include "launch/launcher.hpp"
#include "launch/slurm.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// `text` as one word of a shell, in quotes only where it needs them.
std::string shell_word(const std::string& text);

/// Throws Error for words to sbatch that palpate says itself, or that are no options.
void check_sbatch_words(const std::vector<std::string>& words);

/// The script of the tasks. Task t, which is the array's index plus the script's first argument, carries on the jobs of
/// line t, from 0, of the file `jobs`. All paths are absolute; `plugin_path` is what PALPATE_PLUGIN_PATH is to be, none
/// for unset.
std::string task_script(const std::filesystem::path& program, const std::filesystem::path& directory,
                        const std::filesystem::path& jobs, const LaunchOptions& options,
                        const std::optional<std::string>& plugin_path);

class SlurmLauncher final : public Launcher {
 public:
  /// `submitted` hears of every array as soon as Slurm has taken it. `program` is palpate, on a file system that the
  /// nodes share, as the sweep is. The sweep must outlive the launcher; what was submitted does not end with it.
  SlurmLauncher(std::filesystem::path program, const Sweep& sweep, LaunchOptions options,
                std::function<void(const TaskArray&)> submitted)
      : program_(std::move(program)), sweep_(sweep), options_(std::move(options)), submitted_(std::move(submitted)) {}

  /// Writes the script, and which task has which of `jobs`, to slurm/N in the sweep's directory, where the logs will
  /// be, and submits it. Throws Error when Slurm cannot be asked, when no node has as many cores as a
  /// task is to have, or when an array is refused; those that `submitted` heard of stay.
  void submit(const std::vector<std::size_t>& jobs) override;

  /// A job has returned when its result is there or its task has left the queue. Throws Error when Slurm has said
  /// nothing for ten minutes.
  State poll(double seconds) override;

  void cancel() override;

  std::string stop_command() const override;

 private:
  using Place = std::pair<int, int>;  ///< array and index
  struct TaskState {
    std::vector<std::size_t> jobs;  ///< that have not returned
    bool waiting = true;
  };

  void check_cores() const;
  std::filesystem::path make_folder() const;
  /// For an array of `count` tasks from `first` on.
  std::vector<std::string> words_for(std::size_t first, std::size_t count, const std::filesystem::path& folder) const;

  std::filesystem::path program_;
  const Sweep& sweep_;
  std::filesystem::path directory_ = absolute(sweep_.directory / "").lexically_normal().parent_path();
  LaunchOptions options_;
  std::function<void(const TaskArray&)> submitted_;
  std::vector<int> arrays_;
  std::map<Place, TaskState> tasks_;
  slurm::Watch watch_;
};

}  // namespace palpate
