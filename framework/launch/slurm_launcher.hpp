// SPDX-License-Identifier: MIT
// The launcher for clusters with Slurm. It submits job arrays; each task of an array resumes a few jobs of the sweep
// with `palpate resume DIR --jobs`. A task reads the directory when it runs, and skips jobs that are done or that
// another process runs. No job therefore runs twice, even if it is submitted several times. The state that Slurm
// reports is only a hint.
#pragma once

#include "launch/launcher.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

extern const LauncherType slurm_launcher;

/// Returns `text` as one word of a shell, in quotes if necessary.
std::string shell_word(const std::string& text);

/// Throws Error for words that are not options of sbatch, and for options that palpate itself sets.
void check_sbatch_words(const std::vector<std::string>& words);

/// Returns the script of the tasks. The number of a task is its array index plus the first argument of the script. Task
/// t resumes the jobs in line t, counted from 0, of the file `jobs`. The tasks have the working directory, the plugins
/// and the instruction set of this process. All paths are absolute.
std::string task_script(const std::filesystem::path& program, const std::filesystem::path& directory,
                        const std::filesystem::path& jobs, const LaunchOptions& options);

}  // namespace palpate
