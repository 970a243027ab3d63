// SPDX-License-Identifier: MIT
// The launcher of clusters under Slurm: arrays whose tasks each carry on a few jobs of the sweep with `palpate resume
// DIR --jobs`. What a task does is decided when it runs, from the directory: jobs that are done or in other hands are
// left alone, so nothing runs twice however often it is submitted, and what Slurm says is only ever a hint.
#pragma once

#include "launch/launcher.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

extern const LauncherType slurm_launcher;

/// `text` as one word of a shell, in quotes only where it needs them.
std::string shell_word(const std::string& text);

/// Throws Error for words to sbatch that palpate says itself, or that are no options.
void check_sbatch_words(const std::vector<std::string>& words);

/// The script of the tasks. Task t, which is the array's index plus the script's first argument, carries on the jobs of
/// line t, from 0, of the file `jobs`, in the folder and with the plugins and instructions of this process. All paths
/// are absolute.
std::string task_script(const std::filesystem::path& program, const std::filesystem::path& directory,
                        const std::filesystem::path& jobs, const LaunchOptions& options);

}  // namespace palpate
