// SPDX-License-Identifier: MIT
// The results of a bundle: outputs of commands over its records.
#pragma once

#include "bundle/bundle.hpp"
#include "cli/command_context.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpate::cli {

/// Returns the words of a command that is written as one text, such as "compare --by acquisition --metric rmse_m".
/// Quotes keep blanks together. Throws Error for commands other than compare, pareto and curves.
CommandWords result_command(const std::string& text);

/// Returns the outputs of a command over these records, by their names in the folder of the result. `compare` gives
/// table.csv (with --format: of that format), `pareto` table.txt, `curves` curves.csv: the numbers of the picture.
/// Throws Error if the command fails. `scratch`: an existing folder.
std::map<std::string, std::string> result_files(const CommandEnvironment& program, const CommandWords& command,
                                                const std::vector<std::filesystem::path>& records,
                                                const std::filesystem::path& scratch);

/// Returns one line per difference between two outputs of a command, the content of the file `name`. Unless `exact`,
/// numbers may differ by kNumberTolerance.
std::vector<std::string> compare_outputs(const std::string& recorded, const std::string& now, const std::string& name,
                                         bool exact);

}  // namespace palpate::cli
