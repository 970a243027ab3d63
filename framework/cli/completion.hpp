// SPDX-License-Identifier: MIT
// Shell completion of commands, options, configs, groups, keys, values, plugins and runs. The scripts in cli/shells
// call the program each time the user presses Tab. If there is no completion, the scripts offer files.
#pragma once

#include "cli/command_context.hpp"

#include <string>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace palpate::cli {

/// A possible completion of a word.
struct Completion {
  std::string word;     ///< the completed word; if it ends with '=', '.', '/' or ',', more text may follow
  std::string meaning;  ///< one line; may be ""
};

/// Returns the completions of the last of `words`, the words after `palpate`. The last word may be empty or incomplete.
/// The function writes no files, starts no run and builds nothing. It skips broken configs and plugins, and loads a
/// plugin only if it needs the plugin's options.
std::vector<Completion> completions(CLI::App& app, CommandEnvironment& program, const std::vector<std::string>& words);

}  // namespace palpate::cli
