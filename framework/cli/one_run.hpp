// SPDX-License-Identifier: MIT
// The run that a command is given, for the commands that read one run and change nothing.
#pragma once

#include "cli/commands.hpp"
#include "record/recording.hpp"

namespace palpate::cli {

/// Throws Error for the directory of a sweep, saying which of its folders are runs.
void check_one_run(const std::filesystem::path& directory);

/// Reads the run in `directory`. Throws Error, as check_one_run() does.
Recording read_one_run(const Program& program, const std::filesystem::path& directory);

}  // namespace palpate::cli
