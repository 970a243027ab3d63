// SPDX-License-Identifier: MIT
// The run that a command is given, for the commands that read one run and change nothing.
#pragma once

#include "cli/commands.hpp"
#include "record/recording.hpp"

namespace palpate::cli {

/// Reads the run in `directory`. Throws Error, that of a sweep saying which of its folders are runs.
Recording read_one_run(const Program& program, const std::filesystem::path& directory);

}  // namespace palpate::cli
