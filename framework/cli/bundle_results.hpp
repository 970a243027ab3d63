// SPDX-License-Identifier: MIT
// The results of a bundle: outputs of commands over its records.
#pragma once

#include "bundle/bundle.hpp"
#include "cli/command_context.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace palpate::cli {

/// Directories of the records of a bundle, by their folders in it.
using BundledRecords = std::map<std::string, std::filesystem::path>;

/// Throws Error for commands other than compare, pareto and curves, for options that write files or that are unknown,
/// and for a name that no record has.
void check_result_command(const CommandWords& command, const BundledRecords& records);

/// Returns name and content of the output of a command: table.csv of compare, table.txt of pareto, or curves.csv. The
/// words before the first option are names of runs and sweeps; without such words, the command uses all records. Throws
/// Error if the command fails. `scratch`: an existing folder.
std::pair<std::string, std::string> result_of(const CommandEnvironment& program, const CommandWords& command,
                                              const BundledRecords& records, const std::filesystem::path& scratch);

/// Returns one line per difference between two outputs of a command, the content of the file `name`. Unless `exact`,
/// numbers may differ by kNumberTolerance.
std::vector<std::string> compare_outputs(const std::string& recorded, const std::string& now, const std::string& name,
                                         bool exact);

}  // namespace palpate::cli
