// SPDX-License-Identifier: MIT
// Shell completion of commands, options, configs, groups, keys, values, plugins and runs. The scripts in cli/shells
// call the program each time the user presses Tab, and offer files if there is no completion.
#pragma once

#include "cli/program.hpp"

#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace palpate::cli {

/// A completion of a word.
struct Completion {
  std::string word;     ///< the whole word; more may follow after '=', '.', '/' or ','
  std::string meaning;  ///< one line; may be ""
};

/// Returns the completions of the last of `words`, the words after `palpate`. The last word may be empty or incomplete.
/// Nothing is written, run or built, broken configs and plugins are skipped, and only the plugins whose options are
/// needed are opened.
std::vector<Completion> completions(CLI::App& app, Program& program, const std::vector<std::string>& words);

}  // namespace palpate::cli
